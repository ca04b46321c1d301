//! Sorts the parts of a world into tiles.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::platform::collections::HashMap;
use envgen::World;
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;

use crate::part::PartKind;

/// The largest number of parts of one [`Tile`](crate::Tile) entity: in a world that is spawned at once, and
/// in a streamed world, where a tile entity is the smallest step of work.
const PAGES: [usize; 2] = [512, 128];

/// The largest number of cells along the side of a block of a landscape.
const MAX_BLOCK: f64 = 64.0;

/// A square of the plane. Its side is the side of a tile at level 0, and doubles with each level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct TileKey {
    pub(crate) level: u8,
    pub(crate) at: [i32; 2],
}

/// A part by its kind and its index in the list of that kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PartRef {
    pub(crate) kind: PartKind,
    pub(crate) index: u32,
}

/// The parts of a tile in the order of their ids.
#[derive(Debug)]
pub(crate) struct TilePlan {
    /// The bounding rectangle of the parts.
    pub(crate) bounds: Rect,
    pub(crate) parts: Vec<PartRef>,
}

/// A world with its parts sorted into tiles.
///
/// A part belongs to the tile that contains its centre, at the lowest level whose side is at least as long as
/// the part. So it extends beyond its tile by at most half a side, and nearby tiles are found quickly,
/// however long some parts are.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) world: Arc<World>,
    pub(crate) tiles: BTreeMap<TileKey, TilePlan>,
    pub(crate) parts: usize,
    pub(crate) solids: usize,
    /// The number of cells along the side of a block of ground.
    pub(crate) block: u32,
    /// The largest number of parts of one tile entity.
    pub(crate) page: usize,
    /// The side of the tiles at level 0 in metres.
    pub(crate) side: f64,
    levels: u8,
}

impl Plan {
    /// Sorts the parts of a world into tiles of a given side, or of a side that suits the number of parts.
    pub(crate) fn new(world: Arc<World>, tile: Option<f64>) -> Self {
        let page = PAGES[usize::from(tile.is_some())];
        let size = world.bounds.size();
        let listed = list_lengths(&world);
        let side = tile.unwrap_or_else(|| {
            let pages = (listed as f64 / page as f64).max(1.0);
            (size.x * size.y / pages).sqrt().max(size.max_element() / 1e4)
        });
        let cell = world.raster.as_ref().map_or(1.0, |raster| raster.cell);
        let block = (side / cell).floor().clamp(1.0, MAX_BLOCK) as u32;
        let mut plan = Plan {
            tiles: BTreeMap::new(),
            parts: 0,
            solids: 0,
            block,
            page,
            side,
            levels: 0,
            world: Arc::clone(&world),
        };
        // A world of one page needs no tiles, unless it is streamed.
        let mut tiles: Vec<(TileKey, TilePlan)> = Vec::new();
        // The map is used only for lookup, never for the order of tiles.
        let mut places: HashMap<TileKey, usize> = HashMap::default();
        let whole = (tile.is_none() && listed <= page).then_some(TileKey { level: 0, at: [0, 0] });
        each_part(&world, block, &mut |part, bounds| {
            let key = whole.unwrap_or_else(|| plan.key(bounds));
            plan.levels = plan.levels.max(key.level + 1);
            plan.parts += 1;
            plan.solids += usize::from(part.kind.is_solid());
            let place = *places.entry(key).or_insert_with(|| {
                tiles.push((key, TilePlan { bounds, parts: Vec::new() }));
                tiles.len() - 1
            });
            let tile = &mut tiles[place].1;
            tile.bounds = tile.bounds.union(bounds);
            tile.parts.push(part);
        });
        plan.tiles = tiles.into_iter().collect();
        plan
    }

    fn key(&self, bounds: Rect) -> TileKey {
        let longest = bounds.size().max_element();
        let (mut level, mut side) = (0, self.side);
        while side < longest && level < 60 {
            level += 1;
            side *= 2.0;
        }
        TileKey { level, at: cell(bounds.center(), side) }
    }

