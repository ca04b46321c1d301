//! Independent checks of generated plans: laws over many seeds, and invariants of every plan.
//!
//! Statistical tests use fixed seeds; each states its false-alarm rate.

use glam::DVec2;
use proptest::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::*;
use crate::certificate::{Verdict, verify};
use crate::geometry::Shape;
use crate::world::{Contents, Wall, WallKind};
use crate::{Blueprint, Seed, Spec, SpecError, World, WorldSpec};

const SEEDS: u64 = 10_000;

fn thesis(difficulty: f64, size: u32) -> IndoorSpec {
    IndoorSpec {
        difficulty,
        width: size,
        height: size,
        profile: Profile::Thesis,
        ..Default::default()
    }
}

/// The world of a small map with the other settings of a spec.
pub(super) fn small_world(spec: &IndoorSpec, seed: u64) -> World {
    let small = IndoorSpec { width: 6, height: 6, ..spec.clone() };
    small.generate(Seed(seed)).expect("a map").to_world()
}

fn plans(spec: &IndoorSpec, seeds: u64) -> impl Iterator<Item = FloorPlan> + '_ {
    (0..seeds).map(|seed| spec.generate(Seed(seed)).unwrap())
}

/// A share against its probability: 5 standard deviations, false-alarm rate 6e-7.
#[track_caller]
fn assert_share(hits: u64, of: u64, p: f64) {
    let share = hits as f64 / of as f64;
    let sigma = (p * (1.0 - p) / of as f64).sqrt();
    assert!((share - p).abs() <= 5.0 * sigma + 1e-12, "{hits} of {of} is {share}, not {p}");
}

#[test]
fn spacing_follows_its_law() {
    // Mean and deviation within 5 standard errors, and the deciles by chi-square with 9 degrees of
    // freedom; 36 tests, false-alarm rate under 1e-4 together.
    for (d, width, height) in [(0.0, 16, 16), (3.0, 32, 10), (7.5, 8, 24), (10.0, 16, 40)] {
        let spec = IndoorSpec { width, height, ..thesis(d, 16) };
        // A second map size a side: the two axes are drawn by themselves.
        let raws: Vec<[f64; 2]> =
            plans(&spec, SEEDS).map(|plan| plan.draws().unwrap().spacing_raw).collect();
        for (axis, size) in [(0, width), (1, height)] {
            let (mean, sigma) = (adaptation::spacing_mean(d, size), 0.1 * f64::from(size));
            let n = SEEDS as f64;
            let found = raws.iter().map(|raw| raw[axis]).sum::<f64>() / n;
            let variance =
                raws.iter().map(|raw| (raw[axis] - mean) * (raw[axis] - mean)).sum::<f64>() / n;
            assert!((found - mean).abs() < 5.0 * sigma / n.sqrt(), "{d} {size}: mean {found}");
            let deviation = variance.sqrt();
            assert!((deviation - sigma).abs() < 5.0 * sigma / (2.0 * n).sqrt(), "{deviation}");
            let law = Normal::new(mean, sigma).unwrap();
            let mut deciles = [0_u32; 10];
            for raw in &raws {
                deciles[((law.cdf(raw[axis]) * 10.0) as usize).min(9)] += 1;
            }
            let chi2: f64 = deciles
                .iter()
                .map(|&o| (f64::from(o) - n / 10.0) * (f64::from(o) - n / 10.0) / (n / 10.0))
                .sum();
            assert!(chi2 < 39.3, "{d} {size}: {deciles:?}");
        }
        let correlation: f64 = raws
            .iter()
            .map(|raw| {
                let z = |axis: usize, size: u32| {
                    (raw[axis] - adaptation::spacing_mean(d, size)) / (0.1 * f64::from(size))
                };
                z(0, width) * z(1, height)
            })
            .sum::<f64>()
            / SEEDS as f64;
        assert!(correlation.abs() < 0.05, "{correlation}");
    }
}

#[test]
fn cycles_doorways_and_plans_keep_their_rules() {
    for d in [0.0, 2.0, 6.5, 10.0] {
        let spec = thesis(d, 16);
        let (mut prevented, mut sides, mut doorways) = (0, 0, 0);
        for plan in plans(&spec, SEEDS) {
            let draws = plan.draws().unwrap();
            prevented += u64::from(draws.cycles_prevented);
            let shape = access::hallway_shape(plan.grid());
            assert_eq!(shape.parts, 1);
            assert!(!draws.cycles_prevented || shape.cycles == 0);
            assert!(draws.cycles_prevented || shape.cycles > 0);
            check_cells(&plan);
            sides += 4 * plan.rooms().len() as u64;
            doorways +=
                plan.rooms().iter().map(|room| u64::from(room.doorways.count())).sum::<u64>();
        }
        assert_share(prevented, SEEDS, 1.0 - d / 10.0);
        assert_share(doorways, sides, d / 16.0 + 0.375);
    }
}

