//! The mapper that all estimators share: it takes keyframes, matches each of them against all earlier
//! ones, and adds them to the map.

use envgen::geometry::{Pose, wrap_angle};
use glam::Vec2;

use super::fusion::{Drift, fuse};
use super::likelihood::LikelihoodField;
use super::matcher::{Matcher, Window};
use super::scan_insertion::{ScanInserter, is_near};
use super::surfels::{MATCHED, SurfelMap, WallPoint, wall_points};
use super::sweep::{FEWEST_ECHOES, Sweep, Sweeper};
use super::track::{PoseTrack, Variance};
use super::walls::{WALL_GAP, WallPiece, constrained, walls};
use super::wheel_calibration::{WheelCalibration, WheelScales};
use crate::lidar::{LaserProfile, Scan};
use crate::map::{Cell, CellIndex, Estimate, OccupancyMap, RESOLUTION};
use crate::odometry::Increment;
use crate::robot::Robot;

/// Levels of the field that scans are matched against.
const BLOCKS: [i32; 2] = [1, 4];

/// Standard deviation of the expected position in metres: a constant, and a term per metre of path.
const EXPECTED_POSITION: (f64, f64) = (0.03, 0.05);

/// Standard deviation of the expected heading in radians: a constant, and a term per radian of turning.
const EXPECTED_HEADING: (f64, f64) = (0.01, 0.06);

/// Greatest standard deviations that are searched, in metres and radians. They bound the work.
const WIDEST: (f64, f64) = (0.5, 0.3);

/// Mean likelihood from which a scan fits at the expected pose, and the least improvement that a pose
/// elsewhere needs. In known surroundings less than a tenth of a keyframe's walls are new.
const FITS: f64 = 0.8;
const BETTER: f64 = 0.15;

/// Mean likelihood that a match elsewhere has to reach. Up to a quarter of the echoes of something new
/// fall on known walls somewhere.
const FOUND_AGAIN: f64 = 0.3;

/// Least path length in metres to an older keyframe for a place to count as known from before.
const OLDER: f64 = 10.0;

/// Distance in metres, and difference of headings in radians, within which a keyframe sees the
/// same place as another.
const SAME_PLACE: (f64, f64) = (1.5, 1.0);

/// Conditions for a scan's pose to be right: the least number of its walls, the least fraction of those
/// near walls of the map that lie on them, and the least fraction of all its walls that do. A turned
/// scan meets other walls.
const RIGHT_WALLS: usize = 20;
const RIGHT_OF_KNOWN: f64 = 0.9;
const RIGHT_OF_ALL: f64 = 0.2;

/// Fraction of a scan's walls on the map from which no match is needed.
const CERTAIN: f64 = 0.8;

/// Echoes as near as this to the body of another robot belong to it: a distance in metres, and the most
/// that the deviation of its position adds.
const TEAMMATE: (f64, f64) = (0.1, 0.3);

/// One in this many echoes of a scan is compared with the map.
const ECHO_STEP: usize = 4;

/// A scan in the map.
#[derive(Clone, Debug)]
pub(crate) struct Keyframe {
    pub(crate) robot: usize,
    /// Whether it is its robot's first keyframe, whose pose is known.
    pub(crate) is_first: bool,
    pub(crate) pose: Pose,
    /// The robot's path length in metres when it was taken.
    pub(crate) path: f64,
    pub(crate) sweep: Sweep,
    pub(crate) variance: Variance,
}

/// The step that led to a new keyframe.
#[derive(Clone, Debug)]
pub(crate) struct Added {
    pub(crate) keyframe: usize,
    /// The robot's keyframe before; `None` for its first.
    pub(crate) before: Option<usize>,
    /// Variance of the motion since then, before scan matching.
    pub(crate) motion: Variance,
    /// The walls that hold the pose; empty without a match.
    pub(crate) walls: Vec<WallPiece>,
}

