//! The names of rooms.

use glam::DVec2;
use svg::node::element::Group;

use super::furniture::symbols;
use super::parts::{filled, room_color};
use super::path::PathData;
use super::style::{self, Color, Texture};
use super::text::{Align, CAPITAL_HEIGHT, Typesetter};
use super::view::View;
use crate::geometry::Rect;
use crate::world::{Room, World};

/// More names than a picture has room for.
const MOST_NAMES: usize = 5000;

/// Names give way to no more obstacles than these.
const MOST_OBSTACLES: usize = 500;

/// The height of a line of a label, as a share of its font size.
const LINE: f64 = 1.25;

/// Names in the middle of their rooms, where they fit, with the difficulty below; above or below
/// the middle where start, goal or another name are in the way, or an obstacle need not be.
pub(super) fn draw(world: &World, view: &View, typesetter: &Typesetter) -> Option<Group> {
    let [mut dark, mut light] = [PathData::new(2), PathData::new(2)];
    let mut taken = symbols(world, view);
    let unnamed = taken.len();
    let mut tried = 0;
    let grounds =
        world.surfaces.iter().filter(|s| style::surface(s.kind).1.texture != Texture::Plain);
    let obstacles = world.obstacles.iter().map(|o| &o.shape).chain(grounds.map(|s| &s.shape));
    let obstacles: Vec<_> =
        obstacles.take(MOST_OBSTACLES).map(|shape| view.px_rect(shape.bounds())).collect();
    for room in &world.rooms {
        let around = view.px_rect(room.shape.bounds());
        let size = around.size();
        if size.x < 24.0 || size.y < 10.0 {
            continue;
        }
        tried += 1;
        if tried > MOST_NAMES {
            break;
        }
        let lines = label(room, size - DVec2::new(6.0, 4.0), typesetter);
        if lines.is_empty() {
            continue;
        }
        let height = height_of(&lines);
        let width = lines.iter().map(|l| typesetter.width(&l.0, l.1)).fold(0.0, f64::max);
        let half = DVec2::new(0.5 * width, 0.5 * height);
        let aside = 0.5 * size.y - half.y - 7.0;
        let places = [0.0, 0.5, -0.5, 1.0, -1.0].map(|share| {
            let center = around.center() + DVec2::new(0.0, share * aside.max(0.0));
            Rect::new(center - half, center + half)
        });
        let apart = |at: &Rect, from: &[Rect]| from.iter().all(|other| !other.overlaps(*at));
        let free = || places.into_iter().filter(|at| apart(at, &taken));
        let Some(label) = free().find(|at| apart(at, &obstacles)).or_else(|| free().next()) else {
            continue;
        };
        taken.push(label);
        let ink = if room_color(room).lightness() > 0.52 { &mut dark } else { &mut light };
        let mut top = label.min.y;
        for (line, font) in lines {
            let baseline = top + (LINE + CAPITAL_HEIGHT) * 0.5 * font;
            let at = DVec2::new(around.center().x, baseline);
            typesetter.write(ink, &line, at, font, Align::Middle);
            top += LINE * font;
        }
    }
    if taken.len() == unnamed {
        return None;
    }
    let haloed = |path, color: Color, halo: Color| {
        filled(path, color)
            .set("stroke", halo.to_string())
            .set("stroke-width", 1.8)
            .set("stroke-opacity", 0.75)
            .set("stroke-linejoin", "round")
            .set("paint-order", "stroke")
    };
    let mut group = Group::new().set("id", "names");
    if !dark.is_empty() {
        group = group.add(haloed(dark, style::INK, style::PAGE));
    }
    if !light.is_empty() {
        group = group.add(haloed(light, style::PAGE, style::INK));
    }
    Some(group)
}

fn height_of(lines: &[(String, f64)]) -> f64 {
    lines.iter().map(|line| LINE * line.1).sum()
}

/// A room's label, line by line with font sizes: its name in one line or two, as large as fits,
/// else cut short, and its difficulty.
fn label(room: &Room, space: DVec2, typesetter: &Typesetter) -> Vec<(String, f64)> {
    let fits = |lines: &[(String, f64)]| {
        let inside = |line: &(String, f64)| typesetter.width(&line.0, line.1) <= space.x;
        height_of(lines) <= space.y && lines.iter().all(inside)
    };
    let with_difficulty = |mut lines: Vec<(String, f64)>, font: f64| {
        lines.extend(room.difficulty.map(|d| (format!("{d:.1}"), 0.85 * font)));
        lines
    };
    // Longer names than any room is wide are not measured again and again.
    let name: String = room.name.trim().chars().take(80).collect();
    let middle = name.len() / 2;
    let spaces = name.match_indices(' ').map(|(i, _)| i);
    let broken = spaces.min_by_key(|i| i.abs_diff(middle)).map(|i| (&name[..i], &name[i + 1..]));
    let one = |font: f64| (!name.is_empty()).then(|| vec![(name.clone(), font)]);
    let two = |font: f64| {
        broken.map(|(first, second)| vec![(first.to_owned(), font), (second.to_owned(), font)])
    };
    // One line unless that would be small.
    let full = [12.0, 11.0, 10.0, 9.0]
        .into_iter()
        .map(|font| (font, one(font)))
        .chain([10.0, 9.0, 8.0].map(|font| (font, two(font))))
        .chain([8.0, 7.0].map(|font| (font, one(font))))
        .filter_map(|(font, lines)| Some(with_difficulty(lines?, font)))
        .find(|lines| fits(lines));
    if let Some(lines) = full {
        return lines;
    }
    let cut = typesetter.fitted(&name, 8.0, space.x).filter(|cut| !cut.is_empty());
    let mut lines: Vec<_> = cut.into_iter().map(|cut| (cut, 8.0)).collect();
    lines = with_difficulty(lines, 9.0);
    while !fits(&lines) {
        lines.pop();
    }
    lines
}
