//! Surfels: short pieces of wall, each the mean of many echoes. A matched pose is refined against them.
//!
//! A likelihood field is flat on top: where a wall was seen a hundred times, the field's ridge is as
//! wide as the echoes scatter, and a scan may slide within it. The mean of the echoes has no width.

use std::collections::BTreeMap;

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::{DMat2, DMat3, DVec2, DVec3, IVec2, Vec2};

use super::track::Variance;
use crate::map::floor;

/// Side of a cell in metres. A surfel is the mean over at most two cells along each axis.
const CELL: f64 = 0.2;

/// Cells along a side of a tile.
const TILE: i32 = 16;

/// Number of echoes from which a surfel does not move any more: the map is what the first passes saw.
const MOST_ECHOES: f64 = 100.0;

/// Least number of echoes of a surfel to which a scan is matched.
const FEWEST_ECHOES: f64 = 3.0;

/// Distance in metres along the wall, to either side, over which the normal at an echo is computed, and
/// the most that the echo may be off the line between. It excludes the trunks of trees, which are not
/// walls.
const ARM: f32 = 0.15;
const STRAIGHT: f32 = 0.03;

/// Echoes that are nearer to each other than this in metres, summed from echo to echo, are certainly
/// nearer than an arm, whatever the rounding.
const SURELY_WITHIN_ARM: f64 = ARM as f64 - 1e-4;

/// Greatest gap in metres between neighbouring echoes of one wall.
const GAP: f32 = 0.5;

/// Standard deviation in metres of an echo from its surfel, and the distance beyond which the echo
/// belongs to something else.
const SCATTER: f64 = 0.015;
const FARTHEST: f64 = 0.2;

/// Variances of a pose to which a scan was matched, in square metres and square radians.
pub(crate) const MATCHED: Variance = Variance { position: 9e-4, heading: 2.5e-5 };

/// Least variances of an expected pose.
const LEAST: Variance = Variance { position: 1e-6, heading: 1e-7 };

/// Distance in metres from a surfel within which an echo lies on it.
const NEAR: f64 = 0.04;

/// Fraction of walls across the others from which a position is held in both directions.
const HELD: f64 = 0.05;

/// Greatest number of steps of the refinement, and the step in metres or radians that ends it.
const STEPS: usize = 6;
const STEP: f64 = 2e-4;

/// Greatest last step, in metres or radians, of a refinement that has settled.
const SETTLED: f64 = 5e-3;

/// An echo on a wall, and the wall's normal towards the robot, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WallPoint {
    pub(crate) point: DVec2,
    pub(crate) normal: DVec2,
}

/// Returns the echoes of a scan that lie on a wall, with normals towards the laser's position.
pub(crate) fn wall_points(echoes: &[Vec2], laser: DVec2) -> Vec<WallPoint> {
    let mut walls = Vec::with_capacity(echoes.len());
    let mut along = Vec::with_capacity(echoes.len());
    for row in echoes.chunk_by(|a, b| b.distance(*a) <= GAP) {
        // The distances are summed from echo to echo, so that no two echoes are farther apart than the
        // sum says.
        along.clear();
        let mut sum = 0.0;
        along.extend(row.iter().zip([&row[0]].into_iter().chain(row)).map(|(echo, before)| {
            sum += f64::from(echo.distance(*before));
            sum
        }));
        let (mut left, mut right) = (0, 0);
        for (i, &here) in along.iter().enumerate() {
            while left < i && here - along[left] >= SURELY_WITHIN_ARM {
                left += 1;
            }
            while right < row.len() && along[right] - here < SURELY_WITHIN_ARM {
                right += 1;
            }
            walls.extend(on_wall(&row[..left], row[i], &row[right..], laser));
        }
    }
    walls
}