/// Robots that share one map of keyframes.
#[derive(Clone, Debug)]
pub(crate) struct Mapper {
    sweeper: Sweeper,
    /// Radius in metres of a robot.
    radius: f64,
    painter: ScanInserter,
    matcher: Matcher,
    /// The field that scans are matched against; `None` if poses come from the wheels alone.
    field: Option<LikelihoodField>,
    /// The walls that matched poses are refined against.
    surfels: SurfelMap,
    pub(crate) map: OccupancyMap,
    pub(crate) keyframes: Vec<Keyframe>,
    pub(crate) tracks: Vec<PoseTrack>,
    /// The drift of each robot's last keyframe relative to the map.
    drifts: Vec<Drift>,
    /// What is known of each robot's wheels. Without matching, nothing is.
    wheels: Vec<WheelScales>,
}

impl Mapper {
    /// Robots at their starts.
    pub(crate) fn new(
        starts: &[Pose],
        robot: &Robot,
        laser: &LaserProfile,
        matching: bool,
    ) -> Self {
        Mapper {
            sweeper: Sweeper::new(robot, laser),
            radius: robot.circumscribed_radius,
            painter: ScanInserter::new(),
            matcher: Matcher::new(),
            field: matching.then(|| LikelihoodField::new(&BLOCKS)),
            surfels: SurfelMap::default(),
            map: OccupancyMap::new(),
            keyframes: Vec::new(),
            tracks: starts.iter().copied().map(PoseTrack::new).collect(),
            drifts: vec![Drift::NONE; starts.len()],
            wheels: vec![WheelScales::new(WheelCalibration::default()); starts.len()],
        }
    }

    /// Changes which errors of the wheels are learned, from now on.
    pub(crate) fn calibrate(&mut self, calibration: WheelCalibration) {
        self.wheels.fill(WheelScales::new(calibration));
    }

    /// Processes a tick's measurements of one robot, and returns a new keyframe if there is one.
    /// Unknown robots are ignored.
    pub(crate) fn step(
        &mut self,
        robot: usize,
        odometry: Increment,
        scan: Option<&Scan>,
    ) -> Option<Added> {
        let odometry = self.wheels.get_mut(robot)?.correct(odometry);
        self.tracks[robot].advance(odometry);
        let added = scan.and_then(|scan| self.see(robot, scan));
        self.tracks[robot].record();
        added
    }

    /// Corrects a robot's pose by a scan. If the robot has driven far enough, the scan becomes a
    /// keyframe.
    fn see(&mut self, robot: usize, scan: &Scan) -> Option<Added> {
        let (is_due, matches) = (self.tracks[robot].is_keyframe_due(), self.field.is_some());
        if !is_due && !matches {
            return None;
        }
        let mut sweep = self.sweeper.sweep(scan);
        self.drop_teammates(robot, &mut sweep);
        let laser = self.sweeper.laser().position;
        let walls = if matches { wall_points(&sweep.echoes, laser) } else { Vec::new() };
        let is_certain = self.localise(robot, &walls);
        if is_due { self.add(robot, sweep, &walls, is_certain) } else { None }
    }

    /// Drops the echoes of other robots. Otherwise a robot at rest would be walled in on the map by
    /// what others see of it.
    fn drop_teammates(&self, robot: usize, sweep: &mut Sweep) {
        let others = (0..self.tracks.len()).filter(|&other| other != robot);
        let to_robot = self.estimate(robot).pose.world_to_local();
        let discs: Vec<(Vec2, f32)> = others
            .map(|other| {
                let Estimate { pose, deviation, .. } = self.estimate(other);
                let reach = self.radius + TEAMMATE.0 + deviation.min(TEAMMATE.1);
                (to_robot(pose.position).as_vec2(), reach as f32)
            })
            .collect();
        if !discs.is_empty() {
            let is_off = |echo: &Vec2| discs.iter().all(|(at, reach)| echo.distance(*at) > *reach);
            sweep.echoes.retain(is_off);
        }
    }

