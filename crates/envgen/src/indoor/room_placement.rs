//! Transforms from the frame in which a room is designed to the map.

use glam::{DVec2, Vec2Swizzles};

use crate::geometry::{Shape, box_axis, wrap_angle};

/// Side in metres of a cell for which the contents of rooms are designed.
pub const DESIGN_UNIT: f64 = 3.0;

/// Transforms shapes from a room's own frame to the map.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoomPlacement {
    /// Lower left corner of the turned room, in metres.
    pub(super) corner: DVec2,
    /// Metres of the map per metre of the design.
    pub(super) scale: f64,
    /// Number of quarter turns counter-clockwise.
    pub(super) quarters: u8,
    /// Size of the room in metres of the design, before it is turned.
    pub(super) size: DVec2,
}

impl RoomPlacement {
    /// Transforms a point of the design to the map.
    pub(super) fn point(&self, p: DVec2) -> DVec2 {
        let turned = match self.quarters % 4 {
            0 => p,
            1 => DVec2::new(self.size.y - p.y, p.x),
            2 => self.size - p,
            _ => DVec2::new(p.y, self.size.x - p.x),
        };
        self.corner + turned * self.scale
    }

    /// Returns the transform from the map to the design.
    pub(super) fn inverse(&self) -> RoomPlacement {
        let odd = self.quarters % 2 == 1;
        let size = if odd { self.size.yx() } else { self.size } * self.scale;
        let quarters = (4 - self.quarters % 4) % 4;
        let back = RoomPlacement { corner: DVec2::ZERO, scale: 1.0 / self.scale, quarters, size };
        // The corner must come to lie at the design's origin once it is turned.
        RoomPlacement { corner: back.point(DVec2::ZERO) - back.point(self.corner), ..back }
    }

    /// Transforms a heading of the design to the map.
    pub(super) fn heading(&self, heading: f64) -> f64 {
        let quarter = std::f64::consts::FRAC_PI_2;
        let turned = heading + quarter * f64::from(self.quarters % 4);
        wrap_angle(turned)
    }

    /// Transforms a shape of the design to the map. Axis-aligned boxes remain axis-aligned to the last bit.
    pub(super) fn shape(&self, shape: &Shape) -> Shape {
        match shape {
            Shape::Segment { a, b } => Shape::Segment { a: self.point(*a), b: self.point(*b) },
            Shape::Disc { center, radius } => {
                Shape::Disc { center: self.point(*center), radius: radius * self.scale }
            }
            Shape::Box { center, half_size, heading } => {
                let odd = self.quarters % 2 == 1;
                let (half_size, heading) = if box_axis(*heading) == DVec2::X {
                    (if odd { half_size.yx() } else { *half_size }, 0.0)
                } else {
                    (*half_size, self.heading(*heading))
                };
                let center = self.point(*center);
                Shape::Box { center, half_size: half_size * self.scale, heading }
            }
            Shape::Polygon { vertices } => {
                Shape::Polygon { vertices: vertices.iter().map(|&v| self.point(v)).collect() }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn four_quarters_are_a_whole_turn(x in 0.0..6.0_f64, y in 0.0..9.0_f64, h in -3.0..3.0_f64) {
            let (mut p, mut size, mut heading) = (DVec2::new(x, y), DVec2::new(6.0, 9.0), h);
            for _ in 0..4 {
                let frame = RoomPlacement { corner: DVec2::ZERO, scale: 1.0, quarters: 1, size };
                p = frame.point(p);
                heading = frame.heading(heading);
                size = size.yx();
            }
            prop_assert!(p.distance(DVec2::new(x, y)) < 1e-12);
            prop_assert!((heading - h).abs() < 1e-12);
        }

        #[test]
        fn the_inverse_leads_back(
            x in 0.0..6.0_f64, y in 0.0..9.0_f64, h in -3.0..3.0_f64, quarters in 0..4_u8,
            scale in 0.3..3.0_f64,
        ) {
            let corner = DVec2::new(7.0, -3.0);
            let frame = RoomPlacement { corner, scale, quarters, size: DVec2::new(6.0, 9.0) };
            let (there, back) = (frame.point(DVec2::new(x, y)), frame.inverse());
            prop_assert!(back.point(there).distance(DVec2::new(x, y)) < 1e-12);
            prop_assert!(wrap_angle(back.heading(frame.heading(h)) - h).abs() < 1e-12);
        }

        #[test]
        fn quarters_in_one_go_or_one_by_one(
            x in 0.0..6.0_f64, y in 0.0..9.0_f64, h in -3.0..3.0_f64, quarters in 0..4_u8,
        ) {
            let half_size = DVec2::new(0.3, 0.1);
            let shape = Shape::Box { center: DVec2::new(x, y), half_size, heading: h };
            let size = DVec2::new(6.0, 9.0);
            let once = RoomPlacement { corner: DVec2::ZERO, scale: 1.0, quarters, size }.shape(&shape);
            let mut turned = (shape, size);
            for _ in 0..quarters {
                let frame =
                    RoomPlacement { corner: DVec2::ZERO, scale: 1.0, quarters: 1, size: turned.1 };
                turned = (frame.shape(&turned.0), turned.1.yx());
            }
            for (a, b) in once.corners().iter().zip(turned.0.corners()) {
                prop_assert!(a.distance(b) < 1e-9);
            }
        }
    }
}
