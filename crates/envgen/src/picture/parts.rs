//! The parts of a world, from the ground up.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use svg::node::element::{Group, Path};

use super::ink::{Ink, MANY_PARTS, Shadow};
use super::path::PathData;
use super::style::{self, Color, Style};
use super::text::{Align, CAPITAL_HEIGHT, Typesetter};
use super::view::{View, round_number};
use super::{PictureError, PictureOptions, raster};
use crate::geometry::{Rect, Shape, unit_vector};
use crate::world::{ObstacleKind, RoadStrip, Room, SurfaceKind, WallKind, World};

pub(super) const WALLS: [WallKind; 5] =
    [WallKind::Kerb, WallKind::Partition, WallKind::Alcove, WallKind::Wall, WallKind::EndCap];
pub(super) const OBSTACLES: [ObstacleKind; 15] = [
    ObstacleKind::Other,
    ObstacleKind::Stairs,
    ObstacleKind::Pipe,
    ObstacleKind::Boiler,
    ObstacleKind::Statue,
    ObstacleKind::Counter,
    ObstacleKind::Container,
    ObstacleKind::Cabinet,
    ObstacleKind::Panel,
    ObstacleKind::Desk,
    ObstacleKind::Chair,
    ObstacleKind::Screen,
    ObstacleKind::Rubble,
    ObstacleKind::Crate,
    ObstacleKind::DoorPost,
];

/// The kinds of surface that have a style of their own, from the ground up.
const SURFACES: [SurfaceKind; 6] = [
    SurfaceKind::OpenArea,
    SurfaceKind::Hallway,
    SurfaceKind::Uneven,
    SurfaceKind::Debris,
    SurfaceKind::Water,
    SurfaceKind::Stairs,
];