    /// Moves a robot's pose to where the walls that it sees lie on those of the map, if they do.
    /// Returns whether the pose is certain enough to do without a match.
    fn localise(&mut self, robot: usize, walls: &[WallPoint]) -> bool {
        let track = &mut self.tracks[robot];
        let Some(keyframe) = track.keyframe else { return false };
        let keyframe = self.keyframes[keyframe].pose;
        let expected = keyframe.compose(track.relative);
        if !is_near(expected.position) {
            return false;
        }
        let refined = self.surfels.refine(expected, track.loose(), walls);
        let (near, all) = (refined.near as f64, walls.len() as f64);
        let is_right = refined.is_settled
            && refined.near >= RIGHT_WALLS
            && near >= RIGHT_OF_KNOWN * refined.known as f64
            && near >= RIGHT_OF_ALL * all;
        if is_right {
            track.correct(keyframe.inverse().compose(refined.pose));
        }
        is_right && refined.is_held && near >= CERTAIN * all
    }

    /// The pose estimate of a robot; the origin for unknown robots.
    pub(crate) fn estimate(&self, robot: usize) -> Estimate {
        let Some(track) = self.tracks.get(robot) else { return Estimate::default() };
        let at = track.keyframe.map_or(Variance::default(), |k| self.keyframes[k].variance);
        let Variance { position, heading } =
            at.after(Variance::of_motion(track.distance, track.turned), track.distance);
        Estimate {
            pose: track.pose(|keyframe| self.keyframes[keyframe].pose),
            deviation: position.sqrt(),
            heading_deviation: heading.sqrt(),
        }
    }

    pub(crate) fn trajectory(&self, robot: usize) -> Vec<Pose> {
        let Some(track) = self.tracks.get(robot) else { return Vec::new() };
        track.poses(|keyframe| self.keyframes[keyframe].pose)
    }

    /// Moves all keyframes to new poses and draws the map again. Undoes this unless `accepts` agrees,
    /// which gets the poses before and the mapper with the new map. Returns whether the poses were
    /// accepted.
    pub(crate) fn place_if(
        &mut self,
        poses: Vec<Pose>,
        accepts: impl FnOnce(&[Pose], &Mapper) -> bool,
    ) -> bool {
        let before = self.set_poses(poses);
        let map = self.map.clone();
        self.draw_map();
        let is_accepted = accepts(&before, self);
        if is_accepted {
            self.draw_field();
        } else {
            self.set_poses(before);
            self.map = map;
        }
        is_accepted
    }

    /// Moves all keyframes, and returns their poses before.
    fn set_poses(&mut self, poses: Vec<Pose>) -> Vec<Pose> {
        let moves = self.keyframes.iter_mut().zip(poses);
        moves.map(|(keyframe, pose)| std::mem::replace(&mut keyframe.pose, pose)).collect()
    }

    /// Draws the map again from all keyframes.
    fn draw_map(&mut self) {
        self.map.clear();
        for keyframe in &self.keyframes {
            draw(&mut self.painter, &mut self.map, self.sweeper.laser(), keyframe);
        }
    }

    /// Draws the field and the surfels that scans are matched against again from all keyframes.
    fn draw_field(&mut self) {
        let Some(field) = &mut self.field else { return };
        field.clear();
        self.surfels.clear();
        for keyframe in &self.keyframes {
            let walls = wall_points(&keyframe.sweep.echoes, self.sweeper.laser().position);
            self.surfels.add(keyframe.pose, &walls);
            cover(field, &self.keyframes, keyframe.pose, keyframe.sweep.radius());
            stamp(field, keyframe.pose, &keyframe.sweep.echoes);
        }
    }

    /// The fraction of the echoes of all keyframes that lie on ground that the map shows as free. It
    /// measures how much scans contradict each other.
    pub(crate) fn contradiction(&self) -> f64 {
        let (mut free, mut all) = (0_u64, 0_u64);
        for keyframe in &self.keyframes {
            let on_map = keyframe.pose.local_to_world();
            for echo in keyframe.sweep.echoes.iter().step_by(ECHO_STEP) {
                let cell = CellIndex::of(on_map(echo.as_dvec2()));
                free += u64::from(is_open(&self.map, cell));
                all += 1;
            }
        }
        free as f64 / all.max(1) as f64
    }

