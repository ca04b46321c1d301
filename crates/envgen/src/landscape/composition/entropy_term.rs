//! The contribution of a class to the entropy of a composition.

/// Returns n ln n, which is 0 for 0.
pub(super) fn n_ln_n(n: u32) -> f64 {
    let n = f64::from(n);
    if n > 0.0 { n * libm::log(n) } else { 0.0 }
}
