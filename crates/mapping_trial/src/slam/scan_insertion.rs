//! Insertion of scans into an occupancy map.

use envgen::geometry::Pose;
use glam::{DVec2, Vec2};

use super::sweep::{REACH, Sweep};
use crate::map::{CLAMP, HIT, MISS, OccupancyMap, RESOLUTION, TILE};

/// Greatest distance from the origin in metres at which anything is drawn.
const FARTHEST: f64 = 2e7;

/// Number of fraction bits of the fixed-point coordinates, in cells, along which rays are walked.
const FRACTION: u32 = 16;

const ONE: i32 = 1 << FRACTION;

/// Whether a point is near enough to be drawn. NaN is not.
pub(crate) fn is_near(p: DVec2) -> bool {
    p.abs().max_element() <= FARTHEST && p.is_finite()
}

/// Inserts scans into a map: each cell that contains an echo gains [`HIT`], and each other cell that a
/// ray passes loses [`MISS`], once per scan, however many rays pass it.
///
/// The rays first mark a board, which only needs stores. Then the marks are added to the map, tile by
/// tile. Memory is bounded by the reach of a ray.
#[derive(Clone, Debug, Default)]
pub struct ScanInserter {
    /// The change of each cell of the board of whole tiles, row by row; zero between scans.
    marks: Vec<i8>,
    /// Ends of rays in fixed point on the board, reused.
    ends: Vec<(i32, i32)>,
}

impl ScanInserter {
    /// Creates an inserter with an empty board.
    pub fn new() -> Self {
        ScanInserter::default()
    }

    /// Draws a scan that was taken from `pose`, with the laser at `laser` in the robot's frame, and
    /// announces the change. Nothing is drawn from poses beyond 20,000 km.
    ///
    /// ```
    /// use envgen::geometry::Pose;
    /// use envgen::glam::{DVec2, Vec2};
    /// use mapping_trial::map::{CellIndex, HIT, MISS, OccupancyMap};
    /// use mapping_trial::slam::{scan_insertion::ScanInserter, sweep::Sweep};
    ///
    /// let mut map = OccupancyMap::new();
    /// let sweep = Sweep { echoes: vec![Vec2::new(1.01, 0.01)], clear: vec![] };
    /// // From (2, 0), looking along +x, with the laser at the robot's centre.
    /// ScanInserter::new().draw(&mut map, Pose::new(2.0, 0.0, 0.0), Pose::default(), &sweep);
    /// let log_odds = |x| map.log_odds(CellIndex::of(DVec2::new(x, 0.01)));
    /// assert_eq!((log_odds(3.01), log_odds(2.5), log_odds(3.5)), (HIT, -MISS, 0));
    /// ```
    pub fn draw(&mut self, map: &mut OccupancyMap, pose: Pose, laser: Pose, sweep: &Sweep) {
        let on_map = pose.local_to_world();
        let from = on_map(laser.position);
        if !is_near(from) {
            return;
        }

        // The board has whole tiles around the laser and all ends of rays.
        let per_cell = 1.0 / RESOLUTION;
        let (mut low, mut high) = (from, from);
        let at = |p: Vec2| on_map(p.as_dvec2());
        for &p in sweep.echoes.iter().chain(&sweep.clear) {
            let p = at(p);
            (low, high) = (low.min(p), high.max(p));
        }
        // A margin of one cell, since rounding may put a ray beside its ends.
        let (reach, margin) = (DVec2::splat(2.0 * REACH), DVec2::splat(RESOLUTION));
        let (low, high) = (low.max(from - reach) - margin, high.min(from + reach) + margin);
        let tile_of = |p: DVec2| (p * (per_cell / f64::from(TILE))).floor().as_ivec2();
        let (first, last) = (tile_of(low), tile_of(high));
        let tiles = last - first + 1;
        let (width, height) = ((tiles.x * TILE) as usize, (tiles.y * TILE) as usize);
        if self.marks.len() < width * height {
            self.marks.resize(width * height, 0);
        }
        let corner = (first * TILE).as_dvec2();
        let limit = DVec2::new(width as f64, height as f64) - 1e-3;
        let fixed = |p: DVec2| {
            let on_board = (p * per_cell - corner).clamp(DVec2::ZERO, limit) * f64::from(ONE);
            (on_board.x as i32, on_board.y as i32)
        };

        self.ends.clear();
        self.ends.extend(sweep.echoes.iter().map(|&p| fixed(at(p))));
        self.ends.extend(sweep.clear.iter().map(|&p| fixed(at(p))));
        let start = fixed(from);
        for &end in &self.ends {
            walk(&mut self.marks, width, start, end);
        }
        for &(x, y) in &self.ends[..sweep.echoes.len()] {
            self.marks[(y >> FRACTION) as usize * width + (x >> FRACTION) as usize] = HIT as i8;
        }

        map.begin();
        for row in 0..tiles.y {
            for col in 0..tiles.x {
                let at = ((row * TILE) as usize) * width + (col * TILE) as usize;
                if let Some(marks) = self.marks.get_mut(at..) {
                    transfer(map, (first.x + col, first.y + row), marks, width);
                }
            }
        }
    }
}

