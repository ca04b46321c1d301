//! What is promised of a world, and an independent check of it.
//!
//! A generator writes its promises into [`World::certificate`]. [`verify`] checks them on the world
//! alone, by other means than the generator's: rasters and flood fills in place of graphs and
//! unions, so that an error in one is not repeated in the other.

mod places;

use std::collections::VecDeque;
use std::fmt;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::geometry::{Rect, wrap_angle};
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::world::{RoadStrip, World};

/// A promise that a generator makes of a world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Claim {
    /// A disc of this radius can move from the start to the goal.
    Connected {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// No two trees' centres are nearer than this.
    TreeDistance {
        /// Least distance in metres.
        distance: f64,
    },
    /// Whether a disc can cross an area from its west to its east side with its middle inside.
    CrossesWestEast {
        /// The area.
        area: Rect,
        /// Radius of the disc in metres.
        radius: f64,
        /// Whether it can.
        crosses: bool,
    },
    /// No bend of a road is tighter than this.
    BendRadius {
        /// Least radius in metres.
        radius: f64,
    },
    /// From the start a disc of this radius can reach every room, or every part of a room that its
    /// contents divide, and every piece of the hallways and open areas.
    EveryPlaceReachable {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// This doorway was added, and is open, so that some place can be reached.
    AddedDoorway {
        /// Its place in [`World::doorways`](crate::World::doorways).
        doorway: u32,
    },
}

impl Claim {
    /// Whether its distances are finite and not negative, and its area finite and not empty.
    pub(crate) fn is_definite(&self) -> bool {
        let distance = |d: f64| d.is_finite() && d >= 0.0;
        match *self {
            Claim::Connected { radius } => distance(radius),
            Claim::TreeDistance { distance: least } => distance(least),
            Claim::CrossesWestEast { area, radius, .. } => {
                let finite = area.min.is_finite() && area.max.is_finite();
                distance(radius) && finite && area.min.cmplt(area.max).all()
            }
            Claim::BendRadius { radius } => distance(radius),
            Claim::EveryPlaceReachable { radius } => distance(radius),
            Claim::AddedDoorway { .. } => true,
        }
    }
}

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds.
    Holds,
    /// It does not hold.
    Broken,
    /// It is too close to call at the finest raster that fits into memory.
    Undecided,
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Claim::Connected { radius } => {
                write!(f, "a disc of radius {radius} m can move from start to goal")
            }
            Claim::TreeDistance { distance } => {
                write!(f, "no two trees' centres are nearer than {distance} m")
            }
            Claim::CrossesWestEast { radius, crosses, .. } => {
                let can = if *crosses { "can" } else { "cannot" };
                write!(f, "a disc of radius {radius} m {can} cross from west to east")
            }
            Claim::BendRadius { radius } => {
                write!(f, "no bend of a road is tighter than {radius} m")
            }
            Claim::EveryPlaceReachable { radius } => {
                write!(f, "a disc of radius {radius} m can reach every room and hallway")
            }
            Claim::AddedDoorway { doorway } => {
                write!(f, "doorway {doorway} was added so that a place can be reached")
            }
        }
    }
}

/// Checks every claim of a world's certificate, in order.
pub fn verify(world: &World) -> Vec<(Claim, Verdict)> {
    world.certificate.iter().map(|claim| (*claim, verdict(world, claim))).collect()
}

fn verdict(world: &World, claim: &Claim) -> Verdict {
    match *claim {
        Claim::Connected { radius } => match (world.start, world.goal) {
            (Some(start), Some(goal)) => {
                let from = |grid: &OccupancyGrid| cells_near(grid, start.position);
                let to = |grid: &OccupancyGrid| cells_near(grid, goal.position);
                decide(world, world.bounds, radius, true, &from, &to)
            }
            _ => Verdict::Broken,
        },
        Claim::TreeDistance { distance } => {
            if trees_keep(world, distance) {
                Verdict::Holds
            } else {
                Verdict::Broken
            }
        }
        Claim::CrossesWestEast { area, radius, crosses } => {
            let side = |col: fn(&OccupancyGrid) -> usize| {
                move |grid: &OccupancyGrid| (0..grid.rows()).map(|row| (col(grid), row)).collect()
            };
            decide(world, area, radius, crosses, &side(|_| 0), &side(|grid| grid.cols() - 1))
        }
        Claim::BendRadius { radius } => {
            if world.road_strips.iter().all(|strip| bends_keep(strip, radius)) {
                Verdict::Holds
            } else {
                Verdict::Broken
            }
        }
        Claim::EveryPlaceReachable { radius } => places::every_place_reachable(world, radius),
        Claim::AddedDoorway { doorway } => match world.doorways.get(doorway as usize) {
            Some(doorway) if doorway.open => Verdict::Holds,
            _ => Verdict::Broken,
        },
    }
}