    /// Adds a keyframe at the robot's pose, after its scan is matched there.
    fn add(
        &mut self,
        robot: usize,
        sweep: Sweep,
        points: &[WallPoint],
        is_certain: bool,
    ) -> Option<Added> {
        let track = &self.tracks[robot];
        let expected = track.pose(|keyframe| self.keyframes[keyframe].pose);
        let (before, distance, turned, path) =
            (track.keyframe, track.distance, track.turned, track.total);
        // Far out nothing can be drawn, and a scan without a ray has no information.
        if !is_near(expected.position) || (sweep.echoes.is_empty() && sweep.clear.is_empty()) {
            return None;
        }

        // A robot's first pose is known: nothing is matched there.
        let motion = Variance::of_motion(distance, turned);
        let (step, drift) = match before {
            Some(before) => {
                let shift = expected.position - self.keyframes[before].pose.position;
                (Drift::NONE.after(motion, shift), self.drifts[robot].after(motion, shift))
            }
            None => (Drift::NONE, Drift::NONE),
        };
        let matched = if is_certain {
            Some((expected, false))
        } else {
            let matched =
                before.and_then(|_| self.match_scan(expected, distance, turned, drift, &sweep));
            matched.map(|(pose, is_far)| {
                let refined = self.surfels.refine(pose, MATCHED, points);
                (if refined.is_settled { refined.pose } else { pose }, is_far)
            })
        };
        let (pose, walls) = match (&self.field, matched) {
            (Some(field), Some((matched, is_far))) => {
                let walls = walls(field, matched, &sweep.echoes);
                let prior = if is_far { drift } else { step };
                (fuse(&walls, expected, matched, prior), walls)
            }
            _ => (expected, Vec::new()),
        };
        self.drifts[robot] = if before.is_some() { drift.held(&walls, pose) } else { drift };
        if self.field.is_some() {
            let last = before.map_or(pose, |before| self.keyframes[before].pose);
            self.wheels[robot].keyframe(last, pose, &self.drifts[robot]);
        }
        let variance = before.map_or(Variance::default(), |before| {
            self.variance(before, distance, turned, path, pose, &walls)
        });
        if let Some(field) = &mut self.field {
            cover(field, &self.keyframes, pose, sweep.radius());
            stamp(field, pose, &sweep.echoes);
            self.surfels.add(pose, points);
        }
        let keyframe = self.keyframes.len();
        let is_first = before.is_none();
        self.keyframes.push(Keyframe { robot, is_first, pose, path, sweep, variance });
        draw(&mut self.painter, &mut self.map, self.sweeper.laser(), &self.keyframes[keyframe]);
        self.tracks[robot].restart(keyframe);
        Some(Added { keyframe, before, motion, walls })
    }

    /// Returns the pose at which a scan fits the field best, and whether that is farther off than the
    /// last step alone can explain.
    ///
    /// If walls were out of sight or parallel, more than the last step may be wrong. A scan that does
    /// not fit near the expected pose is then searched as far as the drift reaches. A match there has
    /// to fit clearly better, since a scan of new walls always fits a little better where it is pulled
    /// back over old ones.
    fn match_scan(
        &mut self,
        expected: Pose,
        distance: f64,
        turned: f64,
        drift: Drift,
        sweep: &Sweep,
    ) -> Option<(Pose, bool)> {
        let field = self.field.as_mut()?;
        if sweep.echoes.len() < FEWEST_ECHOES {
            return None;
        }
        let (position, heading) = (EXPECTED_POSITION, EXPECTED_HEADING);
        let (position, heading) =
            (position.0 + position.1 * distance, heading.0 + heading.1 * turned);
        let mut find = |position: f64, heading: f64| {
            let window = Window::around(expected, position.min(WIDEST.0), heading.min(WIDEST.1));
            let radius = Matcher::radius(sweep.radius(), &window);
            cover(field, &self.keyframes, expected, radius);
            self.matcher.find(field, &sweep.echoes, window)
        };
        let near = find(position, heading)?;
        let loose = drift.deviation() > position || drift.heading_deviation() > heading;
        if loose && near.response < FITS {
            let (position, heading) =
                (position + drift.deviation(), heading + drift.heading_deviation());
            let far = find(position, heading)?;
            if far.response >= FOUND_AGAIN && far.response > near.response + BETTER {
                return Some((far.pose, true));
            }
        }
        Some((near.pose, false))
    }

