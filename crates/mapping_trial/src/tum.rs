//! Trajectories as text, in the format of the RGB-D benchmark of TU Munich (Sturm et al., A benchmark
//! for the evaluation of RGB-D SLAM systems, IROS 2012, <https://doi.org/10.1109/IROS.2012.6385773>).
//! SLAM programs write this format, and `evo` reads it.
//!
//! A line is `t x y z qx qy qz qw`: seconds, metres and a unit quaternion. Lines that begin with `#`
//! are comments.

use std::io::{self, Write};

use envgen::geometry::{Pose, wrap_angle};
use glam::DVec2;
use thiserror::Error;

/// The greatest coordinate that is read, in metres, and the greatest time, in seconds. Unix times of
/// this era fit; those in nanoseconds do not.
const MOST: f64 = 1e11;

/// The greatest number of poses that are read: a day at 100 per second.
pub const MAX_POSES: usize = 100 * 24 * 60 * 60;

/// An error in a text that should be a trajectory.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TumError {
    /// A line does not have eight numbers.
    #[error("line {line} must be `t x y z qx qy qz qw`, eight numbers, got `{text}`")]
    Line {
        /// The line's number, from 1.
        line: usize,
        /// The beginning of the line.
        text: String,
    },
    /// A number is not finite or too large.
    #[error("line {line}: every number must be from -{MOST:e} to {MOST:e}, got {value}")]
    Number {
        /// The line's number, from 1.
        line: usize,
        /// The number.
        value: f64,
    },
    /// A time is not one of this era in seconds.
    #[error("line {line}: the time must be in seconds, from -{MOST:e} to {MOST:e}, got {value}")]
    Time {
        /// The line's number, from 1.
        line: usize,
        /// The time.
        value: f64,
    },
    /// A quaternion is zero.
    #[error("line {line}: the quaternion is 0 0 0 0, expected one of length 1")]
    Quaternion {
        /// The line's number, from 1.
        line: usize,
    },
    /// The times are not ascending.
    #[error("line {line}: time {time} s is not after that of the pose before, {before} s")]
    Order {
        /// The line's number, from 1.
        line: usize,
        /// The time in seconds.
        time: f64,
        /// The time of the previous pose, in seconds.
        before: f64,
    },
    /// There are no poses.
    #[error("there are no poses")]
    Empty,
    /// There are too many poses.
    #[error("there are more than {MAX_POSES} poses")]
    Long,
}

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPose {
    /// Time in seconds.
    pub time: f64,
    /// The pose.
    pub pose: Pose,
}

/// Reads a trajectory in the plane. Heights are ignored, and of each rotation only the turn about z
/// counts.
///
/// ```
/// use mapping_trial::tum;
///
/// let poses = tum::read("# comment\n0.5 1 2 0 0 0 1 0\n")?;
/// assert_eq!((poses[0].time, poses[0].pose.position.x), (0.5, 1.0));
/// assert!((poses[0].pose.heading - std::f64::consts::PI).abs() < 1e-12);
/// # Ok::<(), tum::TumError>(())
/// ```
///
/// # Errors
///
/// Names the first line that is not a pose, or whose time is not after the previous one. It is also an
/// error if there are no poses, or too many.
pub fn read(text: &str) -> Result<Vec<TimedPose>, TumError> {
    let mut poses: Vec<TimedPose> = Vec::new();
    for (line, text) in text.lines().enumerate() {
        let (line, text) = (line + 1, text.trim());
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let pose = timed_pose(line, text)?;
        if let Some(before) = poses.last().filter(|before| before.time >= pose.time) {
            return Err(TumError::Order { line, time: pose.time, before: before.time });
        }
        if poses.len() == MAX_POSES {
            return Err(TumError::Long);
        }
        poses.push(pose);
    }
    if poses.is_empty() { Err(TumError::Empty) } else { Ok(poses) }
}