/// An echo, if it lies on a wall: `before` and `after` hold at least the echoes of its row that are an arm away.
fn on_wall(before: &[Vec2], echo: Vec2, after: &[Vec2], laser: DVec2) -> Option<WallPoint> {
    let is_arm = |p: &&Vec2| p.distance(echo) >= ARM;
    let a = *before.iter().rev().find(is_arm)?;
    let b = *after.iter().find(is_arm)?;
    let across = (b - a).try_normalize()?.perp();
    if across.dot(echo - a).abs() > STRAIGHT {
        return None;
    }
    let (point, normal) = (echo.as_dvec2(), across.as_dvec2());
    let normal = if normal.dot(laser - point) < 0.0 { -normal } else { normal };
    Some(WallPoint { point, normal })
}

/// The echoes in a cell on walls that face one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Surfel {
    echoes: f64,
    /// Sum of their positions from the tile's corner.
    sum: DVec2,
    /// Sum of their normals.
    normal: DVec2,
}

/// The walls of a cell by the direction that they face.
type SurfelCell = [Surfel; 4];

/// A map of surfels.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfelMap {
    tiles: BTreeMap<(i32, i32), Box<[SurfelCell]>>,
}

impl SurfelMap {
    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.tiles.clear();
    }

    /// Adds the walls that were seen from a pose.
    pub(crate) fn add(&mut self, pose: Pose, walls: &[WallPoint]) {
        let heading = unit_vector(pose.heading);
        for wall in walls {
            let at = pose.position + heading.rotate(wall.point);
            let normal = heading.rotate(wall.normal);
            let cell = floor(at / CELL);
            let (tile, place) = address(cell);
            let cells = (TILE * TILE) as usize;
            let tile = self
                .tiles
                .entry(tile)
                .or_insert_with(|| vec![SurfelCell::default(); cells].into_boxed_slice());
            let surfel = &mut tile[place][facing(normal)];
            if surfel.echoes < MOST_ECHOES {
                surfel.echoes += 1.0;
                surfel.sum += at - corner(cell);
                surfel.normal += normal;
            }
        }
    }

    /// Moves a pose to where the walls of a scan lie on the surfels (Gauss-Newton on the distances of
    /// points to lines, with weights that fall with the distance; Censi, An ICP variant using a
    /// point-to-line metric, ICRA 2008, <https://doi.org/10.1109/ROBOT.2008.4543181>).
    pub(crate) fn refine(
        &self,
        expected: Pose,
        variance: Variance,
        walls: &[WallPoint],
    ) -> Refined {
        let Variance { position, heading } = variance;
        let position = 1.0 / position.max(LEAST.position);
        let prior = DVec3::new(position, position, 1.0 / heading.max(LEAST.heading));
        let mut pose = expected;
        let (mut near, mut known) = (0, 0);
        let mut normals = DMat2::ZERO;
        let mut last = f64::INFINITY;
        let mut tile = CachedTile { map: self, at: None, cells: None };
        let mut looks = vec![Look::default(); walls.len()];
        for _ in 0..STEPS {
            (near, known, normals) = (0, 0, DMat2::ZERO);
            let heading = unit_vector(pose.heading);
            let off = (expected.position - pose.position)
                .extend(wrap_angle(expected.heading - pose.heading));
            // The upper triangle of the information matrix, row by row.
            let mut sums = [prior.x, 0.0, 0.0, prior.y, 0.0, prior.z];
            let mut pull = prior * off;
            let mut before = Look::default();
            for (wall, look) in walls.iter().zip(&mut looks) {
                let arm = heading.rotate(wall.point);
                let at = pose.position + arm;
                let place = Place::of(at, heading.rotate(wall.normal));
                // Most walls have the same place as in the last step, or as their neighbour.
                if look.place != Some(place) {
                    *look = if before.place == Some(place) { before } else { tile.look(place) };
                }
                before = *look;
                let Some((middle, normal)) = look.found else { continue };
                let distance = normal.dot(middle - at);
                known += 1;
                if distance.abs() > FARTHEST {
                    continue;
                }
                if distance.abs() <= NEAR {
                    near += 1;
                    normals += DMat2::from_cols(normal * normal.x, normal * normal.y);
                }
                let relative = distance / (2.0 * SCATTER);
                let robust = 1.0 / (1.0 + relative * relative);
                let weight = robust * robust / (SCATTER * SCATTER);
                let row = DVec3::new(normal.x, normal.y, normal.dot(arm.perp()));
                let (x, y) = (row * row.x * weight, row * row.y * weight);
                sums[0] += x.x;
                sums[1] += x.y;
                sums[2] += x.z;
                sums[3] += y.y;
                sums[4] += y.z;
                sums[5] += row.z * row.z * weight;
                pull += row * (weight * distance);
            }
            let [xx, xy, xz, yy, yz, zz] = sums;
            let information = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
            let step = information.inverse() * pull;
            if !step.is_finite() {
                let (is_held, is_settled) = (false, false);
                return Refined { pose: expected, near: 0, known: 0, is_held, is_settled };
            }
            pose = Pose {
                position: pose.position + step.truncate(),
                heading: wrap_angle(pose.heading + step.z),
            };
            last = step.abs().max_element();
            if last < STEP {
                break;
            }
        }
        // The ratio of the smaller to the larger eigenvalue, by trace and determinant.
        let trace = normals.x_axis.x + normals.y_axis.y;
        let is_held = normals.determinant() > HELD * trace * trace;
        Refined { pose, near, known, is_held, is_settled: last <= SETTLED }
    }
}

