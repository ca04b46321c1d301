//! Forests without borders, generated tile by tile.

use std::collections::VecDeque;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

use glam::DVec2;

use super::radius;
use super::spec::{ForestSpec, MAX_TREES};
use crate::distribution::poisson;
use crate::error::SpecError;
use crate::generate::Spec;
use crate::geometry::Rect;
use crate::seed::{Seed, Stream};
use crate::world::Tree;

/// The greatest expected number of trees of one tile, before thinning.
const MAX_TREES_A_TILE: f64 = 1e6;

/// The greatest allowed share of the intensity 1 / (pi d^2), which is the limit of thinning by marks. Near that
/// limit, thinning needs ever more trees to choose from; up to this share it needs at most 3 per remaining tree.
const MOST_OF_MATERN: f64 = 0.95;

/// Up to this number of pairs, trees are compared directly, which is faster than with a grid.
const FEW_PAIRS: usize = 4096;

/// A forest that covers the whole plane in square tiles. The trees of a tile depend only on the seed and the tile,
/// so that a window contains the same trees whatever was requested before.
///
/// It uses only `intensity`, the radii and `min_distance` of the spec; size, border, density and clearing apply to
/// rectangular forests.
///
/// - Without a least distance, the trees form a Poisson process. Counts in disjoint windows are independent Poisson
///   numbers of mean intensity x area.
/// - With a least distance d, they form Matern's second hard-core process (B. Matern, Spatial Variation, 1960). A
///   Poisson process of intensity -ln(1 - lambda pi d^2) / (pi d^2) gives every tree a mark, uniform in [0, 1); a
///   tree stays if no tree within d has a lower mark. On average this leaves exactly `intensity` trees per square
///   metre, and depends on no tree farther than d beyond a tile's border. Sequential addition, which packs more
///   tightly, has no such local rule.
///
/// ```
/// use envgen::{Seed, forest::{EndlessForest, ForestSpec}};
/// use envgen::geometry::Rect;
/// use envgen::glam::DVec2;
///
/// let forest = EndlessForest::new(&ForestSpec::default(), 20.0, Seed(1))?;
/// let far = Rect::new(DVec2::splat(1e6), DVec2::splat(1e6 + 100.0));
/// assert!(forest.window(far)?.len() > 300);
/// # Ok::<(), envgen::SpecError>(())
/// ```
#[derive(Clone, Debug)]
pub struct EndlessForest {
    spec: ForestSpec,
    tile: f64,
    seed: Seed,
    /// Number of trees per square metre before thinning.
    parents: f64,
}

/// A tree before thinning.
struct Parent {
    tree: Tree,
    mark: u64,
}

/// The trees before thinning of a tile and the eight tiles around it, row by row from the lowest.
type Around<'a> = [[&'a [Parent]; 3]; 3];

impl EndlessForest {
    /// Creates a forest in tiles with a side of `tile` metres.
    ///
    /// # Errors
    /// When a setting is not allowed; when the intensity is above the limit of thinning by marks (19 in 20 of 1 /
    /// (pi d^2)); and when a tile is narrower than the least distance or would contain more than a million trees on
    /// average.
    pub fn new(spec: &ForestSpec, tile: f64, seed: Seed) -> Result<Self, SpecError> {
        let spec = ForestSpec { width: 1.0, height: 1.0, density: None, ..spec.clone() };
        let distance = spec.min_distance;
        // The limits of the rectangle and of its crossing do not apply here.
        let border = super::Border::Open;
        ForestSpec { min_distance: 0.0, robot_radius: 0.0, border, ..spec.clone() }.validate()?;
        if !(distance >= 0.0 && distance.is_finite()) {
            let allowed = "a finite number, at least 0".to_owned();
            return Err(SpecError::new("min_distance", distance, allowed));
        }
        let disc = PI * distance * distance;
        let most = MOST_OF_MATERN / disc;
        if spec.intensity > most {
            let allowed = format!("at most {most} 1/m^2 at a min_distance of {distance} m");
            return Err(SpecError::new("intensity", spec.intensity, allowed));
        }
        let parents = if disc > 0.0 && spec.intensity * disc > 1e-12 {
            -libm::log1p(-spec.intensity * disc) / disc
        } else {
            spec.intensity
        };
        let widest = (MAX_TREES_A_TILE / parents).sqrt().min(1e5);
        if !(tile >= distance && tile > 0.0 && tile <= widest) {
            let allowed = format!("over 0 m, from {distance} m (min_distance) to {widest} m");
            return Err(SpecError::new("tile", tile, allowed));
        }
        Ok(EndlessForest { spec, tile, seed, parents })
    }

