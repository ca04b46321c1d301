//! What a class adds to the entropy of a composition.

/// n ln n, 0 for 0.
pub(super) fn n_ln_n(n: u32) -> f64 {
    let n = f64::from(n);
    if n > 0.0 { n * libm::log(n) } else { 0.0 }
}
