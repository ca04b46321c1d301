//! Fitting: the frame in which a map matches a world best.

use envgen::geometry::{Pose, wrap_angle};
use glam::DVec2;

use crate::map::{CellIndex, DECIDED, OccupancyMap, TILE};
use crate::mappable_area::{MappableArea, SCORE_CELL};

/// First and last step size of the search, in metres and radians.
const FIRST: (f64, f64) = (0.64, 0.16);
const LAST_SHIFT: f64 = 0.005;

/// Distance in metres to the nearest wall from which a wall of the map does not count.
const REACH: f64 = 1.0;

/// Greatest number of the map's wall points that are compared, evenly spaced over it.
const MOST_POINTS: usize = 4000;

/// Greatest number of steps of one size.
const MOST_STEPS: usize = 200;

/// Greatest distance from the first guess, in metres and radians: farther away, a map fits where it does not belong,
/// such as along a corridor.
const FARTHEST: (f64, f64) = (1.5, 0.3);

/// Returns the pose of a map's frame in the world's frame for which the map's walls are nearest to the
/// world's, near a first guess.
///
/// `map` is in its own frame. From the guess, the search climbs in steps that become smaller. It finds
/// a frame that is up to about a metre and ten degrees away, and none that is turned by more than 17
/// degrees, or that shifts both its origin and the middle of the map's walls by more than 1.5 m. Of frames
/// that look alike, it finds the first. A map without walls stays where it is.
///
/// ```
/// use envgen::geometry::Pose;
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::{robot::Robot, score, mappable_area::MappableArea};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let area = MappableArea::new(&world, &Robot::default())?;
/// // The perfect map is in the world's frame, which is found again from a guess beside it.
/// let frame = score::fit(&area, &area.perfect_map(), Pose::new(0.3, -0.2, 0.05));
/// assert!(frame.position.length() < 0.1 && frame.heading.abs() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit(truth: &MappableArea, map: &OccupancyMap, guess: Pose) -> Pose {
    let points = walls(map);
    // Rotation about the middle of the walls does not shift them.
    let middle = points.iter().sum::<DVec2>() / points.len().max(1) as f64;
    let closeness = |at: Pose| -> f64 {
        let to_world = at.local_to_world();
        points.iter().map(|&p| closeness(truth, to_world(p - middle))).sum()
    };
    let mut best = Pose { position: guess.to_world(middle), heading: guess.heading };
    let first = best;
    let is_near = |at: &Pose| {
        let turn = wrap_angle(at.heading - first.heading).abs();
        // The frame may be turned about the middle of the walls, or about its own origin.
        let turned = Pose { position: guess.position, heading: at.heading }.to_world(middle);
        let shift = at.position.distance(first.position).min(at.position.distance(turned));
        shift <= FARTHEST.0 && turn <= FARTHEST.1
    };
    let mut value = closeness(best);
    let (mut shift, mut turn) = FIRST;
    while shift > LAST_SHIFT && !points.is_empty() {
        for _ in 0..MOST_STEPS {
            let around = neighbours(best, shift, turn).into_iter().filter(is_near);
            let around = around.map(|at| (closeness(at), at));
            let better = around.fold((value, best), |a, b| if b.0 > a.0 { b } else { a });
            if better.0 <= value {
                break;
            }
            (value, best) = better;
        }
        (shift, turn) = (0.5 * shift, 0.5 * turn);
    }
    let turn = Pose { position: DVec2::ZERO, heading: best.heading };
    Pose { position: best.position - turn.to_world(middle), heading: best.heading }
}

/// Middles of the occupied cells, or of some of them if there are many.
fn walls(map: &OccupancyMap) -> Vec<DVec2> {
    let mut points = Vec::new();
    for ((col, row), tile) in map.tiles() {
        for (i, _) in (0..).zip(tile).filter(|(_, odds)| **odds > DECIDED) {
            let index = CellIndex { col: col * TILE + i % TILE, row: row * TILE + i / TILE };
            points.push(index.centre());
        }
    }
    // The order of tiles is that in which they were written.
    points.sort_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)));
    let step = points.len().div_ceil(MOST_POINTS).max(1);
    points.into_iter().step_by(step).collect()
}

/// How near a point is to a wall of the world, from 0 to 1.
fn closeness(truth: &MappableArea, p: DVec2) -> f64 {
    let Some(cell) = truth.frame().cell_at(p) else { return 0.0 };
    let distance = f64::from(truth.wall_distance()[cell]).sqrt() * SCORE_CELL;
    (1.0 - distance / REACH).max(0.0)
}

