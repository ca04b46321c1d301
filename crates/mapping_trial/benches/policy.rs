//! Planning against simple methods for the same.

use std::hint::black_box;

use bench_ratio::{at_most, contest, faster};
use envgen::geometry::Rect;
use envgen::glam::{DVec2, IVec2};
use envgen::indoor::IndoorSpec;
use envgen::occupancy::{Coverage, OccupancyGrid};
use envgen::{Blueprint, Seed, Spec};
use mapping_trial::map::{CellIndex, OccupancyMap, RESOLUTION};
use mapping_trial::policy::costmap::{CellCost, Costmap, SIDE};
use mapping_trial::policy::frontier::Frontiers;
use mapping_trial::policy::search::GridPlanner;
use mapping_trial::robot::Robot;

fn main() {
    let Ok(plan) = IndoorSpec::default().generate(Seed(1)) else { return };
    let world = plan.to_world();
    let Some(start) = world.start else { return };
    let Ok(grid) = OccupancyGrid::of(&world, RESOLUTION, Coverage::Centre) else { return };
    let mut map = known(&grid, world.bounds, |_, _| true);
    renewal(&mut map, start.position);
    frontiers(&known(&grid, world.bounds, |col, row| {
        !(col / PATCH + row / PATCH).is_multiple_of(2)
    }));
    search(&map, start.position);
}

/// Cells along the sides of the patches of a map that is half known.
const PATCH: usize = 80;

/// A map on which some cells of a grid are known.
fn known(
    grid: &OccupancyGrid,
    area: Rect,
    is_known: impl Fn(usize, usize) -> bool,
) -> OccupancyMap {
    let mut map = OccupancyMap::new();
    for row in 0..grid.rows() {
        for col in (0..grid.cols()).filter(|&col| is_known(col, row)) {
            let odds = if grid.occupied(col, row) == Some(true) { 400 } else { -400 };
            map.add(CellIndex::of(grid.cell_centre(col, row)), odds);
        }
    }
    map.touch(area);
    map
}

/// A scan's worth of changes against deriving everything again.
fn renewal(map: &mut OccupancyMap, at: DVec2) {
    let mut costmap = Costmap::new(&Robot::default());
    costmap.refresh(map);
    costmap.derive_all();
    let before = map.clone();
    let mut flip = 400;
    let ours = || {
        // One cell in eight of a square of 3 m changes to and fro.
        flip = -flip;
        let cell = CellIndex::of(at);
        for row in 0..60 {
            for col in (row % 8..60).step_by(8) {
                map.add(CellIndex { col: cell.col + col, row: cell.row + row }, 2 * flip);
            }
        }
        map.touch(Rect::new(at, at + 3.0));
        costmap.refresh(map);
        costmap.derive_all();
        costmap.frontier_len()
    };
    let full = || {
        let mut costmap = Costmap::new(&Robot::default());
        costmap.refresh(&before);
        costmap.derive_all();
        costmap.frontier_len()
    };
    faster("a changed room, against the whole map again", contest(ours, full), 10.0);
}

/// The frontiers of a map that is half known, against everything else that policies derive from it.
fn frontiers(map: &OccupancyMap) {
    let mut costmap = Costmap::new(&Robot::default());
    costmap.refresh(map);
    costmap.derive_all();
    let mut frontiers = Frontiers::new();
    let gather = || {
        frontiers.gather(&mut costmap, |_, _| false);
        frontiers.goals()
    };
    let full = || {
        let mut costmap = Costmap::new(&Robot::default());
        costmap.refresh(map);
        costmap.derive_all();
        costmap.frontier_len()
    };
    let times = contest(gather, full);
    assert!(frontiers.goals() > 0, "a map that is half known has frontiers");
    at_most("frontiers gathered, against the costmap again", times, 0.5);
}

/// A* across the building, against the same by `pathfinding` on the same costs.
fn search(map: &OccupancyMap, start: DVec2) {
    let mut costmap = Costmap::new(&Robot::default());
    costmap.refresh(map);
    costmap.derive_all();
    let mut search = GridPlanner::new();
    // The reachable place that is farthest from the start.
    let mut last = None;
    search.nearest(&mut costmap, start, &[], |node, _| {
        last = Some(node);
        false
    });
    let mut points = Vec::new();
    let Some(last) = last else { return };
    search.path_to(&costmap, last, &mut points);
    let Some(&goal) = points.last() else { return };
    let mut costs = costmap.clone();
    let ours = || {
        let node = search.to(&mut costmap, start, &[], goal);
        node.and_then(|node| search.cost(node))
    };
    let cell = |p: DVec2| (p / SIDE).floor().as_ivec2();
    let (from, to) = (cell(start), cell(goal));
    let baseline = || {
        let found = pathfinding::directed::astar::astar(
            &from,
            |&at| {
                let mut next = Vec::with_capacity(8);
                for dy in -1..=1 {
                    for dx in -1..=1 {
                        let at = at + IVec2::new(dx, dy);
                        let cost = costs.cell_cost_at((at.as_dvec2() + 0.5) * SIDE);
                        let steps = match cost {
                            CellCost::Open => [10, 14],
                            CellCost::Near => [14, 20],
                            CellCost::Close => [22, 31],
                            CellCost::Tight => [36, 51],
                            _ => continue,
                        };
                        if (dx, dy) != (0, 0) {
                            next.push((at, steps[usize::from(dx != 0 && dy != 0)]));
                        }
                    }
                }
                next
            },
            |&at| {
                let way = (at - to).abs();
                let (long, short) = (way.max_element() as u32, way.min_element() as u32);
                10 * (long - short) + 14 * short
            },
            |&at| at == to,
        );
        found.map(|(_, cost)| cost)
    };
    let mut baseline = baseline;
    let mut ours = ours;
    assert_eq!(ours(), baseline(), "both find the cheapest path");
    faster(
        "A* across a building, against pathfinding",
        contest(ours, || black_box(baseline())),
        5.0,
    );
}
