//! Exact Euclidean distances on a grid.

/// Distance to nothing: larger than any squared distance on a grid of at most 2^28 cells in a row.
const FAR: f32 = f32::INFINITY;

/// For each cell the squared distance, in cells, from its middle to the nearest occupied cell's
/// middle; exact up to 2^24, infinite where nothing is occupied.
///
/// Lower envelopes of parabolas, first along columns, then along rows: P. Felzenszwalb and D.
/// Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing 8, 2012. Linear in
/// the number of cells.
pub(crate) fn squared_distances(cols: usize, rows: usize, occupied: &[bool]) -> Vec<f32> {
    let mut distances: Vec<f32> =
        occupied.iter().map(|&solid| if solid { 0.0 } else { FAR }).collect();
    // Along columns the input is 0 or far, so that counting up and down is enough.
    for row in 1..rows {
        for col in 0..cols {
            let above = distances[(row - 1) * cols + col];
            let cell = &mut distances[row * cols + col];
            *cell = cell.min(above + 1.0);
        }
    }
    for row in (0..rows.saturating_sub(1)).rev() {
        for col in 0..cols {
            let below = distances[(row + 1) * cols + col];
            let cell = &mut distances[row * cols + col];
            *cell = cell.min(below + 1.0);
        }
    }
    let mut envelope = Envelope::default();
    for row in distances.chunks_exact_mut(cols.max(1)) {
        envelope.transform(row);
    }
    distances
}

#[derive(Default)]
struct Envelope {
    /// The parabolas that are lowest somewhere: their place and height.
    places: Vec<(f64, f64)>,
    /// From where on each is lowest.
    starts: Vec<f64>,
}

impl Envelope {
    /// Replaces a row of distances along columns by squared distances in the plane.
    fn transform(&mut self, row: &mut [f32]) {
        self.places.clear();
        self.starts.clear();
        for (at, &distance) in row.iter().enumerate() {
            if distance == FAR {
                continue;
            }
            let (x, height) = (at as f64, f64::from(distance) * f64::from(distance));
            let mut start = f64::NEG_INFINITY;
            while let (Some(&(q, h)), Some(&from)) = (self.places.last(), self.starts.last()) {
                start = ((height + x * x) - (h + q * q)) / (2.0 * (x - q));
                if start > from {
                    break;
                }
                self.places.pop();
                self.starts.pop();
                start = f64::NEG_INFINITY;
            }
            self.places.push((x, height));
            self.starts.push(start);
        }
        if self.places.is_empty() {
            return;
        }
        let mut k = 0;
        for (at, distance) in row.iter_mut().enumerate() {
            let x = at as f64;
            while k + 1 < self.starts.len() && self.starts[k + 1] < x {
                k += 1;
            }
            let (q, height) = self.places[k];
            *distance = ((x - q) * (x - q) + height) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn distances_are_those_of_brute_force(
            cols in 1..24_usize, rows in 1..24_usize, seed: u64, share in 0.0..0.3_f64,
        ) {
            let mut stream = crate::Seed(seed).stream("test", 0);
            let occupied: Vec<bool> = (0..cols * rows).map(|_| stream.chance(share)).collect();
            let distances = squared_distances(cols, rows, &occupied);
            for (i, &distance) in distances.iter().enumerate() {
                let (x, y) = ((i % cols) as f32, (i / cols) as f32);
                let brute = (0..cols * rows)
                    .filter(|&j| occupied[j])
                    .map(|j| {
                        let (dx, dy) = ((j % cols) as f32 - x, (j / cols) as f32 - y);
                        dx * dx + dy * dy
                    })
                    .fold(f32::INFINITY, f32::min);
                prop_assert_eq!(distance, brute);
            }
        }
    }
}
