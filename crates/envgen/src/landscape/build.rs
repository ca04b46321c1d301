//! From a landscape to a world.

use glam::DVec2;

use super::blueprint::Landscape;
use super::metrics::Neighbourhood;
use crate::certificate::Claim;
use crate::generate::Spec;
use crate::geometry::{Pose, Shape};
use crate::world::{ClassRaster, Obstacle, ObstacleKind, Surface, SurfaceKind, World};

/// At most this many surfaces are listed. A landscape with more pieces lists none: its raster holds
/// the speed of every position all the same.
pub(super) const MAX_SURFACES: usize = 1 << 16;

pub(super) fn world(landscape: &Landscape) -> World {
    let raster = landscape.to_raster();
    let mut world = raster_world(raster, landscape.spec().provenance(landscape.seed()));
    if world.start.is_some() {
        world.certificate = vec![Claim::Connected { radius: 0.4 * landscape.spec().cell }];
    }
    world
}

/// The world of a raster: the raster itself; cells that cannot be passed as obstacles; slower and
/// faster classes as surfaces, unless there are more than 65 536 pieces of them; start and goal at
/// the ends of the largest connected region.
pub(crate) fn raster_world(
    raster: ClassRaster,
    provenance: crate::provenance::Provenance,
) -> World {
    let mut world = World::new(provenance, raster.frame().bounds());
    if !raster.speeds.is_empty() {
        let blocked = |class: u16| raster.speed_of(class) == 0.0;
        for outline in outlines(&raster, |class| u16::from(blocked(class))) {
            world.obstacles.push(Obstacle { kind: ObstacleKind::Other, shape: outline.1 });
        }
        let changed =
            |class: u16| if raster.speed_of(class) == 1.0 || blocked(class) { 0 } else { class };
        let pieces = outlines(&raster, changed);
        if pieces.len() <= MAX_SURFACES {
            world.surfaces.extend(pieces.into_iter().map(|(class, shape)| Surface {
                kind: SurfaceKind::Class(class),
                shape,
                speed: raster.speed_of(class),
                odometry_noise: 1.0,
            }));
        }
    }
    if let Some((start, goal)) = ends(&raster) {
        let heading = libm::atan2(goal.y - start.y, goal.x - start.x);
        world.start = Some(Pose { position: start, heading });
        world.goal = Some(Pose { position: goal, heading });
    }
    world.raster = Some(raster);
    world
}

/// A run of cells of one key in a row, and the piece that it continues.
#[derive(Clone, Copy)]
struct Run {
    key: u16,
    from: usize,
    to: usize,
    piece: usize,
    /// Runs below that touch it.
    touched: u32,
}

/// A piece of a region: one run of columns in each of consecutive rows.
struct Piece {
    key: u16,
    top: usize,
    runs: Vec<(usize, usize)>,
}

/// The cells of each key, 0 left out, as simple polygons that fill them without overlap.
///
/// A run of cells in a row is joined to the one run of the same key below it where neither touches
/// another, so that a region is divided into pieces of one run per row: these have no holes and their
/// outlines never touch themselves, whatever the region. O(N).
fn outlines(raster: &ClassRaster, key: impl Fn(u16) -> u16) -> Vec<(u16, Shape)> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut above: Vec<Run> = Vec::new();
    for (r, row) in raster.cells.chunks_exact((raster.cols as usize).max(1)).enumerate() {
        let mut runs: Vec<Run> = Vec::new();
        for (c, &class) in row.iter().enumerate() {
            let key = key(class);
            match runs.last_mut() {
                Some(run) if run.key == key && run.to == c => run.to = c + 1,
                _ if key != 0 => {
                    runs.push(Run { key, from: c, to: c + 1, piece: 0, touched: 0 });
                }
                _ => {}
            }
        }
        // Both lists are in order: one sweep finds which runs touch.
        let mut parents = vec![(0_u32, 0_usize); runs.len()];
        let (mut i, mut j) = (0, 0);
        while i < above.len() && j < runs.len() {
            if above[i].from < runs[j].to
                && runs[j].from < above[i].to
                && above[i].key == runs[j].key
            {
                above[i].touched += 1;
                parents[j] = (parents[j].0 + 1, i);
            }
            if above[i].to <= runs[j].to { i += 1 } else { j += 1 }
        }
        for (j, run) in runs.iter_mut().enumerate() {
            let (many, parent) = parents[j];
            if many == 1 && above[parent].touched == 1 {
                run.piece = above[parent].piece;
                pieces[run.piece].runs.push((run.from, run.to));
            } else {
                run.piece = pieces.len();
                pieces.push(Piece { key: run.key, top: r, runs: vec![(run.from, run.to)] });
            }
        }
        above = runs;
    }
    pieces.into_iter().map(|piece| (piece.key, outline(raster, &piece))).collect()
}