fn timed_pose(line: usize, text: &str) -> Result<TimedPose, TumError> {
    let not_a_pose = || TumError::Line { line, text: text.chars().take(60).collect() };
    let numbers: Vec<f64> = text
        .split(|c: char| c.is_whitespace() || c == ',')
        .filter(|part| !part.is_empty())
        .map(str::parse)
        .collect::<Result<_, _>>()
        .map_err(|_| not_a_pose())?;
    let is_wrong = |value: &f64| value.is_nan() || value.abs() > MOST;
    if let Some(column) = numbers.iter().position(is_wrong) {
        let value = numbers[column];
        let is_time = column == 0;
        return Err(if is_time {
            TumError::Time { line, value }
        } else {
            TumError::Number { line, value }
        });
    }
    let [time, x, y, _, qx, qy, qz, qw] = numbers[..] else { return Err(not_a_pose()) };
    let quaternion = [qx, qy, qz, qw];
    let largest = quaternion.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    if largest == 0.0 {
        return Err(TumError::Quaternion { line });
    }
    // Products of tiny numbers would be 0. Powers of 2 change no digit.
    let [qx, qy, qz, qw] = quaternion.map(|part| libm::scalbn(part, -libm::ilogb(largest)));
    // The turn about z of any rotation, also if the length of the quaternion is not exactly 1.
    let heading = libm::atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz);
    Ok(TimedPose { time, pose: Pose { position: DVec2::new(x, y), heading } })
}

/// Writes a trajectory. The numbers are as exact as the poses and their times.
///
/// ```
/// use envgen::geometry::Pose;
/// use mapping_trial::tum::{self, TimedPose};
///
/// let poses = [(0.0, 0.0), (0.5, 1.0)]
///     .map(|(time, x)| TimedPose { time, pose: Pose::new(x, 2.0, 0.0) });
/// let mut text = Vec::new();
/// tum::write(poses, &mut text)?;
/// let text = String::from_utf8(text)?;
/// assert_eq!(text.lines().nth(1), Some("0.5 1 2 0 0 0 0 1"));
/// assert_eq!(tum::read(&text)?, poses);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// Returns any error of the writer.
pub fn write(poses: impl IntoIterator<Item = TimedPose>, out: &mut dyn Write) -> io::Result<()> {
    for TimedPose { time, pose: Pose { position, heading } } in poses {
        let (sin, cos) = libm::sincos(0.5 * heading);
        writeln!(out, "{time} {} {} 0 0 0 {sin} {cos}", position.x, position.y)?;
    }
    Ok(())
}

