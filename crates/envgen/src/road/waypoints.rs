//! The positions of a road's waypoints.

use super::apportion::largest_remainder;

/// Returns waypoints every `step` metres, and the number of them on each segment. A waypoint where two segments
/// meet belongs to the later one.
pub(super) fn evenly(starts: &[f64], count: u64, step: f64) -> (Vec<f64>, Vec<u64>) {
    let stations: Vec<f64> = (0..count).map(|j| j as f64 * step).collect();
    let before: Vec<u64> = starts[..starts.len() - 1]
        .iter()
        .map(|&start| stations.partition_point(|&s| s < start) as u64)
        .chain([count])
        .collect();
    (stations, before.windows(2).map(|pair| pair[1] - pair[0]).collect())
}

/// Returns waypoints by the published rule: each segment gets its share of the waypoints, which are spread evenly
/// on it from its start.
pub(super) fn by_segment(starts: &[f64], count: u64) -> (Vec<f64>, Vec<u64>) {
    let lengths: Vec<f64> = starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let counts = largest_remainder(&lengths, count);
    let mut stations: Vec<f64> = starts
        .iter()
        .zip(lengths)
        .zip(&counts)
        .flat_map(|((&start, length), &share)| {
            (0..share).map(move |k| start + length * (k as f64 / share as f64))
        })
        .collect();
    // The start is a waypoint even where the first segment is too short for one.
    if let Some(first) = stations.first_mut() {
        *first = 0.0;
    }
    (stations, counts)
}
