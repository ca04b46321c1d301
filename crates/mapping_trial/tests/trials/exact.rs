//! Runs of policies on maps that are drawn from true poses, so that every failure is the policy's.

use std::sync::Arc;

use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Pose, Rect, unit_vector};
use envgen::occupancy::{Coverage, OccupancyGrid};
use envgen::{Seed, World};
use glam::DVec2;
use mapping_trial::backend::{Command, Condition, RobotBackend, TICK};
use mapping_trial::flat::{FlatSimulator, FlatWorld};
use mapping_trial::lidar::{LaserProfile, Scan};
use mapping_trial::map::{Cell, CellIndex, Estimate, HIT, MISS, OccupancyMap, RESOLUTION};
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::{Decision, ExplorationPolicy, PolicyInput};
use mapping_trial::robot::Robot;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Finished,
    Stuck,
    Drowned,
    Time,
}

/// The result of a run.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub(crate) end: End,
    /// Simulated time in seconds.
    pub(crate) time: f64,
    /// Fraction of the reachable free space that is free on the map.
    pub(crate) coverage: f64,
    pub(crate) collisions: u32,
    pub(crate) recoveries: u32,
    /// Distance in metres and turning in radians of all robots.
    pub(crate) metres: f64,
    pub(crate) radians: f64,
}

/// A run: the robots, the map drawn from their true poses, and what they see.
pub(crate) struct Run {
    pub(crate) robot: Robot,
    pub(crate) laser: LaserProfile,
    pub(crate) bodies: FlatSimulator,
    pub(crate) map: OccupancyMap,
    pub(crate) scans: Vec<Scan>,
    pub(crate) starts: Vec<Pose>,
    pub(crate) tracks: Vec<Vec<DVec2>>,
    /// The area to map.
    pub(crate) area: Rect,
    /// Simulated time in seconds.
    pub(crate) time: f64,
}

impl Run {
    pub(crate) fn new(world: &World, starts: &[Pose], laser: LaserProfile, seed: Seed) -> Self {
        let robot = Robot::default();
        let flat = Arc::new(FlatWorld::new(world, &robot).expect("a robot"));
        let odometry = OdometryProfile::EXACT;
        let bodies = FlatSimulator::new(flat, &robot, starts, &laser, &odometry, seed);
        Run {
            robot,
            laser,
            bodies,
            map: OccupancyMap::new(),
            scans: vec![Scan { ranges: Vec::new() }; starts.len()],
            starts: starts.to_vec(),
            tracks: vec![Vec::new(); starts.len()],
            area: world.bounds,
            time: 0.0,
        }
    }

    /// Drives until the policy has finished, is stuck, or the time is over.
    pub(crate) fn drive(&mut self, policy: &mut dyn ExplorationPolicy, seconds: f64) -> Outcome {
        let robots = self.starts.len();
        let mut commands = vec![Command::STOP; robots];
        let mut ends: Vec<Option<End>> = vec![None; robots];
        let (mut metres, mut radians) = (0.0, 0.0);
        let ticks = (seconds / TICK) as u32;
        for tick in 0..ticks {
            self.time = f64::from(tick) * TICK;
            let mut all_seen = Vec::with_capacity(robots);
            for robot in 0..robots {
                let seen = self.bodies.observe(robot);
                let pose = self.bodies.pose(robot);
                metres += seen.odometry.distance.abs();
                radians += seen.odometry.turn.abs();
                if let Some(scan) = &seen.scan {
                    draw(&mut self.map, self.robot.laser_pose(pose), &self.laser, scan);
                    self.scans[robot] = scan.clone();
                    self.tracks[robot].push(pose.position);
                }
                all_seen.push(seen);
            }
            if tick % 2 == 0 {
                let estimates: Vec<Estimate> = (0..robots)
                    .map(|robot| Estimate { pose: self.bodies.pose(robot), ..Default::default() })
                    .collect();
                for robot in 0..robots {
                    if matches!(ends[robot], Some(End::Stuck | End::Drowned)) {
                        continue;
                    }
                    let decision = policy.decide(&PolicyInput {
                        robot,
                        estimates: &estimates,
                        map: &self.map,
                        scan: &self.scans[robot],
                        since_scan: Pose::default(),
                        water: &[],
                        seen: &all_seen[robot],
                        body: &self.robot,
                        laser: &self.laser,
                        area: self.area,
                        doors: false,
                    });
                    (commands[robot], ends[robot]) = match decision {
                        Decision::Drive(command) => (command, None),
                        Decision::Finished => (Command::STOP, Some(End::Finished)),
                        Decision::Stuck | Decision::Failed => (Command::STOP, Some(End::Stuck)),
                    };
                }
                for (robot, end) in ends.iter_mut().enumerate() {
                    if self.bodies.condition(robot) == Condition::Drowned {
                        *end = Some(End::Drowned);
                    }
                }
                if ends.iter().all(Option::is_some) {
                    break;
                }
            }
            self.bodies.advance(&commands);
        }
        let end = ends.iter().copied().max_by_key(|end| match end {
            None => 3,
            Some(End::Time) => 2,
            Some(End::Drowned) => 4,
            Some(End::Stuck) => 1,
            Some(End::Finished) => 0,
        });
        Outcome {
            end: end.flatten().unwrap_or(End::Time),
            time: self.time,
            coverage: f64::NAN,
            collisions: (0..robots).map(|robot| self.bodies.collisions(robot)).sum(),
            recoveries: (0..robots).map(|robot| policy.recoveries(robot)).sum(),
            metres,
            radians,
        }
    }
}