/// Marks the cells of a ray except the one that it ends in, with one cell per step along its longer
/// axis.
fn walk(marks: &mut [i8], width: usize, start: (i32, i32), end: (i32, i32)) {
    let (dx, dy) = (end.0 - start.0, end.1 - start.1);
    let steep = dy.abs() > dx.abs();
    let (major, minor) = if steep { (start.1, start.0) } else { (start.0, start.1) };
    let (along, across) = if steep { (dy, dx) } else { (dx, dy) };
    let steps = ((major + along) >> FRACTION) - (major >> FRACTION);
    if steps == 0 {
        return;
    }
    let slope = ((i64::from(across) << FRACTION) / i64::from(along.abs())) as i32;
    // The first cell is that of the laser. Each other cell is the one where the ray crosses its middle.
    let middle = (major & !(ONE - 1)) + ONE / 2;
    let ahead = if along > 0 { middle - major } else { major - middle };
    let mut minor_at = minor + ((i64::from(slope) * i64::from(ahead)) >> FRACTION) as i32;
    let (major_pitch, minor_pitch) = if steep { (width, 1) } else { (1, width) };
    let mut base = (major >> FRACTION) as usize * major_pitch;
    marks[base + (minor >> FRACTION) as usize * minor_pitch] = -(MISS as i8);
    for _ in 1..steps.abs() {
        base = if along > 0 { base + major_pitch } else { base - major_pitch };
        minor_at += slope;
        marks[base + (minor_at >> FRACTION) as usize * minor_pitch] = -(MISS as i8);
    }
}

/// Adds a tile's marks to the map and wipes them.
fn transfer(map: &mut OccupancyMap, tile: (i32, i32), marks: &mut [i8], width: usize) {
    let side = TILE as usize;
    let any = |row: &[i8]| row.iter().fold(0, |any, &mark| any | mark) != 0;
    let mut rows = marks.chunks_mut(width).take(side).map(|row| &mut row[..side]).enumerate();
    let Some((first, row)) = rows.find(|(_, row)| any(row)) else { return };
    let Some(cells) = map.tile_mut(tile.0, tile.1) else {
        row.fill(0);
        rows.for_each(|(_, row)| row.fill(0));
        return;
    };
    add(&mut cells[first * side..][..side], row);
    for (i, row) in rows {
        add(&mut cells[i * side..][..side], row);
    }
}