/// A refined pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Refined {
    pub(crate) pose: Pose,
    /// Number of the scan's walls that lie on one of the map.
    pub(crate) near: usize,
    /// Number of the scan's walls around which the map has one.
    pub(crate) known: usize,
    /// Whether those walls hold the position in every direction.
    pub(crate) is_held: bool,
    /// Whether the last step was small.
    pub(crate) is_settled: bool,
}

/// Where a wall is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    /// The lower left of the four cells that are nearest to a point.
    first: IVec2,
    facing: usize,
}

impl Place {
    fn of(at: DVec2, normal: DVec2) -> Place {
        Place { first: floor(at / CELL - 0.5), facing: facing(normal) }
    }
}

/// Middle and normal of the wall at a place, if there is one.
#[derive(Clone, Copy, Debug, Default)]
struct Look {
    /// `None` before the first look.
    place: Option<Place>,
    found: Option<(DVec2, DVec2)>,
}

/// The tile of the last look-up, since most neighbours are in the same tile.
struct CachedTile<'a> {
    map: &'a SurfelMap,
    at: Option<(i32, i32)>,
    cells: Option<&'a [SurfelCell]>,
}

impl CachedTile<'_> {
    fn look(&mut self, place: Place) -> Look {
        Look { place: Some(place), found: self.surfel(place) }
    }

    /// Returns the middle and the normal of the wall at a place, over the two nearest cells on each
    /// axis.
    fn surfel(&mut self, Place { first, facing }: Place) -> Option<(DVec2, DVec2)> {
        let origin = corner(first);
        let mut all = Surfel::default();
        for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let cell = first + IVec2::new(x, y);
            let (tile, place) = address(cell);
            if self.at != Some(tile) {
                self.at = Some(tile);
                self.cells = self.map.tiles.get(&tile).map(|cells| &**cells);
            }
            let Some(surfel) = self.cells.map(|cells| cells[place][facing]) else { continue };
            all.echoes += surfel.echoes;
            all.sum += surfel.sum + (corner(cell) - origin) * surfel.echoes;
            all.normal += surfel.normal;
        }
        if all.echoes < FEWEST_ECHOES {
            return None;
        }
        Some((origin + all.sum / all.echoes, all.normal.try_normalize()?))
    }
}

/// The lower left corner of a cell in metres.
fn corner(cell: IVec2) -> DVec2 {
    cell.as_dvec2() * CELL
}