/// The outline of a piece, counter-clockwise: down its left side, up its right.
fn outline(raster: &ClassRaster, piece: &Piece) -> Shape {
    let frame = raster.frame();
    let corner = |row: usize, col: usize| frame.corner(col, frame.rows - row);
    // The corners along one side, from the piece's end at row `start`; a step to another column
    // has two.
    let side = |start: usize, columns: &mut dyn Iterator<Item = (usize, usize)>, end: usize| {
        let mut corners = Vec::new();
        let mut last = None;
        for (row, col) in columns {
            match last {
                None => corners.push(corner(start, col)),
                Some(last) if last != col => {
                    corners.extend([corner(row, last), corner(row, col)]);
                }
                Some(_) => {}
            }
            last = Some(col);
        }
        corners.extend(last.map(|last| corner(end, last)));
        corners
    };
    let (top, bottom) = (piece.top, piece.top + piece.runs.len());
    let mut left = (top..).zip(&piece.runs).map(|(row, run)| (row, run.0));
    let mut right = piece.runs.iter().enumerate().rev().map(|(k, run)| (top + k + 1, run.1));
    let mut corners = side(top, &mut left, bottom);
    corners.extend(side(bottom, &mut right, top));
    Shape::Polygon { vertices: corners }
}

/// The cells of the largest region that can be passed, cells joined by their sides; of equal
/// regions the first.
pub(crate) fn largest_region(raster: &ClassRaster) -> Vec<u32> {
    let (cols, total) = (raster.cols as usize, raster.cells.len());
    let mut open: Vec<bool> =
        raster.cells.iter().map(|&class| class != 0 && raster.speed_of(class) > 0.0).collect();
    let (mut best, mut region) = (Vec::new(), Vec::new());
    for start in 0..total {
        if !std::mem::take(&mut open[start]) {
            continue;
        }
        region.clear();
        region.push(start as u32);
        let mut next = 0;
        while let Some(&at) = region.get(next) {
            next += 1;
            for to in neighbours(at as usize, cols, total, Neighbourhood::Four) {
                if std::mem::take(&mut open[to]) {
                    region.push(to as u32);
                }
            }
        }
        if region.len() > best.len() {
            std::mem::swap(&mut best, &mut region);
        }
    }
    best
}

/// The middles of the two cells of the largest region that are nearest to the lower left and to
/// the upper right corner.
fn ends(raster: &ClassRaster) -> Option<(DVec2, DVec2)> {
    let (frame, cols) = (raster.frame(), raster.cols as usize);
    let region = largest_region(raster);
    let rise = |&at: &u32| (i64::from(at) % cols as i64 - i64::from(at) / cols as i64, at);
    let middle = |at: u32| {
        let (col, row) = frame.cell(at as usize);
        frame.center(col, frame.rows - 1 - row)
    };
    let low = region.iter().copied().min_by_key(rise)?;
    let high = region.iter().copied().max_by_key(rise)?;
    Some((middle(low), middle(high)))
}