fn add(cells: &mut [i16], marks: &mut [i8]) {
    for (cell, mark) in cells.iter_mut().zip(marks) {
        // Both values are far from the limits, but with a checked sum the cells would be processed one
        // at a time.
        *cell = cell.saturating_add(i16::from(*mark)).clamp(-CLAMP, CLAMP);
        *mark = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, CellIndex};
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    fn cells(map: &OccupancyMap) -> BTreeMap<(i32, i32), i16> {
        let mut all = BTreeMap::new();
        for (col, row) in map.changed_since(0) {
            for (i, &odds) in map.tile(col, row).into_iter().flatten().enumerate() {
                if odds != 0 {
                    let (x, y) = (i as i32 % TILE, i as i32 / TILE);
                    all.insert((col * TILE + x, row * TILE + y), odds);
                }
            }
        }
        all
    }

    #[test]
    fn a_ray_frees_what_it_passes_and_fills_what_it_meets() {
        let mut map = OccupancyMap::new();
        let sweep = Sweep { echoes: vec![Vec2::new(1.0, 0.0)], clear: vec![Vec2::new(0.0, 0.5)] };
        ScanInserter::new().draw(&mut map, Pose::new(0.02, 0.02, 0.0), Pose::default(), &sweep);
        let drawn = cells(&map);
        assert_eq!(drawn[&(20, 0)], HIT);
        assert!((0..20).all(|x| drawn[&(x, 0)] == -MISS), "{drawn:?}");
        assert!((0..10).all(|y| drawn[&(0, y)] == -MISS), "{drawn:?}");
        assert_eq!(drawn.len(), 30);
        assert_eq!(map.cell(CellIndex { col: 20, row: 0 }), Cell::Occupied);
        // Once more: a free cell is decided by two scans.
        assert_eq!(map.cell(CellIndex { col: 5, row: 0 }), Cell::Unknown);
        ScanInserter::new().draw(&mut map, Pose::new(0.02, 0.02, 0.0), Pose::default(), &sweep);
        assert_eq!(map.cell(CellIndex { col: 5, row: 0 }), Cell::Free);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn each_cell_changes_once_and_lies_on_a_ray(
            x in -40.0..40.0_f64, y in -40.0..40.0_f64, heading in -4.0..4.0_f64,
            offset in -0.5..0.5_f64,
            echoes in proptest::collection::vec((-9.0..9.0_f32, -9.0..9.0_f32), 0..30),
            clear in proptest::collection::vec((-9.0..9.0_f32, -9.0..9.0_f32), 0..30),
        ) {
            let points = |list: &[(f32, f32)]| list.iter().map(|&(x, y)| Vec2::new(x, y)).collect();
            let sweep = Sweep { echoes: points(&echoes), clear: points(&clear) };
            let (pose, laser) = (Pose::new(x, y, heading), Pose::new(offset, 0.0, 0.0));
            let (mut map, mut painter) = (OccupancyMap::new(), ScanInserter::new());
            painter.draw(&mut map, pose, laser, &sweep);
            prop_assert!(painter.marks.iter().all(|&mark| mark == 0));

            let at = |p: &Vec2| pose.to_world(p.as_dvec2());
            let from = pose.to_world(laser.position);
            let hits: Vec<CellIndex> = sweep.echoes.iter().map(|p| CellIndex::of(at(p))).collect();
            let drawn = cells(&map);
            for (&(col, row), &odds) in &drawn {
                let index = CellIndex { col, row };
                prop_assert!(odds == HIT || odds == -MISS, "{odds}");
                prop_assert_eq!(odds == HIT, near_any(&hits, index, &drawn));
                let rays = sweep.echoes.iter().chain(&sweep.clear);
                let nearest = rays
                    .map(|p| envgen::geometry::distance_to_segment(index.centre(), from, at(p)))
                    .fold(f64::INFINITY, f64::min);
                // Half a cell along the shorter axis, and rounding.
                prop_assert!(nearest <= 0.72 * RESOLUTION, "{nearest} m at {index:?}");
            }
            for hit in hits {
                prop_assert!(touches(&drawn, hit), "{hit:?}");
            }
        }

        #[test]
        fn any_pose_can_be_drawn_from(x in any::<f64>(), y in any::<f64>(), heading in any::<f64>()) {
            let sweep = Sweep { echoes: vec![Vec2::splat(30.0), Vec2::ZERO], clear: vec![Vec2::X] };
            let mut map = OccupancyMap::new();
            ScanInserter::new().draw(&mut map, Pose::new(x, y, heading), Pose::default(), &sweep);
            prop_assert!(cells(&map).len() < 2000);
        }
    }

    /// Whether a cell is one of those with an echo. An echo on a border may fall on either side, by the
    /// rounding of fixed point: then the neighbour is the one with the echo.
    fn near_any(hits: &[CellIndex], index: CellIndex, drawn: &BTreeMap<(i32, i32), i16>) -> bool {
        hits.contains(&index)
            || (drawn[&(index.col, index.row)] == HIT
                && hits.iter().any(|hit| {
                    (hit.col - index.col).abs() <= 1
                        && (hit.row - index.row).abs() <= 1
                        && drawn.get(&(hit.col, hit.row)) != Some(&HIT)
                }))
    }

    fn touches(drawn: &BTreeMap<(i32, i32), i16>, hit: CellIndex) -> bool {
        (-1..=1).any(|dx| (-1..=1).any(|dy| drawn.get(&(hit.col + dx, hit.row + dy)) == Some(&HIT)))
    }
}
