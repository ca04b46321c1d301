//! The shared parts against simple reference versions, and policies on input that no trial should give.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use envgen::Seed;
use envgen::geometry::{Pose, Rect, unit_vector};
use glam::{DVec2, IVec2};
use proptest::prelude::*;

use super::costmap::{CellCost, Costmap, SIDE, STEPS};
use super::frontier::Frontiers;
use super::guard::Guard;
use super::search::{GridPlanner, KeepoutZone};
use super::*;
use crate::backend::{Command, Observation};
use crate::lidar::Scan;
use crate::map::{Cell, CellIndex, Estimate, OccupancyMap, RESOLUTION};

const SPAN: i32 = 80;

/// The input of a policy that asks for one of several robots in a wide area.
pub(in crate::policy) fn input<'a>(
    robot: usize,
    estimates: &'a [Estimate],
    (map, scan): (&'a OccupancyMap, &'a Scan),
    seen: &'a Observation,
    (body, laser): (&'a Robot, &'a LaserProfile),
) -> PolicyInput<'a> {
    PolicyInput {
        robot,
        estimates,
        map,
        scan,
        since_scan: Pose::default(),
        water: &[],
        seen,
        body,
        laser,
        area: Rect::new(DVec2::splat(-100.0), DVec2::splat(100.0)),
        doors: false,
    }
}

/// A map of random boxes in a free square, and the revision of each box.
fn boxes(seed: u64, count: u32, map: &mut OccupancyMap, mut after: impl FnMut(&OccupancyMap)) {
    let mut stream = Seed(seed).stream("test/boxes", 0);
    for row in -SPAN / 2..SPAN / 2 {
        for col in -SPAN / 2..SPAN / 2 {
            map.add(CellIndex { col, row }, -200);
        }
    }
    map.touch(Rect::new(DVec2::splat(-10.0), DVec2::splat(10.0)));
    after(map);
    for _ in 0..count {
        let mut draw = |most: i32| (stream.unit() * f64::from(most)) as i32;
        let low = IVec2::new(draw(SPAN) - SPAN / 2, draw(SPAN) - SPAN / 2);
        let size = IVec2::new(1 + draw(8), 1 + draw(8));
        let odds = [400, -400, 200, -160][draw(4) as usize];
        for row in low.y..low.y + size.y {
            for col in low.x..low.x + size.x {
                map.add(CellIndex { col, row }, odds);
            }
        }
        let high = low + size;
        map.touch(Rect::new(low.as_dvec2() * RESOLUTION, high.as_dvec2() * RESOLUTION));
        after(map);
    }
}

