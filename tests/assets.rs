//! Checks that users can rely on the specs under `assets/worlds`.

use std::fs;
use std::path::Path;

use envgen::certificate::{Verdict, verify};
use envgen::{Seed, WorldSpec};

#[test]
fn every_spec_gives_a_world_that_keeps_its_promises() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/worlds");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        assert!(path.to_str().unwrap().ends_with(".envgen.ron"), "{}", path.display());
        let spec = WorldSpec::from_ron(&fs::read_to_string(&path).unwrap());
        let spec = spec.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for seed in 0..3 {
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            assert_eq!(world.check(), Ok(()), "{}", path.display());
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict, Verdict::Holds, "{}: {claim}", path.display());
            }
        }
        count += 1;
    }
    assert!(count >= 4);
}
