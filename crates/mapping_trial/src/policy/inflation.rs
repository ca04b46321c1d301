//! Inflation of obstacles: how far they reach into free space for the centre of a robot, which follows
//! from its size.

use crate::map::RESOLUTION;
use crate::robot::{MAX_RADIUS, PIONEER_3AT, Robot};

/// Distances in metres up to which an occupied cell counts for the Pioneer 3-AT: first where its centre
/// must not be (its radius less a cell of the map, and its radius), then where it should rather not be.
/// Other robots have the same margins around their bodies.
const DISTANCES: [f64; LEVELS] = [0.31, 0.36, 0.45, 0.55, 0.75];

/// Number of distance levels.
pub(super) const LEVELS: usize = 5;

/// The greatest reach of any robot, in cells of the map.
pub(super) const MOST: usize = 48;

const _: () =
    assert!(MOST as f64 * RESOLUTION > MAX_RADIUS - PIONEER_3AT.circumscribed_radius + 0.75);

/// Squared distances in cells at which an occupied cell counts, by level, and the discs of that size.
#[derive(Clone, Debug)]
pub(super) struct Inflation {
    /// The farthest reach in cells.
    pub(super) margin: i32,
    /// How far a row of a disc reaches to either side, by level and row; -1 outside of the disc.
    pub(super) half_widths: [[i8; MOST + 1]; LEVELS],
    /// How much larger the robot is than the Pioneer 3-AT, in metres.
    larger: f64,
}

impl Inflation {
    /// Computes the inflation for a valid robot.
    pub(super) fn of(robot: &Robot) -> Self {
        Inflation::of_radius(robot.circumscribed_radius)
    }

    /// Computes the inflation for a circumscribed radius in metres, at least 0.05.
    pub(super) fn of_radius(radius: f64) -> Self {
        let larger = radius - PIONEER_3AT.circumscribed_radius;
        let squared = DISTANCES.map(|distance| {
            let cells = (distance + larger) / RESOLUTION;
            // Compensates for rounding at whole numbers such as 9 x 9 cells.
            (cells * cells + 1e-9) as i32
        });
        let half_widths = squared.map(|squared| {
            std::array::from_fn(|dy| {
                let left = squared - (dy * dy) as i32;
                if left < 0 { -1 } else { left.isqrt() as i8 }
            })
        });
        Inflation { margin: squared[LEVELS - 1].isqrt(), half_widths, larger }
    }

    /// Enlarges a distance in metres that suits the Pioneer 3-AT by the robot's excess radius.
    pub(super) fn grown(&self, pioneer: f64) -> f64 {
        pioneer + self.larger
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squared reaches of a robot, read off the discs' widest rows and their next ones.
    fn reach(robot: &Robot, level: usize, p: (i32, i32)) -> bool {
        let Inflation { half_widths, .. } = Inflation::of(robot);
        let width = half_widths[level].get(p.1.unsigned_abs() as usize).copied().unwrap_or(-1);
        p.0.abs() <= i32::from(width)
    }

    #[test]
    fn every_cell_within_a_distance_is_reached_and_no_other() {
        for radius in
            [0.05, 0.15, 0.2, 0.208, PIONEER_3AT.circumscribed_radius, 0.5, 0.8, 1.3, MAX_RADIUS]
        {
            let robot = Robot { circumscribed_radius: radius, ..Robot::default() };
            for (level, distance) in [
                (0, radius - 0.045),
                (1, radius + 0.005),
                (2, radius + 0.095),
                (3, radius + 0.195),
                (4, radius + 0.395),
            ] {
                for y in -50..=50_i32 {
                    for x in -50..=50_i32 {
                        let apart = RESOLUTION * f64::from(x * x + y * y).sqrt();
                        // Distances on the line may fall to either side.
                        if (apart - distance).abs() > 1e-6 {
                            assert_eq!(reach(&robot, level, (x, y)), apart < distance, "{radius}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_pioneer_keeps_the_distances_that_it_had() {
        let pioneer = Inflation::of(&PIONEER_3AT);
        assert_eq!(pioneer.margin, 15);
        let widest: Vec<i8> = pioneer.half_widths.iter().map(|widths| widths[0]).collect();
        // The roots of 38, 51, 81, 121 and 225.
        assert_eq!(widest, [6, 7, 9, 11, 15]);
        assert_eq!((pioneer.half_widths[0][1], pioneer.half_widths[0][6]), (6, 1));
        assert_eq!(pioneer.grown(0.6).to_bits(), 0.6_f64.to_bits());
    }
}
