//! The tour of a robot without errors that always goes to the nearest unseen place.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::feature::features;
use super::information::ScanInformation;
use super::leg::{Floor, Leg};
use super::platform::Platform;
use super::poses::{Beam, Laser};
use super::search::Search;
use super::space::Space;
use crate::geometry::{Pose, wrap_angle};
use crate::grid::GridFrame;

/// Distance in metres between scans while the robot drives.
const SCAN_STEP: f64 = 1.0;

/// Turning in radians between scans while the robot looks around.
const TURN_STEP: f64 = 0.25 * PI;

/// The longest straight piece of a path in metres, which limits how far ahead the robot takes short cuts.
const LOOKAHEAD: f64 = 3.0;

/// The greatest number of scans of a tour.
pub const MAX_SCANS: usize = 20_000;

/// The definition of a dead end: a goal after which the robot turns by more than the first number, in radians, and
/// drives back over ground on which it has driven for at least the second number of metres.
const DEAD_END: (f64, f64) = (0.75 * PI, 1.0);

/// The length in metres at which the share of seen ground is recorded.
const SHORT_TOUR: f64 = 350.0;

features! {
    /// Features of the tour of a robot without errors that goes to the nearest unseen place until it has seen all
    /// ground that it can reach (the strategy of B. Yamauchi, A frontier-based approach for autonomous exploration,
    /// CIRA 1997, doi:10.1109/CIRA.1997.613851). The tour begins with a look all around; the robot drives straight
    /// pieces and turns on the spot. `None` if the tour ends before, at its limits.
    pub struct TourFeatures {
        /// Length when 80 % have been seen.
        tour_length_80_m: Option<f64>, "m";
        /// Length when 95 % have been seen.
        tour_length_95_m: Option<f64>, "m";
        /// Length when all has been seen.
        tour_length_100_m: Option<f64>, "m";
        /// Turning when 80 % have been seen.
        tour_turning_80_rad: Option<f64>, "rad";
        /// Turning when 95 % have been seen.
        tour_turning_95_rad: Option<f64>, "rad";
        /// Turning when all has been seen.
        tour_turning_100_rad: Option<f64>, "rad";
        /// Share that has been seen after 350 m.
        tour_seen_after_350_m_share: f64, "";
        /// Number of unseen places that the robot sets out for.
        tour_goals: u64, "";
        /// Number of goals after which it turns around (by over 135 degrees) onto a path that leads back, for 1 m or
        /// more, over ground that it has driven on.
        tour_dead_ends: u64, "";
        /// Mean length of these parts of paths, which it may leave before their end; none without dead end.
        tour_dead_end_depth_mean_m: Option<f64>, "m";
        /// Greatest of them.
        tour_dead_end_depth_max_m: Option<f64>, "m";
        /// Mean over the tour's metres of the ground's factor on the variances of odometry; none where the
        /// robot need not move.
        tour_odometry_noise_mean: Option<f64>, "";
        /// Mean over the tour's metres of how much too far wheels measure, as a fraction of the distance;
        /// none where the robot need not move.
        tour_wheel_bias_mean: Option<f64>, "";
    }
}

/// A scan of the tour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    pub(super) position: DVec2,
    /// The motion since the previous stop.
    pub(super) leg: Leg,
    pub(super) information: ScanInformation,
    /// Number of cells seen so far.
    pub(super) seen: usize,
}

/// A tour, with its scans.
pub(super) struct Tour {
    pub(super) stops: Vec<Stop>,
    /// Points along the tour, at most a cell apart, each with its distance from the previous point in metres.
    pub(super) points: Vec<(DVec2, f64)>,
    goals: u64,
    /// The distance in metres that the robot drives back from each dead end.
    depths: Vec<f64>,
    /// Number of cells that should be seen.
    count: usize,
}

impl Tour {
    pub(super) fn new(
        space: &Space<'_>,
        laser: &Laser<'_>,
        floor: &Floor,
        platform: &Platform,
        start: Pose,
    ) -> Self {
        let mut robot = Explorer {
            space,
            laser,
            floor,
            pose: start,
            cell: space.start,
            unseen: space.reached.clone(),
            seen_cells: 0,
            driven: vec![false; space.frame.len()],
            pending: Leg::default(),
            tour: Tour {
                stops: Vec::new(),
                points: vec![(start.position, 0.0)],
                goals: 0,
                depths: Vec::new(),
                count: space.count,
            },
        };
        robot.look_around(platform.field_of_view);
        let mut search = Search::new(space.frame.len());
        while robot.seen_cells < space.count && robot.tour.stops.len() < MAX_SCANS {
            let unseen = &robot.unseen;
            let Some(path) = search.nearest(space, robot.cell, |cell| unseen[cell]) else { break };
            robot.tour.goals += 1;
            robot.follow(&path);
        }
        robot.tour
    }

