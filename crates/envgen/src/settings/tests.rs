//! Tests of settings.

use super::*;
use crate::{WorldKind, WorldSpec};

const WIDTH: Setting = Setting::number("width", "m", 0.5, 10.0, "how wide");

#[test]
fn errors_name_field_value_and_limits() {
    for text in ["NaN", "inf", "-1", "0.4", "1e300", "wide", ""] {
        let error = WIDTH.parse(text).unwrap_err();
        assert_eq!(error.field, "width");
        assert_eq!(error.value.to_lowercase(), text.to_lowercase());
        assert_eq!(error.allowed, "a number from 0.5 to 10");
    }
    assert!(WIDTH.check(f64::NAN).is_err());
    assert_eq!(WIDTH.parse(" 2 ").unwrap(), Value::from(2.0));
    // As it was written, and not as infinity.
    assert!(WIDTH.parse("1e400").unwrap_err().to_string().ends_with("got 1e400"));
    let clearing = Setting::number("clearing", "m", 0.0, 10.0, "Clear radius");
    assert_eq!(clearing.parse("-0").unwrap().to_string(), "0.0");
}

#[test]
fn groups_hold_the_fields_up_to_the_next_group() {
    #[expect(dead_code, unreachable_pub, reason = "only the list of settings is read")]
    mod fence {
        settings! {
            /// A fence.
            pub struct Fence {
                /// First.
                a: u32 = 0 => integer("", 0..=1);
                /// Second.
                #[alias = "bb"]
                #[group = "rails"]
                b: u32 = 0 => integer("", 0..=1);
                /// Third.
                c: u32 = 0 => integer("", 0..=1);
                /// Fourth.
                #[group = ""]
                d: u32 = 0 => integer("", 0..=1);
                /// Fifth.
                #[group = "posts"]
                e: u32 = 0 => integer("", 0..=1);
                /// Sixth.
                #[group = "rails"]
                f: u32 = 0 => integer("", 0..=1);
            }
        }
    }
    let names = |(group, settings): (_, Vec<&Setting>)| {
        (group, settings.iter().map(|setting| setting.name).collect::<String>())
    };
    let groups: Vec<_> = groups(fence::Fence::SETTINGS).into_iter().map(names).collect();
    let expected = [(None, "ad"), (Some("rails"), "bcf"), (Some("posts"), "e")];
    assert_eq!(groups, expected.map(|(group, names)| (group, names.to_owned())));
}

#[test]
fn lists_split_at_commas() {
    let list = Setting::list("prefabs", "", "names", "what follows what");
    for text in ["a, b,3", "[a,b,3]", " [ \"a\", b, 3 ] "] {
        assert_eq!(list.parse(text).unwrap(), serde_json::json!(["a", "b", 3]), "{text}");
    }
    for text in ["", "[]", "[ ]"] {
        assert_eq!(list.parse(text).unwrap(), serde_json::json!([]), "{text}");
    }
    assert_eq!(list.parse("[a").unwrap(), serde_json::json!(["[a"]));
}

#[test]
fn items_are_numbers_only_where_they_are_no_names() {
    let mut spec = WorldKind::Landscape.default_spec();
    spec.set("entropy", "1").unwrap();
    spec.set("classes", "3").unwrap();
    spec.set("speeds", "1.,.5,+0").unwrap();
    let WorldSpec::Landscape(landscape) = &spec else { panic!("{spec:?}") };
    assert_eq!(landscape.speeds, [1.0, 0.5, 0.0]);
    let mut indoor = WorldKind::Indoor.default_spec();
    indoor.set("rooms", "+1,1.").unwrap();
    let WorldSpec::Indoor(plan) = &indoor else { panic!("{indoor:?}") };
    assert_eq!(plan.rooms, ["+1", "1."]);
    assert!(indoor.set("rooms", "1").is_err());
}

#[test]
fn what_is_wrong_in_a_structured_value_is_named() {
    let error = |value: &str| {
        WorldKind::Indoor.default_spec().set("catalogue", value).unwrap_err().to_string()
    };
    assert!(error("[]").contains("got []: the catalogue must have 1 to 10000 rooms"));
    assert!(error(r#"[{"nme": "a"}]"#).contains("unknown field `nme`"));
    let text = error("abc");
    assert!(text.ends_with("got abc"), "{text}");
}
