//! Whether every room, hallway and open area can be reached.

use glam::DVec2;

use super::Verdict;
use crate::geometry::Shape;
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::world::{SurfaceKind, World};

/// The finest raster has at most this many cells.
const MOST_CELLS: f64 = (1 << 24) as f64;

/// Whether a disc can move from the start to every place on the floors of the world's rooms,
/// hallways and open areas where its middle fits, by flood fill on ever finer rasters. It does not
/// drive on surfaces of speed 0.
///
/// A solid point lies within h / sqrt 2 of the middle of a cell of side h that it occupies, and every
/// point of a way within h / sqrt 2 of a cell's middle: middles farther than radius + sqrt 2 h from
/// all occupied ones are free for certain, those nearer than radius - sqrt 2 h are not. The free
/// space for certain must be flooded whole. A place that is narrower than the raster can tell from solid is not looked for.
pub(super) fn every_place_reachable(world: &World, radius: f64) -> Verdict {
    let Some(start) = world.start else { return Verdict::Broken };
    let area = world.bounds;
    let size = area.size();
    let mut cell = (0.25 * radius).max((size.x * size.y / MOST_CELLS).sqrt());
    loop {
        let fits = (size.x / cell) * (size.y / cell) <= 1.01 * MOST_CELLS;
        let Some(mut solid) = fits.then(|| OccupancyGrid::empty(area, cell).ok()).flatten() else {
            return Verdict::Undecided;
        };
        let mut floor = solid.clone();
        for shape in barriers(world) {
            solid.occupy(&shape, Coverage::Conservative);
        }
        for shape in floors(world) {
            floor.occupy(shape, Coverage::Centre);
        }
        let slack = std::f64::consts::SQRT_2 * cell;
        let sure = solid.inflated(radius + slack);
        let surely_reached = flood(&sure, &cells_near(&sure, start.position));
        let missed = |reached: &[bool]| {
            floor
                .cells()
                .iter()
                .zip(sure.cells())
                .zip(reached)
                .any(|((&floor, &occupied), &reached)| floor && !occupied && !reached)
        };
        if !missed(&surely_reached) && every_room_has(world, &sure, &surely_reached) {
            return Verdict::Holds;
        }
        if radius > slack {
            let maybe = solid.inflated((radius - slack) * (1.0 - 1e-9));
            let reached = flood(&maybe, &cells_near(&maybe, start.position));
            if missed(&reached) || !every_room_has(world, &maybe, &reached) {
                return Verdict::Broken;
            }
        }
        cell *= 0.6;
    }
}

/// The cell around a point, if it lies in the grid.
fn cells_near(grid: &OccupancyGrid, p: DVec2) -> Vec<(usize, usize)> {
    grid.cell_at(p).into_iter().collect()
}

fn barriers(world: &World) -> impl Iterator<Item = Shape> + '_ {
    let solids = world.solids().map(|solid| solid.shape.into_owned());
    let deep = world.surfaces.iter().filter(|surface| surface.speed == 0.0);
    solids.chain(deep.map(|surface| surface.shape.clone()))
}

fn floors(world: &World) -> impl Iterator<Item = &Shape> {
    let halls = world
        .surfaces
        .iter()
        .filter(|s| matches!(s.kind, SurfaceKind::Hallway | SurfaceKind::OpenArea));
    world.rooms.iter().map(|room| &room.shape).chain(halls.map(|surface| &surface.shape))
}

/// Whether some flooded cell's middle lies in every room.
fn every_room_has(world: &World, grid: &OccupancyGrid, reached: &[bool]) -> bool {
    world.rooms.iter().all(|room| {
        let bounds = room.shape.bounds();
        let (Some(low), Some(high)) = (grid.cell_at(bounds.min), grid.cell_at(bounds.max)) else {
            return false;
        };
        (low.1..=high.1).any(|row| {
            (low.0..=high.0).any(|col| {
                reached[row * grid.cols() + col] && room.shape.contains(grid.cell_centre(col, row))
            })
        })
    })
}

/// The free cells that free cells join to some, over sides and corners.
fn flood(grid: &OccupancyGrid, from: &[(usize, usize)]) -> Vec<bool> {
    let (cols, rows) = (grid.cols(), grid.rows());
    let mut reached = vec![false; cols * rows];
    let mut open: Vec<(usize, usize)> = Vec::new();
    let mut visit = |col: usize, row: usize, open: &mut Vec<_>| {
        let cell = row * cols + col;
        if !grid.cells()[cell] && !std::mem::replace(&mut reached[cell], true) {
            open.push((col, row));
        }
    };
    from.iter().for_each(|&(col, row)| visit(col, row, &mut open));
    while let Some((col, row)) = open.pop() {
        for row in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
            for col in col.saturating_sub(1)..=(col + 1).min(cols - 1) {
                visit(col, row, &mut open);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::{Claim, verify};
    use crate::generate::{Blueprint, Spec};
    use crate::indoor::{IndoorSpec, Layout, Profile};
    use crate::seed::Seed;

    #[test]
    fn indoor_maps_keep_their_promises() {
        for (seed, difficulty) in (0..12).zip([0.0, 2.0, 4.5, 6.8, 8.0, 10.0].into_iter().cycle()) {
            let layout = if seed % 2 == 0 { Layout::Grid } else { Layout::LSystem };
            let spec =
                IndoorSpec { difficulty, width: 14, height: 11, layout, ..Default::default() };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            assert!(world.certificate.contains(&Claim::EveryPlaceReachable { radius: 0.36 }));
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "d = {difficulty}, seed {seed}: {claim}");
            }
        }
    }

    #[test]
    fn a_closed_room_breaks_the_promise() {
        let spec = IndoorSpec { width: 8, height: 8, difficulty: 1.0, ..Default::default() };
        let mut world = spec.generate(Seed(2)).unwrap().to_world();
        let claim = Claim::EveryPlaceReachable { radius: 0.36 };
        world.certificate = vec![claim];
        assert_eq!(verify(&world), [(claim, Verdict::Holds)]);
        for door in world.doorways.iter_mut().filter(|door| door.rooms.contains(&Some(0))) {
            door.open = false;
        }
        assert_eq!(verify(&world), [(claim, Verdict::Broken)]);
    }

    #[test]
    fn the_graph_and_the_flood_agree_on_the_thesis() {
        let claim = Claim::EveryPlaceReachable { radius: 0.36 };
        let (mut whole, mut parted) = (0, 0);
        for seed in 0..16 {
            let spec = IndoorSpec {
                width: 9,
                height: 9,
                difficulty: 3.0 + seed as f64 * 0.4,
                profile: Profile::Thesis,
                ..Default::default()
            };
            let plan = spec.generate(Seed(seed)).unwrap();
            let one = plan.access().parts() == 1;
            let mut world = plan.to_world();
            world.certificate.retain(|kept| *kept != claim);
            world.certificate.push(claim);
            let expected = if one { Verdict::Holds } else { Verdict::Broken };
            for (claim, verdict) in verify(&world) {
                let is_places = matches!(claim, Claim::EveryPlaceReachable { .. });
                let expected = if is_places { expected } else { Verdict::Holds };
                assert_eq!(verdict, expected, "seed {seed}: {claim}");
            }
            if one { whole += 1 } else { parted += 1 }
        }
        assert!(whole > 0 && parted > 0, "{whole} whole, {parted} parted");
    }
}
