//! The argument of options that say where a robot starts.

use envgen::geometry::Pose;

/// Parses a pose such as `1.5,-2,90`, or a position such as `1.5,-2`, whose heading is 0.
pub(crate) fn start(text: &str) -> Result<Pose, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let (x, y, degrees) = match numbers.as_deref() {
        Ok(&[x, y, degrees]) => (x, y, degrees),
        Ok(&[x, y]) => (x, y, 0.0),
        _ => (f64::NAN, f64::NAN, f64::NAN),
    };
    if [x, y, degrees].iter().all(|number| number.is_finite()) {
        Ok(Pose::new(x, y, degrees.to_radians()))
    } else {
        Err("not of the form x,y or x,y,heading with numbers in metres and degrees".to_owned())
    }
}
