//! The parts of a world, from the ground up.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use svg::node::element::{Group, Path};

use super::hatch::{FALLING, Hatch, RISING, across, outline};
use super::ink::{Ink, MANY_PARTS, Shadow};
use super::path::PathData;
use super::style::{self, Color, Style};
use super::text::Typesetter;
use super::view::{View, round_number};
use super::{PictureError, PictureOptions, names, raster, roads};
use crate::world::{ObstacleKind, Room, SurfaceKind, WallKind, World};

pub(super) const WALLS: [WallKind; 5] =
    [WallKind::Kerb, WallKind::Partition, WallKind::Alcove, WallKind::Wall, WallKind::EndCap];
pub(super) const OBSTACLES: [ObstacleKind; 3] =
    [ObstacleKind::Other, ObstacleKind::Crate, ObstacleKind::DoorPost];

/// Everything inside the plan's frame but start and goal.
pub(super) fn draw(
    world: &World,
    view: &View,
    options: &PictureOptions,
    typesetter: &Typesetter,
) -> Result<Vec<Group>, PictureError> {
    let mut groups = Vec::new();
    if let Some(raster) = &world.raster {
        groups.push(raster::group(raster, view)?);
    }
    if options.grid {
        groups.push(grid(view));
    }
    surfaces(world, view, &mut groups)?;
    rooms(world, view, &mut groups)?;
    groups.extend(roads::draw(world, view));
    walls(world, view, &mut groups)?;
    doorways(world, view, &mut groups)?;
    trees(world, view, &mut groups)?;
    obstacles(world, view, &mut groups)?;
    if options.names {
        groups.extend(names::draw(world, view, typesetter));
    }
    Ok(groups)
}

pub(super) fn stroked(path: PathData, color: Color, width: f64) -> Path {
    Path::new()
        .set("d", path.into_text())
        .set("fill", "none")
        .set("stroke", color.to_string())
        .set("stroke-width", (width * 100.0).round() / 100.0)
}

pub(super) fn filled(path: PathData, color: Color) -> Path {
    Path::new().set("d", path.into_text()).set("fill", color.to_string())
}

/// The side of the grid's cells in metres: none is smaller than 40 px.
pub(super) fn grid_step(view: &View) -> Option<f64> {
    round_number(100.0 / view.scale)
}

fn grid(view: &View) -> Group {
    let mut path = PathData::new(1);
    let (low, high) = (view.px(view.world.min), view.px(view.world.max));
    if let Some(step) = grid_step(view) {
        // Lines are counted from 0, not from the bounds; worlds so far out that a step is lost in
        // rounding have none.
        let lines = |min: f64, max: f64| {
            let first = (min / step).ceil();
            (0..1000).map(move |i| (first + f64::from(i)) * step).take_while(move |&v| v <= max)
        };
        for x in lines(view.world.min.x, view.world.max.x) {
            let x = view.px(DVec2::new(x, view.world.min.y)).x;
            path.line(DVec2::new(x, low.y), DVec2::new(x, high.y));
        }
        for y in lines(view.world.min.y, view.world.max.y) {
            let y = view.px(DVec2::new(view.world.min.x, y)).y;
            path.line(DVec2::new(low.x, y), DVec2::new(high.x, y));
        }
    }
    Group::new().set("id", "grid").add(stroked(path, style::GRID, 0.8))
}

fn walls(world: &World, view: &View, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    let many = world.walls.len() > MANY_PARTS;
    for kind in WALLS {
        let style = style::wall(kind);
        let mut ink = Ink::new(view, many);
        for wall in world.walls.iter().filter(|wall| wall.kind == kind) {
            ink.shape(&wall.shape);
        }
        push(ink, &id("walls", style), style, groups)?;
    }
    Ok(())
}

fn obstacles(world: &World, view: &View, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    let many = world.obstacles.len() > MANY_PARTS;
    for kind in OBSTACLES {
        let style = style::obstacle(kind);
        let mut ink = Ink::new(view, many);
        for obstacle in world.obstacles.iter().filter(|obstacle| obstacle.kind == kind) {
            ink.shape(&obstacle.shape);
        }
        push(ink, &id("obstacles", style), style, groups)?;
    }
    Ok(())
}

/// `walls-end-cap`.
fn id(list: &str, style: Style) -> String {
    format!("{list}-{}", style.name.replace(' ', "-"))
}

fn push(ink: Ink<'_>, id: &str, style: Style, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    if !ink.is_empty() {
        groups.push(ink.into_group(id, style)?);
    }
    Ok(())
}

fn doorways(world: &World, view: &View, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    let many = world.doorways.len() > MANY_PARTS;
    for (open, style) in [(true, OPEN_DOOR), (false, CLOSED_DOOR)] {
        let mut ink = Ink::new(view, many);
        for door in world.doorways.iter().filter(|door| door.open == open) {
            ink.shape(&door.shape);
        }
        push(ink, if open { "doorways-open" } else { "doorways-closed" }, style, groups)?;
    }
    Ok(())
}

pub(super) const OPEN_DOOR: Style = Style {
    name: "open doorway",
    fill: style::DOOR_OPEN,
    edge: style::DOOR_OPEN_EDGE,
    edge_width: 1.0,
};
pub(super) const CLOSED_DOOR: Style = Style {
    name: "closed door",
    fill: style::DOOR_CLOSED,
    edge: style::DOOR_CLOSED_EDGE,
    edge_width: 1.0,
};