    /// Returns the side of a tile in metres.
    pub fn tile_side(&self) -> f64 {
        self.tile
    }

    /// Returns the expected number of trees of a tile. Without a least distance it is the cost of drawing the tile.
    pub fn expected_trees(&self) -> f64 {
        self.spec.intensity * self.tile * self.tile
    }

    /// Returns the rectangle of tile (`i`, `j`). Its lower left corner is (`i`, `j`) times the side of a tile.
    pub fn tile_rect(&self, i: i32, j: i32) -> Rect {
        let corner = |i: i32, j: i32| DVec2::new(f64::from(i), f64::from(j)) * self.tile;
        Rect::new(corner(i, j), corner(i, j) + DVec2::splat(self.tile))
    }

    /// Returns the trees whose centres lie in tile (`i`, `j`), always in the same order.
    pub fn tile(&self, i: i32, j: i32) -> Vec<Tree> {
        if self.spec.min_distance <= 0.0 {
            return self.parents_of(i, j).into_iter().map(|parent| parent.tree).collect();
        }
        let rows = [-1, 0, 1].map(|dj| self.row(i..=i, j.checked_add(dj)));
        self.thinned(i, j, around(rows.each_ref(), 0))
    }

    /// Returns the trees of tile (`i`, `j`) that remain after thinning.
    fn thinned(&self, i: i32, j: i32, parents: Around) -> Vec<Tree> {
        let distance = self.spec.min_distance;
        // Trees of the tiles around matter where they are near enough to this tile.
        let around = self.tile_rect(i, j).grown(distance);
        let own = parents[1][1];
        let near = |parent: &&Parent| around.contains(parent.tree.center);
        let all: Vec<&Parent> =
            parents.iter().flatten().flat_map(|tile| tile.iter()).filter(near).collect();
        let yields = |parent: &Parent, other: &Parent, offset: DVec2| {
            other.mark < parent.mark && offset.length_squared() < distance * distance
        };
        let mut trees: Vec<Tree> = Vec::with_capacity(own.len());
        if own.len() * all.len() <= FEW_PAIRS {
            let stays = |parent: &&Parent| {
                let offset = |other: &Parent| other.tree.center - parent.tree.center;
                !all.iter().any(|other| yields(parent, other, offset(other)))
            };
            trees.extend(own.iter().filter(stays).map(|parent| parent.tree));
            return trees;
        }
        let centers = all.iter().map(|parent| parent.tree.center);
        let grid = super::index::CellList::of(around, distance, false, centers);
        let stays = |parent: &&Parent| {
            let yields = |k: u32, offset| yields(parent, all[k as usize], offset);
            !grid.any(parent.tree.center, yields)
        };
        trees.extend(own.iter().filter(stays).map(|parent| parent.tree));
        trees
    }

    /// Returns the trees before thinning in row `j`, from the tile before the first to the tile after the last.
    fn row(&self, i: RangeInclusive<i32>, j: Option<i32>) -> Vec<Vec<Parent>> {
        let all = i64::from(*i.start()) - 1..=i64::from(*i.end()) + 1;
        let tile = |i: i64| match (i32::try_from(i), j) {
            (Ok(i), Some(j)) => self.parents_of(i, j),
            _ => Vec::new(),
        };
        all.map(tile).collect()
    }

