//! What every mesh is, checked by rules that know nothing of how it was made.

use std::collections::BTreeMap;

use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::geometry::{Shape, signed_area};
use crate::outline::{ROUNDNESS, outline};
use crate::pieces::{LINE_THICKNESS, Role, pieces};
use crate::world::{Crown, Extent};
use crate::{Seed, WorldKind, WorldSpec};

/// Complains of a mesh that is not closed, oriented and free of degenerate triangles, or whose normals do
/// not point to the side that its triangles are seen from.
fn fault(mesh: &Mesh) -> Option<String> {
    // As files in single precision hold them.
    let position = |i: u32| mesh.positions[i as usize].as_vec3().as_dvec3();
    let key = |i: u32| position(i).to_array().map(|x| (x + 0.0).to_bits());
    let mut edges: BTreeMap<_, [u32; 2]> = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        let [p, q, r] = [a, b, c].map(position);
        let normal = (q - p).cross(r - p);
        if normal.length() <= 0.0 || normal.is_nan() {
            return Some(format!("degenerate triangle {p} {q} {r}"));
        }
        if [a, b, c].iter().any(|&i| mesh.normals[i as usize].dot(normal) <= 0.0) {
            return Some(format!("inward normal at {p} {q} {r}"));
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from, to) = (key(from), key(to));
            // Counts an edge in the one direction and in the other.
            edges.entry((from.min(to), from.max(to))).or_default()[usize::from(from > to)] += 1;
        }
    }
    let open = edges.values().find(|counts| **counts != [1, 1]);
    let long = mesh.normals.iter().find(|normal| (normal.length() - 1.0).abs() > 1e-9);
    open.map(|counts| format!("an edge of {counts:?} triangles"))
        .or(long.map(|normal| format!("normal {normal}")))
}

/// Small worlds of every kind, with settings from a number.
pub(super) fn spec(kind: WorldKind, draw: u64) -> WorldSpec {
    let mut spec = kind.default_spec();
    let mut stream = Seed(draw).stream("test", 0);
    let mut set = |name: &str, value: String| spec.set(name, &value).unwrap();
    match kind {
        WorldKind::Hallway => {
            set("segments", (1 + stream.below(30)).to_string());
            set("corners", ["square", "rounded"][stream.below(2) as usize].into());
            set("alcove_rate", "0.1".into());
            set("narrowing_rate", "0.1".into());
            set("wall_height", stream.between(0.2, 5.0).to_string());
        }
        WorldKind::Forest => {
            set("width", "20".into());
            set("height", "15".into());
            set("radius", stream.between(0.05, 1.0).to_string());
        }
        WorldKind::Road => {
            set("length", stream.between(150.0, 400.0).to_string());
            set("transition", ["0", "0.3", "0.5"][stream.below(3) as usize].into());
            set("speed", stream.between(0.0, 10.0).to_string());
        }
        WorldKind::Indoor => {
            set("width", (4 + stream.below(4)).to_string());
            set("height", (4 + stream.below(4)).to_string());
            set("difficulty", stream.between(0.0, 10.0).to_string());
            set("doorway_height", stream.between(1.0, 3.0).to_string());
        }
        WorldKind::Cellular => {
            set("rows", (8 + stream.below(30)).to_string());
            set("fill", stream.between(0.05, 0.25).to_string());
        }
        WorldKind::Landscape => {
            set("rows", (2 + stream.below(14)).to_string());
            set("cols", (2 + stream.below(14)).to_string());
            set("classes", "4".into());
            set("entropy", "1.2".into());
            set("speeds", "0,1,0.5,0".into());
        }
    }
    spec
}

