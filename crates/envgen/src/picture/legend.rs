//! The row below the plan, with scale bar and legend.

use glam::DVec2;
use svg::node::element::Group;

use super::parts::{self, Layer};
use super::path::PathData;
use super::raster;
use super::shapes::{filled, stroked};
use super::style::{self, Style};
use super::symbols::{arrow, difficulty_bar, flag, sample, scale_bar};
use super::text::{Align, CAPITAL_HEIGHT, Typesetter};
use super::view::View;
use crate::geometry::{Pose, Shape, edges};
use crate::palette;
use crate::scenario::Scenario;
use crate::world::{SurfaceKind, Wall, WallKind, World};

const LABEL_SIZE: f64 = 12.0;
const ROW: f64 = 23.0;
const GAP: f64 = 18.0;
const SAMPLE: DVec2 = DVec2::new(16.0, 11.0);
const BAR: f64 = 130.0;

/// Kerbs that are thinner than this, in px, cannot be distinguished from the edge of the road.
const LEAST_KERB: f64 = 0.4;

/// The greatest number of classes that are listed, by their number.
const MOST_CLASSES: usize = 12;

/// One entry of the legend.
#[derive(Clone, Debug)]
pub(super) enum Entry {
    Part(Style),
    Named(Style, String),
    Tree,
    Road,
    Unlit,
    Start,
    Goal,
    Difficulty,
    Note(String),
}

impl Entry {
    fn label(&self) -> &str {
        match self {
            Entry::Part(style) => style.name,
            Entry::Named(_, label) | Entry::Note(label) => label,
            Entry::Tree => "tree",
            Entry::Road => "road",
            Entry::Unlit => "unlit",
            Entry::Start => "start",
            Entry::Goal => "goal",
            Entry::Difficulty => "difficulty",
        }
    }

    fn sample_width(&self) -> f64 {
        match self {
            Entry::Difficulty => BAR,
            Entry::Note(_) => -6.0,
            Entry::Start => 32.0,
            _ => SAMPLE.x,
        }
    }
}

/// Returns the entries of a world's legend. The last ones explain the numbers in rooms.
pub(super) fn entries(
    world: &World,
    scenario: Option<&Scenario>,
    view: &View,
    numbers: &[String],
) -> Vec<Entry> {
    let mut entries = Vec::new();
    if world.start.is_some() {
        entries.push(Entry::Start);
    }
    if world.goal.is_some() {
        entries.push(Entry::Goal);
    }
    let mut part = |style| entries.push(Entry::Part(style));
    let walls = parts::wall_layers(world);
    walls.iter().rev().filter(|layer| is_seen(layer, view)).for_each(|layer| part(layer.style));
    parts::doorway_layers(world).iter().for_each(|layer| part(layer.style));
    if !world.trees.is_empty() {
        entries.push(Entry::Tree);
    }
    let obstacles = parts::obstacle_layers(world);
    entries.extend(obstacles.iter().map(|layer| Entry::Part(layer.style)));
    if !world.victims.is_empty() {
        entries.push(Entry::Part(style::VICTIM));
    }
    if let Some(Scenario { doors, people, smoke, .. }) = scenario {
        let moving = [
            (!doors.is_empty(), style::LEAF),
            (!people.is_empty(), style::PERSON),
            (!smoke.is_empty(), style::SMOKE),
        ];
        let there = moving.into_iter().filter(|(is_there, _)| *is_there);
        entries.extend(there.map(|(_, style)| Entry::Part(style)));
    }
    if !world.road_strips.is_empty() {
        entries.push(Entry::Road);
    }
    let mut classes = world.raster.as_ref().map(raster::classes).unwrap_or_default();
    // Classes that cannot be passed are obstacles.
    if let Some(raster) = world.raster.as_ref().filter(|raster| !raster.speeds.is_empty()) {
        classes.retain(|&class| raster.speed_of(class) > 0.0);
    }
    for layer in parts::surface_layers(world) {
        match layer.parts[0].kind {
            SurfaceKind::Class(class) => {
                classes.insert(class);
            }
            _ => entries.push(Entry::Part(layer.style)),
        }
    }
    for &class in classes.iter().take(MOST_CLASSES) {
        let (_, style) = style::surface(SurfaceKind::Class(class));
        entries.push(Entry::Named(style, format!("class {class}")));
    }
    if classes.len() > MOST_CLASSES {
        entries.push(Entry::Note(format!("and {} more", classes.len() - MOST_CLASSES)));
    }
    if world.rooms.iter().any(|room| !room.lit) {
        entries.push(Entry::Unlit);
    }
    if world.rooms.iter().any(|room| room.difficulty.is_some()) {
        entries.push(Entry::Difficulty);
    } else if !world.rooms.is_empty() {
        entries.push(Entry::Part(style::ROOM));
    }
    let numbers = numbers.iter().enumerate();
    entries.extend(numbers.map(|(i, text)| Entry::Note(format!("{}  {text}", i + 1))));
    entries
}

