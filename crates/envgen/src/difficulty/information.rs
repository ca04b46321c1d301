//! The information that a scan contains about the pose from which it was taken.

use glam::DVec2;

/// The share of a sum of squares that rounding can leave of zero.
const ROUNDING: f64 = 1e-12;

/// Fisher information of a scan in units of 1 / sigma^2, where sigma is the standard deviation of a range. It is
/// the sum of `J^T J` over the scan's echoes with `J = (n, r sin(incidence))`, in the point-to-line form, whose
/// weights are bounded where a beam grazes a wall.
///
/// A. Censi, On achievable accuracy for range-finder localization, ICRA 2007,
/// doi:10.1109/ROBOT.2007.364120; A. Censi, An ICP variant using a point-to-line metric, ICRA 2008,
/// doi:10.1109/ROBOT.2008.4543181.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScanInformation {
    /// l1, the greater eigenvalue of the information on the position if the heading is unknown: the Schur
    /// complement of the heading.
    pub greatest: f64,
    /// l2, the lesser eigenvalue of the same.
    pub least: f64,
    /// Information on the heading if the position is unknown, in m^2.
    pub heading: f64,
}

impl ScanInformation {
    /// Returns l2 / l1, from 0 to 1; 0 without echoes.
    pub fn ratio(&self) -> f64 {
        if self.greatest > 0.0 { (self.least / self.greatest).min(1.0) } else { 0.0 }
    }
}

/// The sums from which the information of a scan is computed.
///
/// ```
/// use envgen::difficulty::Echoes;
/// use envgen::glam::DVec2;
///
/// // Between two walls, 1 m to the left and to the right, nothing tells the position along them.
/// let mut echoes = Echoes::default();
/// for y in [1.0, -1.0] {
///     for x in [-1.0, 0.0, 1.0] {
///         echoes.add(DVec2::new(x, y), DVec2::new(0.0, -y));
///     }
/// }
/// let information = echoes.information();
/// assert_eq!((information.greatest, information.least), (6.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Echoes {
    /// Sums of `n_x^2`, `n_x n_y` and `n_y^2`.
    normals: [f64; 3],
    /// Sum of `n k`, where k is the lever arm of the heading.
    mixed: DVec2,
    levers: f64,
    /// Sum of squared ranges, with which rounding errors are compared.
    ranges: f64,
}

impl Echoes {
    /// Adds an echo: the vector from the laser to it in metres, and the unit normal of the wall at the echo, both
    /// in the same frame.
    pub fn add(&mut self, echo: DVec2, normal: DVec2) {
        let lever = echo.perp_dot(normal);
        self.normals[0] += normal.x * normal.x;
        self.normals[1] += normal.x * normal.y;
        self.normals[2] += normal.y * normal.y;
        self.mixed += normal * lever;
        self.levers += lever * lever;
        self.ranges += echo.length_squared();
    }

    /// Returns the information of the echoes that were added so far.
    pub fn information(&self) -> ScanInformation {
        let [xx, xy, yy] = self.normals;
        let known = self.levers > ROUNDING * self.ranges;
        let share = if known { 1.0 / self.levers } else { 0.0 };
        let (greatest, least) = eigenvalues(
            xx - self.mixed.x * self.mixed.x * share,
            xy - self.mixed.x * self.mixed.y * share,
            yy - self.mixed.y * self.mixed.y * share,
        );
        // The pseudo-inverse of the normals' sum: the mixed sum lies in its range.
        let (most, fewest) = eigenvalues(xx, xy, yy);
        let mixed = self.mixed;
        let taken = if fewest > ROUNDING * most {
            let determinant = xx * yy - xy * xy;
            (yy * mixed.x * mixed.x - 2.0 * xy * mixed.x * mixed.y + xx * mixed.y * mixed.y)
                / determinant
        } else if most > 0.0 {
            mixed.length_squared() / most
        } else {
            0.0
        };
        ScanInformation { greatest, least, heading: (self.levers - taken).max(0.0) }
    }
}

/// Returns the eigenvalues of a positive semidefinite symmetric matrix, the greater first.
fn eigenvalues(xx: f64, xy: f64, yy: f64) -> (f64, f64) {
    let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let spread = (half * half + xy * xy).sqrt();
    let (greatest, least) = ((middle + spread).max(0.0), (middle - spread).max(0.0));
    (greatest, if least > ROUNDING * greatest { least } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::unit_vector;

    #[test]
    fn a_single_wall_fixes_one_direction_and_the_heading() {
        let mut echoes = Echoes::default();
        for x in [-2.0, -1.0, 0.0, 1.0, 2.0] {
            echoes.add(DVec2::new(x, 3.0), DVec2::NEG_Y);
        }
        let found = echoes.information();
        // Levers are x, whose sum is 0 and whose squares are 10.
        assert_eq!(found, ScanInformation { greatest: 5.0, least: 0.0, heading: 10.0 });
        assert_eq!(Echoes::default().information(), ScanInformation::default());
        assert_eq!(ScanInformation::default().ratio(), 0.0);
    }

    #[test]
    fn one_echo_cannot_tell_position_from_heading() {
        let mut echoes = Echoes::default();
        echoes.add(DVec2::new(1.0, 3.0), DVec2::NEG_Y);
        // With the heading unknown the one equation is spent on it.
        assert_eq!(echoes.information(), ScanInformation::default());
        let mut ahead = Echoes::default();
        ahead.add(DVec2::new(0.0, 3.0), DVec2::NEG_Y);
        // Straight ahead the heading does not matter.
        assert_eq!(ahead.information().greatest, 1.0);
    }

    proptest! {
        #[test]
        fn turning_the_robot_changes_nothing(
            echoes in prop::collection::vec((-8.0..8.0_f64, -8.0..8.0_f64, -4.0..4.0_f64), 0..40),
            turn in -4.0..4.0_f64,
        ) {
            let (mut plain, mut turned) = (Echoes::default(), Echoes::default());
            let rotation = unit_vector(turn);
            for (x, y, normal) in echoes {
                let (echo, normal) = (DVec2::new(x, y), unit_vector(normal));
                plain.add(echo, normal);
                turned.add(rotation.rotate(echo), rotation.rotate(normal));
            }
            let (a, b) = (plain.information(), turned.information());
            for (a, b) in [(a.greatest, b.greatest), (a.least, b.least), (a.heading, b.heading)] {
                prop_assert!(a.is_finite() && a >= 0.0);
                prop_assert!((a - b).abs() <= 1e-7 * (1.0 + a + plain.ranges), "{a} {b}");
            }
            prop_assert!((0.0..=1.0).contains(&a.ratio()));
        }

        #[test]
        fn another_echo_never_takes_information(
            echoes in prop::collection::vec((-8.0..8.0_f64, -8.0..8.0_f64, -4.0..4.0_f64), 1..40),
        ) {
            let mut sums = Echoes::default();
            let mut before = sums.information();
            for (x, y, normal) in echoes {
                sums.add(DVec2::new(x, y), unit_vector(normal));
                let after = sums.information();
                let slack = 1e-7 * (1.0 + sums.ranges);
                prop_assert!(after.least >= before.least - slack);
                prop_assert!(after.greatest >= before.greatest - slack);
                prop_assert!(after.heading >= before.heading - slack);
                before = after;
            }
        }
    }
}
