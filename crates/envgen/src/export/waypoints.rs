//! The distances of waypoints along their road.

use crate::curve::Path;
use crate::geometry::{Pose, wrap_angle};
use crate::world::RoadStrip;

/// The greatest distance of a waypoint from the road, as a share of the coordinates.
const OFF: f64 = 1e-9;

/// The greatest difference between the heading of a waypoint and that of the road, in radians.
const ASKEW: f64 = 1e-6;

/// The greatest angle, in radians, by which a part of the road turns in which a waypoint is searched: from its middle,
/// the search then finds every point of it.
const PART: f64 = 0.5;

/// Returns the distance along a road of each of its waypoints in metres, and for a closed road that of the first
/// waypoint one lap farther. Distances do not decrease, and the last is the road's length.
pub(super) fn distances(strip: &RoadStrip) -> Vec<f64> {
    let path = strip.path();
    let poses: Vec<Pose> = strip.centreline.iter().map(|point| point.pose).collect();
    let exact =
        || evenly(&path, &poses, strip.closed).or_else(|| search(&path, &poses, strip.closed));
    let known = if strip.pieces.is_empty() { None } else { exact() };
    known.unwrap_or_else(|| by_chords(&path, &poses, strip.closed))
}

/// Returns equal steps if the waypoints are there.
fn evenly(path: &Path<'_>, poses: &[Pose], closed: bool) -> Option<Vec<f64>> {
    let steps = if closed { poses.len() } else { poses.len().checked_sub(1)? };
    let distances: Vec<f64> =
        (0..=steps).map(|i| path.length() * i as f64 / steps as f64).collect();
    let mut both = distances.iter().zip(poses);
    both.all(|(&s, pose)| is_at(path, s, pose)).then_some(distances)
}

/// Returns the distances at which the road passes the waypoints one after another; `None` if it does not.
fn search(path: &Path<'_>, poses: &[Pose], closed: bool) -> Option<Vec<f64>> {
    let (first, others) = poses.split_first()?;
    let last = if closed { None } else { Some(others.last()?) };
    if !(is_at(path, 0.0, first) && last.is_none_or(|pose| is_at(path, path.length(), pose))) {
        return None;
    }
    let between = &others[..others.len() - usize::from(!closed)];
    let mut distances = vec![0.0];
    let (mut s, mut piece, mut before) = (0.0, 0, first);
    for pose in between {
        let least = s + pose.position.distance(before.position) - slack(path, pose);
        (s, piece) = next(path, s.max(least), piece, pose)?;
        distances.push(s);
        before = pose;
    }
    distances.push(path.length());
    Some(distances)
}

/// Returns the first distance from `least` on at which the road passes a waypoint, and the index of the piece; `piece`
/// is one that begins before.
fn next(path: &Path<'_>, least: f64, piece: usize, pose: &Pose) -> Option<(f64, usize)> {
    for (i, curve) in path.curves().iter().enumerate().skip(piece) {
        let (start, end) = (path.start_of(i), path.start_of(i + 1));
        if end < least {
            continue;
        }
        let parts = (curve.length * curve.max_curvature() / PART).ceil().max(1.0);
        let length = curve.length / parts;
        let first = ((least - start) / length).floor().clamp(0.0, parts - 1.0);
        for part in first as u64..parts as u64 {
            let middle = start + (part as f64 + 0.5) * length;
            let away = path.pose_at(middle).position.distance(pose.position);
            if away > length + slack(path, pose) {
                continue;
            }
            let s = path.foot_from(middle, pose.position).max(least).min(path.length());
            if s <= end + slack(path, pose) && is_at(path, s, pose) {
                return Some((s, i));
            }
        }
    }
    None
}

/// Returns the lengths of the straight lines between waypoints, stretched to the road's length: for roads of which only
/// points are known, and for waypoints that are not on the road.
fn by_chords(path: &Path<'_>, poses: &[Pose], closed: bool) -> Vec<f64> {
    let ends = poses.iter().skip(1).chain(poses.first().filter(|_| closed));
    let chords = poses.iter().zip(ends).map(|(a, b)| a.position.distance(b.position));
    let mut along = 0.0;
    let sums = chords.map(|chord| {
        along += chord;
        along
    });
    let mut distances: Vec<f64> = poses.first().map(|_| 0.0).into_iter().chain(sums).collect();
    let stretch = if along > 0.0 { path.length() / along } else { 1.0 };
    distances.iter_mut().for_each(|s| *s *= stretch);
    if let Some(last) = distances.last_mut() {
        *last = path.length();
    }
    distances
}

fn is_at(path: &Path<'_>, s: f64, pose: &Pose) -> bool {
    let there = path.pose_at(s);
    there.position.distance(pose.position) <= slack(path, pose)
        && wrap_angle(there.heading - pose.heading).abs() <= ASKEW
}

fn slack(path: &Path<'_>, pose: &Pose) -> f64 {
    OFF * (path.length() + pose.position.length())
}