    /// Returns the tiles whose parts are within `radius` of a point, each with the distance to the bounding
    /// rectangle of its parts.
    pub(crate) fn near(&self, p: DVec2, radius: f64) -> Vec<(f64, TileKey)> {
        let mut found = Vec::new();
        if !p.is_finite() {
            return found;
        }
        let mut visit = |key: &TileKey, tile: &TilePlan| {
            let distance = distance(tile.bounds, p);
            if distance <= radius {
                found.push((distance, *key));
            }
        };
        let mut side = self.side;
        let reach = |side: f64| DVec2::splat(radius + 0.5 * side);
        let columns = |side: f64| (2.0 * reach(side).x / side + 2.0).min(1e6);
        let cells: f64 = (0..self.levels)
            .map(|level| columns(self.side * f64::from(level).exp2()).powi(2))
            .sum();
        if cells > self.tiles.len() as f64 {
            self.tiles.iter().for_each(|(key, tile)| visit(key, tile));
            return found;
        }
        for level in 0..self.levels {
            let ([i0, j0], [i1, j1]) = (cell(p - reach(side), side), cell(p + reach(side), side));
            for i in i0..=i1 {
                let (first, last) =
                    (TileKey { level, at: [i, j0] }, TileKey { level, at: [i, j1] });
                self.tiles.range(first..=last).for_each(|(key, tile)| visit(key, tile));
            }
            side *= 2.0;
        }
        found
    }
}

/// Returns the distance from a point to a rectangle, which is 0 inside.
pub(crate) fn distance(rect: Rect, p: DVec2) -> f64 {
    (rect.min - p).max(p - rect.max).max(DVec2::ZERO).length()
}

/// Returns the cell of a point in a grid through the origin. Casts saturate, so points beyond the range of
/// `i32` share cells.
fn cell(p: DVec2, side: f64) -> [i32; 2] {
    let cell = (p / side).floor();
    [cell.x as i32, cell.y as i32]
}

/// Returns how much of a world there is to check and to sort: parts, points of roads and cells.
pub(crate) fn size(world: &World) -> usize {
    let points: usize = world.road_strips.iter().map(|strip| strip.centreline.len()).sum();
    let cells = world.raster.as_ref().map_or(0, |raster| raster.cells.len());
    list_lengths(world) + points + cells
}

/// Estimates the number of parts from the lengths of the lists.
fn list_lengths(world: &World) -> usize {
    let blocks = world.raster.as_ref().map_or(0, |raster| raster.cells.len() / 4096);
    world.walls.len()
        + world.trees.len()
        + world.road_strips.len()
        + world.rooms.len()
        + world.doorways.len()
        + world.obstacles.len()
        + world.surfaces.len()
        + world.victims.len()
        + blocks
}

/// Returns the first row and column of the block with a given index of a landscape, and its numbers of rows
/// and columns.
pub(crate) fn block_cells(rows: u32, cols: u32, block: u32, index: u32) -> [u32; 4] {
    let across = cols.div_ceil(block).max(1);
    let (row, col) = (index / across * block, index % across * block);
    [row, col, block.min(rows.saturating_sub(row)), block.min(cols.saturating_sub(col))]
}