/// The tile of a cell, and the cell's index in it.
fn address(cell: IVec2) -> ((i32, i32), usize) {
    let tile = (cell.x.div_euclid(TILE), cell.y.div_euclid(TILE));
    (tile, (cell.y.rem_euclid(TILE) * TILE + cell.x.rem_euclid(TILE)) as usize)
}

/// Which of the four directions a normal faces.
fn facing(normal: DVec2) -> usize {
    let (x, y) = (normal.x, normal.y);
    match (x.abs() >= y.abs(), if x.abs() >= y.abs() { x < 0.0 } else { y < 0.0 }) {
        (true, false) => 0,
        (true, true) => 1,
        (false, false) => 2,
        (false, true) => 3,
    }
}

#[cfg(test)]
mod tests {
    use envgen::Seed;
    use proptest::prelude::*;

    use super::*;

    /// Echoes every 4 cm along a wall, counter-clockwise as a laser sees them.
    fn wall(from: DVec2, to: DVec2) -> impl Iterator<Item = DVec2> {
        let steps = (from.distance(to) / 0.04).round();
        (0..=steps as u32).map(move |i| from.lerp(to, f64::from(i) / steps))
    }

    /// A room of 4.13 x 3.07 m around the origin, on no cell's border.
    fn room() -> Vec<DVec2> {
        let corners = [(2.08, -1.41), (2.08, 1.66), (-2.05, 1.66), (-2.05, -1.41), (2.08, -1.41)];
        let corners = corners.map(|(x, y)| DVec2::new(x, y));
        corners.windows(2).flat_map(|pair| wall(pair[0], pair[1])).collect()
    }

    /// The walls that are seen from a pose, with noise of a centimetre.
    fn seen(walls: &[DVec2], from: Pose, seed: u64) -> Vec<WallPoint> {
        let mut noise = Seed(seed).stream("surfels", 0);
        let mut between = || noise.between(-0.0173, 0.0173);
        let noisy = |p: &DVec2| from.to_local(*p + DVec2::new(between(), between())).as_vec2();
        wall_points(&walls.iter().map(noisy).collect::<Vec<_>>(), DVec2::ZERO)
    }

    fn mapped(walls: &[DVec2]) -> SurfelMap {
        let mut map = SurfelMap::default();
        for seed in 0..10 {
            map.add(Pose::default(), &seen(walls, Pose::default(), seed));
        }
        map
    }

    #[test]
    fn a_scan_is_moved_to_its_walls() {
        let map = mapped(&room());
        for seed in 20..40 {
            let truth = Pose::new(0.3, -0.2, 0.4);
            let expected = Pose::new(0.33, -0.22, 0.41);
            let walls = seen(&room(), truth, seed);
            let found = map.refine(expected, MATCHED, &walls);
            let turn = wrap_angle(found.pose.heading - truth.heading);
            assert!(found.pose.position.distance(truth.position) < 0.006, "{found:?}");
            assert!(turn.abs() < 0.002, "{found:?}");
            assert!(found.near as f64 > 0.95 * walls.len() as f64, "{found:?} of {}", walls.len());
        }
    }

    #[test]
    fn the_two_sides_of_a_thin_wall_are_two_walls() {
        let front: Vec<DVec2> = wall(DVec2::new(2.0, -1.0), DVec2::new(2.0, 1.0)).collect();
        let back: Vec<DVec2> = wall(DVec2::new(2.1, 1.0), DVec2::new(2.1, -1.0)).collect();
        let behind = Pose::new(4.0, 0.0, std::f64::consts::PI);
        let mut map = mapped(&front);
        for seed in 50..60 {
            map.add(behind, &seen(&back, behind, seed));
        }
        let expected = Pose { position: behind.position + DVec2::new(0.03, 0.0), ..behind };
        let found = map.refine(expected, MATCHED, &seen(&back, behind, 70));
        assert!((found.pose.position.x - 4.0).abs() < 0.004, "{found:?}");
    }