    pub(super) fn features(&self) -> TourFeatures {
        let (mut length, mut turning) = (0.0, 0.0);
        let (mut slip, mut wheel_bias) = (0.0, 0.0);
        let mut reached: [Option<(f64, f64)>; 3] = [None; 3];
        let mut short = 0;
        for stop in &self.stops {
            length += stop.leg.distance;
            turning += stop.leg.turning;
            slip += stop.leg.slip_distance;
            wheel_bias += stop.leg.wheel_bias;
            for (found, percent) in reached.iter_mut().zip([80, 95, 100]) {
                if found.is_none() && 100 * stop.seen >= percent * self.count {
                    *found = Some((length, turning));
                }
            }
            if length <= SHORT_TOUR {
                short = stop.seen;
            }
        }
        let [a, b, c] = reached;
        let depths = self.depths.len() as f64;
        let deepest = self.depths.iter().copied().reduce(f64::max);
        TourFeatures {
            tour_length_80_m: a.map(|(length, _)| length),
            tour_length_95_m: b.map(|(length, _)| length),
            tour_length_100_m: c.map(|(length, _)| length),
            tour_turning_80_rad: a.map(|(_, turning)| turning),
            tour_turning_95_rad: b.map(|(_, turning)| turning),
            tour_turning_100_rad: c.map(|(_, turning)| turning),
            tour_seen_after_350_m_share: short as f64 / self.count.max(1) as f64,
            tour_goals: self.goals,
            tour_dead_ends: self.depths.len() as u64,
            tour_dead_end_depth_mean_m: deepest.map(|_| self.depths.iter().sum::<f64>() / depths),
            tour_dead_end_depth_max_m: deepest,
            tour_odometry_noise_mean: (length > 0.0).then(|| 1.0 + slip / length),
            tour_wheel_bias_mean: (length > 0.0).then(|| wheel_bias / length),
        }
    }
}

/// A robot on its tour.
struct Explorer<'a> {
    space: &'a Space<'a>,
    laser: &'a Laser<'a>,
    floor: &'a Floor,
    pose: Pose,
    /// The free cell that is nearest to the robot.
    cell: usize,
    /// Cells that the robot reaches and has not seen.
    unseen: Vec<bool>,
    /// Number of cells that the robot reaches and has seen.
    seen_cells: usize,
    /// Cells on or beside the robot's trajectory.
    driven: Vec<bool>,
    /// The motion since the last scan.
    pending: Leg,
    tour: Tour,
}

