//! The parts of a world, drawn from the lowest layer up.

use std::collections::BTreeMap;

use glam::DVec2;
use svg::node::element::Group;

use super::hatch::{Hatch, RISING, outline};
use super::ink::{Ink, MANY_PARTS, Shadow};
use super::path::PathData;
use super::shapes::stroked;
use super::style::{self, Style, Texture};
use super::view::{View, round_number};
use super::{PictureError, PictureOptions, moving, raster, roads};
use crate::geometry::Shape;
use crate::palette::{self, Srgb};
use crate::world::{Doorway, Obstacle, Room, Surface, Wall, World};

/// If a list has more styles than this, none of them has a shadow.
const MOST_SHADOWS: usize = 40;

/// Draws everything inside the plan's frame except names, start and goal.
pub(super) fn draw(
    world: &World,
    view: &View,
    options: &PictureOptions,
) -> Result<Vec<Group>, PictureError> {
    let mut groups = Vec::new();
    if let Some(raster) = &world.raster {
        groups.push(raster::group(raster, view)?);
    }
    if options.grid {
        groups.push(grid(view));
    }
    // Plain floors and classes lie below the rooms; surfaces that make driving hard are drawn on them.
    let (floors, grounds): (Vec<_>, Vec<_>) =
        surface_layers(world).into_iter().partition(|layer| layer.style.texture == Texture::Plain);
    groups.extend(draw_layers("surfaces", floors, view, |s| &s.shape)?);
    rooms(world, view, &mut groups)?;
    groups.extend(draw_layers("surfaces", grounds, view, |s| &s.shape)?);
    groups.extend(roads::draw(world, view));
    groups.extend(draw_layers("walls", wall_layers(world), view, |wall| &wall.shape)?);
    groups.extend(draw_layers("doorways", doorway_layers(world), view, |door| &door.shape)?);
    trees(world, view, &mut groups)?;
    groups.extend(draw_layers("obstacles", obstacle_layers(world), view, |o| &o.shape)?);
    groups.extend(victims(world, view));
    if let Some(scenario) = &options.scenario {
        groups.extend(moving::draw(world, scenario, view)?);
    }
    Ok(groups)
}

/// Draws victims as dots with a round line cap, like trees.
fn victims(world: &World, view: &View) -> Option<Group> {
    if world.victims.is_empty() {
        return None;
    }
    let radius = (0.25 * view.scale).clamp(1.5, 6.0);
    let mut dots = PathData::new(1);
    world.victims.iter().for_each(|victim| dots.dot(view.px(victim.position)));
    let edge = stroked(dots.clone(), style::VICTIM.edge, 2.0 * radius);
    let inside = stroked(dots, style::VICTIM.fill, 2.0 * radius - 1.5);
    let group = Group::new().set("id", "victims").set("stroke-linecap", "round");
    Some(group.add(edge).add(inside))
}

/// Returns the side of the grid's cells in metres, which is at least 40 px.
pub(super) fn grid_step(view: &View) -> Option<f64> {
    round_number(100.0 / view.scale)
}

fn grid(view: &View) -> Group {
    let mut path = PathData::new(1);
    let (low, high) = (view.px(view.world.min), view.px(view.world.max));
    if let Some(step) = grid_step(view) {
        // Lines are counted from 0, not from the bounds; worlds so far from the origin that rounding loses a
        // step have no grid.
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
    Group::new().set("id", "grid").add(stroked(path, palette::GRID, 0.8))
}

/// Parts of one style, which are drawn together.
#[derive(Debug)]
pub(super) struct Layer<'a, T> {
    pub(super) style: Style,
    pub(super) parts: Vec<&'a T>,
}

/// Returns the styles in a list of parts, in the order in which they are drawn.
pub(super) fn layers<T>(parts: &[T], style: impl Fn(&T) -> (u32, Style)) -> Vec<Layer<'_, T>> {
    let mut layers = BTreeMap::new();
    for part in parts {
        let (order, style) = style(part);
        layers.entry(order).or_insert(Layer { style, parts: Vec::new() }).parts.push(part);
    }
    layers.into_values().collect()
}

pub(super) fn wall_layers(world: &World) -> Vec<Layer<'_, Wall>> {
    layers(&world.walls, |wall| match wall.visible_range {
        None => style::wall(wall.kind),
        Some(_) => style::DARK_WALL,
    })
}