    /// Returns the trees whose centres lie in a window, tile by tile, row by row from the lowest.
    ///
    /// # Errors
    /// When the window extends beyond the tiles that can be numbered, or would contain more than [`MAX_TREES`].
    pub fn window(&self, window: Rect) -> Result<Vec<Tree>, SpecError> {
        let error = |allowed: String| {
            Err(SpecError::new("window", format!("{} to {}", window.min, window.max), allowed))
        };
        if !(window.min.is_finite() && window.max.is_finite()) {
            return error("finite".to_owned());
        }
        let (low, high) = ((window.min / self.tile).floor(), (window.max / self.tile).floor());
        let most = f64::from(i32::MAX);
        if low.min_element() < -most || high.max_element() > most {
            return error(format!("within {} m of the origin", most * self.tile));
        }
        let tiles = (high - low + 1.0).max(DVec2::ZERO);
        if tiles.min_element() <= 0.0 {
            return Ok(Vec::new());
        }
        let a_tile = (self.parents * self.tile * self.tile).max(1.0);
        if tiles.x * tiles.y * a_tile > MAX_TREES {
            return error(format!("small enough for {MAX_TREES} trees and tiles"));
        }
        let inside = |tree: &Tree| {
            tree.center.cmpge(window.min).all() && tree.center.cmplt(window.max).all()
        };
        let columns = low.x as i32..=high.x as i32;
        let mut trees = Vec::new();
        // Two of the three rows that a row of tiles needs for thinning are also needed for the next.
        let mut rows: VecDeque<Vec<Vec<Parent>>> = VecDeque::new();
        for j in low.y as i32..=high.y as i32 {
            if self.spec.min_distance <= 0.0 {
                let all = columns.clone().flat_map(|i| self.tile(i, j));
                trees.extend(all.filter(inside));
                continue;
            }
            let missing = [-1, 0, 1].into_iter().skip(rows.len());
            rows.extend(missing.map(|dj| self.row(columns.clone(), j.checked_add(dj))));
            for (place, i) in columns.clone().enumerate() {
                let own = self.thinned(i, j, around([&rows[0], &rows[1], &rows[2]], place));
                trees.extend(own.into_iter().filter(inside));
            }
            rows.pop_front();
        }
        Ok(trees)
    }

    fn parents_of(&self, i: i32, j: i32) -> Vec<Parent> {
        let index = u64::from(i as u32) << 32 | u64::from(j as u32);
        let mut places = self.seed.stream("forest/tile", index);
        let mut radii = self.seed.stream("forest/tile/radii", index);
        let area = self.tile_rect(i, j);
        let count = poisson(&mut places, self.parents * self.tile * self.tile);
        let marked = self.spec.min_distance > 0.0;
        let mut parent = |places: &mut Stream| {
            let offset = DVec2::new(places.unit(), places.unit()) * self.tile;
            let mark = if marked { places.bits() } else { 0 };
            let radius = radius::draw(&self.spec, &mut radii);
            Parent { tree: self.spec.tree(area.min + offset, radius), mark }
        };
        (0..count).map(|_| parent(&mut places)).collect()
    }
}

