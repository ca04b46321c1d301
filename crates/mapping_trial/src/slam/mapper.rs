//! What the mapping estimators share: keyframes, each matched against all before it and put into
//! the map.

use envgen::geometry::{Pose, wrap_angle};
use glam::{DVec2, Vec2};

use super::likelihood::LikelihoodField;
use super::matcher::{Matcher, Window};
use super::painter::{Painter, is_near};
use super::sweep::{FEWEST_ECHOES, Sweep, Sweeper};
use super::track::{Track, Variance};
use crate::lidar::{LaserProfile, Scan};
use crate::map::{Estimate, OccupancyMap};
use crate::odometry::Increment;
use crate::robot::Robot;

/// Levels of the field that scans are matched against.
const BLOCKS: [i32; 2] = [1, 4];

/// Standard deviation of the expected position: metres, and metres a metre of way.
const EXPECTED_POSITION: (f64, f64) = (0.03, 0.05);

/// Standard deviation of the expected heading: radians, and radians a radian of turning.
const EXPECTED_HEADING: (f64, f64) = (0.01, 0.06);

/// Largest standard deviations that are searched for, in metres and radians: a bound of the work.
const WIDEST: (f64, f64) = (0.5, 0.3);

/// Least path in metres to an older keyframe by which a place counts as known from before.
const OLDER: f64 = 10.0;

/// Distance in metres, and difference of headings in radians, within which a keyframe sees the
/// same place as another.
const SAME_PLACE: (f64, f64) = (1.5, 1.0);

/// A scan in the map.
#[derive(Clone, Debug)]
pub(crate) struct Keyframe {
    pub(crate) robot: usize,
    /// Whether it is its robot's first, whose pose is known.
    pub(crate) is_first: bool,
    pub(crate) pose: Pose,
    /// Metres that the robot had come when it was taken.
    pub(crate) path: f64,
    pub(crate) sweep: Sweep,
    pub(crate) variance: Variance,
}

/// What is known of the step that led to a new keyframe.
#[derive(Clone, Copy, Debug)]
#[expect(dead_code, reason = "what closes loops reads it")]
pub(crate) struct Added {
    pub(crate) keyframe: usize,
    /// The robot's keyframe before, none for its first.
    pub(crate) before: Option<usize>,
    /// Way and turning since then.
    pub(crate) way: f64,
    pub(crate) turned: f64,
}

