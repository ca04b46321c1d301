//! World files give the identical world back, and no text breaks their readers.

mod common;

use envgen::export::{ExportError, Format, Job};
use envgen::file::{FileError, MAX_SPEC_DEPTH};
use envgen::hallway::HallwaySpec;
use envgen::import;
use envgen::world::{Digest, SCHEMA_VERSION, Violation};
use envgen::{Blueprint, Provenance, Seed, Spec, World};
use proptest::prelude::*;
use serde_json::{Value, json};

/// The world from its JSON and from its RON.
fn read_back(world: &World) -> [World; 2] {
    let json = world.to_json().unwrap();
    let ron = world.to_ron().unwrap();
    [World::from_json(&json).unwrap(), World::from_ron(&ron).unwrap()]
}

fn assert_identical(world: &World) {
    for back in read_back(world) {
        assert_eq!(&back, world);
        // Equality lets 0 and -0 pass for one; the digest does not.
        assert_eq!(Digest::of(&back), Digest::of(world));
    }
}

#[test]
fn every_part_comes_back() {
    for world in [
        common::empty(1.0, 1.0),
        common::indoor(),
        common::forest(500, 60.0),
        common::road(),
        common::landscape(),
        common::everything(),
    ] {
        assert_identical(&world);
    }
}

#[test]
fn ron_has_one_line_a_part() {
    let world = common::indoor();
    let ron = world.to_ron().unwrap();
    for part in [r#"(kind: wall, shape: box("#, r#"(name: "kitchen", "#] {
        assert!(ron.lines().any(|line| line.trim_start().starts_with(part)), "{part}\n{ron}");
    }
    assert!(ron.starts_with("(\n  schema: 1,\n"), "{}", &ron[..40]);
    assert_eq!(world.to_json().unwrap().lines().count(), 1);
}

#[test]
fn formats_write_what_readers_read() {
    // A project of the World Generator holds a plan, not a world.
    // A map of a robot is two files, plans of others hold less than a world: they have tests of their own.
    const OTHERS: [&str; 5] = ["xml", "geojson", "house.json", "world", "npy"];
    let alone = |ending: &str| !ending.starts_with('y') && !OTHERS.contains(&ending);
    for &(ending, reader) in import::READERS.iter().filter(|(ending, _)| alone(ending)) {
        let format = Format::from_path(format!("a.{ending}").as_ref()).unwrap();
        let read = |file: Vec<u8>| reader(&mut file.as_slice(), "a".as_ref());
        let written = |world: &World| {
            let mut file = Vec::new();
            format.write(&Job::new(world), &mut file).map(|()| file)
        };
        if ["json", "ron"].contains(&ending) {
            let world = common::indoor();
            assert_eq!(read(written(&world).unwrap()).unwrap(), world);
        } else {
            // Of a world these formats hold the raster alone.
            assert!(matches!(written(&common::indoor()), Err(ExportError::Empty { .. })));
            let world = common::landscape();
            let read = read(written(&world).unwrap()).unwrap();
            let size = |world: &World| world.raster.as_ref().map(|r| (r.rows, r.cols));
            assert_eq!(size(&read), size(&world), "{ending}");
        }
    }
}

#[test]
fn other_versions_are_named() {
    let world = common::indoor();
    let current = SCHEMA_VERSION.to_string();
    let json = world.to_json().unwrap();
    let ron = world.to_ron().unwrap();
    let newer_json = json.replacen(&format!("\"schema\":{current}"), "\"schema\":7", 1).replacen(
        "\"trees\"",
        "\"plants\"",
        1,
    );
    let newer_ron = ron
        .replacen(&format!("schema: {current}"), "schema: 7", 1)
        .replacen("trees:", "plants:", 1);
    for error in
        [World::from_json(&newer_json).unwrap_err(), World::from_ron(&newer_ron).unwrap_err()]
    {
        assert!(matches!(error, FileError::Schema { found: 7 }), "{error}");
        assert!(error.to_string().contains("schema version 7, expected 1"), "{error}");
    }
    // Of this version, but not its layout.
    let error = World::from_json(&json.replacen("\"trees\"", "\"plants\"", 1)).unwrap_err();
    assert!(matches!(error, FileError::Json(_)) && error.to_string().contains("plants"), "{error}");
    let error = World::from_ron(&ron.replacen("trees:", "plants:", 1)).unwrap_err();
    assert!(matches!(error, FileError::Ron(_)) && error.to_string().contains("plants"), "{error}");
}

