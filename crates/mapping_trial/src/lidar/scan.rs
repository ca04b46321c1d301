//! Scans, and the ranges that are none.

/// Range of a beam without echo, as in REP 117 of ROS.
pub const NO_ECHO: f64 = f64::INFINITY;

/// Exact range of a beam that ends at a part that is too dark to be seen from there
/// ([`Obstacle::visible_range`](envgen::world::Obstacle::visible_range)).
///
/// The beam is to be ignored, as NaN in a scan: it is neither an echo, nor does it say that its path
/// is free. Lasers tell the two apart: SICK's LMS 200 sends the code 0x1FFB for a signal-to-noise ratio
/// that is too small, and 0x1FF7 for a range beyond its greatest, which by REP 117 of ROS are NaN and
/// infinity. A real laser misses very dark walls altogether; here it always notices them within its
/// greatest range.
pub const UNSEEN: f64 = f64::NAN;

/// The ranges of one scan in metres, beam by beam from right to left. As in REP 117 of ROS,
/// [`NO_ECHO`] is a beam without echo within the greatest range, and NaN is a beam to be
/// ignored, as is a range of 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// One range per beam.
    pub ranges: Vec<f64>,
}