/// The poses one step away.
fn neighbours(at: Pose, shift: f64, turn: f64) -> [Pose; 14] {
    let steps = [-1.0, 0.0, 1.0];
    let moved = |x: f64, y: f64, h: f64| Pose {
        position: at.position + DVec2::new(x, y) * shift,
        heading: wrap_angle(at.heading + h * turn),
    };
    let mut poses = [at; 14];
    let shifts = steps.into_iter().flat_map(|x| steps.map(|y| (x, y, 0.0)));
    let turns =
        [-1.0, 1.0].into_iter().flat_map(|h| [(0.0, 0.0, h), (0.7, 0.0, h), (-0.7, 0.0, h)]);
    let all = shifts.filter(|(x, y, _)| (*x, *y) != (0.0, 0.0)).chain(turns);
    for (pose, (x, y, h)) in poses.iter_mut().zip(all) {
        *pose = moved(x, y, h);
    }
    poses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::RESOLUTION;
    use crate::mappable_area::tests::{add_wall, room};
    use crate::robot::Robot;
    use crate::score::{MapScores, Reference};

    /// A room that looks like itself from one side only.
    fn truth() -> Reference {
        let mut world = room(16.0, 8.0);
        add_wall(&mut world, (5.0, 0.0), (5.1, 3.0));
        add_wall(&mut world, (11.0, 4.5), (11.1, 8.0));
        Reference::new(&world, &Robot::default()).expect("a world with free space")
    }

    #[test]
    fn a_map_that_is_off_is_brought_back() {
        let truth = truth();
        let frame = Pose::new(3.0, 2.0, 0.4);
        let ros = truth.perfect_map().to_ros_map().expect("small");
        // The perfect map in the frame of a start.
        let own = OccupancyMap::from_ros_map(&ros, frame.inverse()).expect("small");
        for off in [Pose::default(), Pose::new(0.7, -0.5, 0.1), Pose::new(-0.3, 0.6, -0.15)] {
            let found = fit(&truth, &own, frame.compose(off));
            let error = frame.between(found);
            assert!(error.position.length() < RESOLUTION, "{off:?}: {error:?}");
            assert!(error.heading.abs() < 0.005, "{off:?}: {error:?}");
            let map = OccupancyMap::from_ros_map(&own.to_ros_map().expect("small"), found);
            let scores = MapScores::of(&truth, &map.expect("small"));
            assert!(scores.f1_15 > 0.99 && scores.coverage > 0.97, "{scores:?}");
        }
    }

    #[test]
    fn a_map_is_not_moved_along_a_corridor() {
        let truth = Reference::new(&room(40.0, 2.0), &Robot::default()).expect("free space");
        let own = truth.perfect_map();
        // Each step towards the ends fits better, but a frame that is so wrong is not nearly known.
        for off in [6.0, -12.0] {
            let found = fit(&truth, &own, Pose::new(off, 0.3, 0.0)).position;
            assert!((found.x - off).abs() < 1.6 && found.y.abs() < 0.1, "{found}");
        }
    }

    #[test]
    fn a_heading_that_is_off_is_found_far_from_the_origin() {
        // The middle of the walls is 30 m from the origin of the frame, and a turn moves it by 1.8 m.
        let mut world = room(60.0, 12.0);
        for (x, from, to) in
            [(9.0, 0.0, 9.5), (21.0, 2.5, 12.0), (30.0, 0.0, 9.5), (47.0, 2.5, 12.0)]
        {
            add_wall(&mut world, (x, from), (x + 0.1, to));
        }
        let truth = Reference::new(&world, &Robot::default()).expect("free space");
        let ros = truth.perfect_map().to_ros_map().expect("small");
        let frame = Pose::new(1.0, 1.5, 0.0);
        let own = OccupancyMap::from_ros_map(&ros, frame.inverse()).expect("small");
        for turn in [0.06, -0.06] {
            let found = frame.between(fit(&truth, &own, frame.compose(Pose::new(0.0, 0.0, turn))));
            assert!(found.position.length() < 0.15 && found.heading.abs() < 0.005, "{found:?}");
        }
    }

    #[test]
    fn a_map_without_walls_stays_where_it_is() {
        let guess = Pose::new(1.0, -2.0, 0.3);
        assert_eq!(fit(&truth(), &OccupancyMap::new(), guess), guess);
    }
}
