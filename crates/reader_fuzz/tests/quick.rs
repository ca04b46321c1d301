//! Reads some mutated files of every format: neither the readers nor the code that uses the result may panic.

use reader_fuzz::mutate::mutated;
use reader_fuzz::work::attempt;
use reader_fuzz::{FORMATS, corpus};

/// The number of mutated files per format.
const CASES: u64 = 150;

/// Every unchanged file of every corpus can be read.
#[test]
fn every_file_of_a_corpus_is_read() {
    for format in FORMATS {
        let files = (format.corpus)();
        assert!(!files.is_empty(), "{}", format.name);
        for (i, file) in files.iter().enumerate() {
            assert_eq!(attempt(format, file), Ok(true), "file {i} of {}", format.name);
        }
    }
}

/// Some mutated files can still be read, and others are rejected.
#[test]
fn mutated_files_are_read_or_refused() {
    for format in FORMATS {
        let files = (format.corpus)();
        let mut read = 0;
        for case in 0..CASES {
            let file = mutated(&files, format.name, case);
            match attempt(format, &file) {
                Ok(whole) => read += u64::from(whole),
                Err(panic) => panic!("case {case} of {}: {panic}", format.name),
            }
        }
        assert!(read > 0 && read < CASES, "{read} of {CASES} files of {} are read", format.name);
    }
}

/// The worlds that mutations start from contain every kind of part and shape.
#[test]
fn the_corpus_holds_every_kind_of_part() {
    use envgen::world::{Contents, ObstacleKind, SurfaceKind, WallKind};

    let worlds = corpus::worlds();
    let kinds = [
        corpus::every::<WallKind>().len(),
        corpus::every::<ObstacleKind>().len(),
        corpus::every::<SurfaceKind>().len(),
        corpus::every::<Contents>().len(),
    ];
    assert!(kinds[0] >= 5 && kinds[1] >= 15 && kinds[2] >= 6 && kinds[3] >= 3, "{kinds:?}");
    let held = |world: &envgen::World| {
        [world.walls.len(), world.obstacles.len(), world.surfaces.len(), world.rooms.len()]
    };
    assert!(worlds.iter().any(|world| held(world) == kinds), "one world holds them all");
    let any = |has: fn(&envgen::World) -> bool| worlds.iter().any(has);
    assert!(any(|world| !world.walls.is_empty()) && any(|world| !world.trees.is_empty()));
    assert!(any(|world| !world.road_strips.is_empty()) && any(|world| !world.rooms.is_empty()));
    assert!(any(|world| !world.doorways.is_empty()) && any(|world| !world.obstacles.is_empty()));
    assert!(any(|world| !world.surfaces.is_empty()) && any(|world| !world.victims.is_empty()));
    assert!(any(|world| world.raster.is_some()) && any(|world| !world.certificate.is_empty()));
    assert!(any(|world| world.start.is_some()) && any(|world| world.goal.is_some()));
}
