//! The formulas that the paper gives for Total Edge Density, with their limits.
//!
//! Source: A. V. Kuznetsov, Generation of a random landscape by given configuration entropy and Total Edge,
//! Computational Technologies 22 (4), 2017, sections 3 and 4. Both formulas are fits to experiments;
//! [`mean_edge_count`](super::mean_edge_count) gives the exact value for the second.

/// A column of table 1 of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TedFit {
    /// Entropy as a share of the greatest entropy, ln l.
    pub relative_entropy: f64,
    /// Constant a0.
    pub a0: f64,
    /// Constant b0.
    pub b0: f64,
    /// Constant c0.
    pub c0: f64,
    /// Constant k.
    pub k: f64,
}

/// Table 1. Its columns are for the relative entropies 0.2 to 1.
pub const TABLE_1: [TedFit; 5] = [
    TedFit { relative_entropy: 0.2, a0: 0.631_706, b0: 0.902_495, c0: 0.541_963, k: 0.089_677_9 },
    TedFit { relative_entropy: 0.4, a0: 1.046_16, b0: 1.7169, c0: 0.489_177, k: 0.105_287 },
    TedFit { relative_entropy: 0.6, a0: 1.501_53, b0: 2.534_05, c0: 0.392_038, k: 0.076_355_2 },
    TedFit { relative_entropy: 0.8, a0: 3.929_62, b0: 7.661_27, c0: 0.188_599, k: 0.018_329_8 },
    TedFit { relative_entropy: 1.0, a0: 5.298_11, b0: 10.9732, c0: 0.154_264, k: 0.005_763_06 },
];

/// Returns the Total Edge Density that the paper's model gives for the automaton: a0 ln(c0 eps^k / (1 - c0 eps)) +
/// b0.
///
/// The model is valid only for about 150 to 225 classes and an `epsilon` of at least 0.02; with 15 classes it is
/// off by up to 0.34. The scan of the paper lost the position of the denominator; the reading used here agrees with
/// simulation and with figure 2 of the paper. To find the `epsilon` for a given density, simulation with
/// [`automaton_fill`](super::automaton_fill) is better; a spec with `total_edge` does this.
///
/// Returns `None` if `epsilon` is outside (0, 1], where the model has no value.
pub fn published_ted(fit: &TedFit, epsilon: f64) -> Option<f64> {
    let inside = epsilon > 0.0 && epsilon <= 1.0;
    inside.then(|| {
        let argument = fit.c0 * libm::pow(epsilon, fit.k) / (1.0 - fit.c0 * epsilon);
        fit.a0 * libm::log(argument) + fit.b0
    })
}

/// Returns the Total Edge Density that the paper fits to random filling: a1 s(b1 S / ln l) - a1 / 2, where s is the
/// logistic function.
///
/// The paper prints "+ a1 / 2", which would give a1 / 2 if there is no entropy and hence no edge. Its a1 contains a
/// power of l - 10.9641, which is not a number for fewer classes and far too large just above: 12 classes get twice
/// the exact density; for 20 classes or more the fit is good to 0.12. Returns `None` for up to 10 classes, and if
/// `entropy` is outside [0, ln l].
///
/// ```
/// use envgen::landscape::{Composition, mean_edge_count, published::random_ted};
///
/// // The fit of the paper is within 0.12 of the exact mean from 20 classes on.
/// let counts = Composition::closest(48 * 48, 30, 2.0, false)?;
/// let exact = mean_edge_count(48, 48, counts.counts()) / (48.0 * 48.0);
/// let fitted = random_ted(30, 2.0).expect("more than 10 classes");
/// assert!((fitted - exact).abs() < 0.12);
/// assert_eq!(random_ted(9, 1.0), None);
/// # Ok::<(), envgen::SpecError>(())
/// ```
pub fn random_ted(classes: u32, entropy: f64) -> Option<f64> {
    let l = f64::from(classes);
    let most = libm::log(l);
    if l <= 10.9641 || !(0.0..=most).contains(&entropy) {
        return None;
    }
    let a1 = 3.903_02 + 5.252_18 * libm::pow(l - 10.9641, -2.192_35);
    let b1 = 1.152_28 * libm::log(0.990_096 * l - 1.183_97);
    let logistic = 1.0 / (1.0 + libm::exp(-b1 * entropy / most));
    Some(a1 * logistic - 0.5 * a1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::{Composition, automaton_fill, edge_count, mean_edge_count};
    use crate::seed::Seed;

    #[test]
    fn the_model_of_the_automaton_holds_where_it_is_said_to() {
        // 152 classes on 48 x 48, as figure 2; means of 20 maps.
        for fit in TABLE_1 {
            let entropy = fit.relative_entropy * libm::log(152.0);
            let entropy = entropy.min(crate::landscape::largest_entropy(2304, 152));
            let composition = Composition::closest(2304, 152, entropy, false).unwrap();
            for epsilon in [0.05, 0.2, 0.5, 0.9] {
                let edges: u64 = (0..20)
                    .map(|seed| {
                        let mut stream = Seed(seed).stream("landscape/automaton", 0);
                        let counts = composition.counts();
                        edge_count(&automaton_fill(48, 48, counts, epsilon, &mut stream), 48)
                    })
                    .sum();
                let found = edges as f64 / 20.0 / 2304.0;
                let model = published_ted(&fit, epsilon).unwrap();
                assert!(
                    (found - model).abs() < 0.1,
                    "S/Smax {}, epsilon {epsilon}: {found}, model {model}",
                    fit.relative_entropy
                );
            }
        }
    }

    #[test]
    fn the_fit_of_random_filling_is_near_the_exact_mean() {
        for classes in [20, 50, 150] {
            for part in [0.0, 0.2, 0.5, 0.8, 0.95] {
                let entropy = part * libm::log(f64::from(classes));
                let composition =
                    Composition::closest(2304, u64::from(classes), entropy, false).unwrap();
                let exact = mean_edge_count(48, 48, composition.counts()) / 2304.0;
                let fit = random_ted(classes, entropy).unwrap();
                assert!((exact - fit).abs() < 0.12, "{classes} {part}: exact {exact}, fit {fit}");
            }
        }
    }

    #[test]
    fn outside_their_limits_the_formulas_have_no_value() {
        assert_eq!(published_ted(&TABLE_1[0], 0.0), None);
        assert_eq!(published_ted(&TABLE_1[0], f64::NAN), None);
        assert_eq!(random_ted(10, 1.0), None);
        assert_eq!(random_ted(20, 4.0), None);
        assert_eq!(random_ted(20, f64::NAN), None);
    }
}
