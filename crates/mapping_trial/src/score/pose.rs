//! Errors of estimated poses.

use envgen::geometry::{Pose, wrap_angle};

use super::trajectory_pair::TrajectoryPair;

/// Length of true path in metres between the two poses of a near relation.
pub(super) const NEAR: f64 = 1.0;

/// Length of true path in metres between the two poses of a far relation.
pub(super) const FAR: f64 = 20.0;

/// Path length in metres from one relation to the next.
const SPACING: f64 = 0.25;

/// A root mean square, empty at first.
#[derive(Default)]
struct Rms {
    sum: f64,
    count: u64,
}

impl Rms {
    fn add(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1;
    }

    fn value(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum / self.count as f64).sqrt())
    }
}

/// Returns the root mean square of the position errors in metres over all robots and ticks, in the
/// start frame, without alignment. It is 0 without poses.
pub(super) fn absolute(tracks: &[TrajectoryPair<'_>]) -> f64 {
    let mut errors = Rms::default();
    for track in tracks {
        for (truth, estimated) in track.truth.iter().zip(track.estimated) {
            errors.add(truth.position.distance(estimated.position));
        }
    }
    errors.value().unwrap_or(0.0)
}

/// Returns the root mean square in metres of the position errors of all robots, relative to the pose
/// [`FAR`] before. Robots that drove less count with their absolute errors, as often per metre. If no
/// robot drove that far, it is the [absolute] error.
pub(super) fn drift(tracks: &[TrajectoryPair<'_>]) -> f64 {
    let (mut positions, mut headings) = (Rms::default(), Rms::default());
    let mut short = Vec::new();
    for track in tracks {
        let before = positions.count;
        add_relative(track, FAR, &mut positions, &mut headings);
        if positions.count == before {
            short.push(track);
        }
    }
    if positions.count == 0 {
        return absolute(tracks);
    }
    short.into_iter().for_each(|track| add_spaced(track, &mut positions));
    positions.value().unwrap_or(0.0)
}

/// Adds the absolute errors of poses that are [`SPACING`] of path apart.
fn add_spaced(track: &TrajectoryPair<'_>, errors: &mut Rms) {
    let (mut gone, mut next) = (0.0, 0.0);
    let mut before: Option<Pose> = None;
    for (truth, estimated) in track.truth.iter().zip(track.estimated) {
        gone += before.map_or(0.0, |before| before.position.distance(truth.position));
        before = Some(*truth);
        if gone >= next {
            next = gone + SPACING;
            errors.add(truth.position.distance(estimated.position));
        }
    }
}

/// Returns the root mean square errors of the relations between poses that are `length` metres of true
/// path apart: of the position in metres and of the heading in radians, over all robots. `None` if no
/// robot drove that far. (Kuemmerle et al., On measuring the accuracy of SLAM algorithms, Autonomous
/// Robots 27, 2009, <https://doi.org/10.1007/s10514-009-9155-6>.)
pub(super) fn relative(tracks: &[TrajectoryPair<'_>], length: f64) -> Option<(f64, f64)> {
    let (mut positions, mut headings) = (Rms::default(), Rms::default());
    for track in tracks {
        add_relative(track, length, &mut positions, &mut headings);
    }
    positions.value().zip(headings.value())
}

fn add_relative(track: &TrajectoryPair<'_>, length: f64, positions: &mut Rms, headings: &mut Rms) {
    let poses = || track.truth.iter().zip(track.estimated);
    let mut ends = poses();
    let (mut gone, mut next_start) = (0.0, 0.0);
    let (mut end_gone, mut end) = (0.0, ends.next());
    let mut before: Option<Pose> = None;
    let mut end_before = end.map(|(truth, _)| *truth);
    for (truth, estimated) in poses() {
        gone += before.map_or(0.0, |before: Pose| before.position.distance(truth.position));
        before = Some(*truth);
        if gone < next_start {
            continue;
        }
        next_start = gone + SPACING;
        // Rounding over thousands of steps must not lose the last relation.
        while end_gone + 1e-9 < gone + length {
            end = ends.next();
            let Some((truth, _)) = end else { break };
            let step = end_before.map_or(0.0, |p| p.position.distance(truth.position));
            end_gone += step;
            end_before = Some(*truth);
        }
        let Some((end_truth, end_estimated)) = end else { break };
        let expected = relation(*truth, *end_truth);
        let found = relation(*estimated, *end_estimated);
        positions.add(expected.position.distance(found.position));
        headings.add(wrap_angle(expected.heading - found.heading));
    }
}

/// Returns the pose `to` relative to `from`. Its heading is only wrapped when two relations are
/// compared.
fn relation(from: Pose, to: Pose) -> Pose {
    Pose { position: from.to_local(to.position), heading: to.heading - from.heading }
}

#[cfg(test)]
mod tests {
    use super::*;
    use envgen::geometry::unit_vector;

    fn straight(count: u32, scale: f64, bend: f64) -> Vec<Pose> {
        let mut pose = Pose::default();
        (0..count)
            .map(|_| {
                let here = pose;
                pose.position += unit_vector(pose.heading) * (0.025 * scale);
                pose.heading += bend;
                here
            })
            .collect()
    }

    #[test]
    fn a_scale_error_grows_with_the_distance() {
        let (truth, estimated) = (straight(2000, 1.0, 0.0), straight(2000, 1.02, 0.0));
        let tracks = [TrajectoryPair { truth: &truth, estimated: &estimated }];
        let (near, turn) = relative(&tracks, NEAR).unwrap();
        assert!((near - 0.02).abs() < 1e-9 && turn == 0.0, "{near}");
        let (far, _) = relative(&tracks, FAR).unwrap();
        assert!((far - 0.4).abs() < 1e-9, "{far}");
        // 2 % of path lengths evenly from 0 to 49.975 m.
        let expected = 0.02 * 49.975 / 3.0_f64.sqrt();
        assert!((absolute(&tracks) - expected).abs() < 1e-3);
    }

    #[test]
    fn a_bend_turns_relations() {
        // 0.025 m per step: 40 steps per metre.
        let (truth, estimated) = (straight(2000, 1.0, 0.0), straight(2000, 1.0, 1e-4));
        let tracks = [TrajectoryPair { truth: &truth, estimated: &estimated }];
        let (_, turn) = relative(&tracks, NEAR).unwrap();
        assert!((turn - 40e-4).abs() < 1e-9, "{turn}");
        let (_, turn) = relative(&tracks, FAR).unwrap();
        assert!((turn - 800e-4).abs() < 1e-9, "{turn}");
    }

    #[test]
    fn short_runs_have_no_far_relations() {
        let truth = straight(100, 1.0, 0.0);
        let tracks = [TrajectoryPair { truth: &truth, estimated: &truth }];
        assert_eq!(relative(&tracks, NEAR), Some((0.0, 0.0)));
        assert_eq!(relative(&tracks, FAR), None);
        assert_eq!((absolute(&[]), drift(&[])), (0.0, 0.0));
    }

    #[test]
    fn robots_that_drove_less_count_with_their_absolute_errors() {
        let (near, near_estimated) = (straight(720, 1.0, 0.0), straight(720, 1.2, 0.0));
        let far = straight(1000, 1.0, 0.0);
        let of_near = TrajectoryPair { truth: &near, estimated: &near_estimated };
        let of_far = TrajectoryPair { truth: &far, estimated: &far };
        assert_eq!(drift(&[of_near]), absolute(&[of_near]));
        assert_eq!(drift(&[of_far]), 0.0);
        // 18 m with an error of a fifth, and 25 m without errors.
        let both = drift(&[of_near, of_far]);
        assert!(both > 1.0 && both < absolute(&[of_near]), "{both}");
        assert_eq!(relative(&[of_near, of_far], FAR), Some((0.0, 0.0)));
    }
}