/// No two rooms overlap, no room lies on a hallway of the rules, every cell is accounted for.
fn check_cells(plan: &FloorPlan) {
    let grid = plan.grid();
    let mut room_cells = 0;
    for (i, room) in plan.rooms().iter().enumerate() {
        let (width, height) = room.size();
        for y in room.y..room.y + height {
            for x in room.x..room.x + width {
                assert_eq!(grid.get(x, y), Some(Cell::Room(i as u32)));
                room_cells += 1;
            }
        }
    }
    assert_eq!(room_cells, grid.count(|cell| matches!(cell, Cell::Room(_))));
    let draws = plan.draws().unwrap();
    let [h, v] = draws.spacing;
    for y in 0..grid.height() {
        for x in 0..grid.width() {
            let cell = grid.get(x, y).unwrap();
            let of_rule = x % h == 0 || y % v == 0;
            let may_be_cut = draws.cycles_prevented && x % h == h - 1 && y % v == 0;
            assert!(of_rule || cell != Cell::Hallway);
            assert!(!of_rule || may_be_cut || cell == Cell::Hallway);
            // Solid is only what cycle prevention cut.
            assert!(may_be_cut || cell != Cell::Solid);
        }
    }
}

#[test]
fn first_choices_follow_the_probabilities() {
    // Chi-square with 19 degrees of freedom; false-alarm rate 1e-5 each.
    for d in [0.0, 4.3, 9.0] {
        let spec = thesis(d, 16);
        let mut counts = vec![0_u64; 20];
        for plan in plans(&spec, SEEDS) {
            for (count, (name, n)) in counts.iter_mut().zip(&plan.draws().unwrap().first_choice) {
                assert!(spec.allowed_rooms().iter().any(|room| room.name == *name));
                *count += n;
            }
        }
        let total: u64 = counts.iter().sum();
        let expected = spec.room_probabilities();
        let chi2: f64 = counts
            .iter()
            .zip(&expected)
            .map(|(&o, p)| {
                let e = p * total as f64;
                (o as f64 - e) * (o as f64 - e) / e
            })
            .sum();
        let p = 1.0 - ChiSquared::new(19.0).unwrap().cdf(chi2);
        assert!(p > 1e-5, "d = {d}: {counts:?}, p = {p}");
    }
}

#[test]
fn a_room_of_the_thesis_is_closed_as_often_as_its_law_says() {
    // One room size, hallways on all four sides: only the draws can close it.
    let mut spec = thesis(0.0, 16);
    spec.rooms = vec!["bisquare".to_owned()];
    (spec.spacing_h, spec.spacing_v) = (Some(3), Some(3));
    spec.cycles = Cycles::Allow;
    let (mut closed, mut rooms) = (0, 0);
    for plan in plans(&spec, 2000) {
        let inner = plan.rooms().iter().enumerate().filter(|(_, room)| room.x < 13 && room.y < 13);
        let doors = plan.access().doors_by_room();
        for (i, _) in inner {
            rooms += 1;
            closed += u64::from(doors[i] == 0);
        }
    }
    assert!(rooms > 30_000);
    assert_share(closed, rooms, 0.625 * 0.625 * 0.625 * 0.625);
}

#[test]
fn base_rules_by_hand() {
    let spec = IndoorSpec {
        spacing_h: Some(5),
        spacing_v: Some(4),
        doorway_probability: Some(0.5),
        room_choice: RoomChoice::Uniform,
        cycles: Cycles::Allow,
        open_areas: false,
        ..thesis(3.0, 16)
    };
    let (mut sides, mut doorways, mut first) = (0, 0, vec![0_u64; 20]);
    for plan in plans(&spec, 2000) {
        let draws = plan.draws().unwrap();
        assert_eq!(draws.spacing, [5, 4]);
        assert!(!draws.cycles_prevented);
        assert_eq!(plan.grid().count(|cell| cell == Cell::Open), 0);
        let metrics = plan.metrics();
        sides += metrics.sides;
        doorways += metrics.doorways;
        for (count, (_, n)) in first.iter_mut().zip(&draws.first_choice) {
            *count += n;
        }
    }
    assert_share(doorways, sides, 0.5);
    let total: u64 = first.iter().sum();
    for count in first {
        assert_share(count, total, 0.05);
    }
}