    /// The variance of a new keyframe's pose: that of the previous keyframe and the step, or that of an
    /// older keyframe that sees the same place.
    fn variance(
        &self,
        before: usize,
        distance: f64,
        turned: f64,
        path: f64,
        pose: Pose,
        walls: &[WallPiece],
    ) -> Variance {
        let motion = Variance::of_motion(distance, turned);
        let before = &self.keyframes[before];
        if walls.is_empty() {
            return before.variance.after(motion, distance);
        }
        let step = constrained(motion, walls);
        let chained = before.variance.after(step, distance);
        let sees_the_same = |other: &&Keyframe| {
            (other.robot != before.robot || path - other.path >= OLDER)
                && other.pose.position.distance(pose.position) <= SAME_PLACE.0
                && wrap_angle(other.pose.heading - pose.heading).abs() <= SAME_PLACE.1
        };
        let older = self.keyframes.iter().filter(sees_the_same).map(|other| other.variance);
        older
            .map(|variance| variance.after(step, 0.0))
            .fold(chained, |best, other| if other.position < best.position { other } else { best })
    }
}

/// Whether a cell of the map is free and none around it is occupied.
fn is_open(map: &OccupancyMap, cell: CellIndex) -> bool {
    map.cell(cell) == Cell::Free
        && (-1..=1).all(|dy| {
            (-1..=1).all(|dx| {
                let near = CellIndex { col: cell.col + dx, row: cell.row + dy };
                map.cell(near) != Cell::Occupied
            })
        })
}

/// Draws a keyframe. The first keyframe of a robot is drawn twice, since a single pass makes no cell
/// free, and a robot without any free cell would not move.
fn draw(painter: &mut ScanInserter, map: &mut OccupancyMap, laser: Pose, keyframe: &Keyframe) {
    for _ in 0..if keyframe.is_first { 2 } else { 1 } {
        painter.draw(map, keyframe.pose, laser, &keyframe.sweep);
    }
}

/// Makes a field cover a position. If stamps may be missing because the field had to be moved, all keyframes are
/// stamped again.
fn cover(field: &mut LikelihoodField, keyframes: &[Keyframe], centre: Pose, radius: f64) {
    if !field.cover(centre.position, radius) {
        for keyframe in keyframes {
            stamp(field, keyframe.pose, &keyframe.sweep.echoes);
        }
    }
}

/// Length in metres of the pieces by which a wall between two echoes is stamped.
const STAMP: f64 = RESOLUTION;

