//! The shape of a part, in the frame of the part and in single precision.

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::geometry::{Rect as WorldRect, Shape, unit_vector};
use envgen::glam::DVec2;

/// A component with the shape of a part in the frame of its [`Transform`], in metres.
///
/// Colliders and meshes are derived from it. Together with the transform, it is the shape of
/// [`envgen::geometry`] in single precision.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub enum PartShape {
    /// A point with a heading along +x.
    Point,
    /// A line without thickness along the x axis, centred at the origin.
    Segment {
        /// Half the length.
        half_length: f32,
    },
    /// A filled circle, centred at the origin.
    Disc {
        /// The radius.
        radius: f32,
    },
    /// A filled rectangle, centred at the origin.
    Box {
        /// Half the size along x and y.
        half_size: Vec2,
    },
    /// A filled simple polygon. Corners are counter-clockwise, and the first is not repeated at the end.
    Polygon {
        /// At least three corners.
        vertices: Vec<Vec2>,
    },
    /// A strip of constant width along a line.
    Strip {
        /// The points of the centre line, in the direction of travel.
        centreline: Vec<Vec2>,
        /// The full width.
        width: f32,
        /// Whether the last point is connected to the first.
        closed: bool,
    },
}

/// Converts from the double precision of the world to a frame whose origin is a given point of the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalFrame {
    origin: DVec2,
}

impl LocalFrame {
    pub(crate) fn new(origin: DVec2) -> Self {
        LocalFrame { origin }
    }

    /// Returns a pose in the frame.
    pub(crate) fn pose(self, position: DVec2, heading: f64) -> Transform {
        let at = (position - self.origin).as_vec2();
        // Sine and cosine are from `libm`, so that transforms are the same on every platform.
        let half = unit_vector(0.5 * heading);
        let rotation = if heading == 0.0 {
            Quat::IDENTITY
        } else {
            Quat::from_xyzw(0.0, 0.0, half.y as f32, half.x as f32)
        };
        Transform { translation: at.extend(0.0), rotation, scale: Vec3::ONE }
    }

    /// Converts a shape of the world to a transform and a shape in the frame of that transform.
    pub(crate) fn place(self, shape: &Shape) -> (Transform, PartShape) {
        match shape {
            Shape::Segment { a, b } => {
                let along = *b - *a;
                let half_length = (0.5 * along.length()) as f32;
                let heading = libm::atan2(along.y, along.x);
                (self.pose((*a + *b) * 0.5, heading), PartShape::Segment { half_length })
            }
            Shape::Disc { center, radius } => {
                (self.pose(*center, 0.0), PartShape::Disc { radius: *radius as f32 })
            }
            Shape::Box { center, half_size, heading } => {
                (self.pose(*center, *heading), PartShape::Box { half_size: half_size.as_vec2() })
            }
            Shape::Polygon { vertices } => {
                let (transform, vertices) = self.around(vertices);
                (transform, PartShape::Polygon { vertices })
            }
        }
    }

    /// Returns points relative to the centre of their bounding box, and the transform of that centre.
    pub(crate) fn around(self, points: &[DVec2]) -> (Transform, Vec<Vec2>) {
        let middle =
            WorldRect::around(points.iter().copied()).map_or(DVec2::ZERO, WorldRect::center);
        let transform = self.pose(middle, 0.0);
        // Points are relative to the rounded centre, which corrects its rounding error.
        let rounded = transform.translation.truncate().as_dvec2() + self.origin;
        (transform, points.iter().map(|point| (*point - rounded).as_vec2()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the corners of a placed shape in the frame of the environment.
    fn corners(transform: Transform, shape: &PartShape) -> Vec<Vec2> {
        let local = match shape {
            PartShape::Segment { half_length } => {
                vec![-Vec2::X * *half_length, Vec2::X * *half_length]
            }
            PartShape::Box { half_size: h } => {
                vec![-*h, Vec2::new(h.x, -h.y), *h, Vec2::new(-h.x, h.y)]
            }
            PartShape::Polygon { vertices } => vertices.clone(),
            _ => Vec::new(),
        };
        local.iter().map(|p| transform.transform_point(p.extend(0.0)).truncate()).collect()
    }

    proptest! {
        #[test]
        fn a_placed_shape_is_where_the_world_has_it(
            x in -500.0..500.0_f64, y in -500.0..500.0_f64, heading in -4.0..4.0_f64,
            w in 0.01..20.0_f64, h in 0.01..20.0_f64,
        ) {
            let center = DVec2::new(x, y);
            let turned = Shape::Box { center, half_size: DVec2::new(w, h), heading };
            let polygon = Shape::Polygon { vertices: turned.corners() };
            let segment = Shape::Segment { a: turned.corners()[0], b: turned.corners()[2] };
            let origin = DVec2::new(1e6, -1e6);
            for shape in [turned, polygon, segment] {
                for (frame, shift) in [(LocalFrame::new(DVec2::ZERO), DVec2::ZERO), (LocalFrame::new(center), center), (LocalFrame::new(origin - center), origin - center)] {
                    let (transform, placed) = frame.place(&shape);
                    let ours = corners(transform, &placed);
                    prop_assert_eq!(ours.len(), shape.corners().len());
                    for (ours, theirs) in ours.iter().zip(shape.corners()) {
                        let theirs = theirs - shift;
                        // The tolerance is a few units in the last place at this distance.
                        let tolerance = 1e-5 + 5e-7 * theirs.length();
                        prop_assert!(ours.as_dvec2().distance(theirs) < tolerance);
                    }
                }
            }
        }
    }

    #[test]
    fn discs_and_poses_are_placed() {
        let disc = Shape::Disc { center: DVec2::new(3.0, 4.0), radius: 0.5 };
        let (transform, shape) = LocalFrame::new(DVec2::new(1.0, 1.0)).place(&disc);
        assert_eq!(transform, Transform::from_xyz(2.0, 3.0, 0.0));
        assert_eq!(shape, PartShape::Disc { radius: 0.5 });
        let pose = LocalFrame::new(DVec2::ZERO).pose(DVec2::ONE, std::f64::consts::FRAC_PI_2);
        assert!((pose.rotation * Vec3::X).distance(Vec3::Y) < 1e-6);
    }
}