#[test]
fn broken_worlds_are_neither_read_nor_written() {
    let world = common::forest(3, 10.0);
    let json = world.to_json().unwrap();
    let mut value: Value = serde_json::from_str(&json).unwrap();
    value["trees"][1]["radius"] = json!(-1.0);
    let error = World::from_json(&value.to_string()).unwrap_err();
    assert!(matches!(error, FileError::World(Violation::Size(_))), "{error}");

    let radius = format!("radius: {:?}", world.trees[2].radius);
    for (bad, name) in [("inf", "not finite"), ("NaN", "not finite"), ("1e300", "bounds")] {
        let ron = world.to_ron().unwrap().replacen(&radius, &format!("radius: {bad}"), 1);
        let error = World::from_ron(&ron).unwrap_err();
        assert!(matches!(error, FileError::World(_)), "{error}");
        assert!(error.to_string().contains(name), "{error}");
    }

    let mut broken = world;
    broken.trees[0].radius = f64::NAN;
    assert!(matches!(broken.to_json(), Err(FileError::World(Violation::NotFinite(_)))));
    assert!(matches!(broken.to_ron(), Err(FileError::World(Violation::NotFinite(_)))));
}

#[test]
fn a_raster_that_claims_more_than_it_has_is_refused() {
    let json = common::landscape().to_json().unwrap();
    let mut value: Value = serde_json::from_str(&json).unwrap();
    for (rows, cols) in [(u32::MAX, u32::MAX), (1 << 20, 1 << 20), (0, 0), (48, 73)] {
        value["raster"]["rows"] = rows.into();
        value["raster"]["cols"] = cols.into();
        let error = World::from_json(&value.to_string()).unwrap_err();
        assert!(matches!(error, FileError::World(Violation::Raster { .. })), "{error}");
    }
}

/// A value of arrays and objects in each other, `depth` levels of them.
fn nested(depth: usize) -> Value {
    (0..depth)
        .fold(json!(1), |inner, i| if i % 2 == 0 { json!([inner]) } else { json!({ "a": inner }) })
}

#[test]
fn what_is_written_can_be_read() {
    let mut world = common::empty(1.0, 1.0);
    world.provenance = Provenance::other("manual", nested(MAX_SPEC_DEPTH));
    assert_identical(&world);
    world.provenance = Provenance::other("manual", nested(MAX_SPEC_DEPTH + 1));
    assert!(matches!(world.to_json(), Err(FileError::TooDeep)));
    assert!(matches!(world.to_ron(), Err(FileError::TooDeep)));
}

#[test]
fn deep_nesting_is_refused() {
    let world = common::empty(1.0, 1.0);
    let (json, ron) = (world.to_json().unwrap(), world.to_ron().unwrap());
    let start = json.find("\"spec\":").unwrap() + 7;
    let start_ron = ron.find("spec: ").unwrap() + 6;
    for open in ["[", "{\"a\":", "(", "Some(", "a(", "/*", "r#", "[(", "((a:", "-", "\"\\u{"] {
        let deep = open.repeat(200_000);
        assert!(World::from_json(&deep).is_err());
        assert!(World::from_ron(&deep).is_err());
        assert!(World::from_json(&format!("{}{deep}", &json[..start])).is_err());
        assert!(World::from_ron(&format!("{}{deep}", &ron[..start_ron])).is_err());
        // In a field that no version has, which the look for the version skips.
        assert!(World::from_json(&format!("{{\"x\":{deep}")).is_err());
        assert!(World::from_ron(&format!("(x:{deep}")).is_err());
    }
}