/// Number of random worlds: 40, or what the environment variable `MESH_WORLDS` says.
fn worlds() -> u32 {
    std::env::var("MESH_WORLDS").ok().and_then(|number| number.parse().ok()).unwrap_or(40)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(worlds()))]

    /// Bodies are closed and oriented, without degenerate triangles, and prisms have the volume of their
    /// outline by their height.
    #[test]
    fn worlds_have_sound_meshes(seed: u64, kind in 0..WorldKind::ALL.len()) {
        let spec = spec(WorldKind::ALL[kind], seed);
        let Ok(blueprint) = spec.generate(Seed(seed)) else { return Ok(()) };
        let world = blueprint.to_world();
        for piece in pieces(&world) {
            let mesh = Mesh::of(&piece).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert_eq!(fault(&mesh), None, "{}", piece);
            match &piece.form {
                Form::Prism { shape, extent } => {
                    let area = match &**shape {
                        Shape::Disc { .. } => signed_area(&outline(shape).1),
                        shape => shape.area(),
                    };
                    let volume = area * extent.height();
                    prop_assert!((mesh.volume() - volume).abs() <= 1e-9 * volume.max(1e-6), "{}", piece);
                }
                Form::Crown { crown, .. } => {
                    let whole = 4.0 / 3.0 * std::f64::consts::PI * crown.radius * crown.radius * 0.5 * crown.extent.height();
                    prop_assert!((0.8..1.0).contains(&(mesh.volume() / whole)));
                }
                Form::Road { strip, extent } => {
                    // The strip of a curve has the area of its length by its width.
                    let volume = strip.path().length() * strip.width * extent.height();
                    prop_assert!((mesh.volume() / volume - 1.0).abs() < 0.01, "{} {}", mesh.volume(), volume);
                }
            }
        }
    }

    #[test]
    fn discs_are_round_enough(radius in 1e-3..10.0) {
        let (_, corners) = outline(&Shape::Disc { center: DVec2::ZERO, radius });
        for (a, b) in crate::geometry::edges(&corners) {
            prop_assert!((a.length() - radius).abs() < 1e-12);
            let inside = radius - (0.5 * (a + b)).length();
            prop_assert!((0.0..=ROUNDNESS).contains(&inside), "{}", inside);
        }
    }
}

proptest! {
    #[test]
    fn coarse_bodies_are_closed(around in 0..20_u32, bands in 0..9_u32, radius in 0.01..9.0_f64, height in 0.1..20.0_f64) {
        let extent = Extent::new(1.0, 1.0 + height).unwrap();
        let center = DVec2::new(3.0, -2.0);
        let crown = Mesh::coarse_ellipsoid(center, Crown { extent, radius }, around, bands);
        prop_assert_eq!(fault(&crown), None);
        let whole: f64 = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * 0.5 * height;
        prop_assert!(crown.volume() > 0.1 * whole && crown.volume() < whole);
        let trunk = Mesh::cylinder(center, radius, extent, around);
        prop_assert_eq!(fault(&trunk), None);
        let sides = f64::from(around.max(3));
        let area: f64 = 0.5 * sides * radius * radius * libm::sin(std::f64::consts::TAU / sides);
        prop_assert!((trunk.volume() / (area * height) - 1.0).abs() < 1e-9);
        prop_assert_eq!(trunk.triangles.len() as u32, 4 * around.max(3) - 4);
    }
}

#[test]
fn lines_have_a_thickness() {
    let shape = Shape::Segment { a: DVec2::new(1e5, 0.0), b: DVec2::new(1e5, 2.0) };
    let mesh = Mesh::extruded(&shape, crate::world::WALL).unwrap();
    assert_eq!(fault(&mesh), None);
    assert!((mesh.volume() - 2.0 * LINE_THICKNESS * 2.6).abs() < 1e-9);
}

#[test]
fn what_is_not_simple_is_named() {
    let corner = |x, y| DVec2::new(x, y);
    let vertices = vec![corner(0., 0.), corner(1., 1.), corner(1., 0.), corner(0., 1.)];
    let mut world = crate::World::new(
        crate::Provenance::other("test", serde_json::Value::Null),
        crate::geometry::Rect::new(DVec2::ZERO, DVec2::ONE),
    );
    let kind = crate::world::WallKind::Wall;
    world.walls.push(crate::world::Wall::new(kind, Shape::Polygon { vertices }));
    let pieces = pieces(&world);
    assert_eq!(pieces[0].role, Role::Ground);
    let error = Mesh::of(&pieces[1]).unwrap_err().to_string();
    assert!(error.starts_with("wall_0 has no mesh"), "{error}");
}
