//! Prisms as the bodies that simulators provide: boxes, cylinders, and polygons for everything else.

use glam::{DVec2, DVec3};

use crate::geometry::Shape;
use crate::pieces::LINE_THICKNESS;
use crate::world::Extent;

/// The least length of the box of a line, in metres.
const SHORTEST_LINE: f64 = 1e-30;

/// A prism in the form of a simulator's body.
pub(super) enum Body<'a> {
    /// A box, rotated about the vertical axis.
    Box { center: DVec3, size: DVec3, heading: f64 },
    /// An upright cylinder.
    Cylinder { center: DVec3, radius: f64, length: f64 },
    /// A polygon, extruded upwards.
    Polygon {
        #[cfg_attr(
            not(any(feature = "mjcf", feature = "sdf")),
            expect(dead_code, reason = "USD writes its mesh")
        )]
        corners: &'a [DVec2],
    },
}

impl<'a> Body<'a> {
    pub(super) fn of(shape: &'a Shape, extent: Extent) -> Self {
        let middle = 0.5 * (extent.bottom() + extent.top());
        match shape {
            Shape::Disc { center, radius } => Body::Cylinder {
                center: center.extend(middle),
                radius: *radius,
                length: extent.height(),
            },
            Shape::Box { center, half_size, heading } => Body::Box {
                center: center.extend(middle),
                size: (2.0 * *half_size).extend(extent.height()),
                heading: *heading,
            },
            Shape::Segment { a, b } => {
                let along = *b - *a;
                // Simulators refuse a box without length, and some read numbers of 32 bits.
                let length = along.length().max(SHORTEST_LINE);
                Body::Box {
                    center: (0.5 * (*a + *b)).extend(middle),
                    size: DVec3::new(length, LINE_THICKNESS, extent.height()),
                    heading: libm::atan2(along.y, along.x),
                }
            }
            Shape::Polygon { vertices } => Body::Polygon { corners: vertices },
        }
    }
}