pub(super) fn obstacle_layers(world: &World) -> Vec<Layer<'_, Obstacle>> {
    layers(&world.obstacles, |obstacle| match obstacle.visible_range {
        None => style::obstacle(obstacle.kind),
        Some(_) => style::DARK_OBSTACLE,
    })
}

pub(super) fn surface_layers(world: &World) -> Vec<Layer<'_, Surface>> {
    layers(&world.surfaces, |surface| style::surface(surface.kind))
}

pub(super) fn doorway_layers(world: &World) -> Vec<Layer<'_, Doorway>> {
    layers(
        &world.doorways,
        |door| {
            if door.open { (0, style::OPEN_DOOR) } else { (1, style::CLOSED_DOOR) }
        },
    )
}

/// Draws layers as groups with names such as `walls-end-cap`.
fn draw_layers<T>(
    list: &str,
    layers: Vec<Layer<'_, T>>,
    view: &View,
    shape: impl Fn(&T) -> &Shape,
) -> Result<Vec<Group>, PictureError> {
    let many = layers.iter().map(|layer| layer.parts.len()).sum::<usize>() > MANY_PARTS;
    let shadows = layers.len() <= MOST_SHADOWS;
    let mut groups = Vec::new();
    let mut named = BTreeMap::new();
    for Layer { style, parts } in layers {
        let mut ink = if shadows { Ink::new(view, many) } else { Ink::without_shadow(view, many) };
        let mut hatch = Hatch::default();
        for part in parts {
            ink.shape(shape(part));
            hatch.texture(style.texture, shape(part), view);
        }
        let mut id = format!("{list}-{}", style.name.replace(' ', "-"));
        // Classes share a name.
        let count = named.entry(style.name).or_insert(0_u32);
        *count += 1;
        if *count > 1 {
            id = format!("{id}-{count}");
        }
        let mut group = ink.into_group(&id, style)?;
        if style.texture.is_see_through() {
            group = group.set("fill-opacity", 0.35);
        }
        if !hatch.path.is_empty() {
            let dashes = match style.texture {
                Texture::Waves => "7 5",
                Texture::Dots => "1.5 3",
                _ => "none",
            };
            group = group.add(stroked(hatch.path, style.edge, 0.9).set("stroke-dasharray", dashes));
        }
        groups.push(group);
    }
    Ok(groups)
}

/// Draws each tree as two dots with a round line cap, the edge and the crown. Radii are rounded to a tenth of a
/// pixel, so that all trees of the same size are one path.
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
        group = group.add(shadow.into_image(palette::TREE.edge)?);
    }
    let (mut edges, mut crowns) = (Vec::new(), Vec::new());
    for (tenths, path) in sizes {
        let radius = f64::from(tenths) / 10.0;
        // Small trees are dark throughout.
        let edge = (0.12 * radius).clamp(0.8, 1.5);
        if radius > edge + 0.5 {
            crowns.push(stroked(path.clone(), palette::TREE.fill, 2.0 * (radius - edge)));
        }
        edges.push(stroked(path, palette::TREE.edge, 2.0 * radius));
    }
    groups.push(edges.into_iter().chain(crowns).fold(group, Group::add));
    Ok(())
}

fn rooms(world: &World, view: &View, groups: &mut Vec<Group>) -> Result<(), PictureError> {
    if world.rooms.is_empty() {
        return Ok(());
    }
    let many = world.rooms.len() > MANY_PARTS;
    let mut colors: BTreeMap<Srgb, Ink<'_>> = BTreeMap::new();
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
        let style = Style { fill: color, ..style::ROOM };
        group = group.add(ink.into_group(&format!("rooms-{}", &color.to_string()[1..]), style)?);
    }
    if !hatch.path.is_empty() {
        let path = stroked(hatch.path, palette::UNLIT, 1.1).set("stroke-opacity", 0.55);
        group = group.add(path.set("id", "rooms-unlit"));
    }
    groups.push(group);
    Ok(())
}

/// Returns the colour of a room. Difficulties are distinguished to a tenth; unlit rooms are darker.
pub(super) fn room_color(room: &Room) -> Srgb {
    palette::room_floor(room.difficulty.map(|rated| (rated * 10.0).round() / 10.0), room.lit)
}
