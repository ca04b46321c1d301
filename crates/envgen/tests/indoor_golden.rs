//! Frozen digests: a change here changes the maps of every seed, and needs a new value version.

use envgen::indoor::{IndoorSpec, Layout, Profile};
use envgen::world::Digest;
use envgen::{Blueprint, Seed, Spec};

fn digests(spec: &IndoorSpec, seed: u64) -> [String; 2] {
    let plan = spec.generate(Seed(seed)).unwrap();
    [Digest::of(&plan).to_string(), plan.to_world().digest().to_string()]
        .map(|d| d[..16].to_owned())
}

#[test]
fn maps_are_frozen() {
    let thesis =
        |difficulty| IndoorSpec { difficulty, profile: Profile::Thesis, ..Default::default() };
    let l_system =
        IndoorSpec { layout: Layout::LSystem, width: 40, height: 30, ..Default::default() };
    let varied = IndoorSpec { clearance: Some(1.0), width: 8, height: 8, ..Default::default() };
    let found = [
        digests(&thesis(0.0), 1),
        digests(&thesis(9.0), 2),
        digests(&IndoorSpec::default(), 3),
        digests(&l_system, 4),
        digests(&varied, 5),
    ];
    assert_eq!(
        found,
        [
            ["0c45f62b5c67c91c", "5edca5fe4ef4cd96"],
            ["43f07f8e3f4fa806", "d81fce8483a876fd"],
            ["96bbf6ed373b1117", "8c631fbffa7f5dfc"],
            ["3f6e7306ac5fb87e", "5bd3ec4c407e786c"],
            ["4176ab100c51e977", "cd339aaba42c2ecc"]
        ]
    );
}
