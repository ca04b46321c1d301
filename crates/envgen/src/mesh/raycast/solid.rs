//! The solids with which rays are intersected.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use crate::geometry::{Rect, edges, polygon_contains, unit_vector};
use crate::mesh::extrude::road_surface;
use crate::mesh::revolve::{AROUND, BANDS};
use crate::outline::outline;
use crate::pieces::Form;
use crate::world::{Crown, Extent};

/// A body, or a part of one.
#[derive(Clone, Debug)]
pub(super) enum Solid {
    /// A counter-clockwise polygon, extruded from a bottom to a top.
    Prism { corners: Vec<DVec2>, extent: Extent },
    /// The points that are behind all planes. A plane is an outward normal, and the distance of the plane from the
    /// origin in lengths of that normal.
    Convex { bounds: Rect, extent: Extent, planes: Vec<(DVec3, f64)> },
}

impl Solid {
    /// Returns the solids of a body; for a road, one for each triangle.
    pub(super) fn of(form: &Form<'_>) -> Vec<Solid> {
        match form {
            Form::Prism { shape, extent } => {
                let (pivot, corners) = outline(shape);
                let corners = corners.into_iter().map(|corner| pivot + corner).collect();
                vec![Solid::Prism { corners, extent: *extent }]
            }
            Form::Crown { center, crown } => vec![Solid::crown(*center, *crown)],
            Form::Road { strip, extent } => {
                let Some(flat) = road_surface(strip) else { return Vec::new() };
                let corner = |i: u32| flat.vertices[i as usize];
                let prism = |t: &[u32; 3]| Solid::Prism {
                    corners: t.map(corner).to_vec(),
                    extent: *extent,
                };
                flat.triangles.iter().map(prism).collect()
            }
        }
    }

    /// Returns the flat sides of a crown, from its profile in the middle between two corners.
    fn crown(center: DVec2, crown: Crown) -> Solid {
        let (half, extent) = (0.5 * crown.extent.height(), crown.extent);
        let middle = 0.5 * (extent.bottom() + extent.top());
        let apothem = crown.radius * libm::cos(PI / f64::from(AROUND));
        let profile: Vec<DVec2> = (0..=BANDS)
            .map(|band| {
                let (sin, cos) = libm::sincos(PI * (f64::from(band) / f64::from(BANDS) - 0.5));
                match band {
                    0 => DVec2::new(0.0, extent.bottom()),
                    BANDS => DVec2::new(0.0, extent.top()),
                    _ => DVec2::new(apothem * cos, middle + half * sin),
                }
            })
            .collect();
        let mut planes = Vec::with_capacity((AROUND * BANDS) as usize);
        for sector in 0..AROUND {
            let outward = unit_vector(TAU * (f64::from(sector) + 0.5) / f64::from(AROUND));
            for band in profile.windows(2) {
                let along = band[1] - band[0];
                let normal = (outward * along.y).extend(-along.x);
                let point = (center + outward * band[0].x).extend(band[0].y);
                planes.push((normal, normal.dot(point)));
            }
        }
        let bounds = Rect::new(center, center).grown(crown.radius);
        Solid::Convex { bounds, extent, planes }
    }

    pub(super) fn bounds(&self) -> Rect {
        match self {
            Solid::Prism { corners, .. } => around(corners.iter().copied()),
            Solid::Convex { bounds, .. } => *bounds,
        }
    }

    /// Returns the bottom and top.
    pub(super) fn heights(&self) -> [f64; 2] {
        let (Solid::Prism { extent, .. } | Solid::Convex { extent, .. }) = self;
        [extent.bottom(), extent.top()]
    }

    /// Returns the distance along a ray to a surface that faces it, in lengths of its direction; `None` if the ray
    /// misses.
    pub(super) fn distance(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        match self {
            Solid::Prism { corners, extent } => to_prism(from, direction, corners, *extent),
            Solid::Convex { planes, .. } => to_convex(from, direction, planes),
        }
    }
}

fn to_prism(from: DVec3, direction: DVec3, corners: &[DVec2], extent: Extent) -> Option<f64> {
    let (plan, along) = (from.truncate(), direction.truncate());
    let [bottom, top] = [extent.bottom(), extent.top()];
    let cap = if direction.z < 0.0 { top } else { bottom };
    let to_cap = (cap - from.z) / direction.z;
    let is_met =
        to_cap >= 0.0 && to_cap.is_finite() && polygon_contains(corners, plan + along * to_cap);
    let sides = edges(corners).filter_map(|(a, b)| {
        let side = b - a;
        let facing = along.perp_dot(side);
        if facing >= 0.0 {
            return None;
        }
        let distance = (a - plan).perp_dot(side) / facing;
        let at = (a - plan).perp_dot(along) / facing;
        let height = from.z + distance * direction.z;
        let is_met =
            distance >= 0.0 && (0.0..=1.0).contains(&at) && (bottom..=top).contains(&height);
        is_met.then_some(distance)
    });
    sides.chain(is_met.then_some(to_cap)).reduce(f64::min)
}

fn to_convex(from: DVec3, direction: DVec3, planes: &[(DVec3, f64)]) -> Option<f64> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for &(normal, offset) in planes {
        let (before, facing) = (offset - normal.dot(from), normal.dot(direction));
        if facing == 0.0 {
            if before < 0.0 {
                return None;
            }
        } else if facing < 0.0 {
            enter = enter.max(before / facing);
        } else {
            leave = leave.min(before / facing);
        }
    }
    (enter >= 0.0 && enter <= leave).then_some(enter)
}

/// Returns the bounds of points in the plane.
fn around(points: impl IntoIterator<Item = DVec2>) -> Rect {
    Rect::around(points).unwrap_or(Rect::new(DVec2::ZERO, DVec2::ZERO))
}
