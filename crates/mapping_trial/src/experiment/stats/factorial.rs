//! Full factorial designs, and the variances of their effects by mean squares.

/// A measure of every trial of a full factorial design: all combinations of the levels of all factors,
/// each with the same number of trials.
#[derive(Clone, Debug, PartialEq)]
pub struct Factorial {
    /// Names of the factors, the maps first.
    pub factors: Vec<&'static str>,
    /// Number of levels of each factor.
    pub sizes: Vec<usize>,
    /// Number of trials per combination, which differ in noise.
    pub repeats: usize,
    /// Whether trials of a map with the same number have the same noise in all combinations.
    pub shares_noise: bool,
    /// The values. The levels of the first factor vary slowest, and the noise varies fastest.
    pub values: Vec<f64>,
}

impl Factorial {
    /// The name of a component. Component `i` is the interaction of the factors whose bits are set in
    /// `i + 1`; the last component is noise.
    pub(super) fn effect(&self, component: usize) -> String {
        let set = component + 1;
        if set == 1 << self.factors.len() {
            return "noise".to_owned();
        }
        let names = self.factors.iter().enumerate().filter(|(factor, _)| set >> factor & 1 == 1);
        names.map(|(_, name)| *name).collect::<Vec<_>>().join(" x ")
    }

    /// The number of trials of each level of a component, as by [`Self::effect`]; 1 for noise.
    pub(super) fn trials_per_level(&self, component: usize) -> f64 {
        let others = (0..self.sizes.len()).filter(|factor| (component + 1) >> factor & 1 == 0);
        let levels: usize = others.map(|factor| self.sizes[factor]).product();
        let is_noise = component + 1 == 1 << self.sizes.len();
        if is_noise { 1.0 } else { (levels * self.repeats) as f64 }
    }

    /// The design without one of its maps.
    pub(super) fn without(&self, map: usize) -> Factorial {
        let of_map = self.values.len() / self.sizes[0];
        let mut rest = self.clone();
        rest.values.drain(map * of_map..(map + 1) * of_map);
        rest.sizes[0] -= 1;
        rest
    }
}

/// The set of the maps alone, by its bit.
const MAP: usize = 1;

/// The cells of a design, which are the combinations of levels of all factors, grouped by the levels of
/// a set of factors.
pub(super) struct Grouping {
    /// Number of groups.
    count: usize,
    /// The group of each cell.
    of: Vec<u32>,
}

/// The groupings by all sets of factors, in the order of their bits.
pub(super) fn groupings(sizes: &[usize]) -> Vec<Grouping> {
    let cells: usize = sizes.iter().product();
    let by = |set: usize| {
        let has = |factor: usize| set >> factor & 1 == 1;
        let group = |cell: usize| {
            let (mut rest, mut group, mut step) = (cell, 0, 1);
            for (factor, &levels) in sizes.iter().enumerate().rev() {
                if has(factor) {
                    group += rest % levels * step;
                    step *= levels;
                }
                rest /= levels;
            }
            group as u32
        };
        let levels = sizes.iter().enumerate().filter(|&(factor, _)| has(factor));
        Grouping {
            count: levels.map(|(_, &levels)| levels).product(),
            of: (0..cells).map(group).collect(),
        }
    };
    (0..1 << sizes.len()).map(by).collect()
}

/// The variances of all sets of factors in the order of their bits, and then of noise. They are unbiased, hence also
/// negative.
pub(super) fn variances(design: &Factorial, groupings: &[Grouping]) -> Vec<f64> {
    let full = groupings.len() - 1;
    let sums: Vec<f64> = groupings.iter().map(|by| squares(design, by, false)).collect();
    let levels = |set: usize| groupings[set].count as f64;
    // The sum of squares of an interaction is what its means have beyond those of all smaller sets.
    let mean_square = |set: usize| {
        let own: f64 = subsets(set).map(|part| sign(set, part) * sums[part]).sum();
        let freedom: f64 = subsets(set).map(|part| sign(set, part) * levels(part)).sum();
        own / freedom
    };
    let cells = levels(full);
    let total: f64 = design.values.iter().map(|x| x * x).sum();
    let noise = (total - sums[full]) / (cells * (design.repeats as f64 - 1.0));
    let mut squares: Vec<f64> =
        (0..=full).map(|set| if set == 0 { 0.0 } else { mean_square(set) }).collect();
    // What noise adds to all of them alike is no difference: that of a set without the map is that with it.
    let noises = design.shares_noise.then(|| shared_noises(design, groupings, &sums));
    for (set, square) in squares.iter_mut().enumerate().skip(1) {
        *square -= noises.as_ref().map_or(noise, |noises| noises[set | MAP]);
    }
    let mut found: Vec<f64> = (1..=full)
        .map(|set| {
            let above = (set..=full).filter(|whole| whole & set == set);
            let sum: f64 = above.map(|whole| sign(whole, set) * squares[whole]).sum();
            let per_level = cells / levels(set) * design.repeats as f64;
            sum / per_level
        })
        .collect();
    found.push(noise);
    found
}

/// The mean squares of shared noise, which is nested within maps, and of its interactions with the
/// other factors, by the set of factors with the map; 0 for sets without the map.
fn shared_noises(design: &Factorial, groupings: &[Grouping], sums: &[f64]) -> Vec<f64> {
    let by_noise: Vec<f64> = groupings.iter().map(|by| squares(design, by, true)).collect();
    let levels = |set: usize| groupings[set].count as f64;
    let of = |set: usize| {
        if set & MAP == 0 {
            return 0.0;
        }
        let parts = || subsets(set).filter(|part| part & MAP != 0);
        let own: f64 = parts().map(|part| sign(set, part) * (by_noise[part] - sums[part])).sum();
        let freedom: f64 = parts().map(|part| sign(set, part) * levels(part)).sum();
        own / (freedom * (design.repeats as f64 - 1.0))
    };
    (0..groupings.len()).map(of).collect()
}

/// The sum of the squared means over everything except a set of factors and, if `are_apart`, the
/// repeats. Each mean is weighted by its number of values.
fn squares(design: &Factorial, by: &Grouping, are_apart: bool) -> f64 {
    let each = if are_apart { design.repeats } else { 1 };
    let mut sums = vec![0.0; by.count * each];
    for (&group, repeats) in by.of.iter().zip(design.values.chunks_exact(design.repeats)) {
        for (number, value) in repeats.iter().enumerate() {
            sums[group as usize * each + number % each] += value;
        }
    }
    let values_each = design.values.len() as f64 / sums.len() as f64;
    sums.iter().map(|sum| sum * sum / values_each).sum()
}

/// All subsets of a set of bits, including the empty one.
fn subsets(set: usize) -> impl Iterator<Item = usize> {
    (0..=set).filter(move |part| part & set == *part)
}

/// The sign of inclusion and exclusion: -1 if the sets differ by an odd number of factors.
fn sign(set: usize, part: usize) -> f64 {
    if (set.count_ones() - part.count_ones()).is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// The estimate of a variance, which is not negative.
pub(super) fn cut(variance: f64) -> f64 {
    variance.max(0.0)
}

/// The variance within a map: that of noise and of all interactions with the map.
pub(super) fn within(variances: &[f64]) -> f64 {
    let of_map = |set: usize| set & MAP != 0 && set != MAP;
    let interactions = (0..variances.len() - 1).filter(|&i| of_map(i + 1));
    cut(variances[variances.len() - 1]) + interactions.map(|i| cut(variances[i])).sum::<f64>()
}