/// Draws a scan into a map: cells along its rays are free, those at their ends occupied.
fn draw(map: &mut OccupancyMap, from: Pose, laser: &LaserProfile, scan: &Scan) {
    let mut area = Rect::new(from.position, from.position);
    for (beam, &range) in scan.ranges.iter().enumerate() {
        if range.is_nan() {
            continue;
        }
        let direction = unit_vector(from.heading + laser.angle(beam));
        let end = from.position + direction * range.min(laser.max_range);
        area = area.union(Rect::new(end, end));
        let last = CellIndex::of(end);
        cells(from.position, direction, end.distance(from.position), |cell| {
            if cell != last {
                map.add(cell, -MISS);
            }
        });
        if range < laser.max_range {
            map.add(last, HIT);
        }
    }
    map.touch(area.grown(RESOLUTION));
}

/// The cells that a ray passes (Amanatides and Woo, 1987).
fn cells(from: DVec2, direction: DVec2, length: f64, mut visit: impl FnMut(CellIndex)) {
    let mut cell = CellIndex::of(from);
    let end = CellIndex::of(from + direction * length);
    let border =
        |index: i32, way: f64| (f64::from(index) + f64::from(u8::from(way > 0.0))) * RESOLUTION;
    // A ray along an axis never crosses a border of the other one.
    let crossing = |index: i32, from: f64, way: f64| {
        if way == 0.0 { f64::INFINITY } else { (border(index, way) - from) / way }
    };
    let mut next = DVec2::new(
        crossing(cell.col, from.x, direction.x),
        crossing(cell.row, from.y, direction.y),
    );
    let step = (RESOLUTION / direction).abs();
    for _ in 0..10_000 {
        visit(cell);
        if cell == end || next.min_element() > length {
            break;
        }
        if next.x < next.y {
            cell.col += if direction.x > 0.0 { 1 } else { -1 };
            next.x += step.x;
        } else {
            cell.row += if direction.y > 0.0 { 1 } else { -1 };
            next.y += step.y;
        }
    }
}

/// Returns where a robot's footprint can get from a start: the centres of the cells of 0.1 m that it
/// covers.
pub(crate) fn reachable(world: &World, start: DVec2, robot: &Robot) -> Vec<DVec2> {
    const SIDE: f64 = 0.1;
    let Ok(grid) = OccupancyGrid::of(world, SIDE, Coverage::Centre) else { return Vec::new() };
    let near = ClearanceIndex::new(world, 1.0).expect("a reach");
    let radius = robot.circumscribed_radius + 0.005;
    let (cols, rows) = (grid.cols(), grid.rows());
    let fits = |col: usize, row: usize| near.clearance(grid.cell_centre(col, row)) >= radius;
    let mut seen = vec![false; cols * rows];
    let mut under = vec![false; cols * rows];
    let mut open: Vec<(usize, usize)> = grid.cell_at(start).into_iter().collect();
    for &(col, row) in &open {
        seen[row * cols + col] = true;
    }
    while let Some((col, row)) = open.pop() {
        let reach = 3_i64;
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (x, y) = (col as i64 + dx, row as i64 + dy);
                if (dx * dx + dy * dy) as f64 * SIDE * SIDE < 0.09
                    && (0..cols as i64).contains(&x)
                    && (0..rows as i64).contains(&y)
                {
                    under[y as usize * cols + x as usize] = true;
                }
            }
        }
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (x, y) = (col as i64 + dx, row as i64 + dy);
            if !(0..cols as i64).contains(&x) || !(0..rows as i64).contains(&y) {
                continue;
            }
            let (x, y) = (x as usize, y as usize);
            if !seen[y * cols + x] && fits(x, y) {
                seen[y * cols + x] = true;
                open.push((x, y));
            }
        }
    }
    (0..rows)
        .flat_map(|row| (0..cols).map(move |col| (col, row)))
        .filter(|&(col, row)| under[row * cols + col])
        .map(|(col, row)| grid.cell_centre(col, row))
        .collect()
}

/// Fraction of positions that are free on a map.
pub(crate) fn coverage(map: &OccupancyMap, places: &[DVec2]) -> f64 {
    let free = places.iter().filter(|&&p| map.cell(CellIndex::of(p)) == Cell::Free).count();
    free as f64 / places.len().max(1) as f64
}
