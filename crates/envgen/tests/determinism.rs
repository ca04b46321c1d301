//! The same spec and seed give the same world, whatever runs beside it and in which order.

use std::thread;

use envgen::world::Digest;
use envgen::{Seed, WorldKind, WorldSpec};
use proptest::prelude::*;

fn digests(spec: &WorldSpec, seeds: impl Iterator<Item = u64>) -> Vec<(u64, Digest)> {
    seeds.map(|seed| (seed, spec.generate(Seed(seed)).unwrap().to_world().digest())).collect()
}

#[test]
fn one_thread_and_many_make_the_same_worlds() {
    for &kind in WorldKind::ALL {
        let spec = kind.default_spec();
        let alone = digests(&spec, 0..16);
        let mut together: Vec<_> = thread::scope(|scope| {
            // Each thread takes every eighth seed, and the last ones first.
            let threads: Vec<_> = (0..8)
                .map(|first| {
                    let spec = &spec;
                    scope.spawn(move || digests(spec, (0..16).rev().filter(|s| s % 8 == first)))
                })
                .collect();
            threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
        });
        together.sort_by_key(|(seed, _)| *seed);
        assert_eq!(alone, together, "{kind}");
    }
}

#[test]
fn seeds_differ_and_zero_is_one_of_them() {
    for &kind in WorldKind::ALL {
        let made = digests(&kind.default_spec(), 0..8);
        for (i, (seed, digest)) in made.iter().enumerate() {
            for (other, same) in &made[i + 1..] {
                assert_ne!(digest, same, "{kind}: seeds {seed} and {other}");
            }
        }
    }
}

#[test]
fn a_world_names_what_makes_it_again() {
    for &kind in WorldKind::ALL {
        let spec = kind.default_spec();
        let world = spec.generate(Seed(3)).unwrap().to_world();
        assert_eq!(WorldSpec::from_provenance(&world.provenance), Ok(spec));
        assert_eq!(world.provenance.seed, Some(Seed(3)));
        assert_eq!(world.provenance.value_version, kind.value_version());
        assert_eq!(world.provenance.algorithm, envgen::STREAM_ALGORITHM);
    }
}

/// Numbers that have broken programs before.
fn nasty_number() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("NaN".to_owned()),
        Just("inf".to_owned()),
        Just("-inf".to_owned()),
        Just("-0.0".to_owned()),
        Just("1e300".to_owned()),
        Just("1e-300".to_owned()),
        Just("18446744073709551615".to_owned()),
        (-1e6..1e6_f64).prop_map(|x| x.to_string()),
        (0..100_u32).prop_map(|n| n.to_string()),
    ]
}

proptest! {
    #[test]
    fn any_text_is_a_spec_or_an_error(text in ".{0,200}") {
        let _ = WorldSpec::from_ron(&text);
    }

    #[test]
    fn text_like_a_spec_is_a_spec_or_an_error(
        kind in prop::sample::select(WorldKind::ALL),
        fields in prop::collection::vec((any::<prop::sample::Index>(), nasty_number()), 0..4),
        brackets in 0..300_usize,
    ) {
        let settings = kind.settings();
        let fields: Vec<_> =
            fields.iter().map(|(i, x)| format!("{}: {x}", i.get(settings).name)).collect();
        let deep = "(".repeat(brackets);
        let _ = WorldSpec::from_ron(&format!("{kind}({}{deep})", fields.join(", ")));
        if let Ok(spec) = WorldSpec::from_ron(&format!("{kind}({})", fields.join(", "))) {
            // What validates is within its limits; what does not says which field, at once.
            if let Err(error) = spec.validate() {
                prop_assert!(!error.field.is_empty() && !error.allowed.is_empty());
                prop_assert!(spec.generate(Seed(1)).is_err());
            }
        }
    }

    #[test]
    fn any_setting_can_be_given_any_text(
        kind in prop::sample::select(WorldKind::ALL),
        setting in any::<prop::sample::Index>(),
        text in prop_oneof![nasty_number(), ".{0,20}"],
    ) {
        let setting = setting.get(kind.settings());
        let mut spec = kind.default_spec();
        let before = spec.clone();
        if spec.set(setting.name, &text).is_err() {
            prop_assert_eq!(spec, before);
        }
    }
}