    #[test]
    fn along_a_bare_wall_the_expected_pose_stays() {
        let bare: Vec<DVec2> = wall(DVec2::new(4.0, 1.03), DVec2::new(-4.0, 1.03)).collect();
        let near: Vec<DVec2> = bare.iter().copied().filter(|p| p.x.abs() < 2.0).collect();
        let expected = Pose::new(0.1, 0.02, 0.0);
        let found = mapped(&bare).refine(expected, MATCHED, &seen(&near, Pose::default(), 90));
        assert!((found.pose.position.x - 0.1).abs() < 0.01, "{found:?}");
        assert!(found.pose.position.y.abs() < 0.006, "{found:?}");
    }

    #[test]
    fn corners_and_lone_echoes_are_no_walls() {
        let echoes = [(2.0, -0.2), (2.0, -0.1), (2.0, 0.0), (1.9, 0.0), (1.8, 0.0), (0.5, 0.5)];
        let echoes = echoes.map(|(x, y)| Vec2::new(x, y));
        assert_eq!(wall_points(&echoes, DVec2::ZERO), []);
        let straight: Vec<Vec2> = (-3..=3).map(|i| Vec2::new(2.0, 0.1 * i as f32)).collect();
        let found = wall_points(&straight, DVec2::ZERO);
        assert_eq!(found.len(), 3);
        assert!(found.iter().all(|wall| wall.normal.distance(-DVec2::X) < 1e-6), "{found:?}");
    }

    proptest! {
        /// Against a search from echo to echo.
        #[test]
        fn walls_are_those_of_a_plain_search(
            steps in prop::collection::vec((-0.2..0.2_f32, -0.05..0.05_f32), 0..120),
            scale in prop::sample::select(vec![0.05_f32, 0.3, 1.0, 4.0]),
        ) {
            let mut at = Vec2::new(1.0, -2.0);
            let echoes: Vec<Vec2> = steps
                .iter()
                .map(|&(x, y)| {
                    at += scale * Vec2::new(0.15 + x, y);
                    at
                })
                .collect();
            let is_gap = |a: usize, b: usize| echoes[a].distance(echoes[b]) > GAP;
            let mut plain = Vec::new();
            for (i, &echo) in echoes.iter().enumerate() {
                let is_arm = |&other: &usize| echoes[other].distance(echo) >= ARM;
                let a = (0..i).rev().take_while(|&k| !is_gap(k, k + 1)).find(is_arm);
                let b = (i + 1..echoes.len()).take_while(|&k| !is_gap(k, k - 1)).find(is_arm);
                if let (Some(a), Some(b)) = (a, b) {
                    plain.extend(on_wall(&[echoes[a]], echo, &[echoes[b]], DVec2::ZERO));
                }
            }
            prop_assert_eq!(wall_points(&echoes, DVec2::ZERO), plain);
        }

        #[test]
        fn nothing_makes_a_pose_infinite(
            points in prop::collection::vec((-50.0..50.0_f32, -50.0..50.0_f32), 0..200),
            (x, y, heading) in (-1e5..1e5_f64, -1e5..1e5_f64, -4.0..4.0_f64),
            (position, turn) in (0.0..10.0_f64, 0.0..10.0_f64),
        ) {
            let points: Vec<Vec2> = points.into_iter().map(|(x, y)| Vec2::new(x, y)).collect();
            let walls = wall_points(&points, DVec2::ZERO);
            let pose = Pose::new(x, y, heading);
            let mut map = SurfelMap::default();
            (0..4).for_each(|_| map.add(pose, &walls));
            let variance = Variance { position, heading: turn };
            let found = map.refine(pose, variance, &walls);
            prop_assert!(found.pose.position.is_finite() && found.pose.heading.is_finite());
            prop_assert!(found.near <= walls.len());
            let empty = SurfelMap::default().refine(pose, variance, &walls);
            prop_assert!(empty.pose.position.distance(pose.position) < 1e-9 && empty.near == 0);
        }
    }
}