#[test]
fn guaranteed_plans_are_one_free_space() {
    let difficulties = [0.0, 1.0, 3.0, 5.0, 7.0, 9.0, 10.0];
    let (mut rooms, mut emptied) = (0, 0);
    for (seed, d) in (0..SEEDS).zip(difficulties.into_iter().cycle()) {
        let layout = if seed % 3 == 0 { Layout::LSystem } else { Layout::Grid };
        let spec = IndoorSpec { difficulty: d, layout, ..Default::default() };
        let plan = spec.generate(Seed(seed)).unwrap();
        let access = plan.access();
        assert_eq!(access.parts(), 1, "d = {d}, seed {seed}");
        assert!(access.doors_by_room().iter().all(|&doors| doors > 0));
        for opening in plan.openings() {
            assert!(grid::is_whole(plan.grid(), opening.gate));
        }
        rooms += plan.rooms().len();
        emptied += plan.rooms().iter().filter(|room| room.contents == Contents::Emptied).count();
    }
    // Emptying is the last resort.
    assert!(emptied * 250 < rooms, "{emptied} of {rooms} rooms were emptied");
}

#[test]
fn drawn_doorways_open_and_contents_yield() {
    let (mut cleared, mut rooms) = (0, 0);
    for seed in 0..200 {
        let spec = IndoorSpec { difficulty: (seed % 11) as f64, ..Default::default() };
        let plan = spec.generate(Seed(seed)).unwrap();
        let mut closed = 0;
        for room in plan.rooms() {
            for side in room.doorways.iter() {
                let places = (1..2 * room.side_length(side)).map(|at| room.gate(side, at));
                let whole = |gate: &Gate| grid::is_whole(plan.grid(), *gate);
                let possible = places.clone().any(|gate| whole(&gate));
                let open = places.filter(|gate| plan.openings().iter().any(|o| o.gate == *gate));
                assert!(open.count() >= usize::from(possible), "seed {seed}: {}", room.room.name);
                closed += u64::from(!possible);
            }
        }
        assert_eq!(plan.metrics().doorways_closed, closed);
        let world = plan.to_world();
        for (room, built) in plan.rooms().iter().zip(&world.rooms) {
            let design = Catalogue::builtin().get(&room.room.name).unwrap();
            assert_eq!(room.contents.is_as_designed(), room.room == *design);
            assert_eq!(room.contents, built.contents);
            let empty = room.room.barriers().count() == 0;
            assert!(room.contents != Contents::Emptied || empty);
        }
        let metrics = plan.metrics();
        (rooms, cleared) = (rooms + metrics.rooms, cleared + metrics.rooms_cleared);
    }
    // Doorways go where nothing blocks them if they can: few rooms lose contents.
    assert!(cleared > 0 && cleared * 10 < rooms, "{cleared} of {rooms} rooms were cleared");
}

#[test]
fn contents_keep_away_from_open_doorways_when_guaranteed() {
    use crate::geometry::Shape;
    for seed in 0..60 {
        let difficulty = (seed % 11) as f64;
        let spec = IndoorSpec { difficulty, ..Default::default() };
        let world = spec.generate(Seed(seed)).unwrap().to_world();
        let partitions =
            world.walls.iter().filter(|wall| wall.kind == crate::world::WallKind::Partition);
        let contents: Vec<&Shape> = partitions
            .map(|wall| &wall.shape)
            .chain(world.obstacles.iter().map(|obstacle| &obstacle.shape))
            .chain(world.surfaces.iter().filter(|s| s.speed == 0.0).map(|s| &s.shape))
            .collect();
        for door in &world.doorways {
            let opening = door.shape.bounds();
            let horizontal = opening.size().x > opening.size().y;
            // Points of the zone that is 0.94 m wide and 0.5 m deep on both sides.
            for along in 0..=10 {
                for across in -10..=10 {
                    let (u, v) = (f64::from(along) / 10.0 - 0.5, f64::from(across) / 10.0);
                    let (u, v) = (0.938 * u, 0.548 * v);
                    let offset = if horizontal { (u, v) } else { (v, u) };
                    let p = opening.center() + glam::DVec2::from(offset);
                    assert!(contents.iter().all(|shape| !shape.contains(p)), "seed {seed}: {p}");
                }
            }
        }
    }
}

