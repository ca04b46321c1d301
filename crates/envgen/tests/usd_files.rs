//! Files of Universal Scene Description, read back by the crate `openusd`.

#[path = "common/samples.rs"]
mod samples;

use envgen::export::{Format, Job};
use envgen::geometry::Shape;
use envgen::pieces::{Form, pieces};
use openusd::sdf::Value;

use samples::{place_names, with_polygon, worlds, write};

#[test]
fn files_are_the_same_to_the_byte() {
    for (first, second) in worlds().iter().zip(&worlds()) {
        assert_eq!(write(first, "usda"), write(second, "usda"));
    }
}

#[test]
fn every_piece_is_a_prim() {
    for world in worlds() {
        let text = String::from_utf8(write(&world, "usda")).unwrap();
        let layer = openusd::usda::parse(&text).unwrap();
        let field = |path: &str, name: &str| {
            let spec = layer.spec(&openusd::sdf::path(path).unwrap());
            spec.and_then(|spec| spec.get(name).cloned())
        };
        let Some(Value::TokenVec(found)) = field("/World", "primChildren") else {
            panic!("{text}")
        };
        let found: Vec<&str> = found.iter().map(|name| name.as_str()).collect();
        let all = pieces(&world);
        let names = place_names(&world).into_iter();
        let names = names.chain(all.iter().map(ToString::to_string));
        let names: Vec<String> = names.chain(["floor_plane".to_owned()]).collect();
        assert_eq!(found, names);
        // What robots drive on collides, and is not drawn.
        assert!(field("/World/floor_plane", "apiSchemas").is_some());
        let purpose = field("/World/floor_plane.purpose", "default");
        assert_eq!(purpose, Some(Value::Token("guide".into())));
        let provenance = serde_json::to_string(&world.provenance).unwrap();
        let stated = field("/World.userProperties:provenance", "default");
        assert_eq!(stated, Some(Value::String(provenance)));
        assert_eq!(field("/", "upAxis"), Some(Value::Token("Z".into())));
        for piece in &all {
            let path = format!("/World/{piece}");
            assert_eq!(field(&path, "apiSchemas").is_some(), piece.is_solid, "{piece}");
            let expected = match &piece.form {
                Form::Road { .. } => "Mesh",
                Form::Crown { .. } => "Sphere",
                Form::Prism { shape, .. } => match shape.as_ref() {
                    Shape::Disc { .. } => "Cylinder",
                    Shape::Polygon { .. } => "Mesh",
                    _ => "Cube",
                },
            };
            assert_eq!(field(&path, "typeName"), Some(Value::Token(expected.into())), "{piece}");
        }
    }
}

#[test]
fn outlines_that_cross_themselves_are_refused() {
    let world = with_polygon(&[(1., 1.), (5., 5.), (5., 1.), (1., 5.)]);
    let format = Format::from_path("world.usda".as_ref()).unwrap();
    let error = format.write(&Job::new(&world), &mut Vec::new()).unwrap_err().to_string();
    assert!(error.starts_with("obstacle_0 has no mesh"), "{error}");
}
