use std::convert::Infallible;

use super::*;
use crate::indoor::catalogue::Catalogue;
use crate::seed::Seed;

const ROBOT: Dimensions = Dimensions { unit: 3.0, wall: 0.1, doorway: 0.94, radius: 0.36 };

/// A room varied by the laws that specs have.
fn varied(room: &SharedRoom, wanted: f64, seed: u64) -> Varied {
    let uniform =
        |most: f64| move |stream: &mut Stream| Ok::<_, Infallible>(stream.between(-most, most));
    let mut stream = Seed(seed).stream("test", 0);
    let (moves, turns) = (uniform(FARTHEST_MOVE), uniform(GREATEST_TURN));
    let Ok(varied) = vary(room, wanted, ROBOT, &mut stream, &moves, &turns);
    varied
}

#[test]
fn rooms_come_near_the_wanted_width() {
    for (name, wanted) in [
        ("single office", 0.6),
        ("single office", 1.2),
        ("computer lab", 0.8),
        ("computer lab", 1.4),
        ("warehouse", 1.0),
        ("multi office", 0.8),
    ] {
        let room = Catalogue::builtin().get(name).unwrap();
        let varied = varied(room, wanted, 1);
        let (was, is) = ((varied.before - wanted).abs(), (varied.after - wanted).abs());
        assert!(is <= 2.0 * STEP, "{name} to {wanted}: {} became {}", varied.before, varied.after);
        assert!(was > is);
        // What is reported is what the room has.
        assert_eq!(narrowest_passage(&varied.room, 3.0, 0.1, 0.94), varied.after);
        assert_eq!(varied.room.validate(), Ok(()));
        assert_eq!(varied.room.walls, room.walls);
        let interior = varied.room.interior(ROBOT);
        assert_eq!(clear_ports(&interior, &varied.room), [true; 4]);
        assert_eq!(cut_off(&interior, &varied.room), 0);
    }
}

#[test]
fn rooms_without_obstacles_stay() {
    for name in ["empty", "maze"] {
        let room = Catalogue::builtin().get(name).unwrap();
        let varied = varied(room, 0.5, 1);
        assert_eq!((&varied.room, varied.before), (room, varied.after));
    }
}

#[test]
fn the_same_seed_moves_the_same_things() {
    let room = Catalogue::builtin().get("computer lab").unwrap();
    assert_eq!(varied(room, 0.7, 3), varied(room, 0.7, 3));
    assert_ne!(varied(room, 0.7, 3), varied(room, 0.7, 4));
}

#[test]
fn no_pocket_is_left_that_the_footprint_just_fits_in() {
    for seed in 0..12 {
        for name in ["dragon room", "multi office", "single office"] {
            let room = Catalogue::builtin().get(name).unwrap();
            let varied = varied(room, 0.0, seed);
            let interior = varied.room.interior(ROBOT);
            assert_eq!(interior.overlooked(&varied.room, ROBOT), 0, "{name}, seed {seed}");
        }
    }
}

#[test]
fn designed_rooms_overlook_nothing() {
    for room in Catalogue::builtin().rooms() {
        assert_eq!(room.interior(ROBOT).overlooked(room, ROBOT), 0, "{}", room.name);
    }
}