/// The finest raster has at most this many cells.
const MOST_CELLS: f64 = (1 << 24) as f64;

/// Whether a disc's middle can move between two sets of cells inside an area, by flood fill on ever
/// finer rasters.
///
/// Let h be the side of a cell. A solid point lies within h / sqrt 2 of the middle of a cell that
/// it occupies, and every point of a way within h / sqrt 2 of a cell's middle. So middles that are
/// farther than radius + sqrt 2 h from all occupied middles make a way for certain, and a way for
/// certain leads through middles that are at least radius - sqrt 2 h away.
fn decide(
    world: &World,
    area: Rect,
    radius: f64,
    claimed: bool,
    from: &dyn Fn(&OccupancyGrid) -> Vec<(usize, usize)>,
    to: &dyn Fn(&OccupancyGrid) -> Vec<(usize, usize)>,
) -> Verdict {
    let size = area.size();
    let verdict = |way: bool| if way == claimed { Verdict::Holds } else { Verdict::Broken };
    let mut cols = (size.x / (0.5 * radius)).max(size.x / size.y).clamp(16.0, 1024.0).ceil();
    loop {
        // The columns fill the area exactly; of the rows the last may reach over it.
        let cell = size.x / cols;
        let fits = cols * (size.y / cell) <= MOST_CELLS;
        let Some(mut solid) = fits.then(|| OccupancyGrid::empty(area, cell).ok()).flatten() else {
            return Verdict::Undecided;
        };
        world.solids().for_each(|s| solid.occupy(&s.shape, Coverage::Conservative));
        let slack = std::f64::consts::SQRT_2 * cell;
        let mut sure = solid.inflated(radius + slack);
        sure.occupy_middles_outside(area);
        if joined(&sure, from, to) {
            return verdict(true);
        }
        if radius > slack && !joined(&solid.inflated((radius - slack) * (1.0 - 1e-9)), from, to) {
            return verdict(false);
        }
        cols *= 2.0;
    }
}

/// The cell around a point, if it lies in the grid.
fn cells_near(grid: &OccupancyGrid, p: DVec2) -> Vec<(usize, usize)> {
    grid.cell_at(p).into_iter().collect()
}

/// Whether free cells join two sets of cells, over sides and corners.
fn joined(
    grid: &OccupancyGrid,
    from: &dyn Fn(&OccupancyGrid) -> Vec<(usize, usize)>,
    to: &dyn Fn(&OccupancyGrid) -> Vec<(usize, usize)>,
) -> bool {
    let (cols, rows) = (grid.cols(), grid.rows());
    let mut closed = grid.cells().to_vec();
    let mut goal = vec![false; cols * rows];
    for (col, row) in to(grid) {
        goal[row * cols + col] = true;
    }
    let mut open: VecDeque<(usize, usize)> = VecDeque::new();
    let mut visit = |col: usize, row: usize, open: &mut VecDeque<_>| {
        let cell = row * cols + col;
        if !std::mem::replace(&mut closed[cell], true) {
            open.push_back((col, row));
        }
    };
    for (col, row) in from(grid) {
        visit(col, row, &mut open);
    }
    while let Some((col, row)) = open.pop_front() {
        if goal[row * cols + col] {
            return true;
        }
        for row in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
            for col in col.saturating_sub(1)..=(col + 1).min(cols - 1) {
                visit(col, row, &mut open);
            }
        }
    }
    false
}

/// Whether all trees keep a distance: sweep in order of x.
fn trees_keep(world: &World, distance: f64) -> bool {
    let mut centers: Vec<DVec2> = world.trees.iter().map(|tree| tree.center).collect();
    centers.sort_by(|a, b| a.x.total_cmp(&b.x));
    centers.iter().enumerate().all(|(i, a)| {
        let near = centers[i + 1..].iter().take_while(|b| b.x - a.x < distance);
        near.into_iter().all(|b| a.distance_squared(*b) >= distance * distance)
    })
}

