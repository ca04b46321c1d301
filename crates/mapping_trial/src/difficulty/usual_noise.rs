//! The usual variance of scores by noise alone, for worlds in which it is not known yet.

use std::sync::LazyLock;

use envgen::calibration::Dials;

use super::panel::Panel;
use crate::experiment::survey::Condition;
use crate::slam::SlamKind;

/// Mean scores, and the variances by noise alone at these scores: those within a map and a condition,
/// of 5,808 degrees of freedom, in maps of 8 x 8 and 10 x 10 cells (`difficulty_proof`), each trial
/// with noise of its own. Easy worlds vary little, and so do those that are as difficult as can be.
const VARIANCES: Dials<&[(f64, f64)]> = Dials {
    difficulty: &[
        (0.0, 0.001),
        (1.5, 0.053),
        (2.5, 0.119),
        (3.5, 0.226),
        (4.5, 0.586),
        (5.5, 0.595),
        (6.5, 0.218),
        (7.5, 0.181),
    ],
    mapping: &[
        (0.0, 0.001),
        (0.5, 0.116),
        (1.5, 0.276),
        (2.5, 0.531),
        (3.5, 0.538),
        (4.5, 1.129),
        (5.5, 1.73),
        (6.5, 1.168),
        (7.5, 0.349),
        (8.5, 0.106),
    ],
    navigation: &[
        (0.0, 0.001),
        (1.5, 0.008),
        (2.5, 0.029),
        (3.5, 0.042),
        (4.5, 0.063),
        (5.5, 0.069),
        (6.5, 0.13),
        (7.5, 0.359),
    ],
};

/// How much greater the variances are under conditions unlike those of the reference panel, in the same maps: for
/// difficulty, mapping and navigation 1.5, 1.8 and 0.6 times by a `TurtleBot3`, and 1.7, 2.4 and 0.3 times with another
/// laser and `pose_graph` as well.
const OTHER_CONDITIONS: Dials<f64> = Dials { difficulty: 1.6, mapping: 2.0, navigation: 1.0 };

/// The least variances under such conditions. A single trial may score 0 in a world whose mean score is 2.
const LEAST: Dials<f64> = Dials { difficulty: 0.05, mapping: 0.1, navigation: 0.01 };

static REFERENCE: LazyLock<Panel> = LazyLock::new(Panel::reference);

/// Returns the usual variance of each dial by noise alone, for a mean score under a condition.
pub(super) fn usual_variance_under(condition: &Condition, scores: Dials<f64>) -> Dials<f64> {
    // The noise is also that of a policy that is not in the panel, and within a tenth that of `pose_graph`.
    let is_usual = REFERENCE.conditions.iter().any(|usual| {
        let (name, policy) = (condition.name.clone(), condition.policy);
        let slam = match condition.slam {
            SlamKind::PoseGraph => SlamKind::PoseGraph,
            SlamKind::ScanToMap | SlamKind::DeadReckoning => usual.slam,
        };
        Condition { name, policy, slam, ..usual.clone() } == *condition
    });
    let usual = usual_variance(scores);
    if is_usual {
        return usual;
    }
    usual
        .zip(OTHER_CONDITIONS.zip(LEAST))
        .map(|(variance, (factor, least))| (factor * variance).max(least))
}

/// Returns the usual variance of each dial at a mean score: linear between those of the table, and
/// constant beyond.
fn usual_variance(scores: Dials<f64>) -> Dials<f64> {
    scores.zip(VARIANCES).map(|(score, table)| {
        let after = table.partition_point(|&(at, _)| at <= score);
        match (after.checked_sub(1).map(|before| table[before]), table.get(after)) {
            (Some((from, low)), Some(&(to, high))) => {
                low + (high - low) * (score - from) / (to - from)
            }
            (Some((_, end)), None) => end,
            (None, first) => first.map_or(0.0, |&(_, variance)| variance),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::odometry::OdometryProfile;
    use crate::policy::PolicyKind;
    use crate::robot::Robot;

    #[test]
    fn other_conditions_have_more_noise() {
        let scores = Dials { difficulty: 3.5, mapping: 0.0, navigation: 3.5 };
        for usual in &Panel::reference().conditions {
            assert_eq!(usual_variance_under(usual, scores), usual_variance(scores));
            let tour = Condition { policy: PolicyKind::Tour, ..usual.clone() };
            let graph = Condition { slam: SlamKind::PoseGraph, ..usual.clone() };
            for known in [tour, graph] {
                assert_eq!(usual_variance_under(&known, scores), usual_variance(scores));
            }
            let driven = Condition { driver: Some("driver".to_owned()), ..usual.clone() };
            let small =
                Condition { robot: Robot { length: 0.3, ..usual.robot.clone() }, ..usual.clone() };
            let estimator = Condition { slam: SlamKind::DeadReckoning, ..usual.clone() };
            let odometry = OdometryProfile::default();
            let rough = OdometryProfile { b_t: 0.5, ..odometry };
            let wheels = Condition { odometry: rough, ..usual.clone() };
            for other in [driven, small, estimator, wheels] {
                let found = usual_variance_under(&other, scores);
                assert_eq!((found.mapping, found.navigation), (0.1, 0.042));
                assert!((found.difficulty - 1.6 * 0.226).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn variances_are_linear_between_those_of_the_table() {
        let at = |score: f64| {
            usual_variance(Dials { difficulty: score, mapping: score, navigation: score })
        };
        assert_eq!(at(3.5).difficulty, 0.226);
        assert!((at(2.0).navigation - 0.5 * (0.008 + 0.029)).abs() < 1e-12);
        assert_eq!((at(-1.0), at(30.0)), (at(0.0), at(10.0)));
        assert_eq!(at(30.0).mapping, 0.106);
        assert!((0..=100).all(|k| at(0.1 * f64::from(k)).mapping > 0.0));
    }
}
