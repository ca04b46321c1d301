//! What Zwennes' appendix A says of each room holds for its file.

use glam::DVec2;

use super::*;
use crate::geometry::Shape;
use crate::indoor::dimensions::Dimensions;
use crate::indoor::grid::Side;
use crate::indoor::interior::{Interior, Port, narrowest_passage};
use crate::indoor::variation::cut_off;
use crate::world::{ObstacleKind, SurfaceKind};

/// The Pioneer 3-AT of the paper, in its walls.
const ROBOT: Dimensions = Dimensions { unit: 3.0, wall: 0.1, doorway: 0.94, radius: 0.36 };

/// Appendix A: name, columns, rows, difficulty.
const APPENDIX: [(&str, u32, u32, f64); 20] = [
    ("dark", 1, 1, 0.5),
    ("empty", 1, 1, 0.5),
    ("bisquare", 2, 2, 1.5),
    ("victims", 1, 2, 2.0),
    ("maze", 2, 2, 2.5),
    ("futuristic reception", 2, 2, 3.5),
    ("warehouse", 2, 2, 4.0),
    ("maze (smaller)", 2, 2, 4.0),
    ("computer lab", 2, 2, 5.0),
    ("single office", 1, 1, 5.25),
    ("dragon room", 2, 2, 5.5),
    ("multi office", 2, 1, 5.75),
    ("cubicle unlit", 4, 4, 6.25),
    ("boiler room", 1, 1, 6.8),
    ("single office north destroyed", 1, 1, 7.0),
    ("multi office tight unlit destroyed", 2, 1, 7.2),
    ("computer lab unlit destroyed", 2, 2, 7.3),
    ("cubicle unlit destroyed", 4, 4, 8.0),
    ("water room", 3, 3, 9.0),
    ("maze2", 6, 6, 9.5),
];

fn room(name: &str) -> &'static SharedRoom {
    Catalogue::builtin().get(name).unwrap()
}

fn width_of(name: &str) -> f64 {
    narrowest_passage(room(name), 3.0, 0.1, 0.94)
}

/// The place for a doorway in the middle of a side.
fn middle(room: &SharedRoom, side: Side) -> Port {
    let length = match side {
        Side::North | Side::South => room.width,
        Side::East | Side::West => room.height,
    };
    room.interior(ROBOT).port(side, length)
}

#[test]
fn names_sizes_and_difficulties_are_the_papers() {
    let rooms: Vec<_> = Catalogue::builtin()
        .rooms()
        .iter()
        .map(|room| (room.name.as_str(), room.width, room.height, room.difficulty))
        .collect();
    assert_eq!(rooms, APPENDIX);
}

#[test]
fn every_side_takes_a_doorway_and_every_place_has_one() {
    for room in Catalogue::builtin().rooms() {
        for side in Side::ALL {
            assert!(middle(room, side).usable(), "{} {side:?}", room.name);
        }
        for radius in [0.34, 0.35, 0.36] {
            let interior = room.interior(Dimensions { radius, ..ROBOT });
            assert_eq!(cut_off(&interior, room), 0, "{} {radius}", room.name);
        }
    }
}

#[test]
fn empty_rooms_are_empty_and_unlit_rooms_are_dark() {
    for name in ["dark", "empty", "bisquare", "victims"] {
        assert_eq!(room(name).barriers().count() + room(name).surfaces.len(), 0, "{name}");
    }
    for room in Catalogue::builtin().rooms() {
        let dark = room.name == "dark" || room.name.contains("unlit");
        assert_eq!(room.lit, !dark, "{}", room.name);
        assert_eq!(room.victims.is_empty(), room.name != "victims", "{}", room.name);
        assert!(!room.reason.is_empty());
    }
}

#[test]
fn the_reception_has_plenty_of_space_around_it() {
    let room = room("futuristic reception");
    let counter = room.obstacles[0].shape.bounds();
    assert_eq!(room.obstacles.len(), 1);
    let space = (counter.min - 0.05).min(room.size() - 0.05 - counter.max).min_element();
    assert!(space >= 1.0, "{space} m");
    assert!(counter.center().distance(room.size() * 0.5) < 1e-9);
}

