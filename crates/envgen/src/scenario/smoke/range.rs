//! The range of a laser in uniform smoke.

/// Computes Lambert's W: the solution w >= 0 of w exp(w) = x, for x >= 0; NaN for other numbers.
///
/// It uses Halley's iteration (R. M. Corless et al., On the Lambert W function, Advances in Computational
/// Mathematics 5, 1996, section 5, <https://doi.org/10.1007/BF02124750>), from above, where it converges for every
/// x.
///
/// ```
/// use envgen::scenario::smoke::lambert_w;
///
/// // W(e) = 1, and the omega constant.
/// assert!((lambert_w(std::f64::consts::E) - 1.0).abs() < 1e-15);
/// assert!((lambert_w(1.0) - 0.567_143_290_409_783_8).abs() < 1e-15);
/// ```
pub fn lambert_w(x: f64) -> f64 {
    if x.is_nan() || x < 0.0 {
        return f64::NAN;
    }
    if x == 0.0 || x == f64::INFINITY {
        return x;
    }
    if x > 1e6 {
        // In logarithms, so that nothing overflows: w + ln w = ln x.
        let ln_x = libm::log(x);
        let mut w = ln_x;
        for _ in 0..8 {
            w = w * (1.0 + ln_x - libm::log(w)) / (1.0 + w);
        }
        return w;
    }
    let mut w = libm::log1p(x);
    for _ in 0..20 {
        let e = libm::exp(w);
        let f = w * e - x;
        let next = w - f / (e * (w + 1.0) - 0.5 * (w + 2.0) * f / (w + 1.0));
        if (next - w).abs() <= 1e-16 * w {
            return next;
        }
        w = next;
    }
    w
}

/// Returns the distance in metres up to which a laser has an echo from a surface in smoke of an extinction
/// coefficient in 1/m, if it has one up to `power_range` metres without smoke.
///
/// The power of an echo falls as exp(-2 `extinction` R) / R^2 (the lidar equation with the Beer-Lambert law), so
/// that R exp(`extinction` R) = `power_range`. NaN if an argument is negative or NaN.
///
/// ```
/// use envgen::scenario::smoke::smoke_range;
///
/// assert_eq!(smoke_range(30.0, 0.0), 30.0);
/// // In smoke of 1/m a laser that sees 30 m sees R with R exp(R) = 30.
/// let range = smoke_range(30.0, 1.0);
/// assert!((range * libm::exp(range) - 30.0).abs() < 1e-9 && range < 2.6);
/// ```
pub fn smoke_range(power_range: f64, extinction: f64) -> f64 {
    if power_range.is_nan() || power_range < 0.0 || extinction.is_nan() || extinction < 0.0 {
        return f64::NAN;
    }
    let product = power_range * extinction;
    // The first terms of the series, where the quotient would lose digits.
    if product < 1e-8 { power_range * (1.0 - product) } else { lambert_w(product) / extinction }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ranges_are_those_of_the_table() {
        let extinctions = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0];
        for (power_range, ranges) in [
            (20.0, [11.3, 8.5, 6.0, 3.5, 2.2, 1.35, 1.0, 0.68]),
            (30.0, [14.5, 10.5, 7.2, 4.0, 2.5, 1.5, 1.1, 0.74]),
        ] {
            for (extinction, expected) in extinctions.into_iter().zip(ranges) {
                let range = smoke_range(power_range, extinction);
                assert!(
                    (range / expected - 1.0).abs() < 0.01,
                    "{power_range} {extinction}: {range}"
                );
            }
        }
    }

    #[test]
    fn nonsense_has_no_range() {
        assert!(lambert_w(-0.1).is_nan() && lambert_w(f64::NAN).is_nan());
        assert_eq!((lambert_w(0.0), lambert_w(f64::INFINITY)), (0.0, f64::INFINITY));
        assert!(smoke_range(-1.0, 1.0).is_nan() && smoke_range(1.0, f64::NAN).is_nan());
        assert_eq!(smoke_range(20.0, 0.0), 20.0);
    }

    proptest! {
        #[test]
        fn it_solves_its_equation(exponent in -300.0..300.0_f64) {
            let x = libm::pow(10.0, exponent);
            let w = lambert_w(x);
            // In logarithms: w + ln w = ln x.
            let error = w + libm::log(w) - libm::log(x);
            prop_assert!(error.abs() < 1e-12 * (1.0 + libm::log(x).abs()), "{x}: {w}, {error}");
        }

        #[test]
        fn the_echo_at_the_range_is_just_strong_enough(
            power_range in 0.1..100.0_f64, extinction in 1e-12..20.0_f64,
        ) {
            let range = smoke_range(power_range, extinction);
            let power = range * libm::exp(extinction * range) / power_range;
            prop_assert!((power - 1.0).abs() < 1e-9, "{power}");
        }
    }
}