#[test]
fn guaranteed_changes_nothing_that_was_drawn_before_the_doorways() {
    for seed in 0..200 {
        let strict = IndoorSpec { turn: Turn::Never, difficulty: 2.0, ..Default::default() };
        let letter = IndoorSpec { profile: Profile::Thesis, ..strict.clone() };
        let (strict, letter) =
            (strict.generate(Seed(seed)).unwrap(), letter.generate(Seed(seed)).unwrap());
        assert_eq!(strict.grid(), letter.grid());
        let sides = |plan: &FloorPlan| -> Vec<_> {
            plan.rooms().iter().map(|room| (room.x, room.y, room.doorways)).collect()
        };
        assert_eq!(sides(&strict), sides(&letter));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_valid_spec_makes_a_sound_world(
        seed: u64,
        difficulty in 0.0..=10.0_f64,
        width in 4..40_u32,
        height in 4..40_u32,
        unit in 1.5..4.0_f64,
        guaranteed: bool,
        l_system: bool,
        branching in 0.0..=1.0_f64,
        footprint in 0.1..0.4_f64,
    ) {
        let spec = IndoorSpec {
            difficulty,
            width,
            height,
            cell_size: unit,
            profile: if guaranteed { Profile::Guaranteed } else { Profile::Thesis },
            layout: if l_system { Layout::LSystem } else { Layout::Grid },
            branching,
            robot_radius: footprint,
            ..Default::default()
        };
        let plan = spec.generate(Seed(seed)).unwrap();
        prop_assert_eq!(&plan, &spec.generate(Seed(seed)).unwrap());
        let access = plan.access();
        prop_assert!(!guaranteed || access.parts() == 1);
        let world = plan.to_world();
        prop_assert_eq!(world.check(), Ok(()));
        check_world(&plan, &world);
        let metrics = plan.metrics();
        prop_assert_eq!(metrics.cells.hallway + metrics.cells.open + metrics.cells.room
            + metrics.cells.solid, u64::from(width * height));
        prop_assert!(serde_json::to_string(&plan).is_ok());
    }
}

/// There are walls on every line between cells that are not one space, except for the doorways.
fn check_world(plan: &FloorPlan, world: &World) {
    let spec = plan.spec();
    let walls: Vec<_> = world
        .walls
        .iter()
        .filter(|wall| wall.kind == crate::world::WallKind::Wall)
        .map(|wall| &wall.shape)
        .collect();
    let solid = |p| walls.iter().any(|shape| shape.contains(p));
    let openings: std::collections::BTreeSet<_> =
        plan.openings().iter().map(|opening| opening.gate).collect();
    for gate in &openings {
        assert!(!solid(plan.gate_middle(*gate)));
    }
    for i in 0..plan.grid().cells().len().min(200) {
        let (x, y) = plan.grid().position(i);
        for gate in [
            Gate { wall: Axis::Horizontal, line: y, at: 2 * x + 1 },
            Gate { wall: Axis::Vertical, line: x, at: 2 * y + 1 },
        ] {
            let [[a, _], [b, _]] = gate.cells(plan.grid());
            let divided = a != b && !(a.is_floor() && b.is_floor());
            let near = openings.range(..).any(|opening| {
                opening.wall == gate.wall
                    && opening.line == gate.line
                    && 0.5 * spec.cell_size * f64::from(opening.at.abs_diff(gate.at)) < spec.doorway
            });
            assert!(solid(plan.gate_middle(gate)) == divided || near);
        }
        assert!(!solid(plan.cell_middle(x, y)));
    }
    if let (Some(start), Some(goal)) = (world.start, world.goal) {
        assert!(world.clearance(start.position) >= spec.robot_radius);
        assert!(world.clearance(goal.position) >= spec.robot_radius);
    }
}

#[test]
fn clearances_narrow_or_widen_every_furnished_room() {
    let spec = IndoorSpec {
        difficulty: 6.0,
        width: 8,
        height: 8,
        rooms: ["computer lab", "single office", "multi office"].map(str::to_owned).to_vec(),
        clearance: Some(1.3),
        ..Default::default()
    };
    let plan = spec.generate(Seed(4)).unwrap();
    let draws = plan.draws().unwrap();
    assert_eq!(draws.variations.len(), plan.rooms().len());
    assert!(draws.variations.iter().all(|[before, after]| after >= before));
    assert!(draws.variations.iter().any(|[before, after]| after > &(before + 0.1)));
    assert_eq!(plan.access().parts(), 1);
    assert_eq!(plan.to_world().check(), Ok(()));
}

#[test]
fn bad_specs_name_field_value_and_limits() {
    let refused = |spec: IndoorSpec| -> SpecError { spec.validate().unwrap_err() };
    let ok = IndoorSpec::default;
    for difficulty in [f64::NAN, -1.0, 10.5, f64::INFINITY] {
        let error = refused(IndoorSpec { difficulty, ..ok() });
        assert_eq!(
            (error.field.as_str(), error.allowed.as_str()),
            ("difficulty", "a number from 0 to 10")
        );
    }
    for size in [0, 3, 1025, 1_000_000_000] {
        let error = refused(IndoorSpec { width: size, ..ok() });
        assert_eq!(error.value, size.to_string());
        assert_eq!(error.field, "width");
        assert_eq!(refused(IndoorSpec { height: size, ..ok() }).field, "height");
    }
    assert_eq!(refused(IndoorSpec { cell_size: f64::NAN, ..ok() }).field, "cell_size");
    assert_eq!(refused(IndoorSpec { robot_radius: 0.45, ..ok() }).field, "robot_radius");
    assert_eq!(refused(IndoorSpec { doorway: 2.9, ..ok() }).field, "doorway");
    assert_eq!(refused(IndoorSpec { spacing_h: Some(16), ..ok() }).field, "spacing_h");
    assert_eq!(refused(IndoorSpec { spacing_v: Some(2), ..ok() }).field, "spacing_v");
    assert_eq!(refused(IndoorSpec { open_areas: false, ..ok() }).field, "open_areas");
    let narrow = IndoorSpec { cell_size: 1.2, wall_thickness: 0.5, robot_radius: 0.05, ..ok() };
    assert_eq!(IndoorSpec { doorway: 0.2, ..narrow.clone() }.validate(), Ok(()));
    let error = refused(IndoorSpec { doorway: 0.3, ..narrow.clone() });
    assert!(error.allowed.starts_with("at most 0.2 m"), "{error}");
    let error = refused(IndoorSpec { doorway: 0.2, robot_radius: 0.06, ..narrow });
    assert!(error.allowed.starts_with("at most 0.05 m"), "{error}");
    let error = refused(IndoorSpec { doorway_probability: Some(f64::NAN), ..ok() });
    assert_eq!(error.field, "doorway_probability");
    assert_eq!(refused(IndoorSpec { clearance: Some(-1.0), ..ok() }).field, "clearance");
    let error = refused(IndoorSpec { rooms: vec!["sauna".to_owned()], ..ok() });
    assert!(error.value == "sauna" && error.allowed.contains("water room"));
    let rooms = vec!["maze2".to_owned()];
    let error = refused(IndoorSpec { rooms, width: 6, height: 6, ..ok() });
    assert!(error.allowed.contains("at most 5 by 5 cells"), "{error}");
}

#[test]
fn settings_are_read_from_text() {
    let mut spec = WorldSpec::from(IndoorSpec::default());
    for (name, value) in [
        ("difficulty", "7"),
        ("profile", "thesis"),
        ("rooms", "dark, maze (smaller)"),
        ("spacing_h", "5"),
        ("doorway_probability", "0.25"),
        ("clearance", "0.8"),
        ("layout", "l_system"),
    ] {
        spec.set(name, value).unwrap();
    }
    let WorldSpec::Indoor(ref indoor) = spec else { unreachable!() };
    assert_eq!(indoor.rooms, ["dark", "maze (smaller)"]);
    assert_eq!((indoor.spacing_h, indoor.clearance), (Some(5), Some(0.8)));
    spec.set("spacing_h", "null").unwrap();
    assert_eq!(WorldSpec::from_ron(&spec.to_ron()), Ok(spec.clone()));
    assert!(spec.set("difficulty", "10.5").is_err());
    let seed = Seed(3);
    let world = spec.generate(seed).unwrap().to_world();
    assert_eq!(WorldSpec::from_provenance(&world.provenance), Ok(spec));
}

#[test]
fn a_spec_with_its_own_catalogue_is_whole() {
    let catalogue = Catalogue::new([RoomDesign::bare("cell", 1, 1, 3.0)]).unwrap();
    let spec = IndoorSpec { catalogue: Some(catalogue), ..Default::default() };
    let world = spec.generate(Seed(1)).unwrap().to_world();
    assert!(world.rooms.iter().all(|room| room.name == "cell"));
    let back = WorldSpec::from_provenance(&world.provenance).unwrap();
    assert_eq!(back, WorldSpec::from(spec.clone()));
    assert_eq!(WorldSpec::from_ron(&back.to_ron()), Ok(back));
}

#[test]
fn blueprints_have_the_documented_fields() {
    let plan = thesis(3.0, 16).generate(Seed(2)).unwrap();
    let json = serde_json::to_value(&plan).unwrap();
    assert_eq!(
        (&json["width"], &json["height"], &json["unit"]),
        (&16.into(), &16.into(), &3.0.into())
    );
    assert!(json["cycles_prevented"].is_boolean());
    assert_eq!(json["spacing"].as_array().unwrap().len(), 2);
    let cells = json["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 16);
    assert!(cells.iter().all(|row| row.as_str().unwrap().chars().count() == 16));
    assert!(cells[0].as_str().unwrap().starts_with('.'));
    for (room, placed) in json["rooms"].as_array().unwrap().iter().zip(plan.rooms()) {
        for field in ["name", "x", "y", "width", "height", "turned", "difficulty"] {
            assert!(!room[field].is_null(), "{field}");
        }
        assert_eq!(room["doorways"].as_array().unwrap().len(), placed.doorways.count() as usize);
    }
    let metrics = serde_json::to_value(plan.metrics()).unwrap();
    for field in [
        "spacing_raw",
        "first_choice",
        "room_difficulty_mean",
        "sides",
        "doorways",
        "room_areas",
        "dead_ends",
        "cycles",
    ] {
        assert!(!metrics[field].is_null(), "{field}");
    }
}

#[test]
fn what_would_hold_too_much_is_refused() {
    let large = IndoorSpec { width: 1024, height: 1024, ..Default::default() };
    assert!(large.validate().is_ok());
    let narrow = IndoorSpec {
        mazes: 1.0,
        maze_passage: 0.12,
        robot_radius: 0.01,
        wall_thickness: 0.01,
        ..large.clone()
    };
    assert_eq!(narrow.validate().unwrap_err().field, "maze_passage");
    assert!(IndoorSpec { width: 64, height: 64, ..narrow.clone() }.validate().is_ok());
    // What programs ask before they generate is about as much as comes out.
    let narrow = IndoorSpec { width: 64, height: 64, ..narrow };
    assert!(narrow.work() > 20.0 * IndoorSpec { mazes: 0.0, ..narrow.clone() }.work());

    let mut full = RoomDesign::bare("full", 1, 1, 3.0);
    let wall = |i: u32| {
        let y = 0.5 + 0.0002 * f64::from(i);
        let center = DVec2::new(1.5, y);
        let shape = Shape::Box { center, half_size: DVec2::new(1.0, 0.0001), heading: 0.0 };
        Wall::new(WallKind::Wall, shape)
    };
    full.walls.extend((0..9000).map(wall));
    let catalogue = Some(Catalogue::new([full]).unwrap());
    let full = IndoorSpec { catalogue, ..large };
    assert_eq!(full.validate().unwrap_err().field, "width");
}

#[test]
fn rooms_in_which_the_robot_has_no_place_are_not_claimed_to_be_reachable() {
    let spec = IndoorSpec {
        doorway: 2.8,
        robot_radius: 1.35,
        rooms: vec!["single office".to_owned()],
        ..thesis(5.0, 8)
    };
    for seed in 0..20 {
        let world = spec.generate(Seed(seed)).unwrap().to_world();
        for (claim, verdict) in verify(&world) {
            assert_eq!(verdict, Verdict::Holds, "{seed}: {claim:?}");
        }
    }
}

#[test]
fn doorways_of_calibrated_maps_are_not_narrower_than_asked() {
    for narrowest in [0.82, 0.9, 1.2] {
        let spec = IndoorSpec {
            width: 8,
            height: 8,
            profile: Profile::Calibrated,
            doorway_narrowest: Some(narrowest),
            ..Default::default()
        };
        for seed in 0..4 {
            let plan = spec.generate(Seed(seed)).unwrap();
            assert_eq!(plan.spec().doorway_narrowest, Some(narrowest));
            assert_eq!(plan.spec().validate(), Ok(()), "{seed}");
            for doorway in plan.to_world().doorways {
                let width = doorway.shape.bounds().size().max_element();
                assert!(width >= narrowest - 1e-9, "{narrowest} {seed}: {width}");
            }
        }
    }
}