/// Trees are dots of a round line cap: two for each, the edge and the crown. Radii are rounded to
/// a tenth of a pixel, so that all trees of a size are one path.
fn trees(world: &World, view: &View, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    let many = world.trees.len() > MANY_PARTS;
    let mut shadow = None;
    let mut sizes: BTreeMap<u32, PathData> = BTreeMap::new();
    for tree in &world.trees {
        let radius = tree.radius * view.scale;
        let at = view.px(tree.center);
        if many && radius < 1.0 {
            let area = std::f64::consts::PI * radius * radius;
            shadow.get_or_insert_with(|| Shadow::new(view)).add(at, area);
            continue;
        }
        let tenths = if radius < 20.0 { radius * 10.0 } else { radius.round() * 10.0 };
        let path = sizes
            .entry(tenths.round().max(4.0) as u32)
            .or_insert_with(|| PathData::new(if many { 1 } else { 2 }));
        path.dot(at);
    }
    if world.trees.is_empty() {
        return Ok(());
    }
    let mut group = Group::new().set("id", "trees").set("stroke-linecap", "round");
    if let Some(shadow) = shadow {
        group = group.add(shadow.into_image(style::TREE_EDGE)?);
    }
    let (mut edges, mut crowns) = (Vec::new(), Vec::new());
    for (tenths, path) in sizes {
        let radius = f64::from(tenths) / 10.0;
        // Small trees are dark all through.
        let edge = (0.12 * radius).clamp(0.8, 1.5);
        if radius > edge + 0.5 {
            crowns.push(stroked(path.clone(), style::TREE, 2.0 * (radius - edge)));
        }
        edges.push(stroked(path, style::TREE_EDGE, 2.0 * radius));
    }
    groups.push(edges.into_iter().chain(crowns).fold(group, Group::add));
    Ok(())
}

fn surfaces(world: &World, view: &View, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    let many = world.surfaces.len() > MANY_PARTS;
    for (kind, style) in surface_styles(world) {
        let mut ink = Ink::new(view, many);
        let mut hatch = Hatch::default();
        for surface in world.surfaces.iter().filter(|surface| surface.kind == kind) {
            ink.shape(&surface.shape);
            let outline = outline(&surface.shape, view);
            match kind {
                SurfaceKind::Uneven => {
                    hatch.add(&outline, RISING, 8.0);
                }
                SurfaceKind::Debris => {
                    hatch.add(&outline, RISING, 7.0);
                    hatch.add(&outline, FALLING, 7.0);
                }
                SurfaceKind::Water => hatch.add(&outline, DVec2::X, 6.0),
                SurfaceKind::Stairs => hatch.add(&outline, across(&outline), 6.0),
                SurfaceKind::Class(_) => {}
            }
        }
        if ink.is_empty() {
            continue;
        }
        let mut id = id("surfaces", style);
        if let SurfaceKind::Class(class) = kind {
            id = format!("{id}-{class}");
        }
        let mut group = ink.into_group(&id, style)?;
        if !hatch.path.is_empty() {
            let dashes = match kind {
                SurfaceKind::Water => "7 5",
                SurfaceKind::Uneven => "1.5 3",
                _ => "none",
            };
            group = group.add(stroked(hatch.path, style.edge, 0.9).set("stroke-dasharray", dashes));
        }
        groups.push(group);
    }
    Ok(())
}

/// The kinds of surface in a world, each with its style.
pub(super) fn surface_styles(world: &World) -> Vec<(SurfaceKind, Style)> {
    let plain = [SurfaceKind::Uneven, SurfaceKind::Debris, SurfaceKind::Water, SurfaceKind::Stairs];
    let mut found = [false; 4];
    let mut classes = BTreeSet::new();
    for surface in &world.surfaces {
        match surface.kind {
            SurfaceKind::Class(class) => {
                classes.insert(class);
            }
            kind => {
                if let Some(i) = plain.iter().position(|&known| known == kind) {
                    found[i] = true;
                }
            }
        }
    }
    let classes = classes.into_iter().map(SurfaceKind::Class);
    let plain = plain.into_iter().zip(found).filter_map(|(kind, found)| found.then_some(kind));
    classes.chain(plain).map(|kind| (kind, style::surface(kind))).collect()
}

fn rooms(world: &World, view: &View, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    if world.rooms.is_empty() {
        return Ok(());
    }
    let many = world.rooms.len() > MANY_PARTS;
    let mut colors: BTreeMap<Color, Ink<'_>> = BTreeMap::new();
    let mut hatch = Hatch::default();
    for room in &world.rooms {
        // No shadows: there may be as many colours as difficulties, and rooms are seldom small.
        let ink = colors.entry(room_color(room)).or_insert_with(|| Ink::without_shadow(view, many));
        ink.shape(&room.shape);
        if !room.lit {
            hatch.add(&outline(&room.shape, view), RISING, 7.0);
        }
    }
    let mut group = Group::new().set("id", "rooms");
    for (color, ink) in colors {
        let style = Style { name: "room", fill: color, edge: style::ROOM_EDGE, edge_width: 0.8 };
        group = group.add(ink.into_group(&format!("rooms-{}", &color.to_string()[1..]), style)?);
    }
    if !hatch.path.is_empty() {
        let path = stroked(hatch.path, style::DARK, 1.1).set("stroke-opacity", 0.55);
        group = group.add(path.set("id", "rooms-unlit"));
    }
    groups.push(group);
    Ok(())
}

/// Difficulties are told apart to a tenth; rooms without light are darker.
pub(super) fn room_color(room: &Room) -> Color {
    let color = room
        .difficulty
        .map_or(style::ROOM, |difficulty| style::difficulty((difficulty * 10.0).round() / 10.0));
    if room.lit { color } else { color.mix(style::DARK, 0.18) }
}
