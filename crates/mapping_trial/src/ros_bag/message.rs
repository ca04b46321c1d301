//! The messages of a bag, field by field in the order of their definitions in [`super::schema`].

use envgen::geometry::Pose;
use glam::DVec2;

use super::cdr::CdrWriter;
use crate::backend::TICK;
use crate::lidar::{LaserProfile, NO_ECHO};
use crate::odometry::Increment;

/// Range in metres below which echoes are too close to be measured: `range_min` of scans.
pub(super) const RANGE_MIN: f64 = 0.01;

/// Time and frame of a message.
#[derive(Clone, Copy)]
pub(super) struct Header<'a> {
    /// Nanoseconds of simulated time.
    pub(super) stamp: u64,
    /// Name of the frame.
    pub(super) frame: &'a str,
}

/// A pose of one frame in another, and its height above it in metres.
#[derive(Clone, Copy)]
pub(super) struct Transform<'a> {
    pub(super) header: Header<'a>,
    pub(super) child: &'a str,
    pub(super) pose: Pose,
    pub(super) height: f64,
}

/// A map in the form of ROS: 0 free, 100 occupied, -1 unknown, row by row from the lowest.
pub(super) struct Grid<I> {
    pub(super) resolution: f64,
    pub(super) cols: usize,
    pub(super) rows: usize,
    pub(super) origin: DVec2,
    pub(super) cells: I,
}

/// Writes a `builtin_interfaces/Time`. Trials last a day at most.
fn time(out: &mut CdrWriter, stamp: u64) {
    out.i32(i32::try_from(stamp / 1_000_000_000).unwrap_or(i32::MAX));
    out.u32((stamp % 1_000_000_000) as u32);
}

fn header(out: &mut CdrWriter, header: Header<'_>) {
    time(out, header.stamp);
    out.string(header.frame);
}

/// Writes a position and a quaternion about z: a `geometry_msgs/Pose`, or a `geometry_msgs/Transform`,
/// which has the same fields.
fn pose(out: &mut CdrWriter, pose: Pose, height: f64) {
    let (sin, cos) = libm::sincos(0.5 * pose.heading);
    for value in [pose.position.x, pose.position.y, height, 0.0, 0.0, sin, cos] {
        out.f64(value);
    }
}

/// Writes a `rosgraph_msgs/Clock`.
pub(super) fn clock(out: &mut CdrWriter, stamp: u64) {
    out.begin();
    time(out, stamp);
}

/// Writes a `geometry_msgs/PoseStamped`.
pub(super) fn pose_stamped(out: &mut CdrWriter, of: Header<'_>, at: Pose) {
    out.begin();
    header(out, of);
    pose(out, at, 0.0);
}

/// Writes a `tf2_msgs/TFMessage`.
pub(super) fn transforms(out: &mut CdrWriter, transforms: &[Transform<'_>]) {
    out.begin();
    out.sequence(transforms.len());
    for transform in transforms {
        header(out, transform.header);
        out.string(transform.child);
        pose(out, transform.pose, transform.height);
    }
}

/// Writes a `nav_msgs/Odometry` after the motion of a tick. Covariances are 0, which means that they
/// are not known.
pub(super) fn odometry(
    out: &mut CdrWriter,
    of: Header<'_>,
    child: &str,
    at: Pose,
    motion: Increment,
) {
    let covariance = |out: &mut CdrWriter| (0..36).for_each(|_| out.f64(0.0));
    out.begin();
    header(out, of);
    out.string(child);
    pose(out, at, 0.0);
    covariance(out);
    for value in [motion.distance / TICK, 0.0, 0.0, 0.0, 0.0, motion.turn / TICK] {
        out.f64(value);
    }
    covariance(out);
}

/// Writes a `sensor_msgs/LaserScan`, whose beams are all measured at the same time. By REP 117 of ROS,
/// a beam without echo is +Inf, an echo that is too close -Inf, and a beam to be ignored NaN.
pub(super) fn scan(out: &mut CdrWriter, of: Header<'_>, laser: &LaserProfile, ranges: &[f64]) {
    out.begin();
    header(out, of);
    let last = ranges.len().saturating_sub(1);
    let increment = laser.angle(1) - laser.angle(0);
    let period = f64::from(laser.ticks_a_scan) * TICK;
    for value in
        [laser.angle(0), laser.angle(last), increment, 0.0, period, RANGE_MIN, laser.max_range]
    {
        out.f32(value as f32);
    }
    out.sequence(ranges.len());
    for &range in ranges {
        out.f32(ros_range(range));
    }
    // Intensities.
    out.sequence(0);
}

fn ros_range(range: f64) -> f32 {
    if range > 0.0 && range < RANGE_MIN {
        f32::NEG_INFINITY
    } else if range > 0.0 && range < NO_ECHO {
        range as f32
    } else if range == NO_ECHO {
        f32::INFINITY
    } else {
        f32::NAN
    }
}

/// Writes a `nav_msgs/OccupancyGrid`.
pub(super) fn grid(out: &mut CdrWriter, of: Header<'_>, grid: Grid<impl Iterator<Item = i8>>) {
    out.begin();
    header(out, of);
    time(out, of.stamp);
    out.f32(grid.resolution as f32);
    out.u32(grid.cols as u32);
    out.u32(grid.rows as u32);
    pose(out, Pose { position: grid.origin, heading: 0.0 }, 0.0);
    out.sequence(grid.cols * grid.rows);
    out.i8s(grid.cells);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_rep_117() {
        assert_eq!(ros_range(1.5), 1.5);
        assert_eq!(ros_range(NO_ECHO), f32::INFINITY);
        assert_eq!(ros_range(0.004), f32::NEG_INFINITY);
        for ignored in [0.0, f64::NAN, -1.0] {
            assert!(ros_range(ignored).is_nan(), "{ignored}");
        }
    }

    #[test]
    fn a_time_is_split_into_seconds_and_the_rest() {
        let mut out = CdrWriter::default();
        clock(&mut out, 3_050_000_000);
        assert_eq!(out.bytes()[4..], [3, 0, 0, 0, 0x80, 0xf0, 0xfa, 0x02]);
    }
}