#[test]
fn rooms_leave_as_much_space_as_the_paper_says() {
    // Plenty of room to move; some space to move left; tricky, but not impossible; walkways of
    // reasonable size; a slight hindrance.
    assert!(width_of("warehouse") >= 1.2);
    assert!(room("warehouse").obstacles.iter().all(|o| o.kind == ObstacleKind::Container));
    assert!((0.8..1.2).contains(&width_of("dragon room")));
    assert!((0.8..1.2).contains(&width_of("computer lab")));
    assert!((0.8..width_of("computer lab")).contains(&width_of("single office")));
    assert!(width_of("cubicle unlit") >= 1.2);
    assert!((1.0..2.0).contains(&width_of("multi office")));
    assert!(room("multi office").walls.is_empty());
    for name in ["warehouse", "dragon room", "computer lab", "single office", "multi office"] {
        assert_eq!(room(name).interior(ROBOT).parts().len(), 1, "{name}");
    }
}

#[test]
fn what_is_destroyed_is_harder_to_pass() {
    for (intact, destroyed) in [
        ("computer lab", "computer lab unlit destroyed"),
        ("single office", "single office north destroyed"),
        ("multi office", "multi office tight unlit destroyed"),
        ("cubicle unlit", "cubicle unlit destroyed"),
    ] {
        assert!(width_of(destroyed) < 0.9 * width_of(intact), "{destroyed}");
        assert!(room(destroyed).surfaces.iter().any(|s| s.kind == SurfaceKind::Debris));
    }
    // Slanted walls: not one of the panels runs along an axis.
    let panels = room("cubicle unlit destroyed");
    let mut panels = panels.obstacles.iter().filter(|o| o.kind == ObstacleKind::Panel);
    assert!(panels.all(|o| matches!(o.shape, Shape::Box { heading, .. } if heading != 0.0)));
}

#[test]
fn fallen_things_split_the_tight_office_in_two() {
    let room = room("multi office tight unlit destroyed");
    assert_eq!(room.interior(ROBOT).parts().len(), 2);
    assert_ne!(middle(room, Side::West).part, middle(room, Side::East).part);
    // Not even much smaller robots get through.
    assert_eq!(room.interior(Dimensions { radius: 0.2, ..ROBOT }).parts().len(), 2);
}

#[test]
fn the_boiler_is_what_blocks_the_boiler_room() {
    let boiler_room = room("boiler room");
    assert_eq!(boiler_room.interior(ROBOT).parts().len(), 2);
    assert_ne!(middle(boiler_room, Side::West).part, middle(boiler_room, Side::East).part);
    let mut without = (**boiler_room).clone();
    without.obstacles.retain(|o| o.kind != ObstacleKind::Boiler);
    assert_eq!(without.obstacles.len(), 2);
    assert_eq!(Interior::new(&without, ROBOT).parts().len(), 1);
}

#[test]
fn mazes_are_mazes() {
    // Seen from its passages: every one leads to every other, and many end.
    for (name, cells, ends) in [("maze", 5, 5), ("maze (smaller)", 6, 8), ("maze2", 18, 60)] {
        let room = room(name);
        let pitch = room.size().x / cells as f64;
        let at = |i: usize| DVec2::new((i % cells) as f64 + 0.5, (i / cells) as f64 + 0.5) * pitch;
        let passes = |a: DVec2, b: DVec2| {
            let clear = |p: DVec2| room.barriers().all(|shape| shape.distance(p) > 0.36);
            (0..=10).all(|k| clear(a.lerp(b, f64::from(k) / 10.0)))
        };
        let mut sets = crate::union_find::UnionFind::new(cells * cells);
        let (mut exits, mut pieces) = (vec![0; cells * cells], cells * cells);
        for i in 0..cells * cells {
            let right = (i % cells + 1 < cells).then_some(i + 1);
            let above = (i / cells + 1 < cells).then_some(i + cells);
            for j in [right, above].into_iter().flatten().filter(|&j| passes(at(i), at(j))) {
                exits[i] += 1;
                exits[j] += 1;
                pieces -= usize::from(sets.join(i, j));
            }
        }
        assert_eq!(pieces, 1, "{name}");
        let dead = exits.iter().filter(|&&exits| exits == 1).count();
        assert!(dead >= ends, "{name}: {dead} dead ends");
        assert!(room.surfaces.iter().any(|s| s.kind == SurfaceKind::Uneven));
        assert_eq!(room.interior(ROBOT).parts().len(), 1);
    }
    // The smaller one is denser, the very large one narrow.
    assert!(width_of("maze") > 1.0 && width_of("maze (smaller)") < 1.0 && width_of("maze2") < 1.0);
}