/// Whether a layer of walls is visible in a picture. Kerbs vanish at the edge of a distant road.
fn is_seen(layer: &Layer<'_, Wall>, view: &View) -> bool {
    let kerb = |wall: &&Wall| wall.kind == WallKind::Kerb;
    layer.parts.iter().any(|wall| !kerb(wall) || thickness(&wall.shape) * view.scale >= LEAST_KERB)
}

/// Returns the approximate thickness of a long shape, in metres.
fn thickness(shape: &Shape) -> f64 {
    let outline: f64 = edges(&shape.corners()).map(|(a, b)| a.distance(b)).sum();
    if outline > 0.0 { 2.0 * shape.area() / outline } else { 0.0 }
}

/// Draws scale bar and legend, row by row within `width` px or one entry per row, and returns their size.
pub(super) fn draw(
    entries: Vec<Entry>,
    view: &View,
    corner: DVec2,
    width: f64,
    typesetter: &Typesetter,
) -> (Group, DVec2) {
    let mut group = Group::new().set("id", "legend");
    let mut labels = PathData::new(2);
    let mut small = PathData::new(2);
    let mut x = 0.0;
    let mut rows = 0.0;
    let mut widest: f64 = 0.0;
    let baseline = |rows: f64| corner.y + rows * ROW + 15.0;
    if let Some((bar, long)) = scale_bar(view, DVec2::new(corner.x, baseline(0.0)), typesetter) {
        group = group.add(bar);
        widest = long;
        x += long + 1.5 * GAP;
    }
    let mut last_is_bar = false;
    for entry in entries {
        let long = entry.sample_width() + 6.0 + typesetter.width(entry.label(), LABEL_SIZE);
        if x > 0.0 && x + long > width {
            (x, rows) = (0.0, rows + 1.0);
        }
        let base = DVec2::new(corner.x + x, baseline(rows));
        let middle = base.y - 0.5 * CAPITAL_HEIGHT * LABEL_SIZE;
        let min = DVec2::new(base.x, middle - 0.5 * SAMPLE.y);
        let max = min + SAMPLE;
        let center = (min + max) * 0.5;
        group = match &entry {
            Entry::Part(style) | Entry::Named(style, _) => group.add(sample(*style, min, max)),
            Entry::Tree => {
                let [mut edge, mut crown] = [PathData::new(2), PathData::new(2)];
                edge.circle(center, 6.0);
                crown.circle(center, 5.0);
                group.add(filled(edge, palette::TREE.edge)).add(filled(crown, palette::TREE.fill))
            }
            Entry::Road => {
                let [mut path, mut marks] = [PathData::new(2), PathData::new(2)];
                path.rect(min, max);
                marks.line(DVec2::new(min.x + 2.0, center.y), DVec2::new(min.x + 6.5, center.y));
                marks.line(DVec2::new(max.x - 6.5, center.y), DVec2::new(max.x - 2.0, center.y));
                let road =
                    filled(path, palette::ROAD.fill).set("stroke", palette::ROAD.edge.to_string());
                group.add(road).add(stroked(marks, palette::ROAD_MARKING, 1.1))
            }
            Entry::Unlit => {
                let [mut path, mut lines] = [PathData::new(2), PathData::new(2)];
                path.rect(min, max);
                for shift in [1.0, 6.0] {
                    let from = DVec2::new(min.x + shift, max.y);
                    lines.line(from, from + DVec2::new(SAMPLE.y, -SAMPLE.y) * 0.9);
                }
                let fill = palette::room_floor(None, false);
                let room = filled(path, fill).set("stroke", palette::ROOM.edge.to_string());
                group
                    .add(room.set("stroke-width", 0.8))
                    .add(stroked(lines, palette::UNLIT, 1.1).set("stroke-opacity", 0.55))
            }
            Entry::Start => {
                group.add(arrow(DVec2::new(min.x + 7.0, middle), Pose::new(0.0, 0.0, 0.0)))
            }
            Entry::Goal => group.add(flag(DVec2::new(min.x + 3.0, base.y + 2.0), 0.72)),
            Entry::Difficulty => {
                last_is_bar = true;
                let at = DVec2::new(min.x, middle - 5.0);
                group.add(difficulty_bar(at, BAR, &mut small, typesetter))
            }
            Entry::Note(_) => group,
        };
        let at = DVec2::new(base.x + entry.sample_width() + 6.0, base.y);
        typesetter.write(&mut labels, entry.label(), at, LABEL_SIZE, Align::Left);
        widest = widest.max(x + long);
        x += long + GAP;
    }
    if !labels.is_empty() {
        group = group.add(filled(labels, palette::INK));
    }
    if !small.is_empty() {
        group = group.add(filled(small, palette::QUIET_INK));
    }
    (group, DVec2::new(widest, (rows + 1.0) * ROW + if last_is_bar { 8.0 } else { 0.0 }))
}