#[test]
fn numbers_of_other_texts_come_back() {
    let mut world = common::empty(1.0, 1.0);
    world.provenance = Provenance::other(
        "import",
        json!({
            "numbers": [0.1, -0.0, 5e-324, 1.7976931348623157e308, u64::MAX, i64::MIN, 1e15, 3.0],
            "texts": ["", "\"\\\n\t\u{0}\u{7f}\u{1f600}", "#{}()r#\"\"#"],
            "": [[], {}, null, false],
        }),
    );
    assert_identical(&world);
}

/// Any JSON value as a spec may be, four levels deep.
fn spec_value() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<u64>().prop_map(Value::from),
        any::<f64>().prop_filter("finite", |x| x.is_finite()).prop_map(Value::from),
        any::<String>().prop_map(Value::from),
    ];
    leaf.prop_recursive(4, 24, 5, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Value::from),
            prop::collection::btree_map(any::<String>(), inner, 0..5)
                .prop_map(|map| Value::Object(map.into_iter().collect())),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_hallway_comes_back(
        seed: u64,
        segments in 1..60_u64,
        p_st in 0.05..0.95_f64,
        pitch in 2.2..3.0_f64,
        alcove_rate in 0.0..0.15_f64,
        door_frame_rate in 0.0..0.15_f64,
        spec in spec_value(),
    ) {
        let asked =
            HallwaySpec { segments, p_st, pitch, alcove_rate, door_frame_rate, ..Default::default() };
        let mut world = asked.generate(Seed(seed)).unwrap().to_world();
        assert_identical(&world);
        world.provenance = Provenance::other("import", spec);
        world.provenance.seed = Some(Seed(seed));
        assert_identical(&world);
    }

    #[test]
    fn any_text_is_an_error(text in any::<String>(), bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(World::from_json(&text).is_err());
        prop_assert!(World::from_ron(&text).is_err());
        prop_assert!(import::read_json(&mut bytes.as_slice()).is_err());
        prop_assert!(import::read_ron(&mut bytes.as_slice()).is_err());
    }

    /// Pieces of RON and JSON in any order.
    #[test]
    fn any_pieces_are_an_error(
        pieces in prop::collection::vec(prop::sample::select(&[
            "(", ")", "[", "]", "{", "}", ",", ":", "schema", "\"schema\"", "1", "-", "0x", "1e999", "spec", "trees",
            "Some(", "None", "()", "\"", "'", "\\", "r#\"", "//", "/*", "*/", "\n", "b\"", "#![enable(", "implicit_some",
            "unwrap_newtypes", ")]", "NaN", "inf", "World", "null", "true", "2f32", "9u8", ".", "_", "e",
        ][..]), 0..60),
    ) {
        let text = pieces.concat();
        prop_assert!(World::from_json(&text).is_err());
        prop_assert!(World::from_ron(&text).is_err());
    }

    /// One character of a file replaced, taken away or put in twice: an error, or a whole world.
    #[test]
    fn any_damage_is_survived(at in any::<prop::sample::Index>(), with in any::<Option<char>>(), ron: bool) {
        let world = common::indoor();
        let text = if ron { world.to_ron().unwrap() } else { world.to_json().unwrap() };
        let mut damaged: Vec<char> = text.chars().collect();
        let i = at.index(damaged.len());
        match with {
            Some(c) => damaged[i] = c,
            None => damaged.truncate(i),
        }
        let damaged: String = damaged.into_iter().collect();
        let read = if ron { World::from_ron(&damaged) } else { World::from_json(&damaged) };
        if let Ok(world) = read {
            prop_assert!(world.check().is_ok());
        }
    }
}
