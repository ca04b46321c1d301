//! The equations by which a map adapts to a difficulty d, a real number from 0 to 10.
//!
//! Source: O. Zwennes, Adaptive Indoor Map Generator for USARSim, 2011, section 4. The equations have no numbers
//! there; here they are named after the adaptation to which they belong.

/// Least distance between parallel hallways, in cells.
pub const LEAST_SPACING: u32 = 3;

/// Standard deviation of the distance between hallways before the clamp, as a share of the map's size.
pub const SPACING_DEVIATION: f64 = 0.1;

/// Returns the expected distance between hallways before the clamp, in cells (first adaptation). `size` is the
/// map's width for vertical hallways and its height for horizontal ones.
pub fn spacing_mean(difficulty: f64, size: u32) -> f64 {
    (0.06 * difficulty + 0.2) * f64::from(size)
}

/// Returns the distance between hallways before the clamp, in cells, for a standard normal number (first adaptation).
pub fn spacing_raw(difficulty: f64, size: u32, normal: f64) -> f64 {
    spacing_mean(difficulty, size) + normal * SPACING_DEVIATION * f64::from(size)
}

/// Returns the distance between hallways in whole cells: rounded, and clamped to 3..=`size` - 1. The paper clamps
/// to `size`, at which no second hallway would fit, although it promises at least two.
///
/// # Panics
/// When `raw` is NaN.
#[track_caller]
pub fn spacing(raw: f64, size: u32) -> u32 {
    let most = f64::from(size.saturating_sub(1).max(LEAST_SPACING));
    assert!(!raw.is_nan(), "the distance between hallways is NaN");
    raw.round().clamp(f64::from(LEAST_SPACING), most) as u32
}

/// Returns the probability that hallway cycles are prevented (fifth adaptation).
pub fn cycle_prevention_probability(difficulty: f64) -> f64 {
    1.0 - difficulty / 10.0
}

/// Returns the inverse squared error of a room's difficulty (fourth adaptation).
pub fn inverse_squared_error(difficulty: f64, room: f64) -> f64 {
    1.0 / ((difficulty - room) * (difficulty - room) + 1.0)
}

/// Returns the probability of each room to be drawn, given their difficulties (fourth adaptation).
pub fn room_probabilities(difficulty: f64, rooms: &[f64]) -> Vec<f64> {
    let errors: Vec<f64> =
        rooms.iter().map(|&room| inverse_squared_error(difficulty, room)).collect();
    let total: f64 = errors.iter().sum();
    errors.into_iter().map(|error| error / total).collect()
}

/// Returns the probability of a doorway in a side of a room (third adaptation), which is exactly 1 at difficulty 10.
pub fn doorway_probability(difficulty: f64) -> f64 {
    difficulty / 16.0 + 0.375
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_equations_at_their_ends() {
        assert_eq!(spacing_mean(0.0, 10), 2.0);
        assert_eq!(spacing_mean(10.0, 10), 8.0);
        assert_eq!(spacing_raw(5.0, 20, -1.0), 8.0);
        assert_eq!(cycle_prevention_probability(0.0), 1.0);
        assert_eq!(cycle_prevention_probability(10.0), 0.0);
        assert_eq!(doorway_probability(0.0), 0.375);
        assert_eq!(doorway_probability(10.0), 1.0);
        assert_eq!(inverse_squared_error(3.0, 3.0), 1.0);
        assert_eq!(inverse_squared_error(3.0, 5.0), 0.2);
    }

    #[test]
    fn a_closed_room_by_hand() {
        // Spec, section 6: four sides without a doorway at d = 0.
        let closed = (1.0 - doorway_probability(0.0)) * (1.0 - doorway_probability(0.0));
        assert!((closed * closed - 0.152_587_890_625).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn spacing_stays_in_range(raw in -1e9..1e9_f64, size in 4..=1024_u32) {
            let spacing = spacing(raw, size);
            prop_assert!((3..size).contains(&spacing));
            prop_assert!(spacing == 3 || spacing == size - 1
                || (f64::from(spacing) - raw).abs() <= 0.5);
        }

        #[test]
        fn probabilities_sum_to_one(
            difficulty in 0.0..=10.0_f64,
            rooms in proptest::collection::vec(0.0..=10.0_f64, 1..30),
        ) {
            let p = room_probabilities(difficulty, &rooms);
            prop_assert!((p.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for (i, &a) in rooms.iter().enumerate() {
                for (j, &b) in rooms.iter().enumerate() {
                    if (a - difficulty).abs() < (b - difficulty).abs() {
                        prop_assert!(p[i] >= p[j]);
                    }
                }
            }
        }
    }
}
