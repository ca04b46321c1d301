//! Scans, and the values of beams without an echo.

/// The range of a beam without echo, as in REP 117 of ROS.
pub const NO_ECHO: f64 = f64::INFINITY;

/// The exact range of a beam that ends at a part too dark to be seen from there
/// ([`Obstacle::visible_range`](envgen::world::Obstacle::visible_range)).
///
/// As NaN in a scan, it means that the beam is to be ignored: it is not an echo, and it does not show
/// that its path is free. Lasers distinguish the two cases: SICK's LMS 200 sends the code 0x1FFB for a
/// signal-to-noise ratio that is too small, and 0x1FF7 for a range beyond its greatest. By REP 117 of
/// ROS, these are NaN and infinity.
///
/// A real laser misses very dark walls altogether. The simulated one always notices them within its
/// greatest range.
pub const UNSEEN: f64 = f64::NAN;

/// The ranges of one scan in metres, beam by beam from right to left.
///
/// As in REP 117 of ROS, [`NO_ECHO`] is a beam without echo within the greatest range, and NaN is a
/// beam to be ignored. A range of 0 is ignored, too.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// One range per beam.
    pub ranges: Vec<f64>,
}