/// Returns the nine tiles of three rows, beginning with the column `first`.
fn around(rows: [&Vec<Vec<Parent>>; 3], first: usize) -> Around<'_> {
    rows.map(|row| [0, 1, 2].map(|di| &*row[first + di]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;

    fn forest(min_distance: f64, intensity: f64, tile: f64) -> EndlessForest {
        let spec = ForestSpec { min_distance, intensity, ..Default::default() };
        EndlessForest::new(&spec, tile, Seed(9)).unwrap()
    }

    fn window(x: f64, y: f64, width: f64, height: f64) -> Rect {
        Rect::new(DVec2::new(x, y), DVec2::new(x + width, y + height))
    }

    fn sorted(mut trees: Vec<Tree>) -> Vec<Tree> {
        trees.sort_by(|a, b| {
            a.center.x.total_cmp(&b.center.x).then(a.center.y.total_cmp(&b.center.y))
        });
        trees
    }

    #[test]
    fn windows_hold_the_same_trees_however_they_are_cut() {
        for forest in [forest(0.0, 0.2, 7.0), forest(1.0, 0.2, 7.0)] {
            let whole = forest.window(window(-31.0, -8.5, 60.0, 33.0)).unwrap();
            let mut parts = Vec::new();
            for (x, y, w, h) in
                [(9.0, -8.5, 20.0, 33.0), (-31.0, 4.0, 40.0, 20.5), (-31.0, -8.5, 40.0, 12.5)]
            {
                parts.extend(forest.window(window(x, y, w, h)).unwrap());
            }
            assert!(whole.len() > 200);
            assert_eq!(sorted(whole), sorted(parts));
        }
    }

    #[test]
    fn a_window_is_its_tiles() {
        let forest = forest(1.0, 0.2, 6.0);
        let tiles = (-2..3).flat_map(|j| (-4..1).map(move |i| (i, j)));
        let trees: Vec<Tree> = tiles.flat_map(|(i, j)| forest.tile(i, j)).collect();
        assert!(trees.len() > 100);
        assert_eq!(forest.window(window(-24.0, -12.0, 30.0, 30.0)).unwrap(), trees);
    }

    #[test]
    fn counts_in_windows_are_poisson() {
        // 4000 windows of 6 x 6 m that cut tiles: variance / mean within 5 sigma of 1, where sigma
        // is sqrt(2 / 4000); mean within 5 standard errors of 7.2.
        let forest = forest(0.0, 0.2, 10.0);
        let counts: Vec<f64> = (0..4000)
            .map(|k| {
                let (x, y) = (f64::from(k % 64) * 6.0 - 190.0, f64::from(k / 64) * 6.0 - 190.0);
                forest.window(window(x, y, 6.0, 6.0)).unwrap().len() as f64
            })
            .collect();
        let mean = counts.iter().sum::<f64>() / 4000.0;
        let variance = counts.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / 3999.0;
        assert!((mean - 7.2).abs() < 5.0 * (7.2_f64 / 4000.0).sqrt(), "{mean}");
        assert!((variance / mean - 1.0).abs() < 5.0 * (2.0_f64 / 4000.0).sqrt(), "{variance}");
    }

    #[test]
    fn marks_thin_to_the_asked_intensity_and_keep_the_distance_across_tiles() {
        // Tiles of few trees and of many, which are thinned by two methods.
        for tile in [4.0, 40.0] {
            let forest = forest(1.5, 0.12, tile);
            let trees = forest.window(window(-200.0, -200.0, 400.0, 400.0)).unwrap();
            // Matern's process is more regular than Poisson's, so 5 Poisson sigmas are over 5 of its.
            let area = 160_000.0;
            let expected = 0.12 * area;
            let found = trees.len() as f64;
            assert!((found - expected).abs() < 5.0 * expected.sqrt(), "{found}");
            assert!((forest.expected_trees() * area - expected * tile * tile).abs() < 1e-6);
            let trees = sorted(trees);
            for (i, a) in trees.iter().enumerate() {
                for b in trees[i + 1..].iter().take_while(|b| b.center.x - a.center.x < 1.5) {
                    assert!(a.center.distance(b.center) >= 1.5);
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let new = |min_distance, intensity, tile| {
            let spec = ForestSpec { min_distance, intensity, ..Default::default() };
            EndlessForest::new(&spec, tile, Seed(0)).map(|_| ()).unwrap_err().field
        };
        assert_eq!(new(2.0, 0.1, 10.0), "intensity");
        assert_eq!(new(2.0, 0.01, 1.0), "tile");
        assert_eq!(new(0.0, 0.01, f64::NAN), "tile");
        assert_eq!(new(0.0, 0.01, 1e9), "tile");
        assert_eq!(new(f64::NAN, 0.01, 10.0), "min_distance");
        let forest = forest(0.0, 1.0, 10.0);
        assert!(forest.window(window(0.0, 0.0, 1e9, 1e9)).is_err());
        assert!(forest.window(window(1e15, 0.0, 1.0, 1.0)).is_err());
        assert!(forest.window(window(0.0, 0.0, 0.0, 1e10)).is_err());
        assert!(forest.window(window(f64::NAN, 0.0, 1.0, 1.0)).is_err());
        let reversed = Rect { min: DVec2::new(30.0, -1e10), max: DVec2::new(-30.0, 1e10) };
        assert_eq!(forest.window(reversed), Ok(Vec::new()));
    }

    #[test]
    fn the_robot_does_not_matter() {
        let spec = ForestSpec { robot_radius: 30.0, ..Default::default() };
        assert!(EndlessForest::new(&spec, 10.0, Seed(1)).is_ok());
    }

    #[test]
    fn trees_stand_in_their_tile() {
        let forest = forest(0.0, 0.5, 3.0);
        for (i, j) in [(0, 0), (-4, 7), (i32::MIN, i32::MAX)] {
            let tile = Shape::from_rect(forest.tile_rect(i, j).grown(1e-6));
            assert!(forest.tile(i, j).iter().all(|tree| tile.contains(tree.center)));
        }
    }
}