/// Returns the poses of a trajectory at given times, interpolated between its own poses; `None` before
/// the first and after the last.
///
/// ```
/// use envgen::geometry::Pose;
/// use mapping_trial::tum::{TimedPose, at_times};
///
/// let track = [(0.0, 0.0), (2.0, 4.0)]
///     .map(|(time, x)| TimedPose { time, pose: Pose::new(x, 0.0, 0.0) });
/// let poses: Vec<_> = at_times(&track, [0.5, 2.0, 2.5].into_iter()).collect();
/// assert_eq!(poses, [Some(Pose::new(1.0, 0.0, 0.0)), Some(Pose::new(4.0, 0.0, 0.0)), None]);
/// ```
pub fn at_times<'a>(
    trajectory: &'a [TimedPose],
    times: impl Iterator<Item = f64> + 'a,
) -> impl Iterator<Item = Option<Pose>> + 'a {
    times.map(move |time| {
        let after = trajectory.partition_point(|pose| pose.time < time);
        let b = trajectory.get(after)?;
        if b.time == time {
            return Some(b.pose);
        }
        let a = trajectory[..after].last()?;
        let part = (time - a.time) / (b.time - a.time);
        let turn = wrap_angle(b.pose.heading - a.pose.heading);
        Some(Pose {
            position: a.pose.position.lerp(b.pose.position, part),
            heading: wrap_angle(a.pose.heading + part * turn),
        })
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pose() -> impl Strategy<Value = Pose> {
        (-1e3..1e3_f64, -1e3..1e3_f64, -3.1..3.1_f64).prop_map(|(x, y, h)| Pose::new(x, y, h))
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let error = |text: &str| read(text).expect_err("no trajectory").to_string();
        assert!(error("# nothing\n\n").contains("no poses"));
        assert!(error("\n0 1 2\n").starts_with("line 2 must be `t x y z qx qy qz qw`"));
        assert!(error("0 1 2 3 0 0 0 one").contains("`0 1 2 3 0 0 0 one`"));
        assert!(error("0 1 2 3 0 0 0 1 9").contains("eight numbers"));
        assert!(error("0 1 NaN 3 0 0 0 1").contains("got NaN"));
        assert!(error("0 1 inf 3 0 0 0 1").contains("got inf"));
        assert!(error("0 1 2 3 0 0 0 0").contains("quaternion"));
        let twice = "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n";
        assert!(error(twice).contains("line 2: time 1 s is not after"));
    }

    #[test]
    fn a_tilted_robot_has_the_heading_of_its_turn_about_z() {
        // Turned by a right angle about z, then pitched by 0.2 rad.
        let (s, c) = libm::sincos(0.1);
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let text = format!("0 0 0 0 {} {} {} {}", -h * s, h * s, h * c, h * c);
        let heading = read(&text).unwrap()[0].pose.heading;
        assert!((heading - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "{heading}");
    }

    #[test]
    fn times_of_less_than_a_nanosecond_stay_apart() {
        let poses = [0.0, 1e-10, 2e-10].map(|time| TimedPose { time, pose: Pose::default() });
        let mut text = Vec::new();
        write(poses, &mut text).unwrap();
        assert_eq!(read(std::str::from_utf8(&text).unwrap()).unwrap(), poses);
    }

    proptest! {
        #[test]
        fn the_length_of_a_quaternion_does_not_matter(
            heading in -3.1..3.1_f64, exponent in -300..10_i32, tilt in -0.5..0.5_f64,
        ) {
            let (s, c) = libm::sincos(0.5 * heading);
            let (tilted, upright) = libm::sincos(0.5 * tilt);
            let whole = [-s * tilted, c * tilted, s * upright, c * upright];
            let [short, whole] = [libm::pow(10.0, f64::from(exponent)), 1.0].map(|length| {
                let [qx, qy, qz, qw] = whole.map(|part| length * part);
                let text = format!("0 0 0 0 {qx:e} {qy:e} {qz:e} {qw:e}");
                read(&text).map(|poses| poses[0].pose.heading)
            });
            prop_assert!((whole.clone()? - heading).abs() < 1e-12);
            prop_assert!((short? - whole?).abs() < 1e-12);
        }

        #[test]
        fn what_was_written_is_read(
            poses in proptest::collection::vec(pose(), 1..20),
            // Times since the start, and Unix times in steps that they resolve.
            (first, step) in prop_oneof![
                (Just(0.0), prop_oneof![Just(0.05), 1e-12..1.0_f64]),
                (1e9..2e9_f64, 1e-6..1.0_f64),
            ],
        ) {
            let timed = poses.iter().enumerate().map(|(i, &pose)| TimedPose { time: first + step * i as f64, pose });
            let mut text = Vec::new();
            write(timed.clone(), &mut text).unwrap();
            let found = read(std::str::from_utf8(&text).unwrap()).unwrap();
            prop_assert_eq!(found.len(), poses.len());
            for (found, expected) in found.iter().zip(timed) {
                prop_assert_eq!(found.time, expected.time);
                prop_assert_eq!(found.pose.position, expected.pose.position);
                prop_assert!((found.pose.heading - expected.pose.heading).abs() < 1e-14);
            }
        }

        #[test]
        fn no_text_makes_it_panic(text in "[0-9 .e#naif,\n-]{0,200}") {
            let _ = read(&text);
        }

        #[test]
        fn a_straight_drive_is_interpolated_exactly(speed in 0.1..2.0_f64, at in 0.0..9.0_f64) {
            let pose = |time: f64| TimedPose { time, pose: Pose::new(speed * time, 1.0, 0.5) };
            let poses: Vec<TimedPose> = (0..10).map(|i| pose(f64::from(i))).collect();
            let times = [at, -0.1, 9.1, 9.0];
            let found: Vec<_> = at_times(&poses, times.into_iter()).collect();
            let first = found[0].expect("within");
            prop_assert!(first.position.distance(pose(at).pose.position) < 1e-12);
            prop_assert_eq!(&found[1..], &[None, None, Some(poses[9].pose)][..]);
        }
    }
}
