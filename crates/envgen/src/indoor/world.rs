//! Builds the world of a plan, in metres.

use glam::DVec2;
use serde_json::json;

use super::access::{AccessGraph, PlaceKind};
use super::blueprint::FloorPlan;
use super::grid::{Axis, Cell, Gate, Opening, Origin};
use super::{clutter, materials};
use crate::generate::Spec;
use crate::geometry::{Pose, Rect, Shape};
use crate::provenance::Provenance;
use crate::world::{
    Claim, DOORWAY, Doorway, Extent, Obstacle, Room, Surface, SurfaceKind, WALL, Wall, WallKind,
    World,
};

pub(super) fn world(plan: &FloorPlan) -> World {
    let spec = plan.spec();
    let half_wall = 0.5 * spec.wall_thickness;
    let size = DVec2::new(f64::from(plan.grid.width()), f64::from(plan.grid.height()));
    let floor = Rect::new(DVec2::ZERO, size * spec.cell_size);
    let mut world = World::new(provenance(plan), floor.grown(half_wall));
    walls(plan, &mut world.walls);
    world.doorways = plan.openings.iter().map(|opening| doorway(plan, opening)).collect();
    floors(plan, &mut world.surfaces);
    for i in 0..plan.rooms.len() {
        room(plan, i, &mut world);
    }
    let access = plan.access();
    if let Some(start) = start(plan, &access) {
        let distances = access.distances(start);
        let from = access.places()[start as usize].at;
        world.start = Some(Pose { position: from, heading: heading(&access, start) });
        let goal = farthest(&distances);
        world.goal = Some(Pose { position: access.places()[goal].at, heading: 0.0 });
        let radius = spec.robot_radius;
        world.certificate.push(Claim::Connected { radius });
        if distances.iter().all(|distance| distance.is_finite()) && has_place_in_all(plan, &access)
        {
            world.certificate.push(Claim::EveryPlaceReachable { radius });
        }
        for (i, opening) in plan.openings.iter().enumerate() {
            if opening.origin == Origin::Added {
                world.certificate.push(Claim::AddedDoorway { doorway: i as u32 });
            }
        }
    }
    if spec.doorway_height != DOORWAY.top() && !plan.openings.is_empty() {
        world.certificate.push(Claim::Headroom { height: spec.doorway_height });
    }
    world
        .certificate
        .extend(plan.prediction().map(|&prediction| Claim::PredictedDifficulty { prediction }));
    let seed = plan.seed.unwrap_or_default();
    materials::apply(spec, seed, &mut world);
    // After the materials: crates do not change which objects are dark.
    clutter::add(spec, seed, &mut world);
    world
}

fn provenance(plan: &FloorPlan) -> Provenance {
    let (spec, seed) = match &plan.choice {
        Some(choice) => (&choice.spec, Some(choice.seed)),
        None => (plan.spec(), plan.seed),
    };
    let mut provenance = match seed {
        Some(seed) => spec.provenance(seed),
        None => Provenance::other("import", json!(plan.spec)),
    };
    provenance.edited = plan.edited;
    if plan.edited && seed.is_some() {
        provenance.difficulty_requested = Some(spec.difficulty);
        provenance.edits = plan.edits.iter().map(|edit| json!(edit)).collect();
    }
    provenance
}

/// Adds the walls between cells that do not belong to the same space, merged along their lines and cut by the openings.
fn walls(plan: &FloorPlan, walls: &mut Vec<Wall>) {
    let (width, height) = (plan.grid.width(), plan.grid.height());
    let cell = |x: u32, y: u32| plan.grid.get(x, y).unwrap_or_default();
    let divided = |a: Cell, b: Cell| a != b && !(a.is_floor() && b.is_floor());
    let mut openings = plan.openings.iter().map(|opening| opening.gate).peekable();
    for line in 0..=height {
        let wall = |x: u32| divided(cell(x, line.wrapping_sub(1)), cell(x, line));
        runs(plan, Axis::Horizontal, line, width, wall, &mut openings, walls);
    }
    for line in 0..=width {
        let wall = |y: u32| divided(cell(line.wrapping_sub(1), y), cell(line, y));
        runs(plan, Axis::Vertical, line, height, wall, &mut openings, walls);
    }
}