/// Visits every part with its bounding rectangle, in the order of the ids.
fn each_part(world: &World, block: u32, visit: &mut dyn FnMut(PartRef, Rect)) {
    let mut list = |kind: PartKind, bounds: &mut dyn Iterator<Item = Rect>| {
        for (index, bounds) in (0..).zip(bounds) {
            visit(PartRef { kind, index }, bounds);
        }
    };
    let at = |pose: &Pose| Rect::new(pose.position, pose.position);
    let disc = |center, radius| Shape::Disc { center, radius }.bounds();
    list(PartKind::Wall, &mut world.walls.iter().map(|wall| wall.shape.bounds()));
    list(PartKind::Tree, &mut world.trees.iter().map(|tree| disc(tree.center, tree.radius)));
    list(
        PartKind::RoadStrip,
        &mut world.road_strips.iter().map(|strip| strip.bounds().unwrap_or(world.bounds)),
    );
    list(PartKind::Room, &mut world.rooms.iter().map(|room| room.shape.bounds()));
    list(PartKind::Doorway, &mut world.doorways.iter().map(|door| door.shape.bounds()));
    list(PartKind::Obstacle, &mut world.obstacles.iter().map(|obstacle| obstacle.shape.bounds()));
    list(PartKind::Surface, &mut world.surfaces.iter().map(|surface| surface.shape.bounds()));
    list(PartKind::Start, &mut world.start.iter().map(at));
    list(PartKind::Goal, &mut world.goal.iter().map(at));
    list(PartKind::Victim, &mut world.victims.iter().map(at));
    if let Some(raster) = &world.raster {
        let blocks = raster.rows.div_ceil(block) * raster.cols.div_ceil(block);
        let bounds = |index| {
            let [row, col, rows, cols] = block_cells(raster.rows, raster.cols, block, index);
            let low = DVec2::new(f64::from(col), f64::from(raster.rows - row - rows));
            let size = DVec2::new(f64::from(cols), f64::from(rows));
            let min = raster.origin + low * raster.cell;
            Rect::new(min, min + size * raster.cell)
        };
        list(PartKind::Ground, &mut (0..blocks).map(bounds));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use envgen::{Blueprint, Seed, Spec, WorldKind};
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn world(kind: WorldKind, seed: u64) -> Arc<World> {
        Arc::new(kind.default_spec().generate(Seed(seed)).unwrap().to_world())
    }

    fn parts(plan: &Plan) -> usize {
        plan.tiles.values().map(|tile| tile.parts.len()).sum()
    }

    #[test]
    fn cells_and_points_of_roads_are_work() {
        let landscape = world(WorldKind::Landscape, 1);
        let cells = landscape.raster.as_ref().unwrap().cells.len();
        let road = world(WorldKind::Road, 1);
        let points = road.road_strips.iter().map(|strip| strip.centreline.len()).sum();
        for (world, least) in [(landscape, cells), (road, points)] {
            assert!(size(&world) >= least && least > 100, "{} {least}", size(&world));
        }
    }

    #[test]
    fn every_part_is_in_one_tile_that_reaches_around_it() {
        for &kind in WorldKind::ALL {
            let world = world(kind, 1);
            for tile in [None, Some(0.7), Some(8.0), Some(1e5)] {
                let plan = Plan::new(Arc::clone(&world), tile);
                assert_eq!(parts(&plan), plan.parts, "{kind}");
                let mut seen = BTreeSet::new();
                let mut around = Vec::new();
                each_part(&world, plan.block, &mut |part, bounds| around.push((part, bounds)));
                for tile in plan.tiles.values() {
                    for part in &tile.parts {
                        assert!(seen.insert((part.kind, part.index)), "{kind}: {part:?} twice");
                        let (_, bounds) = around.iter().find(|(p, _)| p == part).unwrap();
                        assert!(tile.bounds.contains_rect(*bounds));
                    }
                    let order: Vec<_> = tile.parts.iter().map(|p| (p.kind, p.index)).collect();
                    assert!(order.is_sorted());
                }
                assert_eq!(seen.len(), around.len(), "{kind}");
            }
        }
    }

    #[test]
    fn bounds_of_roads_reach_around_their_turns() {
        use envgen::road::RoadSpec;

        let spec = RoadSpec { step: 60.0, ..Default::default() };
        let world = spec.generate(Seed(3)).unwrap().to_world();
        let surface = world.road_strips[0].mesh(1e-3).vertices;
        each_part(&world, 64, &mut |part, bounds| {
            let grown = bounds.grown(1e-9);
            assert!(part.kind != PartKind::RoadStrip || surface.iter().all(|p| grown.contains(*p)));
        });
    }

    #[test]
    fn blocks_fill_a_landscape_without_overlap() {
        for (rows, cols, block) in [(1, 1, 64), (65, 130, 64), (7, 5, 3), (6, 6, 3)] {
            let blocks = u32::div_ceil(rows, block) * u32::div_ceil(cols, block);
            let mut count = vec![0; (rows * cols) as usize];
            for index in 0..blocks {
                let [row, col, height, width] = block_cells(rows, cols, block, index);
                assert!(height > 0 && width > 0);
                for r in row..row + height {
                    for c in col..col + width {
                        count[(r * cols + c) as usize] += 1;
                    }
                }
            }
            assert!(count.iter().all(|&n| n == 1), "{rows} {cols} {block}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn near_finds_what_a_search_of_all_tiles_finds(
            x in -60.0..60.0_f64, y in -60.0..60.0_f64, radius in 0.0..60.0_f64,
            tile in 0.3..40.0_f64,
        ) {
            static WORLD: std::sync::OnceLock<Arc<World>> = std::sync::OnceLock::new();
            let world = WORLD.get_or_init(|| world(WorldKind::Road, 3));
            let plan = Plan::new(Arc::clone(world), Some(tile));
            let p = world.bounds.center() + DVec2::new(x, y);
            let mut found: Vec<_> = plan.near(p, radius).into_iter().map(|(_, key)| key).collect();
            found.sort();
            let all: Vec<_> = plan
                .tiles
                .iter()
                .filter(|(_, tile)| distance(tile.bounds, p) <= radius)
                .map(|(key, _)| *key)
                .collect();
            prop_assert_eq!(found, all);
        }
    }

    #[test]
    fn points_out_of_reach_find_nothing_and_do_not_panic() {
        let plan = Plan::new(world(WorldKind::Forest, 1), Some(5.0));
        for p in [DVec2::splat(1e300), DVec2::splat(-1e300), DVec2::splat(f64::NAN)] {
            assert!(plan.near(p, 10.0).is_empty());
        }
    }

    #[test]
    fn hallways_of_the_spec_are_small() {
        let spec = envgen::hallway::HallwaySpec::default();
        let plan = Plan::new(Arc::new(spec.generate(Seed(1)).unwrap().to_world()), None);
        assert_eq!(plan.tiles.len(), 1);
    }
}
