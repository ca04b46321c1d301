//! Rays against the triangles of the meshes.

use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::mesh::Mesh;
use crate::mesh::tests::spec;
use crate::pieces::pieces;
use crate::{Seed, WorldKind};

/// Distances that differ by less are the same, in metres.
const SAME: f64 = 1e-9;

/// Distance along a ray to a triangle that faces it, and how near the ray passes an edge, as a share of the
/// triangle. T. Moeller and B. Trumbore, "Fast, minimum storage ray-triangle intersection", 1997,
/// `doi:10.1080/10867651.1997.10487468`.
fn to_triangle(from: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, f64)> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let facing = ab.dot(across);
    if facing <= 0.0 {
        return None;
    }
    let to = from - a;
    let u = to.dot(across) / facing;
    let q = to.cross(ab);
    let v = direction.dot(q) / facing;
    let distance = ac.dot(q) / facing;
    let edge = u.min(v).min(1.0 - u - v);
    (distance >= 0.0 && edge >= -1e-9).then_some((distance, edge))
}

/// All triangles of all bodies, at their places.
fn triangles(forms: &[&Form<'_>], meshes: &[Mesh]) -> Vec<(usize, [DVec3; 3])> {
    assert_eq!(forms.len(), meshes.len());
    let of = |(i, mesh): (usize, &Mesh)| {
        let corner = |k: u32| mesh.positions[k as usize] + mesh.pivot.extend(0.0);
        mesh.triangles.iter().map(|t| (i, t.map(corner))).collect::<Vec<_>>()
    };
    meshes.iter().enumerate().flat_map(of).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The first body along a ray is the first triangle's, at the same distance.
    #[test]
    fn rays_meet_what_the_meshes_have(seed: u64, kind in 0..WorldKind::ALL.len()) {
        let spec = spec(WorldKind::ALL[kind], seed);
        let Ok(blueprint) = spec.generate(Seed(seed)) else { return Ok(()) };
        let world = blueprint.to_world();
        let pieces = pieces(&world);
        let forms: Vec<&Form<'_>> = pieces.iter().map(|piece| &piece.form).collect();
        let meshes: Vec<Mesh> = pieces.iter().map(|piece| Mesh::of(piece).unwrap()).collect();
        let triangles = triangles(&forms, &meshes);
        let rays = BodyRaycaster::new(forms.iter().copied());
        let mut stream = Seed(seed).stream("rays", 0);
        let area = world.bounds.grown(3.0);
        for _ in 0..24 {
            let mut between = |a: f64, b: f64| stream.between(a, b);
            let from = DVec3::new(
                between(area.min.x, area.max.x),
                between(area.min.y, area.max.y),
                between(-0.5, 4.0),
            );
            let direction = DVec3::new(between(-1.0, 1.0), between(-1.0, 1.0), between(-0.5, 0.3));
            let hit = rays.cast(from, direction, 1e3);
            let met: Vec<_> = triangles
                .iter()
                .filter_map(|&(body, corners)| Some((body, to_triangle(from, direction, corners)?)))
                .filter(|(_, (distance, _))| *distance <= 1e3)
                .collect();
            let first = met.iter().map(|(_, (distance, _))| *distance).fold(f64::INFINITY, f64::min);
            // Rays through an edge may pass between two surfaces by rounding.
            let nearest = met.iter().filter(|(_, (distance, _))| *distance <= first + SAME);
            if nearest.clone().all(|(_, (_, edge))| edge.abs() < 1e-7) && first.is_finite() {
                continue;
            }
            prop_assert_eq!(hit.is_some(), first.is_finite(), "{:?} {}", hit, first);
            if let Some(hit) = hit {
                prop_assert!((hit.distance - first).abs() < SAME, "{:?} {}", hit, first);
                prop_assert!(nearest.clone().any(|(body, _)| *body == hit.body), "{:?}", hit);
            }
        }
    }

    /// The index leaves out nothing: as if each body was asked.
    #[test]
    fn the_index_changes_nothing(seed: u64, kind in 0..WorldKind::ALL.len()) {
        let spec = spec(WorldKind::ALL[kind], seed);
        let Ok(blueprint) = spec.generate(Seed(seed)) else { return Ok(()) };
        let world = blueprint.to_world();
        let pieces = pieces(&world);
        let rays = BodyRaycaster::new(pieces.iter().map(|piece| &piece.form));
        let mut stream = Seed(seed).stream("rays", 1);
        for i in 0..40 {
            let mut between = |a: f64, b: f64| stream.between(a, b);
            let (min, max) = (world.bounds.min, world.bounds.max);
            let from = DVec3::new(between(min.x, max.x), between(min.y, max.y), between(0.01, 3.0));
            let direction = match i {
                // Along the axes, on which worlds are built.
                0..6 => [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z][i],
                _ => DVec3::new(between(-1.0, 1.0), between(-1.0, 1.0), between(-0.2, 0.2)),
            };
            let range = between(0.0, 30.0);
            let all = rays.solids.iter().filter_map(|(body, solid)| {
                let distance = solid.distance(from, direction)?;
                (distance <= range).then_some(BodyHit { distance, body: *body })
            });
            let order = |a: &BodyHit, b: &BodyHit| a.distance.total_cmp(&b.distance).then(a.body.cmp(&b.body));
            prop_assert_eq!(rays.cast(from, direction, range), all.min_by(order));
        }
    }

    /// Wherever and whatever a ray is, the answer is a distance within its range.
    #[test]
    fn odd_rays_are_harmless(numbers: [f64; 7]) {
        let world = spec(WorldKind::Hallway, 3).generate(Seed(3)).unwrap().to_world();
        let pieces = pieces(&world);
        let rays = BodyRaycaster::new(pieces.iter().map(|piece| &piece.form));
        let [a, b, c, d, e, f, range] = numbers;
        if let Some(hit) = rays.cast(DVec3::new(a, b, c), DVec3::new(d, e, f), range) {
            prop_assert!((0.0..=range).contains(&hit.distance));
        }
    }
}

#[test]
fn nothing_is_met_where_nothing_is() {
    let rays = BodyRaycaster::new([]);
    assert_eq!(rays.cast(DVec3::ZERO, DVec3::X, f64::INFINITY), None);
    let form = Form::Prism {
        shape: std::borrow::Cow::Owned(crate::geometry::Shape::from_rect(Rect::new(
            DVec2::new(1.0, -1.0),
            DVec2::new(2.0, 1.0),
        ))),
        extent: crate::world::Extent::new(0.0, 1.0).unwrap(),
    };
    let rays = BodyRaycaster::new([&form]);
    let eye = DVec3::new(0.0, 0.0, 0.5);
    let at = |distance| Some(BodyHit { distance, body: 0 });
    assert_eq!(rays.cast(eye, DVec3::X, 1.0), at(1.0));
    assert_eq!(rays.cast(eye, 2.0 * DVec3::X, 1.0), at(0.5));
    assert_eq!(rays.cast(eye, DVec3::X, 0.99), None);
    assert_eq!(rays.cast(eye, DVec3::NEG_X, 10.0), None);
    assert_eq!(rays.cast(eye, DVec3::ZERO, 10.0), None);
    assert_eq!(rays.cast(eye, DVec3::X, f64::NAN), None);
    // From inside, and from behind.
    assert_eq!(rays.cast(eye + 1.5 * DVec3::X, DVec3::X, 10.0), None);
    assert_eq!(rays.cast(eye + 3.0 * DVec3::X, DVec3::NEG_X, 10.0), at(1.0));
    assert_eq!(rays.cast(DVec3::new(1.5, 0.0, 3.0), DVec3::NEG_Z, 10.0), at(2.0));
    assert_eq!(rays.cast(DVec3::new(1.5, 0.0, -3.0), DVec3::Z, 10.0), at(3.0));
}