/// The neighbours of a cell of a grid of `cells` cells, the four of its sides first.
pub(super) fn neighbours(
    at: usize,
    cols: usize,
    cells: usize,
    neighbourhood: Neighbourhood,
) -> impl Iterator<Item = usize> {
    let column = at % cols;
    let (left, right) = (column > 0, column + 1 < cols);
    let (up, down) = (at >= cols, at + cols < cells);
    let corners = neighbourhood == Neighbourhood::Eight;
    [
        (left, -1),
        (right, 1),
        (up, -(cols as isize)),
        (down, cols as isize),
        (corners && up && left, -(cols as isize) - 1),
        (corners && up && right, -(cols as isize) + 1),
        (corners && down && left, cols as isize - 1),
        (corners && down && right, cols as isize + 1),
    ]
    .into_iter()
    .filter(|step| step.0)
    .map(move |(_, step)| at.wrapping_add_signed(step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Blueprint;
    use crate::landscape::LandscapeSpec;
    use crate::provenance::Provenance;
    use crate::seed::Seed;
    use proptest::prelude::*;

    fn world_of(rows: u32, cols: u32, cells: Vec<u16>, speeds: Vec<f64>) -> World {
        let origin = DVec2::new(-3.0, 1.5);
        let raster = ClassRaster { rows, cols, cell: 0.5, origin, cells, speeds };
        raster_world(raster, Provenance::other("test", serde_json::Value::Null))
    }

    #[test]
    fn a_ring_falls_into_pieces_without_holes() {
        let cells = vec![2, 2, 2, 2, 1, 2, 2, 2, 2];
        let world = world_of(3, 3, cells, vec![0.0, 1.0, 0.0]);
        assert_eq!(world.check(), Ok(()));
        assert_eq!(world.obstacles.len(), 4);
        assert_eq!(world.start.map(|pose| pose.position), Some(DVec2::new(-2.25, 2.25)));
    }

    #[test]
    fn nothing_to_pass_leaves_no_start() {
        let world = world_of(1, 2, vec![1, 1], vec![0.0, 0.0]);
        assert_eq!((world.start, world.goal, world.obstacles.len()), (None, None, 1));
        assert_eq!(world.check(), Ok(()));
    }

    #[test]
    fn a_landscape_of_very_many_pieces_keeps_its_speeds_in_the_raster() {
        let spec = LandscapeSpec {
            rows: 600,
            cols: 600,
            classes: 2,
            entropy: 0.69,
            speeds: vec![0.5, 0.7],
            ..Default::default()
        };
        let world = spec.generate(Seed(1)).unwrap().to_world();
        assert!(world.surfaces.is_empty());
        assert!([0.5, 0.7].contains(&world.raster.unwrap().speed_at(DVec2::ONE).unwrap()));
    }

    proptest! {
        #[test]
        fn the_world_is_the_raster(rows in 1_u32..12, cols in 1_u32..12, seed: u64) {
            let mut stream = Seed(seed).stream("test", 0);
            let cells: Vec<u16> = (0..rows * cols).map(|_| stream.below(4) as u16).collect();
            let world = world_of(rows, cols, cells, vec![0.0, 1.0, 0.5, 0.0]);
            prop_assert_eq!(world.check(), Ok(()));
            let raster = world.raster.as_ref().unwrap();
            for r in 0..rows {
                for c in 0..cols {
                    let middle = DVec2::new(f64::from(c) + 0.5, f64::from(rows - r) - 0.5);
                    let p = raster.origin + middle * raster.cell;
                    let speed = raster.speed_at(p).unwrap();
                    let solids = world.obstacles.iter().filter(|o| o.shape.contains(p)).count();
                    let slow: Vec<f64> = world
                        .surfaces
                        .iter()
                        .filter(|s| s.shape.contains(p))
                        .map(|s| s.speed)
                        .collect();
                    prop_assert_eq!(solids, usize::from(speed == 0.0));
                    prop_assert_eq!(slow, if speed == 0.5 { vec![0.5] } else { vec![] });
                }
            }
        }
    }
}