#[test]
fn narrow_walkways_cross_the_water() {
    let room = room("water room");
    let sides = Side::ALL.map(|side| middle(room, side).part);
    assert!(sides.iter().all(|&part| part.is_some() && part == sides[0]));
    assert!((0.72..1.0).contains(&width_of("water room")));
    let dry = |p: DVec2| room.surfaces.iter().all(|s| s.speed > 0.0 || !s.shape.contains(p));
    let water: Vec<_> = room.surfaces.iter().filter(|s| s.kind == SurfaceKind::Water).collect();
    assert!(water.iter().all(|s| s.speed == 0.0));
    assert!(water.iter().map(|s| s.shape.area()).sum::<f64>() > 0.75 * 81.0);
    assert!(dry(DVec2::new(4.5, 1.0)) && !dry(DVec2::new(1.0, 1.0)));
    // Stairs lie between each pair of neighbouring doorways.
    let sees = |a: DVec2, b: DVec2| {
        let stairs = || room.obstacles.iter().filter(|o| o.kind == ObstacleKind::Stairs);
        (0..=200).all(|k| stairs().all(|o| !o.shape.contains(a.lerp(b, f64::from(k) / 200.0))))
    };
    let doors = [(4.5, 8.7), (8.7, 4.5), (4.5, 0.3), (0.3, 4.5)].map(DVec2::from);
    for i in 0..4 {
        assert!(!sees(doors[i], doors[(i + 1) % 4]), "{i}");
    }
    assert!(sees(doors[0], doors[2]) && sees(doors[1], doors[3]));
}

#[test]
fn a_catalogue_is_refused_for_what_is_wrong() {
    assert_eq!(Catalogue::new([]), Err(CatalogueError::Count(0)));
    let twice = [RoomDesign::bare("a", 1, 1, 1.0), RoomDesign::bare("a", 2, 2, 2.0)];
    assert_eq!(Catalogue::new(twice), Err(CatalogueError::Duplicate("a".to_owned())));
    let flat = RoomDesign::bare("a", 0, 1, 1.0);
    assert!(matches!(Catalogue::new([flat]), Err(CatalogueError::Room(RoomError::Size { .. }))));
}

/// Found by mutated files: turned by a quarter, the box lay outside of its room.
#[test]
fn headings_that_a_quarter_turn_is_lost_in_are_refused() {
    let refused = |shape: &str| {
        let text = format!(
            "(name: \"a\", width: 2, height: 1, difficulty: 1, obstacles: [(kind: desk, shape: {shape})])"
        );
        SharedRoom::new(room_from_ron(&text).unwrap()).err().map(|error| error.to_string())
    };
    let boxed =
        |heading| format!("box(center: (3.0, 1.5), half_size: (1.0, 1.45), heading: {heading})");
    assert_eq!(refused(&boxed("-6.2831853")), None);
    for heading in ["9223372036854775807", "-1001", "1e300"] {
        let error = refused(&boxed(heading)).unwrap();
        assert!(error.contains("obstacle 0 is not") && error.contains("1000 rad"), "{error}");
    }
    let corner = |i: u32| {
        let turn = crate::geometry::unit_vector(std::f64::consts::TAU * f64::from(i) / 1001.0);
        format!("({}, {})", 3.0 + turn.x, 1.5 + turn.y)
    };
    let corners: Vec<String> = (0..1001).map(corner).collect();
    let error = refused(&format!("polygon(vertices: [{}])", corners.join(", "))).unwrap();
    assert!(error.contains("three to 1000 corners"), "{error}");
}

#[test]
fn a_catalogue_survives_json() {
    let json = serde_json::to_string(Catalogue::builtin()).unwrap();
    let back: Catalogue = serde_json::from_str(&json).unwrap();
    assert_eq!(&back, Catalogue::builtin());
    assert!(serde_json::from_str::<Catalogue>("[]").is_err());
}