/// Adds the walls on one line. `openings` are those that are still ahead, in order.
fn runs(
    plan: &FloorPlan,
    axis: Axis,
    line: u32,
    cells: u32,
    wall: impl Fn(u32) -> bool,
    openings: &mut std::iter::Peekable<impl Iterator<Item = Gate>>,
    walls: &mut Vec<Wall>,
) {
    let half_wall = 0.5 * plan.spec.wall_thickness;
    let unit = plan.spec.cell_size;
    let height = Extent::unless_usual(WALL, plan.spec.wall_height);
    let mut push = |from: f64, to: f64| {
        if to > from {
            let shape = Shape::from_rect(along_line(plan, axis, line, from, to, half_wall));
            walls.push(Wall { height, ..Wall::new(WallKind::Wall, shape) });
        }
    };
    let mut along = 0;
    while along < cells {
        if !wall(along) {
            along += 1;
            continue;
        }
        let mut end = along + 1;
        while end < cells && wall(end) {
            end += 1;
        }
        // A run ends at a crossing wall, and fills its corner.
        let mut from = f64::from(along) * unit - half_wall;
        let to = f64::from(end) * unit + half_wall;
        let here = |gate: &Gate| gate.wall == axis && gate.line == line && gate.at < 2 * end;
        while let Some(gate) = openings.next_if(here) {
            let middle = 0.5 * f64::from(gate.at) * unit;
            let half_doorway = 0.5 * doorway_width(plan, gate);
            push(from, middle - half_doorway);
            from = from.max(middle + half_doorway);
        }
        push(from, to);
        along = end;
    }
}

/// Returns the rectangle around a line of the grid, from `from` to `to` metres along it (from the left or from the
/// top) and `half` metres to either side.
fn along_line(plan: &FloorPlan, axis: Axis, line: u32, from: f64, to: f64, half: f64) -> Rect {
    let across = f64::from(line) * plan.spec.cell_size;
    let top = f64::from(plan.grid.height()) * plan.spec.cell_size;
    match axis {
        Axis::Horizontal => {
            Rect::new(DVec2::new(from, top - across - half), DVec2::new(to, top - across + half))
        }
        Axis::Vertical => {
            Rect::new(DVec2::new(across - half, top - to), DVec2::new(across + half, top - from))
        }
    }
}

/// Returns the width of an opening in metres, which is drawn for its position only.
fn doorway_width(plan: &FloorPlan, gate: Gate) -> f64 {
    let widest = plan.spec.doorway;
    let Some(narrowest) = plan.spec.doorway_narrowest else { return widest };
    let place = u64::from(gate.line) << 32 | u64::from(gate.at);
    let stream = match gate.wall {
        Axis::Horizontal => "indoor/doorway_width_h",
        Axis::Vertical => "indoor/doorway_width_v",
    };
    let drawn = plan.seed.unwrap_or_default().stream(stream, place).unit();
    narrowest + (widest - narrowest) * drawn
}

/// Returns the rectangle of an opening, as thick as the wall.
pub(super) fn doorway_rect(plan: &FloorPlan, gate: Gate) -> Rect {
    let middle = 0.5 * f64::from(gate.at) * plan.spec.cell_size;
    let half = 0.5 * doorway_width(plan, gate);
    let half_wall = 0.5 * plan.spec.wall_thickness;
    along_line(plan, gate.wall, gate.line, middle - half, middle + half, half_wall)
}

fn doorway(plan: &FloorPlan, opening: &Opening) -> Doorway {
    let gate = opening.gate;
    let rect = doorway_rect(plan, gate);
    let rooms = gate.cells(&plan.grid).map(|[cell, _]| match cell {
        Cell::Room(room) => Some(room),
        _ => None,
    });
    let height = Extent::unless_usual(DOORWAY, plan.spec.doorway_height);
    Doorway { height, ..Doorway::new(Shape::from_rect(rect), true, rooms) }
}

/// Adds the floors of hallways and open areas, as rectangles that are as large as a scan from the top left allows.
fn floors(plan: &FloorPlan, surfaces: &mut Vec<Surface>) {
    let grid = &plan.grid;
    let mut covered = vec![false; grid.cells().len()];
    for (i, &cell) in grid.cells().iter().enumerate() {
        let kind = match cell {
            Cell::Hallway => SurfaceKind::Hallway,
            Cell::Open => SurfaceKind::OpenArea,
            _ => continue,
        };
        if covered[i] {
            continue;
        }
        let (x, y) = grid.position(i);
        let free = |x: u32, y: u32| grid.get(x, y) == Some(cell) && !covered[grid.index(x, y)];
        let mut right = x + 1;
        while free(right, y) {
            right += 1;
        }
        let mut bottom = y + 1;
        while (x..right).all(|x| free(x, bottom)) {
            bottom += 1;
        }
        for y in y..bottom {
            let start = grid.index(x, y);
            covered[start..start + (right - x) as usize].fill(true);
        }
        let min = plan.point(f64::from(x), f64::from(bottom));
        let max = plan.point(f64::from(right), f64::from(y));
        let shape = Shape::from_rect(Rect::new(min, max));
        surfaces.push(Surface::new(kind, shape));
    }
}