/// Robots that share one map of keyframes.
#[derive(Clone, Debug)]
pub(crate) struct Mapper {
    sweeper: Sweeper,
    painter: Painter,
    matcher: Matcher,
    /// What scans are matched against; none where poses come from the wheels alone.
    field: Option<LikelihoodField>,
    pub(crate) map: OccupancyMap,
    pub(crate) keyframes: Vec<Keyframe>,
    pub(crate) tracks: Vec<Track>,
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
            painter: Painter::new(),
            matcher: Matcher::new(),
            field: matching.then(|| LikelihoodField::new(&BLOCKS)),
            map: OccupancyMap::new(),
            keyframes: Vec::new(),
            tracks: starts.iter().copied().map(Track::new).collect(),
        }
    }

    /// Takes a tick's measurements of one robot; tells of a new keyframe. Robots that there are not
    /// are ignored.
    pub(crate) fn step(
        &mut self,
        robot: usize,
        odometry: Increment,
        scan: Option<&Scan>,
    ) -> Option<Added> {
        let track = self.tracks.get_mut(robot)?;
        track.advance(odometry);
        let added = match scan {
            Some(scan) if track.is_keyframe_due() => self.add(robot, scan),
            _ => None,
        };
        self.tracks[robot].record();
        added
    }

    /// Where a robot is thought to be; the origin for robots that there are not.
    pub(crate) fn estimate(&self, robot: usize) -> Estimate {
        let Some(track) = self.tracks.get(robot) else { return Estimate::default() };
        let at = track.keyframe.map_or(Variance::default(), |k| self.keyframes[k].variance);
        let Variance { position, heading } =
            at.after(Variance::of_motion(track.way, track.turned), track.way);
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

    /// Draws map and field again from all keyframes.
    #[expect(dead_code, reason = "for estimators that change the past")]
    pub(crate) fn redraw(&mut self) {
        self.map.clear();
        for keyframe in &self.keyframes {
            draw(&mut self.painter, &mut self.map, self.sweeper.laser(), keyframe);
        }
        if let Some(field) = &mut self.field {
            field.clear();
            for keyframe in &self.keyframes {
                cover(field, &self.keyframes, keyframe.pose, keyframe.sweep.radius());
                stamp(field, keyframe.pose, &keyframe.sweep.echoes);
            }
        }
    }

    /// Adds a keyframe where the robot is, after a scan there was matched.
    fn add(&mut self, robot: usize, scan: &Scan) -> Option<Added> {
        let sweep = self.sweeper.sweep(scan);
        let track = &self.tracks[robot];
        let expected = track.pose(|keyframe| self.keyframes[keyframe].pose);
        let (before, way, turned, path) = (track.keyframe, track.way, track.turned, track.total);
        // Far out nothing can be drawn; a scan without a ray says nothing.
        if !is_near(expected.position) || (sweep.echoes.is_empty() && sweep.clear.is_empty()) {
            return None;
        }

        // A robot's first pose is known: nothing is matched there.
        let matched = before.and_then(|_| self.match_scan(expected, way, turned, &sweep));
        let pose = matched.unwrap_or(expected);
        let variance = before.map_or(Variance::default(), |before| {
            self.variance(before, way, turned, path, pose, matched.map(|_| &sweep.echoes[..]))
        });
        if let Some(field) = &mut self.field {
            cover(field, &self.keyframes, pose, sweep.radius());
            stamp(field, pose, &sweep.echoes);
        }
        let keyframe = self.keyframes.len();
        let is_first = before.is_none();
        self.keyframes.push(Keyframe { robot, is_first, pose, path, sweep, variance });
        draw(&mut self.painter, &mut self.map, self.sweeper.laser(), &self.keyframes[keyframe]);
        self.tracks[robot].restart(keyframe);
        Some(Added { keyframe, before, way, turned })
    }

    /// The pose at which a scan fits the field best.
    fn match_scan(&mut self, expected: Pose, way: f64, turned: f64, sweep: &Sweep) -> Option<Pose> {
        let field = self.field.as_mut()?;
        if sweep.echoes.len() < FEWEST_ECHOES {
            return None;
        }
        let (position, heading) = (EXPECTED_POSITION, EXPECTED_HEADING);
        let window = Window::around(
            expected,
            (position.0 + position.1 * way).min(WIDEST.0),
            (heading.0 + heading.1 * turned).min(WIDEST.1),
        );
        let radius = Matcher::radius(sweep.radius(), &window);
        cover(field, &self.keyframes, expected, radius);
        self.matcher.find(field, &sweep.echoes, window).map(|found| found.pose)
    }

    /// How sure the pose of a new keyframe is: as sure as the one before it and the step, or as an
    /// older one that sees the same place.
    fn variance(
        &self,
        before: usize,
        way: f64,
        turned: f64,
        path: f64,
        pose: Pose,
        matched: Option<&[Vec2]>,
    ) -> Variance {
        let motion = Variance::of_motion(way, turned);
        let before = &self.keyframes[before];
        let Some(echoes) = matched else { return before.variance.after(motion, way) };
        let step = constrained(motion, echoes);
        let chained = before.variance.after(step, way);
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

/// Standard deviation in metres that an echo's distance from its wall is believed to have.
const WALL_DEVIATION: f64 = 0.1;

/// Longest distance in metres of neighbouring echoes that are taken for one wall.
const WALL_GAP: f64 = 0.5;

/// What a match leaves of a step's variance: the echoes hold the pose across the walls that they
/// stand on, not along them.
fn constrained(motion: Variance, echoes: &[Vec2]) -> Variance {
    let (mut xx, mut xy, mut yy, mut turn) = (0.0, 0.0, 0.0, 0.0);
    for pair in echoes.windows(2) {
        let (a, b) = (pair[0].as_dvec2(), pair[1].as_dvec2());
        let length = a.distance(b);
        if length > 1e-6 && length < WALL_GAP {
            let normal = (b - a).perp() / length;
            xx += normal.x * normal.x;
            xy += normal.x * normal.y;
            yy += normal.y * normal.y;
            let lever = normal.perp_dot(a);
            turn += lever * lever;
        }
    }
    let weight = 1.0 / (WALL_DEVIATION * WALL_DEVIATION);
    let middle: f64 = 0.5 * (xx + yy);
    let worst = middle - (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    let both = |variance: f64, information: f64| variance / (1.0 + variance * information.max(0.0));
    Variance {
        position: both(motion.position, weight * worst),
        heading: both(motion.heading, weight * turn),
    }
}

/// Draws a keyframe; a robot's first twice, since a single pass decides no free cell, and robots
/// that know of none stay where they are.
fn draw(painter: &mut Painter, map: &mut OccupancyMap, laser: Pose, keyframe: &Keyframe) {
    for _ in 0..if keyframe.is_first { 2 } else { 1 } {
        painter.draw(map, keyframe.pose, laser, &keyframe.sweep);
    }
}

/// Makes a field cover a place; where it has to be moved, the keyframes around are stamped again.
fn cover(field: &mut LikelihoodField, keyframes: &[Keyframe], centre: Pose, radius: f64) {
    if !field.cover(centre.position, radius) {
        for keyframe in keyframes {
            stamp(field, keyframe.pose, &keyframe.sweep.echoes);
        }
    }
}

/// Stamps echoes that were measured from a pose.
pub(crate) fn stamp(field: &mut LikelihoodField, pose: Pose, echoes: &[Vec2]) {
    let heading: DVec2 = envgen::geometry::unit_vector(pose.heading);
    for p in echoes {
        field.stamp(pose.position + heading.rotate(p.as_dvec2()));
    }
}
