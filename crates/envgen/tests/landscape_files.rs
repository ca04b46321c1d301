//! Files of rasters that are damaged, or nothing of the kind: errors, never a panic.

use std::path::Path;

use envgen::export::{Format, Job};
use envgen::import::{ImportedRaster, read_scenarios};
use envgen::landscape::LandscapeSpec;
use envgen::landscape::metrics::{Border, RasterReport};
use envgen::{Blueprint, Seed, Spec};
use proptest::prelude::*;

const NAMES: [&str; 4] = ["a.asc", "a.map", "a.json", "a.classes.png"];

/// Reads and measures whatever the bytes hold.
fn survive(name: &str, mut bytes: &[u8]) {
    if let Ok(read) = ImportedRaster::read(Path::new(name), &mut bytes) {
        let _ = RasterReport::new(&read.raster, Border::Counted);
    }
}

fn file(name: &str) -> Vec<u8> {
    let spec = LandscapeSpec { rows: 5, cols: 7, classes: 4, entropy: 1.2, ..Default::default() };
    let world = spec.generate(Seed(1)).unwrap().to_world();
    let mut bytes = Vec::new();
    Format::from_path(Path::new(name)).unwrap().write(&Job::new(&world), &mut bytes).unwrap();
    bytes
}

proptest! {
    #[test]
    fn any_bytes_are_survived(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for name in NAMES {
            survive(name, &bytes);
        }
        let _ = read_scenarios(&mut bytes.as_slice());
    }

    #[test]
    fn any_damage_is_survived(
        which in 0..NAMES.len(), at in any::<prop::sample::Index>(), byte: u8, cut: bool,
    ) {
        let mut bytes = file(NAMES[which]);
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if cut {
            bytes.truncate(at);
        }
        survive(NAMES[which], &bytes);
    }
}

#[test]
fn what_is_written_is_read() {
    for name in NAMES {
        let read = ImportedRaster::read(Path::new(name), &mut file(name).as_slice()).unwrap();
        assert_eq!((read.raster.rows, read.raster.cols), (5, 7), "{name}");
    }
}