fn room(plan: &FloorPlan, i: usize, world: &mut World) {
    let placed = &plan.rooms[i];
    let design = &placed.room;
    let frame = plan.design_placement(i);
    let (width, height) = placed.size();
    let size = DVec2::new(f64::from(width), f64::from(height)) * plan.spec.cell_size;
    let floor = Rect::new(frame.corner, frame.corner + size).grown(-0.5 * plan.spec.wall_thickness);
    world.rooms.push(Room {
        name: design.name.clone(),
        shape: Shape::from_rect(floor),
        difficulty: Some(design.difficulty),
        lit: design.lit,
        contents: placed.contents,
        height: Extent::unless_usual(WALL, plan.spec.wall_height),
    });
    let walls = design.walls.iter();
    let usual = Extent::unless_usual(WALL, plan.spec.wall_height);
    world.walls.extend(walls.map(|wall| {
        let usual = usual.filter(|_| wall.kind.extent() == WALL);
        Wall { shape: frame.shape(&wall.shape), height: wall.height.or(usual), ..*wall }
    }));
    // Stairs are as high as the walls, door posts at most.
    let top = plan.spec.wall_height;
    let obstacles = design.obstacles.iter();
    world.obstacles.extend(obstacles.map(|obstacle| {
        let height = obstacle.height.or(obstacle.kind.height_beside_walls(top));
        Obstacle { shape: frame.shape(&obstacle.shape), height, ..*obstacle }
    }));
    let surfaces = design.surfaces.iter();
    world.surfaces.extend(surfaces.map(|surface| {
        let is_stairs = surface.kind == SurfaceKind::Stairs;
        let height = surface.height.or(usual.filter(|_| is_stairs));
        Surface { shape: frame.shape(&surface.shape), height, ..*surface }
    }));
    world.victims.extend(design.victims.iter().map(|victim| Pose {
        position: frame.point(victim.position),
        heading: frame.heading(victim.heading),
    }));
}

/// Draws a hallway cell as the start; an open cell if there are no hallways.
fn start(plan: &FloorPlan, access: &AccessGraph) -> Option<u32> {
    let of_kind = |hallway: bool| -> Vec<u32> {
        let wanted = |kind: PlaceKind| match kind {
            PlaceKind::Hallway { .. } => hallway,
            PlaceKind::Open { .. } => !hallway,
            PlaceKind::Room { .. } => false,
        };
        (0..access.places().len() as u32)
            .filter(|&i| wanted(access.places()[i as usize].kind))
            .collect()
    };
    let mut cells = of_kind(true);
    if cells.is_empty() {
        cells = of_kind(false);
    }
    if cells.is_empty() {
        return None;
    }
    let drawn = plan
        .seed
        .map_or(0, |seed| seed.stream("indoor/start", 0).below(cells.len() as u64) as usize);
    cells.get(drawn).copied()
}

/// Whether the robot fits somewhere in every room. In a full room, no place could be out of reach.
fn has_place_in_all(plan: &FloorPlan, access: &AccessGraph) -> bool {
    let mut has_place = vec![false; plan.rooms.len()];
    for place in access.places() {
        if let PlaceKind::Room { room, .. } = place.kind {
            has_place[room as usize] = true;
        }
    }
    has_place.into_iter().all(|has_place| has_place)
}

/// Returns the direction of the first link of a place.
fn heading(access: &AccessGraph, place: u32) -> f64 {
    let first = access.links().iter().find(|link| link.places.contains(&place));
    let Some(link) = first else { return 0.0 };
    let other = link.places[usize::from(link.places[0] == place)];
    let along = access.places()[other as usize].at - access.places()[place as usize].at;
    libm::atan2(along.y, along.x)
}

/// Returns the first of the farthest places that can be reached.
fn farthest(distances: &[f64]) -> usize {
    let mut best = (0, -1.0);
    for (i, &distance) in distances.iter().enumerate() {
        if distance.is_finite() && distance > best.1 {
            best = (i, distance);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Blueprint;
    use crate::indoor::IndoorSpec;
    use crate::seed::Seed;
    use crate::world::ObstacleKind;

    #[test]
    fn stairs_are_as_high_as_the_walls() {
        for wall_height in [1.2, 2.6, 5.0] {
            let mut stairs = 0;
            for seed in 0..10 {
                let spec = IndoorSpec {
                    wall_height,
                    doorway_height: 1.1,
                    difficulty: 8.0,
                    ..Default::default()
                };
                let world = spec.generate(Seed(seed)).unwrap().to_world();
                let obstacles = world.obstacles.iter().filter(|o| o.kind == ObstacleKind::Stairs);
                let surfaces = world.surfaces.iter().filter(|s| s.kind == SurfaceKind::Stairs);
                let tops = obstacles.map(Obstacle::extent).chain(surfaces.map(Surface::extent));
                for extent in tops {
                    assert_eq!(extent.top(), wall_height);
                    stairs += 1;
                }
            }
            assert!(stairs > 0, "maps with walls of {wall_height} m have stairs");
        }
    }
}