impl Explorer<'_> {
    /// Looks all around. If the field of view is less than a full turn, the robot turns around once.
    fn look_around(&mut self, field_of_view: f64) {
        let turn = if field_of_view < TAU { TAU } else { 0.0 };
        let parts = (turn / field_of_view.min(TURN_STEP)).ceil();
        let first = self.pose.heading;
        self.drive_on(self.pose.position);
        self.scan();
        for part in 1..=parts as usize {
            self.turn_to(first + turn * (part as f64 / parts));
            self.scan();
        }
    }

    /// Drives along a path until its last cell has been seen.
    fn follow(&mut self, path: &[usize]) {
        let Some(&goal) = path.last() else { return };
        let back = self.stretch_driven(path);
        let heading_before = self.pose.heading;
        let (mut next, mut is_first) = (0, true);
        while next < path.len() && self.unseen[goal] {
            let (target, index) = self.short_cut(path, next);
            next = index + 1;
            let offset = target - self.pose.position;
            if offset == DVec2::ZERO {
                self.drive_on(target);
                continue;
            }
            let heading = libm::atan2(offset.y, offset.x);
            if std::mem::take(&mut is_first) {
                let turn = wrap_angle(heading - heading_before).abs();
                if turn > DEAD_END.0 && back >= DEAD_END.1 {
                    self.tour.depths.push(back);
                }
            }
            self.turn_to(heading);
            let parts = (offset.length() / SCAN_STEP.max(self.space.frame.cell_size)).ceil();
            let from = self.pose.position;
            for part in 1..=parts as usize {
                self.drive_on(from + offset * (part as f64 / parts));
                self.scan();
                if !self.unseen[goal] {
                    break;
                }
            }
        }
    }

    /// Returns the farthest point of a path, from point `next` on, to which a straight line leads.
    fn short_cut(&self, path: &[usize], next: usize) -> (DVec2, usize) {
        let from = self.pose.position;
        let point = |index: usize| self.space.points[path[index]];
        let mut best = next;
        let ahead = LOOKAHEAD.max(2.0 * self.space.frame.cell_size);
        for index in next + 1..path.len() {
            let p = point(index);
            if from.distance_squared(p) > ahead * ahead || !self.space.is_clear(from, p) {
                break;
            }
            best = index;
        }
        (point(best), best)
    }

    /// Returns the length in metres of the beginning of a path that lies on ground on which the robot has driven.
    fn stretch_driven(&self, path: &[usize]) -> f64 {
        let driven = path.iter().take_while(|&&cell| self.driven[cell]).count();
        let points = path[..driven].windows(2);
        points.map(|pair| self.space.points[pair[0]].distance(self.space.points[pair[1]])).sum()
    }

    fn turn_to(&mut self, heading: f64) {
        let turn = wrap_angle(heading - self.pose.heading).abs();
        self.pending.turn(self.floor, self.pose.position, turn);
        self.pose.heading = wrap_angle(heading);
    }

    /// Drives straight to a point.
    fn drive_on(&mut self, to: DVec2) {
        let from = self.pose.position;
        let length = from.distance(to);
        let parts = (length / self.space.frame.cell_size).ceil();
        for part in 1..=parts as usize {
            let p = from + (to - from) * (part as f64 / parts);
            self.tour.points.push((p, length / parts));
            self.pending.roll(self.floor, p, length / parts);
            self.mark(p);
        }
        self.mark(to);
        self.pending.distance += length;
        self.pose.position = to;
        // Its own cell may have no point of its own where only its border is free.
        self.cell = self.space.reached_near(to).unwrap_or(self.cell);
        self.see(self.cell);
    }

    /// Marks the cell of a point as seen, and the cells around it as driven on.
    fn mark(&mut self, p: DVec2) {
        let frame = self.space.frame;
        let Some((col, row)) = frame.cell_at(p) else { return };
        self.see(frame.index(col, row));
        for row in row.saturating_sub(1)..(row + 2).min(frame.rows) {
            let cells = frame.index(col.saturating_sub(1), row)
                ..=frame.index((col + 1).min(frame.cols - 1), row);
            self.driven[cells].fill(true);
        }
    }

    fn see(&mut self, cell: usize) {
        if std::mem::take(&mut self.unseen[cell]) {
            self.seen_cells += 1;
        }
    }

    fn scan(&mut self) {
        let frame = self.space.frame;
        let unseen = &mut self.unseen;
        let mut new = 0;
        let max_range = self.laser.max_range;
        let information = self.laser.scan(self.pose, |from, direction, beam| {
            let range = match beam {
                Beam::Echo(range) => range,
                Beam::Free => max_range,
                Beam::Lost => return,
            };
            for cell in cells_along(frame, from, direction, range) {
                new += usize::from(std::mem::take(&mut unseen[cell]));
            }
        });
        self.seen_cells += new;
        let leg = std::mem::take(&mut self.pending);
        let (position, seen) = (self.pose.position, self.seen_cells);
        self.tour.stops.push(Stop { position, leg, information, seen });
    }
}

/// Returns the cells that a beam sees: those that contain one of its points, which are one cell side apart,
/// beginning at the laser. Positions are whole multiples of 2^-20 of a cell, which is fast.
fn cells_along(
    frame: GridFrame,
    from: DVec2,
    direction: DVec2,
    range: f64,
) -> impl Iterator<Item = usize> {
    const UNIT: f64 = (1 << 20) as f64;
    let per_cell = 1.0 / frame.cell_size;
    let at = (from - frame.origin) * per_cell;
    // Where the beam leaves the grid.
    let size = DVec2::new(frame.cols as f64, frame.rows as f64);
    let ahead = DVec2::select(direction.cmpge(DVec2::ZERO), size - at, at);
    let leaves = (ahead / direction.abs()).min_element();
    let steps = (range * per_cell).min(leaves).max(-1.0) as i64;
    let whole = |p: DVec2| [(p.x * UNIT) as i64, (p.y * UNIT) as i64];
    let ([mut x, mut y], [dx, dy]) = (whole(at), whole(direction));
    let cols = frame.cols;
    let len = frame.len();
    (0..=steps).filter_map(move |_| {
        // Rounding may put the last point beside the grid.
        let (col, row) = ((x >> 20) as usize, (y >> 20) as usize);
        (x, y) = (x + dx, y + dy);
        let cell = row.wrapping_mul(cols).wrapping_add(col);
        (col < cols && cell < len).then_some(cell)
    })
}