/// Stamps echoes that were measured from a pose, and the walls between them. Distant echoes alone would
/// be a row of dots, to which those of the next scan would be pulled.
pub(crate) fn stamp(field: &mut LikelihoodField, pose: Pose, echoes: &[Vec2]) {
    let on_map = pose.local_to_world();
    let place = |p: &Vec2| on_map(p.as_dvec2());
    for (i, echo) in echoes.iter().enumerate() {
        let at = place(echo);
        field.stamp(at);
        let Some(next) = echoes.get(i + 1).filter(|next| next.distance(*echo) <= WALL_GAP) else {
            continue;
        };
        let next = place(next);
        let pieces = (at.distance(next) / STAMP).ceil();
        for piece in 1..pieces as u32 {
            field.stamp(at.lerp(next, f64::from(piece) / pieces));
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use envgen::geometry::unit_vector;
    use glam::DVec2;

    /// What a robot without a turn sees of a hall of 8 x 6 m around the origin.
    pub(in crate::slam) fn hall_scan(laser: &LaserProfile, at: DVec2) -> Scan {
        let range = |beam: u32| {
            let direction = unit_vector(laser.angle(beam as usize));
            let walls = DVec2::new(4.0, 3.0).copysign(direction);
            ((walls - at) / direction).min_element()
        };
        Scan { ranges: (0..laser.beams).map(range).collect() }
    }

    #[test]
    fn robots_do_not_wall_each_other_in() {
        let (robot, laser) = (Robot::default(), LaserProfile::LMS200_MM);
        let stands = Pose::new(2.9, 0.8, 0.0);
        let mut mapper = Mapper::new(&[Pose::default(), stands], &robot, &laser, true);
        for tick in 0..15 {
            let distance = if tick == 0 { 0.0 } else { 0.1 };
            let at = DVec2::new(0.1 * f64::from(tick) + robot.laser_offset, 0.0);
            let mut scan = hall_scan(&laser, at);
            let to = stands.position - at;
            for (beam, range) in scan.ranges.iter_mut().enumerate() {
                let direction = unit_vector(laser.angle(beam));
                let (along, across) = (to.dot(direction), to.perp_dot(direction));
                let half2 =
                    robot.circumscribed_radius * robot.circumscribed_radius - across * across;
                if half2 > 0.0 && along > 0.0 {
                    *range = range.min(along - half2.sqrt());
                }
            }
            mapper.step(0, Increment { distance, turn: 0.0 }, Some(&scan));
            mapper.step(1, Increment::default(), None);
        }
        let is_occupied =
            |x: f64, y: f64| mapper.map.cell(CellIndex::of(DVec2::new(x, y))) == Cell::Occupied;
        assert!(is_occupied(4.01, -0.5) || is_occupied(3.99, -0.5), "the wall of the hall");
        let grid = || (-16..=16).map(|step| 0.05 * f64::from(step));
        let near = |x: f64| grid().any(|y| is_occupied(2.9 + x, 0.8 + y));
        assert!(!grid().any(near), "something around the other robot");
    }

    #[test]
    fn poses_that_are_not_accepted_leave_no_trace() {
        let (robot, laser) = (Robot::default(), LaserProfile::LMS200_MM);
        let mut mapper = Mapper::new(&[Pose::default()], &robot, &laser, true);
        for tick in 0..20 {
            let distance = if tick == 0 { 0.0 } else { 0.1 };
            let at = DVec2::new(0.1 * f64::from(tick) + robot.laser_offset, 0.0);
            mapper.step(0, Increment { distance, turn: 0.0 }, Some(&hall_scan(&laser, at)));
        }
        let poses: Vec<Pose> = mapper.keyframes.iter().map(|keyframe| keyframe.pose).collect();
        assert!(poses.len() > 3);
        let turned = |pose: &Pose| Pose::new(pose.position.x, pose.position.y, pose.heading + 0.3);
        let others: Vec<Pose> = poses.iter().map(turned).collect();
        // Without what is zero: map and field do not shrink.
        let state = |mapper: &Mapper| {
            let poses: Vec<Pose> = mapper.keyframes.iter().map(|keyframe| keyframe.pose).collect();
            let field = mapper.field.iter().flat_map(|field| field.cells(0)).copied();
            let cells = mapper.map.tiles().flat_map(|(_, cells)| cells).copied();
            (
                poses,
                field.filter(|&cell| cell != 0).collect::<Vec<_>>(),
                cells.filter(|&cell| cell != 0).collect::<Vec<_>>(),
            )
        };
        let before = state(&mapper);
        let is_placed = mapper.place_if(others.clone(), |old, mapper| {
            assert_eq!(old, poses);
            assert_ne!(state(mapper).2, before.2, "the map shows the new poses");
            false
        });
        assert!(!is_placed && state(&mapper) == before);
        assert!(mapper.place_if(others, |_, _| true));
        let placed = state(&mapper);
        assert!(placed.0 != before.0 && placed.1 != before.1 && placed.2 != before.2);
        // And back: what is drawn is as if nothing had been.
        assert!(mapper.place_if(poses, |_, _| true) && state(&mapper) == before);
    }
}