/// Whether no bend of a road is tighter than a radius: by the curvatures that it states, and by the
/// places that it leads through. Where the curvature stays within 1 / radius and the heading
/// changes by an angle under pi, the chord is at least 2 radius sin(angle / 2).
fn bends_keep(strip: &RoadStrip, radius: f64) -> bool {
    let path = strip.path();
    let stated = strip.centreline.iter().map(|point| point.curvature.abs());
    let mut stated = stated.chain(path.curves().iter().map(|curve| curve.tightest()));
    let parts = (path.length() / (0.5 * radius)).ceil().clamp(1.0, MOST_CELLS);
    let mut walk = path.walk();
    let mut before = path.pose_at(0.0);
    stated.all(|curvature| curvature * radius <= 1.0 + 1e-9)
        && (1..=parts as u64).all(|i| {
            let (pose, _) = walk.to(path.length() * (i as f64 / parts));
            let angle = wrap_angle(pose.heading - before.heading).abs();
            let chord = pose.position.distance(before.position);
            let slack = 1e-9 * (1.0 + pose.position.length());
            before = pose;
            2.0 * radius * libm::sin(0.5 * angle) <= chord + slack
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::ForestSpec;
    use crate::generate::{Blueprint, Spec};
    use crate::geometry::{Pose, Shape};
    use crate::hallway::HallwaySpec;
    use crate::provenance::Provenance;
    use crate::road::RoadSpec;
    use crate::seed::Seed;
    use crate::world::{Wall, WallKind};

    /// A wall from south to north with a gap of `gap` metres in its middle.
    fn gap_world(gap: f64) -> World {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 6.0));
        let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        for (low, high) in [(0.0, 3.0 - 0.5 * gap), (3.0 + 0.5 * gap, 6.0)] {
            let rect = Rect::new(DVec2::new(5.0, low), DVec2::new(5.2, high));
            world.walls.push(Wall { kind: WallKind::Wall, shape: Shape::from_rect(rect) });
        }
        world.start = Some(Pose::new(1.0, 1.0, 0.0));
        world.goal = Some(Pose::new(9.0, 5.0, 0.0));
        world
    }

    #[test]
    fn a_gap_lets_through_what_is_narrower() {
        for (gap, way) in [(1.02, true), (0.98, false), (0.0, false)] {
            let mut world = gap_world(gap);
            let area = world.bounds;
            for claimed in [true, false] {
                let claim = Claim::CrossesWestEast { area, radius: 0.5, crosses: claimed };
                let expected = if way == claimed { Verdict::Holds } else { Verdict::Broken };
                world.certificate = vec![claim];
                assert_eq!(verify(&world), [(claim, expected)], "gap {gap}");
            }
            let claim = Claim::Connected { radius: 0.5 };
            world.certificate = vec![claim];
            let expected = if way { Verdict::Holds } else { Verdict::Broken };
            assert_eq!(verify(&world), [(claim, expected)], "gap {gap}");
        }
    }

    #[test]
    fn trees_too_near_break_their_claim() {
        let spec = ForestSpec { min_distance: 2.0, ..Default::default() };
        let mut world = spec.generate(Seed(1)).unwrap().to_world();
        assert!(verify(&world).iter().all(|(_, verdict)| *verdict == Verdict::Holds));
        world.trees[3].center = world.trees[4].center + DVec2::new(1.9, 0.0);
        assert_eq!(
            verify(&world).last().unwrap(),
            &(Claim::TreeDistance { distance: 2.0 }, Verdict::Broken)
        );
    }

    #[test]
    fn roads_keep_their_promises() {
        for seed in 0..20 {
            let transition = 0.02 * seed as f64;
            let spec = RoadSpec { random: 8, transition, ..Default::default() };
            let mut world = spec.generate(Seed(seed)).unwrap().to_world();
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "seed {seed}: {claim}");
            }
            let turning = world.road_strips[0].pieces.iter().any(|piece| !piece.is_line());
            for claim in &mut world.certificate {
                if let Claim::BendRadius { radius } = claim {
                    *radius *= 1.01;
                    assert!(turning);
                }
            }
            let broken = verify(&world).iter().any(|(_, verdict)| *verdict == Verdict::Broken);
            assert_eq!(broken, turning, "seed {seed}");
        }
    }

    #[test]
    fn hallways_keep_their_promises() {
        for seed in 0..20 {
            let spec = HallwaySpec {
                door_frame_rate: 0.1,
                narrowing_rate: 0.1,
                alcove_rate: 0.1,
                ..Default::default()
            };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "seed {seed}: {claim}");
            }
        }
    }

    #[test]
    fn the_union_of_trunks_and_the_flood_agree_on_ways_through() {
        // Below and above the percolation threshold. A narrowest gap within two hundredths of a
        // metre of the robot's width stays undecided.
        let (mut ways, mut decided) = (0, 0);
        for seed in 0..30 {
            let intensity = if seed % 2 == 0 { 0.15 } else { 0.22 };
            let spec = ForestSpec { intensity, ..Default::default() };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            let [(claim, verdict)] = verify(&world)[..] else { panic!("one claim") };
            assert_ne!(verdict, Verdict::Broken, "seed {seed}: {claim}");
            decided += u32::from(verdict == Verdict::Holds);
            ways += u32::from(matches!(claim, Claim::CrossesWestEast { crosses: true, .. }));
        }
        assert!(decided >= 25 && (8..=22).contains(&ways), "{decided} decided, {ways} ways");
    }
}