/// Sine and cosine of 45 degrees.
const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Hatches stop when they are this many lines: worlds of very many overlapping grounds stay small.
const MOST_HATCHES: usize = 100_000;

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
    // Grounds of their own lie under the rooms, those that are strewn about a room on its floor.
    surfaces(world, view, is_ground, &mut groups)?;
    rooms(world, view, &mut groups)?;
    surfaces(world, view, |kind| !is_ground(kind), &mut groups)?;
    roads(world, view, &mut groups);
    walls(world, view, &mut groups)?;
    doorways(world, view, &mut groups)?;
    trees(world, view, &mut groups)?;
    obstacles(world, view, &mut groups)?;
    victims(world, view, &mut groups);
    if options.names {
        groups.extend(names(&world.rooms, view, typesetter));
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

/// Dots of a round line cap, as trees are.
fn victims(world: &World, view: &View, groups: &mut Vec<Group>) {
    if world.victims.is_empty() {
        return;
    }
    let radius = (0.25 * view.scale).clamp(1.5, 6.0);
    let mut dots = PathData::new(1);
    world.victims.iter().for_each(|victim| dots.dot(view.px(victim.position)));
    let edge = stroked(dots.clone(), style::VICTIM.edge, 2.0 * radius);
    let inside = stroked(dots, style::VICTIM.fill, 2.0 * radius - 1.5);
    groups.push(
        Group::new().set("id", "victims").set("stroke-linecap", "round").add(edge).add(inside),
    );
}

fn is_ground(kind: SurfaceKind) -> bool {
    matches!(kind, SurfaceKind::Class(_) | SurfaceKind::Hallway | SurfaceKind::OpenArea)
}

fn surfaces(
    world: &World,
    view: &View,
    wanted: fn(SurfaceKind) -> bool,
    groups: &mut Vec<Group>,
) -> Result<(), PictureError> {
    let many = world.surfaces.len() > MANY_PARTS;
    for (kind, style) in surface_styles(world).into_iter().filter(|(kind, _)| wanted(*kind)) {
        let mut ink = Ink::new(view, many);
        let mut hatch = Hatch::default();
        for surface in world.surfaces.iter().filter(|surface| surface.kind == kind) {
            ink.shape(&surface.shape);
            let outline = outline(&surface.shape, view);
            match kind {
                SurfaceKind::Uneven => {
                    hatch.add(&outline, DVec2::new(DIAGONAL, -DIAGONAL), 8.0);
                }
                SurfaceKind::Debris => {
                    hatch.add(&outline, DVec2::new(DIAGONAL, -DIAGONAL), 7.0);
                    hatch.add(&outline, DVec2::new(DIAGONAL, DIAGONAL), 7.0);
                }
                SurfaceKind::Water => hatch.add(&outline, DVec2::X, 6.0),
                SurfaceKind::Stairs => hatch.add(&outline, across(&outline), 6.0),
                SurfaceKind::Hallway | SurfaceKind::OpenArea | SurfaceKind::Class(_) => {}
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
    let plain = SURFACES;
    let mut found = [false; SURFACES.len()];
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
            hatch.add(&outline(&room.shape, view), DVec2::new(DIAGONAL, -DIAGONAL), 7.0);
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

fn roads(world: &World, view: &View, groups: &mut Vec<Group>) {
    if world.road_strips.is_empty() {
        return;
    }
    // Widths in tenths of a pixel; strips of one width are one path.
    let mut widths: BTreeMap<u32, PathData> = BTreeMap::new();
    let mut markings = PathData::new(1);
    let mut dashes = PathData::new(1);
    for strip in &world.road_strips {
        let width = strip.width * view.scale;
        let path = widths
            .entry((width * 10.0).round().max(10.0) as u32)
            .or_insert_with(|| PathData::new(1));
        lane_line(strip, 0.0, view, path);
        let lane = width / f64::from(strip.lanes);
        if width >= 8.0 {
            let edge = 0.5 * strip.width - 1.8 / view.scale;
            lane_line(strip, edge, view, &mut markings);
            lane_line(strip, -edge, view, &mut markings);
        }
        if lane >= 4.0 && strip.lanes <= 16 {
            for i in 1..strip.lanes {
                let offset = (f64::from(i) / f64::from(strip.lanes) - 0.5) * strip.width;
                lane_line(strip, offset, view, &mut dashes);
            }
        }
    }
    let round = |path: Path| path.set("stroke-linejoin", "round");
    let mut group = Group::new().set("id", "roads");
    for (tenths, path) in &widths {
        let width = f64::from(*tenths) / 10.0;
        let edge = if width >= 3.0 { 1.6 } else { 0.0 };
        group = group.add(round(stroked(path.clone(), style::ROAD_EDGE, width + edge)));
    }
    for (tenths, path) in widths {
        group = group.add(round(stroked(path, style::ASPHALT, f64::from(tenths) / 10.0)));
    }
    if !markings.is_empty() {
        group = group.add(stroked(markings, style::MARKING, 0.8).set("stroke-opacity", 0.85));
    }
    if !dashes.is_empty() {
        // Lines of 3 m with gaps of 6 m, or as short as can still be seen.
        let dash = (3.0 * view.scale).clamp(4.0, 200.0);
        let path = stroked(dashes, style::MARKING, 1.1);
        group = group.add(path.set("stroke-dasharray", format!("{dash:.1} {:.1}", 1.5 * dash)));
    }
    groups.push(group);
}

/// A line beside a road's centreline, `offset` metres to its left. Points nearer to each other
/// than can be seen are left out.
fn lane_line(strip: &RoadStrip, offset: f64, view: &View, path: &mut PathData) {
    let last = strip.centreline.len() - 1;
    let mut previous = None;
    for (i, point) in strip.centreline.iter().enumerate() {
        let left = unit_vector(point.pose.heading).perp();
        let at = view.px(point.pose.position + left * offset);
        match previous {
            None => path.move_to(at),
            Some(previous) if i < last && at.distance_squared(previous) < 0.25 => continue,
            Some(_) => path.line_to(at),
        }
        previous = Some(at);
    }
    if strip.closed {
        path.close();
    }
}

/// The outline of any shape in px; discs have 24 corners.
fn outline(shape: &Shape, view: &View) -> Vec<DVec2> {
    match shape {
        Shape::Disc { center, radius } => (0..24)
            .map(|i| unit_vector(f64::from(i) * std::f64::consts::TAU / 24.0))
            .map(|direction| view.px(*center) + direction * *radius * view.scale)
            .collect(),
        _ => view.outline(shape),
    }
}

/// The direction of treads: along the shorter sides of an outline.
fn across(outline: &[DVec2]) -> DVec2 {
    let sides = [(0, 1), (1, 2)].map(|(i, j)| match (outline.get(i), outline.get(j)) {
        (Some(&a), Some(&b)) => b - a,
        _ => DVec2::X,
    });
    let shorter = if sides[0].length() < sides[1].length() { sides[0] } else { sides[1] };
    shorter.try_normalize().unwrap_or(DVec2::X)
}

/// Parallel lines inside outlines.
#[derive(Debug)]
struct Hatch {
    path: PathData,
    lines: usize,
}

impl Default for Hatch {
    fn default() -> Self {
        Hatch { path: PathData::new(1), lines: 0 }
    }
}

impl Hatch {
    /// Adds the lines of a direction (a unit vector) that are multiples of `spacing` px from the
    /// picture's corner, so that the lines of neighbours meet.
    fn add(&mut self, outline: &[DVec2], direction: DVec2, spacing: f64) {
        let normal = direction.perp();
        let heights = outline.iter().map(|p| p.dot(normal));
        let (low, high) = heights
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
        let (first, last) = ((low / spacing).ceil(), (high / spacing).floor());
        if !(last - first).is_finite() || last - first > 1e5 {
            return;
        }
        let mut crossings = Vec::new();
        for k in 0..=(last - first).max(-1.0) as i64 {
            let height = (first + k as f64) * spacing;
            crossings.clear();
            for (a, b) in crate::geometry::edges(outline) {
                let (ha, hb) = (a.dot(normal), b.dot(normal));
                if (ha > height) != (hb > height) {
                    crossings.push((a + (b - a) * ((height - ha) / (hb - ha))).dot(direction));
                }
            }
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                if self.lines == MOST_HATCHES {
                    return;
                }
                self.lines += 1;
                let at = |along: f64| direction * along + normal * height;
                self.path.line(at(pair[0]), at(pair[1]));
            }
        }
    }
}

/// Names in the middle of their rooms, where they fit, with the difficulty below.
fn names(rooms: &[Room], view: &View, typesetter: &Typesetter) -> Option<Group> {
    let [mut dark, mut light] = [PathData::new(2), PathData::new(2)];
    let mut taken: Vec<Rect> = Vec::new();
    for room in rooms {
        let around = view.px_rect(room.shape.bounds());
        let size = around.size();
        // A picture has no room for more names than these.
        if size.x < 24.0 || size.y < 10.0 || taken.len() > 2000 {
            continue;
        }
        let font = (size.x / 7.0).min(size.y / 2.6).clamp(8.0, 13.0);
        let mut lines = Vec::new();
        if let Some(name) = typesetter.fitted(&room.name, font, size.x - 6.0) {
            lines.push((name, font));
        }
        if let Some(difficulty) = room.difficulty {
            lines.push((format!("{difficulty:.1}"), 0.85 * font));
        }
        while lines.iter().map(|line| 1.25 * line.1).sum::<f64>() > size.y - 2.0 {
            lines.pop();
        }
        let height: f64 = lines.iter().map(|line| 1.25 * line.1).sum();
        let width = lines.iter().map(|l| typesetter.width(&l.0, l.1)).fold(0.0, f64::max);
        let half = DVec2::new(0.5 * width, 0.5 * height);
        let label = Rect::new(around.center() - half, around.center() + half);
        if lines.is_empty() || taken.iter().any(|other| other.overlaps(label)) {
            continue;
        }
        taken.push(label);
        let ink = if room_color(room).lightness() > 0.52 { &mut dark } else { &mut light };
        let mut top = label.min.y;
        for (line, font) in lines {
            let baseline = top + (1.25 + CAPITAL_HEIGHT) * 0.5 * font;
            let at = DVec2::new(around.center().x, baseline);
            typesetter.write(ink, &line, at, font, Align::Middle);
            top += 1.25 * font;
        }
    }
    if taken.is_empty() {
        return None;
    }
    let label = |path, color: Color, halo: Color| {
        filled(path, color)
            .set("stroke", halo.to_string())
            .set("stroke-width", 2.4)
            .set("stroke-opacity", 0.5)
            .set("stroke-linejoin", "round")
            .set("paint-order", "stroke")
    };
    let mut group = Group::new().set("id", "names");
    if !dark.is_empty() {
        group = group.add(label(dark, style::INK, style::PAGE));
    }
    if !light.is_empty() {
        group = group.add(label(light, style::PAGE, style::INK));
    }
    Some(group)
}
