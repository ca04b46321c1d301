//! What the mapping estimators share: keyframes, each matched against all before it and put into
//! the map.

use envgen::geometry::{Pose, unit_vector, wrap_angle};
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
#[derive(Clone, Debug)]
pub(crate) struct Added {
    pub(crate) keyframe: usize,
    /// The robot's keyframe before, none for its first.
    pub(crate) before: Option<usize>,
    /// Variance of the motion since then, before a scan was matched.
    pub(crate) motion: Variance,
    /// The walls that hold the pose, none where none was matched.
    pub(crate) walls: Vec<WallPiece>,
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
        let walls = match (&self.field, matched) {
            (Some(field), Some(pose)) => walls(field, pose, &sweep.echoes),
            _ => Vec::new(),
        };
        let variance = before.map_or(Variance::default(), |before| {
            self.variance(before, way, turned, path, pose, &walls)
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
        let motion = Variance::of_motion(way, turned);
        Some(Added { keyframe, before, motion, walls })
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
        walls: &[WallPiece],
    ) -> Variance {
        let motion = Variance::of_motion(way, turned);
        let before = &self.keyframes[before];
        if walls.is_empty() {
            return before.variance.after(motion, way);
        }
        let step = constrained(motion, walls);
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

/// Variance of the same.
pub(crate) const WALL_VARIANCE: f64 = WALL_DEVIATION * WALL_DEVIATION;

/// Longest distance in metres of neighbouring echoes that are taken for one wall.
const WALL_GAP: f32 = 0.5;

/// Least length in metres that a wall's direction is read from: ten times the noise of a range.
const WALL_LENGTH: f32 = 0.3;

/// Likelihood of an echo, in 1/255, from which it has found its wall.
const FOUND: u8 = 77;

/// A piece of wall as seen from a pose: a point and the unit normal there.
pub(crate) type WallPiece = (DVec2, DVec2);

/// The walls that a matched scan was held by: for each echo that stands where echoes stood before,
/// the wall from there to the next echo that is far enough for the noise not to matter. An echo of
/// what is new says nothing about the pose.
pub(crate) fn walls(field: &LikelihoodField, pose: Pose, echoes: &[Vec2]) -> Vec<WallPiece> {
    let heading = unit_vector(pose.heading);
    let mut end = 0;
    let mut pieces = Vec::with_capacity(echoes.len());
    for (i, &a) in echoes.iter().enumerate() {
        end = end.max(i);
        let b = loop {
            if echoes[end].distance(a) >= WALL_LENGTH {
                break Some(echoes[end]);
            }
            match echoes.get(end + 1) {
                Some(next) if next.distance(echoes[end]) <= WALL_GAP => end += 1,
                _ => break None,
            }
        };
        let Some(b) = b else { continue };
        let (a, b) = (a.as_dvec2(), b.as_dvec2());
        if field.at(pose.position + heading.rotate(a)) >= FOUND {
            pieces.push((a, (b - a).normalize().perp()));
        }
    }
    pieces
}

/// What a match leaves of a step's variance: the echoes hold the pose across the walls that they
/// stand on, not along them.
pub(crate) fn constrained(motion: Variance, walls: &[WallPiece]) -> Variance {
    let (mut xx, mut xy, mut yy, mut turn) = (0.0, 0.0, 0.0, 0.0);
    for (point, normal) in walls {
        xx += normal.x * normal.x;
        xy += normal.x * normal.y;
        yy += normal.y * normal.y;
        let lever = normal.dot(point.perp());
        turn += lever * lever;
    }
    let middle: f64 = 0.5 * (xx + yy);
    let worst = middle - (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    let left =
        |variance: f64, weight: f64| variance / (1.0 + variance * weight.max(0.0) / WALL_VARIANCE);
    Variance { position: left(motion.position, worst), heading: left(motion.heading, turn) }
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
    let heading = unit_vector(pose.heading);
    for p in echoes {
        field.stamp(pose.position + heading.rotate(p.as_dvec2()));
    }
}
