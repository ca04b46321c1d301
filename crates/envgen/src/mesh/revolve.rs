//! Bodies of revolution: the crowns of trees.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::Mesh;
use crate::geometry::unit_vector;
use crate::world::Crown;

/// Number of corners around the axis.
pub(super) const AROUND: u32 = 12;

/// Number of bands from the bottom to the top.
pub(super) const BANDS: u32 = 6;

impl Mesh {
    /// Creates an ellipsoid with a vertical axis and smooth normals.
    pub fn ellipsoid(center: DVec2, crown: Crown) -> Self {
        Mesh::coarse_ellipsoid(center, crown, AROUND, BANDS)
    }

    /// Creates an ellipsoid with a vertical axis, with `around` corners around the axis (at least 3) and `bands`
    /// bands from the bottom to the top (at least 2); smaller numbers are raised. It is intended for objects that
    /// are seen from far away.
    pub fn coarse_ellipsoid(center: DVec2, crown: Crown, around: u32, bands: u32) -> Self {
        let (around, bands) = (around.max(3), bands.max(2));
        let mut mesh = Mesh::empty(center);
        let (half, extent) = (0.5 * crown.extent.height(), crown.extent);
        let middle = 0.5 * (extent.bottom() + extent.top());
        let girth = TAU * crown.radius / f64::from(around);
        // A pole has a corner for each triangle, a ring one more than there are sectors, for the seam.
        let ring = |mesh: &mut Mesh, band: u32| -> Vec<u32> {
            let (sin, cos) = libm::sincos(PI * (f64::from(band) / f64::from(bands) - 0.5));
            let height = match band {
                0 => extent.bottom(),
                _ if band == bands => extent.top(),
                _ => middle + half * sin,
            };
            let is_pole = band == 0 || band == bands;
            (0..=around)
                .map(|i| {
                    let outward = unit_vector(TAU * f64::from(i % around) / f64::from(around));
                    let at = if is_pole { DVec2::ZERO } else { outward * (crown.radius * cos) };
                    let across = if is_pole { DVec2::ZERO } else { outward * (cos / crown.radius) };
                    let normal = across.extend(sin / half).normalize_or(DVec3::Z);
                    mesh.push(at.extend(height), normal, DVec2::new(girth * f64::from(i), height))
                })
                .collect()
        };
        let mut below = ring(&mut mesh, 0);
        for band in 1..=bands {
            let above = ring(&mut mesh, band);
            for i in 0..around as usize {
                let [a, b, c, d] = [below[i], below[i + 1], above[i + 1], above[i]];
                if band > 1 {
                    mesh.triangles.push([a, b, c]);
                }
                if band < bands {
                    mesh.triangles.push([a, c, d]);
                }
            }
            below = above;
        }
        mesh
    }
}
