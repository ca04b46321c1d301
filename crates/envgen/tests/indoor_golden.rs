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
            ["28c82f3e3d8f0938", "5edca5fe4ef4cd96"],
            ["6440421b0ab1e1d8", "d81fce8483a876fd"],
            ["bbe17176fa71bc5a", "f881d3df2d05e118"],
            ["2b45783e431be52c", "a92e394ccbf89e5f"],
            ["071e070beef87114", "911e2d66ee8a8760"]
        ]
    );
}