fn every_node(mut visit: impl FnMut(IVec2, DVec2)) {
    for y in -24..24 {
        for x in -24..24 {
            let cell = IVec2::new(x, y);
            visit(cell, (cell.as_dvec2() + 0.5) * SIDE);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Deriving step by step gives the same as deriving at once.
    #[test]
    fn a_renewed_costmap_is_a_new_one(seed in 0_u64..10_000, count in 1_u32..30) {
        let (mut map, mut step_by_step) = (OccupancyMap::new(), Costmap::new(&Robot::default()));
        boxes(seed, count, &mut map, |map| {
            step_by_step.refresh(map);
            step_by_step.derive_all();
        });
        let mut at_once = Costmap::new(&Robot::default());
        at_once.refresh(&map);
        prop_assert_eq!(step_by_step.frontier_len(), at_once.frontier_len());
        let mut same = true;
        every_node(|_, p| same &= step_by_step.cell_cost_at(p) == at_once.cell_cost_at(p));
        prop_assert!(same);
        // A map that starts again leaves nothing behind.
        map.clear();
        step_by_step.refresh(&map);
        prop_assert_eq!(step_by_step.frontier_len(), 0);
        every_node(|_, p| same &= step_by_step.cell_cost_at(p) == CellCost::Unknown);
        prop_assert!(same);
    }

    /// Cell costs follow from the distances to occupied cells, for robots of every size: the
    /// margins in metres around a body that touches within its radius and half a centimetre.
    #[test]
    fn costs_are_distances(
        seed in 0_u64..10_000,
        count in 1_u32..30,
        radius in prop_oneof![Just(0.355), Just(2.0), 0.05..2.0_f64],
    ) {
        let side = radius * std::f64::consts::SQRT_2;
        let robot = Robot {
            length: side,
            width: side,
            circumscribed_radius: radius,
            max_speed: 0.5,
            laser_offset: 0.0,
            ..Robot::default()
        };
        let (mut map, mut costmap) = (OccupancyMap::new(), Costmap::new(&robot));
        boxes(seed, count, &mut map, |_| ());
        costmap.refresh(&map);
        let mut occupied = Vec::new();
        for row in -60..60 {
            for col in -60..60 {
                if map.cell(CellIndex { col, row }) == Cell::Occupied {
                    occupied.push(IVec2::new(col, row));
                }
            }
        }
        let mut wrong = None;
        every_node(|cell, p| {
            let four = [0, 1, 2, 3].map(|i| 2 * cell + IVec2::new(i & 1, i >> 1));
            let is = |at: IVec2| map.cell(CellIndex { col: at.x, row: at.y });
            // Metres between the centres of cells.
            let far = |at: IVec2| {
                let squared = occupied.iter().map(|o| (*o - at).length_squared()).min();
                squared.map_or(f64::INFINITY, |squared| f64::from(squared).sqrt() * RESOLUTION)
            };
            let free = four.into_iter().filter(|at| is(*at) == Cell::Free);
            let best = free.map(far).fold(0.0, f64::max);
            let touches = radius + 0.005 - RESOLUTION;
            let limits = [
                (radius + 0.395, CellCost::Open),
                (radius + 0.195, CellCost::Near),
                (radius + 0.095, CellCost::Close),
                (radius + 0.005, CellCost::Tight),
                (touches, CellCost::Squeeze),
            ];
            let cell_cost = limits.into_iter().find(|(far, _)| best > *far + 1e-9).map_or_else(
                || {
                    let near = |at: &IVec2| is(*at) == Cell::Free || far(*at) <= touches + 1e-9;
                    if four.iter().any(|at| is(*at) == Cell::Occupied) {
                        CellCost::Occupied
                    } else if four.iter().any(near) {
                        CellCost::Inflated
                    } else {
                        CellCost::Unknown
                    }
                },
                |(_, cell_cost)| cell_cost,
            );
            if costmap.cell_cost_at(p) != cell_cost {
                wrong = Some((p, costmap.cell_cost_at(p), cell_cost));
            }
        });
        prop_assert_eq!(wrong, None);
    }

    /// Both searches find what a simple one finds, and A* the same as Dijkstra.
    #[test]
    fn paths_are_the_cheapest(seed in 0_u64..10_000, count in 1_u32..20) {
        let (mut map, mut costmap) = (OccupancyMap::new(), Costmap::new(&Robot::default()));
        boxes(seed, count, &mut map, |_| ());
        costmap.refresh(&map);
        let mut start = None;
        every_node(|_, p| {
            if start.is_none() && costmap.cell_cost_at(p).is_passable() {
                start = Some(p);
            }
        });
        let Some(start) = start else { return Ok(()) };
        let plain = plain_costs(&mut costmap, start);
        let mut search = GridPlanner::new();
        search.nearest(&mut costmap, start, &[], |_, _| false);
        let mut found = BTreeMap::new();
        every_node(|cell, p| {
            if let Some(cost) = costmap.node_at(p).and_then(|node| search.cost(node)) {
                found.insert((cell.x, cell.y), cost);
            }
        });
        prop_assert_eq!(&found, &plain);
        for (&(x, y), &cost) in plain.iter().step_by(97) {
            let p = (IVec2::new(x, y).as_dvec2() + 0.5) * SIDE;
            let node = search.to(&mut costmap, start, &[], p);
            prop_assert_eq!(node.and_then(|node| search.cost(node)), Some(cost));
        }
    }

    /// The scan's free distance along an arc is that of a disc that is moved along it in small steps.
    #[test]
    fn arcs_end_at_the_first_touch(
        curvature in -3.0..3.0_f64,
        ranges in proptest::collection::vec(0.3..2.9_f64, 181),
    ) {
        let (robot, laser) = (Robot::default(), LaserProfile::default());
        let mut guard = Guard::new(&robot, &laser);
        guard.look(&Scan { ranges }, Pose::default());
        let curvature = if curvature.abs() < 0.05 { 0.0 } else { curvature };
        let touches = |p: DVec2| {
            guard.echoes().iter().any(|echo| echo.distance(p) < robot.circumscribed_radius)
        };
        prop_assume!(!touches(DVec2::ZERO));
        let free = guard.free_along(curvature);
        let (mut pose, mut driven) = (Pose::default(), 0.0);
        while driven < 1.0 && !touches(pose.position) {
            pose.position += unit_vector(pose.heading + 0.0005 * curvature) * 0.001;
            pose.heading += 0.001 * curvature;
            driven += 0.001;
        }
        prop_assert!((free.min(1.0) - driven).abs() < 0.02, "{free} is not {driven}");
    }
}

/// Dijkstra with a heap and a table, step costs written out.
fn plain_costs(costmap: &mut Costmap, start: DVec2) -> BTreeMap<(i32, i32), u32> {
    let first = (start / SIDE).floor().as_ivec2();
    let mut best = BTreeMap::from([((first.x, first.y), 0)]);
    let mut open = BinaryHeap::from([Reverse((0, (first.x, first.y)))]);
    while let Some(Reverse((cost, at))) = open.pop() {
        if best[&at] < cost {
            continue;
        }
        for (direction, step) in STEPS.into_iter().enumerate() {
            let next = IVec2::new(at.0, at.1) + step;
            let cell_cost = costmap.cell_cost_at((next.as_dvec2() + 0.5) * SIDE);
            let steps = match cell_cost {
                CellCost::Open => [10, 14],
                CellCost::Near => [14, 20],
                CellCost::Close => [22, 31],
                CellCost::Tight => [36, 51],
                _ => continue,
            };
            let (next, through) = ((next.x, next.y), cost + steps[direction % 2]);
            if best.get(&next).is_none_or(|&known| through < known) {
                best.insert(next, through);
                open.push(Reverse((through, next)));
            }
        }
    }
    best
}

#[test]
fn a_door_of_the_smallest_kind_stays_open() {
    // Walls at x = 0 with a gap of 0.94 m, at every place of the gap on the grid.
    for shift in 0..20 {
        let mut map = OccupancyMap::new();
        let low = f64::from(shift) * 0.0047;
        for row in -40..60 {
            for col in -40..40 {
                let cell = CellIndex { col, row };
                let y = cell.centre().y;
                let wall = (0..2).contains(&col) && (y < low || y > low + 0.94);
                map.add(cell, if wall { 200 } else { -200 });
            }
        }
        map.touch(Rect::new(DVec2::splat(-3.0), DVec2::splat(3.0)));
        let mut costmap = Costmap::new(&Robot::default());
        costmap.refresh(&map);
        let (a, b) = (DVec2::new(-1.0, 0.45), DVec2::new(1.0, 0.45));
        let mut search = GridPlanner::new();
        assert!(search.to(&mut costmap, a, &[], b).is_some(), "shifted by {low} m");
        let door = KeepoutZone { center: DVec2::new(0.05, 0.5), radius: 0.6 };
        assert!(search.to(&mut costmap, a, &[door], b).is_none(), "the door is blocked");
    }
}

/// The costs of two rooms of 3 x 6 m, with a wall without a door between them.
fn two_rooms() -> Costmap {
    let mut map = OccupancyMap::new();
    for row in -60..60 {
        for col in -60..60 {
            map.add(CellIndex { col, row }, if col == 0 { 200 } else { -200 });
        }
    }
    map.touch(Rect::new(DVec2::splat(-3.0), DVec2::splat(3.0)));
    let mut costmap = Costmap::new(&Robot::default());
    costmap.refresh(&map);
    costmap
}

#[test]
fn a_robot_that_does_not_fit_gets_out_but_not_through_walls() {
    let mut costmap = two_rooms();
    let mut search = GridPlanner::new();
    let start = DVec2::new(0.15, 0.0);
    assert_eq!(costmap.cell_cost_at(start), CellCost::Inflated);
    assert!(search.to(&mut costmap, start, &[], DVec2::new(1.0, 0.0)).is_some());
    assert!(search.to(&mut costmap, start, &[], DVec2::new(-1.0, 0.0)).is_none());
}

#[test]
fn there_is_no_path_to_what_was_not_searched() {
    let costmap = two_rooms();
    let (left, right) = (DVec2::new(-1.5, 0.0), DVec2::new(1.5, 0.0));
    let [left_node, right_node] = [left, right].map(|p| costmap.node_at(p).expect("on the map"));
    let (mut search, mut points) = (GridPlanner::new(), vec![left]);
    search.path_to(&costmap, right_node, &mut points);
    assert_eq!((points.len(), search.cost(right_node)), (0, None));
    let mut length = |search: &GridPlanner, node| {
        search.path_to(&costmap, node, &mut points);
        points.len()
    };
    let mut other = costmap.clone();
    search.nearest(&mut other, left, &[], |_, _| false);
    assert_eq!((length(&search, left_node), length(&search, right_node)), (1, 0));
    // Nor to what an earlier search visited.
    search.nearest(&mut other, right, &[], |_, _| false);
    assert_eq!((length(&search, left_node), length(&search, right_node)), (0, 1));
}

#[test]
fn searches_of_large_robots_in_occupied_cells_are_in_order() {
    let mut map = OccupancyMap::new();
    for row in -120..120 {
        for col in -120..120 {
            map.add(CellIndex { col, row }, if col * col + row * row < 50 { 200 } else { -200 });
        }
    }
    map.touch(Rect::new(DVec2::splat(-6.0), DVec2::splat(6.0)));
    let robot = Robot { length: 3.0, width: 2.6, circumscribed_radius: 2.0, ..Robot::default() };
    let mut costmap = Costmap::new(&robot);
    costmap.refresh(&map);
    let mut search = GridPlanner::new();
    let mut costs = Vec::new();
    search.nearest(&mut costmap, DVec2::ZERO, &[], |_, cost| {
        costs.push(cost);
        false
    });
    assert!(costs.is_sorted() && costs.len() > 10_000, "{} cells", costs.len());
    for goal in [DVec2::new(1.0, 0.3), DVec2::new(-4.2, 3.1), DVec2::new(0.4, -5.5)] {
        let node = costmap.node_at(goal).expect("on the map");
        search.nearest(&mut costmap, DVec2::ZERO, &[], |_, _| false);
        let cheapest = search.cost(node);
        assert_eq!(search.to(&mut costmap, DVec2::ZERO, &[], goal), Some(node));
        assert_eq!(search.cost(node), cheapest, "{goal}");
    }
}

#[test]
fn frontiers_are_where_the_unknown_is_wide() {
    let mut map = OccupancyMap::new();
    for row in 0..60 {
        for col in 0..60 {
            // A gap of two cells in the middle does not count.
            if !(30..32).contains(&col) {
                map.add(CellIndex { col, row }, -200);
            }
        }
    }
    map.touch(Rect::new(DVec2::ZERO, DVec2::splat(3.0)));
    let mut costmap = Costmap::new(&Robot::default());
    costmap.refresh(&map);
    assert!(costmap.is_frontier(CellIndex { col: 0, row: 20 }));
    assert!(costmap.is_frontier(CellIndex { col: 59, row: 20 }));
    assert!(!costmap.is_frontier(CellIndex { col: 29, row: 20 }));
    assert!(!costmap.is_frontier(CellIndex { col: 20, row: 20 }));
    let mut frontiers = Frontiers::new();
    frontiers.gather(&mut costmap, |_, _| false);
    assert_eq!(frontiers.len(), 1, "one ring");
    assert!(frontiers.cells(0).len() >= 4 * 59 - 4 && frontiers.goals() > 0);
    frontiers.gather(&mut costmap, |_, _| true);
    assert_eq!(frontiers.goals(), 0);
}

/// A corridor along x, 2 m wide and open at both ends, which is mapped up to a column.
fn draw_corridor(map: &mut OccupancyMap, end: i32) {
    map.clear();
    for row in -21..=20 {
        for col in -80..end {
            let is_wall = row == -21 || row == 20;
            map.add(CellIndex { col, row }, if is_wall { 400 } else { -400 });
        }
    }
    map.touch(Rect::new(DVec2::new(-4.0, -1.1), DVec2::new(12.0, 1.1)));
}

#[test]
fn each_robot_plans_again_when_the_map_changes() {
    let (body, laser) = (Robot::default(), LaserProfile::default());
    let mut policy = build(PolicyKind::Nearest, 2, &body, &laser);
    let mut map = OccupancyMap::new();
    draw_corridor(&mut map, 120);
    let estimates =
        [-2.0, 3.0].map(|x| Estimate { pose: Pose::new(x, 0.0, 0.0), ..Default::default() });
    let mut end_of_second = |map: &OccupancyMap, from: i32, seconds: i32| {
        for step in 10 * from..10 * (from + seconds) {
            for robot in 0..2 {
                policy.decide(&input(
                    robot,
                    &estimates,
                    (map, &Scan { ranges: vec![1.0; 181] }),
                    &Observation {
                        time: 0.1 * f64::from(step),
                        battery: 100.0,
                        ..Default::default()
                    },
                    (&body, &laser),
                ));
            }
        }
        policy.path(1).last().map(|end| end.x)
    };
    // The look around takes 10 s; stuck robots choose another goal after 5 s.
    let first = end_of_second(&map, 0, 12).expect("a path");
    assert!((4.0..6.0).contains(&first), "{first}");
    // Another robot has mapped on: the frontier is farther.
    draw_corridor(&mut map, 180);
    let second = end_of_second(&map, 12, 2).expect("a path");
    assert!((7.0..9.0).contains(&second), "{second}");
}

#[test]
fn a_robot_drives_on_past_one_that_stays() {
    let (body, laser) = (Robot::default(), LaserProfile::default());
    let mut policy = build(PolicyKind::Nearest, 2, &body, &laser);
    // A hall of 5 m between walls.
    let mut map = OccupancyMap::new();
    for row in -60..60 {
        for col in -60..200 {
            let index = CellIndex { col, row };
            let is_wall = col < -50 || !(-50..50).contains(&row);
            map.add(index, if is_wall { 200 } else { -200 });
        }
    }
    map.touch(Rect::new(DVec2::splat(-3.0), DVec2::splat(10.0)));
    // The first stays in the path of the second.
    let (first, mut second) = (Pose::new(0.5, 0.0, 0.0), Pose::new(-1.0, 0.0, 0.0));
    let (mut driven, mut waited) = (0.0, 0);
    for step in 0..600 {
        let estimates = [first, second].map(|pose| Estimate { pose, ..Default::default() });
        let decision = policy.decide(&input(
            1,
            &estimates,
            (&map, &Scan { ranges: vec![3.0; 181] }),
            &Observation { time: 0.1 * f64::from(step), battery: 100.0, ..Default::default() },
            (&body, &laser),
        ));
        let Decision::Drive(command) = decision else {
            panic!("{decision:?} in decision {step} at {second:?} after {driven} m")
        };
        waited += usize::from(command == Command::STOP);
        second.heading += 0.1 * command.turn_rate;
        second.position += 0.1 * command.speed * unit_vector(second.heading);
        driven += 0.1 * command.speed;
        if second.position.x > 4.0 {
            break;
        }
    }
    assert!(second.position.x > 4.0, "at {}, {driven} m driven", second.position);
    assert!((35..100).contains(&waited), "{waited} decisions to wait");
}

const KINDS: [PolicyKind; 6] = [
    PolicyKind::Nearest,
    PolicyKind::InfoGain,
    PolicyKind::Cautious,
    PolicyKind::WallFollow,
    PolicyKind::Corridors,
    PolicyKind::Tour,
];

/// Asks every policy for some seconds, and returns its last decisions.
fn ask(map: &OccupancyMap, estimate: Estimate, scan: &Scan, robots: usize) -> Vec<Decision> {
    let (body, laser) = (Robot::default(), LaserProfile::default());
    let estimates = vec![estimate; robots];
    KINDS
        .iter()
        .map(|&kind| {
            let mut policy = build(kind, robots, &body, &laser);
            let mut last = Decision::Finished;
            for step in 0..400 {
                let seen = Observation {
                    time: 0.1 * f64::from(step),
                    bumped: step % 3 == 0,
                    battery: 100.0,
                    ..Default::default()
                };
                for robot in 0..robots {
                    last = policy.decide(&input(
                        robot,
                        &estimates,
                        (map, scan),
                        &seen,
                        (&body, &laser),
                    ));
                    if let Decision::Drive(command) = last {
                        assert!(command.speed.is_finite() && command.turn_rate.is_finite());
                        assert!(command.speed.abs() <= body.max_speed, "{kind:?} {command:?}");
                    }
                }
            }
            assert_eq!(policy.recoveries(9), 0);
            assert!(policy.path(9).is_empty());
            last
        })
        .collect()
}

#[test]
fn nothing_panics_on_what_no_trial_gives() {
    let nan = Scan { ranges: vec![f64::NAN; 181] };
    let empty = OccupancyMap::new();
    for decision in ask(&empty, Estimate::default(), &nan, 1) {
        assert_eq!(decision, Decision::Finished, "nothing is known, nothing can be reached");
    }
    let odd = Scan { ranges: vec![0.0, -1.0, f64::INFINITY, 1e300, 0.2] };
    let lost = Pose { position: DVec2::new(f64::NAN, 1.0), heading: f64::INFINITY };
    let far = Pose::new(1e300, -1e300, 1.0);
    for pose in [lost, far, Pose::default()] {
        ask(&empty, Estimate { pose, deviation: f64::NAN, heading_deviation: -1.0 }, &odd, 2);
    }
    ask(&empty, Estimate::default(), &Scan { ranges: Vec::new() }, 1);
    // A map as large as maps get, with a tile at either end.
    let mut huge = OccupancyMap::new();
    for at in [0, 32 * 4000] {
        huge.add(CellIndex { col: at, row: at }, -400);
    }
    huge.touch(Rect::new(DVec2::ZERO, DVec2::splat(7000.0)));
    ask(&huge, Estimate::default(), &nan, 1);
}

#[test]
fn a_tour_begins_where_nearest_does_not() {
    // A hallway along x with unknown space at -3 and 9 m, and through a gap in the wall above 2 m. The nearest is the
    // gap; a path through all three begins at -3.
    let mut map = OccupancyMap::new();
    for row in -21..=20 {
        for col in -60..180 {
            let is_wall = row == -21 || (row == 20 && !(28..52).contains(&col));
            map.add(CellIndex { col, row }, if is_wall { 400 } else { -400 });
        }
    }
    map.touch(Rect::new(DVec2::new(-3.0, -1.1), DVec2::new(9.0, 1.1)));
    let (body, laser) = (Robot::default(), LaserProfile::default());
    let goal = |kind: PolicyKind| {
        let mut policy = build(kind, 1, &body, &laser);
        for step in 0..400 {
            let time = 0.1 * f64::from(step);
            policy.decide(&input(
                0,
                &[Estimate::default()],
                (&map, &Scan { ranges: vec![1.0; 181] }),
                &Observation { time, battery: 100.0, ..Default::default() },
                (&body, &laser),
            ));
            if let [first, .., last] = policy.path(0) {
                assert!(first.length() < 0.2, "{kind:?}: paths begin at the robot, not at {first}");
                return *last;
            }
        }
        panic!("{kind:?} has no path");
    };
    let (near, first) = (goal(PolicyKind::Nearest), goal(PolicyKind::Tour));
    assert!((1.0..3.0).contains(&near.x) && near.y > 0.5, "{near}");
    assert!(first.x < -2.0, "{first}");
}

#[test]
fn kinds_are_named_as_in_files() {
    let name = |kind| serde_json::to_string(&kind).expect("a name");
    assert_eq!(
        KINDS.map(name).join(" ").replace('"', ""),
        "nearest info_gain cautious wall_follow corridors tour"
    );
}
