use proptest::prelude::*;

use super::*;
use crate::occupancy::Coverage;
use crate::raycast::Raycaster;

const YAML: &str = "image: hall.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";

fn description(yaml: &str) -> RosDescription {
    RosDescription::from_yaml(yaml).expect("a description")
}

/// Cells as text, the top row first: `#`, `.` and `?`.
fn picture(map: &RosMap) -> Vec<String> {
    let letter = |cell: &RosCell| match cell {
        RosCell::Occupied => '#',
        RosCell::Free => '.',
        RosCell::Unknown => '?',
    };
    map.cells.chunks_exact(map.cols).rev().map(|row| row.iter().map(letter).collect()).collect()
}

fn map_of(rows: &[&str]) -> RosMap {
    let cell = |letter| match letter {
        b'#' => RosCell::Occupied,
        b'.' => RosCell::Free,
        _ => RosCell::Unknown,
    };
    let cells = rows.iter().rev().flat_map(|row| row.bytes().map(cell)).collect();
    let origin = Pose::new(-1.0, 2.0, 0.0);
    RosMap { cols: rows[0].len(), resolution: 0.5, origin, cells }
}

#[test]
fn greys_become_cells_as_in_ros() {
    let pgm = b"P2 6 1 255 0 88 90 204 206 254";
    let cells = |yaml: &str| picture(&description(yaml).map(pgm).unwrap()).concat();
    // p is 1, 0.655, 0.647, 0.2, 0.192 and 0.004.
    assert_eq!(cells(YAML), "##??..");
    assert_eq!(cells(&YAML.replace("negate: 0", "negate: 1")), ".??###");
    assert_eq!(cells(&YAML.replace("negate: 0", "negate: true")), ".??###");
    assert_eq!(cells(&format!("{YAML}mode: scale\n")), "##??..");
    assert_eq!(cells(&format!("{YAML}mode: trinary\n")), "##??..");
    // Nav2 ignores capitals.
    assert_eq!(cells(&format!("{YAML}mode: Trinary\n")), "##??..");
    assert_eq!(cells(&format!("{YAML}mode: RAW\n")), ".##???");
    // 0 %, 88 % and 90 %; the others are not percentages.
    assert_eq!(cells(&format!("{YAML}mode: raw\n")), ".##???");
    // Thresholds are not reached by what equals them.
    let sharp = YAML.replace("0.65", "0.8").replace("0.196", "0.6");
    let pgm = b"P2 3 1 5 1 2 0";
    assert_eq!(picture(&description(&sharp).map(pgm).unwrap()), ["??#"]);
}

#[test]
fn transparency_is_unknown_where_probabilities_scale() {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 3, 1);
    encoder.set_color(png::ColorType::GrayscaleAlpha);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0, 255, 0, 254, 255, 0]).unwrap();
    writer.finish().unwrap();
    let cells = |yaml: &str| picture(&description(yaml).map(&png).unwrap()).concat();
    assert_eq!(cells(&format!("{YAML}mode: scale\n")), "#??");
    // Transparency is averaged in: (3 x 0 + 255) / 4 is p = 0.75, (3 x 255 + 0) / 4 is p = 0.25.
    assert_eq!(cells(YAML), "##?");
}

#[test]
fn what_is_wrong_with_a_description_is_named() {
    for (from, to, what) in [
        ("image: hall.pgm\n", "", "image"),
        ("hall.pgm", "\"\"", "`image` must be the name"),
        ("resolution: 0.5\n", "", "resolution"),
        ("resolution: 0.5", "resolution: 0", "`resolution` must be from 0.001 to 100000 m, got 0"),
        ("resolution: 0.5", "resolution: .nan", "`resolution` must be"),
        ("resolution: 0.5", "resolution: -1", "`resolution` must be"),
        ("resolution: 0.5", "resolution: wide", "resolution"),
        ("-1.0, 2.0, 0.0", "-1.0, 2.0", "not the YAML of a map"),
        ("-1.0, 2.0, 0.0", "-1.0, .inf, 0.0", "`origin` must be three"),
        ("-1.0, 2.0, 0.0", "-1.0, 2.0, 1e30", "`origin`"),
        ("negate: 0", "negate: 2", "`negate` must be 0, 1"),
        ("negate: 0", "negate: maybe", "`negate: maybe`: `negate` must be 0, 1, false or true"),
        ("negate: 0", "negate: 1.0", "`negate: 1.0`: `negate` must be 0, 1, false or true"),
        ("0.65", "1.5", "`occupied_thresh` must be from 0 to 1, got 1.5"),
        ("0.196", ".nan", "`free_thresh` must be from 0 to 1, got NaN"),
        ("0.196", "0.7", "`free_thresh` must be at most `occupied_thresh`, 0.65, got 0.7"),
        (
            "negate: 0",
            "negate: 0\nmode: Dual",
            "line 5, `mode: Dual`: `Dual` is not one of trinary",
        ),
        ("image: ", "image: [", "not the YAML of a map"),
        ("image: ", "image: [", "line 1, `image: [hall.pgm`: not a text or a number"),
        ("[-1.0, 2.0, 0.0]", "here", "line 3, `origin: here`: not a list in brackets"),
        (YAML, "hall", "line 1, `hall`: not a key with its value"),
        ("resolution", "\tresolution", "not valid YAML"),
        ("negate: 0", "negate: 0\nimage: b.pgm", "line 5, `image: b.pgm`: the key occurs twice"),
        ("resolution: 0.5\n", "", "not the YAML of a map: `resolution` is missing"),
        ("resolution: 0.5", "resolution: wide", "line 2, `resolution: wide`: not a number"),
        ("negate: 0\n", "negate: 0\n\tx: [\n", "line "),
    ] {
        assert!(YAML.contains(from), "{from}");
        let error = RosDescription::from_yaml(&YAML.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(what), "{to}: {error}");
        let words = ["error", "Options", "Policy", "deserialize", "scalar", "\n"];
        assert!(words.iter().all(|word| !error.contains(word)), "{to}: {error}");
    }
    assert!(RosDescription::from_yaml("").is_err());
    // Fields that Nav2 and others add are ignored.
    assert!(RosDescription::from_yaml(&format!("{YAML}frame_id: map\n")).is_ok());
    // Nor does a file that refers to itself over and over.
    let bomb = "a: &a [x, x, x, x, x, x, x, x, x]\nb: &b [*a, *a, *a, *a, *a, *a, *a, *a, *a]\n\
                c: &c [*b, *b, *b, *b, *b, *b, *b, *b, *b]\nd: [*c, *c, *c, *c, *c, *c, *c, *c]\n";
    let _ = RosDescription::from_yaml(&bomb.repeat(3));
}

#[test]
fn runs_join_into_few_boxes() {
    let map = map_of(&["#####", "#...#", "#...#", "#####"]);
    let world = map.to_world(UnknownCells::Solid);
    assert_eq!(world.check(), Ok(()));
    assert_eq!((world.walls.len(), world.obstacles.len()), (4, 0));
    assert_eq!(world.walls.iter().map(|wall| wall.shape.area()).sum::<f64>(), 14.0 * 0.25);
    // The border is closed: nothing more is added around it.
    // In a room of 3 x 2 all cells are one cell from a wall: the first.
    assert_eq!(world.start, Some(Pose::new(-0.25, 2.75, 0.0)));
    assert_eq!(world.bounds, Rect::new(DVec2::new(-1.0, 2.0), DVec2::new(1.5, 4.0)));
}

#[test]
fn unknown_cells_are_solid_or_free() {
    let map = map_of(&["??????", "?#..#?", "?#...?", "??????"]);
    let solid = map.to_world(UnknownCells::Solid);
    let area = |shapes: Vec<&Shape>| shapes.iter().map(|shape| shape.area()).sum::<f64>();
    assert_eq!(area(solid.obstacles.iter().map(|part| &part.shape).collect()), 16.0 * 0.25);
    assert_eq!(area(solid.walls.iter().map(|part| &part.shape).collect()), 3.0 * 0.25);
    // Unknown cells are free, but the ground beyond the map is not.
    let free = map.to_world(UnknownCells::Free).obstacles;
    assert!(free.len() == 4 && free.iter().all(|part| !part.shape.contains(DVec2::new(0.5, 3.9))));
    let full = map_of(&["#?", "??"]).to_world(UnknownCells::Solid);
    assert_eq!((full.start, full.check()), (None, Ok(())));
}

#[test]
fn maps_with_too_many_walls_are_refused() {
    let side = 3000;
    let cell = |i: usize| {
        if (i / side + i % side).is_multiple_of(2) { RosCell::Occupied } else { RosCell::Free }
    };
    let (cols, resolution, origin) = (side, 0.05, Pose::default());
    let cells = (0..side * side).map(cell).collect();
    let chequered = RosMap { cols, resolution, origin, cells };
    let error = chequered.check_boxes().unwrap_err().to_string();
    assert!(error.starts_with("the map has 4500000 walls"), "{error}");
    // Runs above each other are one wall.
    let cells = (0..side * side).map(|i| cell(i % side)).collect();
    let striped = RosMap { cells, ..chequered };
    striped.check_boxes().unwrap();
    assert_eq!(striped.to_world(UnknownCells::Solid).walls.len(), 1500);
}

#[test]
fn starts_have_room_in_maps_of_tiny_cells() {
    let (side, resolution) = (2000, 0.001);
    let origin = Pose::new(-10.0, -10.0, 0.0);
    let map = RosMap { cols: side, resolution, origin, cells: vec![RosCell::Free; side * side] };
    let start = map.to_world(UnknownCells::Solid).start.unwrap();
    assert!(start.position.distance(DVec2::splat(-9.0)) < 0.15, "{start:?}");
    // A turned map of a room in the middle of a block, with nothing around it.
    let (side, origin) = (800, Pose::new(0.0, 0.0, std::f64::consts::FRAC_PI_4));
    let is_free = |i: usize| [i % side, i / side].iter().all(|at| (280..520).contains(at));
    let cell = |i| if is_free(i) { RosCell::Free } else { RosCell::Occupied };
    let cells = (0..side * side).map(cell).collect();
    let turned = RosMap { cols: side, resolution: 0.005, origin, cells };
    let start = turned.to_world(UnknownCells::Solid).start.unwrap();
    assert!(start.position.distance(origin.to_world(DVec2::splat(2.0))) < 0.1, "{start:?}");
    // In a room that is too small for the coarser grid.
    let small = RosMap { cols: 50, cells: vec![RosCell::Free; 2500], ..map };
    assert!(small.to_world(UnknownCells::Solid).start.is_some());
}

#[test]
fn an_open_border_is_closed_beyond_the_map() {
    let world = map_of(&["##.#", "#...", "####"]).to_world(UnknownCells::Solid);
    assert_eq!(world.check(), Ok(()));
    // Above the gap in the first row, and beside both open cells of the right column: each reaches
    // past a corner only where it ends at one.
    let boxes: Vec<Rect> = world.obstacles.iter().map(|part| part.shape.bounds()).collect();
    let v = DVec2::new;
    assert_eq!(boxes, [Rect::new(v(0.0, 3.5), v(0.5, 4.0)), Rect::new(v(1.0, 2.5), v(1.5, 3.0))]);
    assert_eq!(world.bounds, Rect::new(v(-1.0, 2.0), v(1.5, 4.0)));
    let open = map_of(&["."]).to_world(UnknownCells::Free);
    assert_eq!((open.obstacles.len(), open.bounds.size()), (4, DVec2::splat(1.5)));
}

#[test]
fn a_turned_map_turns_about_its_corner() {
    let mut map = map_of(&["..", "#."]);
    map.origin = Pose::new(3.0, 1.0, std::f64::consts::FRAC_PI_2);
    let world = map.to_world(UnknownCells::Solid);
    assert_eq!(world.check(), Ok(()));
    // Columns run up, rows to the left; three cells of the border are open.
    let shape = &world.walls[0].shape;
    assert!(shape.contains(DVec2::new(2.75, 1.25)) && !shape.contains(DVec2::new(2.75, 1.75)));
    assert!(world.bounds.min.distance(DVec2::new(1.5, 0.5)) < 1e-12);
    assert_eq!(world.start.unwrap().heading, std::f64::consts::FRAC_PI_2);
    assert!(world.clearance(world.start.unwrap().position) > 0.2);
}

#[test]
fn files_that_are_not_there_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hall.yaml");
    let read = || super::super::read_world(&path).map_err(|error| error.to_string());
    assert!(read().unwrap_err().contains("No such file"));
    std::fs::write(&path, YAML).unwrap();
    let error = read().unwrap_err();
    assert!(error.contains("`image` is ") && error.contains("hall.pgm, which cannot"), "{error}");
    std::fs::write(folder.path().join("hall.pgm"), b"P5 2 2 255 \x00").unwrap();
    let error = read().unwrap_err();
    assert!(error.contains("hall.pgm: the PGM must hold 4 bytes"), "{error}");
    std::fs::write(folder.path().join("hall.pgm"), b"P5 2 2 255 \x00\xfe\xfe\xfe").unwrap();
    let world = read().unwrap();
    assert_eq!((world.walls.len(), world.provenance.kind.as_str()), (1, "import"));
}

fn maps() -> impl Strategy<Value = RosMap> {
    let cells = prop::sample::select(vec![RosCell::Free, RosCell::Occupied, RosCell::Unknown]);
    let origin = (-50.0..50.0_f64, -50.0..50.0_f64);
    (1..12_usize, 1..12_usize, origin, 0.01..2.0_f64)
        .prop_flat_map(move |(cols, rows, (x, y), resolution)| {
            let cells = prop::collection::vec(cells.clone(), cols * rows);
            let origin = Pose::new(x, y, 0.0);
            (Just((cols, resolution, origin)), cells)
        })
        .prop_map(|((cols, resolution, origin), cells)| RosMap { cols, resolution, origin, cells })
}

proptest! {
    #[test]
    fn files_give_back_the_same_map(mut map in maps(), heading in -4.0..4.0_f64) {
        map.origin.heading = heading;
        let (mut yaml, mut image) = (Vec::new(), Vec::new());
        map.write_yaml("map.pgm", &mut yaml).unwrap();
        map.write_pgm(&mut image).unwrap();
        let description = RosDescription::from_yaml(std::str::from_utf8(&yaml).unwrap()).unwrap();
        prop_assert_eq!(&description.image, "map.pgm");
        prop_assert_eq!(&description.map(&image).unwrap(), &map);
        #[cfg(feature = "picture")]
        {
            let mut image = Vec::new();
            map.write_png(&mut image).unwrap();
            prop_assert_eq!(&description.map(&image).unwrap(), &map);
        }
    }

    #[test]
    fn a_world_is_its_cells(map in maps(), heading in -4.0..4.0_f64, turned in any::<bool>()) {
        let mut map = map;
        map.origin.heading = if turned { heading } else { 0.0 };
        let world = map.to_world(UnknownCells::Free);
        prop_assert_eq!(world.check(), Ok(()));
        let rays = Raycaster::new(&world);
        for (i, cell) in map.cells.iter().enumerate() {
            let low = DVec2::new((i % map.cols) as f64, (i / map.cols) as f64);
            for (dx, dy) in [(0.5, 0.5), (0.01, 0.99), (0.99, 0.01), (0.01, 0.01), (0.99, 0.99)] {
                let p = map.origin.to_world((low + DVec2::new(dx, dy)) * map.resolution);
                let inside = world.walls.iter().filter(|wall| wall.shape.contains(p)).count();
                prop_assert_eq!(inside, usize::from(*cell == RosCell::Occupied));
                let hit = rays.cast(p, 0.3, 1e-4 * map.resolution);
                prop_assert_eq!(hit.is_some(), *cell == RosCell::Occupied);
            }
        }
        if !turned {
            let grid = OccupancyGrid::of(&world, map.resolution, Coverage::Centre).unwrap();
            for (i, cell) in map.cells.iter().enumerate() {
                let middle = DVec2::new((i % map.cols) as f64, (i / map.cols) as f64) + 0.5;
                let occupied = grid.occupied_at(map.origin.to_world(middle * map.resolution));
                prop_assert_eq!(occupied, Some(*cell == RosCell::Occupied));
            }
        }
    }

    #[test]
    fn no_path_leads_out_of_a_map(
        map in maps(),
        heading in -4.0..4.0_f64,
        unknown in prop::sample::select(vec![UnknownCells::Solid, UnknownCells::Free]),
        angles in prop::collection::vec(0.0..6.3_f64, 8),
    ) {
        let mut map = map;
        map.origin.heading = heading;
        let world = map.to_world(unknown);
        prop_assert_eq!(world.check(), Ok(()));
        let rays = Raycaster::new(&world);
        let far = world.bounds.size().length();
        for (i, _) in map.cells.iter().enumerate().filter(|(_, cell)| **cell == RosCell::Free) {
            let middle = DVec2::new((i % map.cols) as f64, (i / map.cols) as f64) + 0.5;
            let p = map.origin.to_world(middle * map.resolution);
            for angle in &angles {
                prop_assert!(rays.cast(p, *angle, far).is_some(), "{p} {angle}");
            }
        }
    }

    #[test]
    fn no_image_panics(bytes in prop::collection::vec(any::<u8>(), 0..60), head in 0..3_usize) {
        let file = [[b"P5 ", b"P2 ", &b"\x89PN"[..]][head], &bytes[..]].concat();
        let _ = description(YAML).map(&file);
    }

    #[test]
    fn no_description_panics(text in "[a-z:\\[\\]{}&*!|> \\-\n.0-9\"']{0,80}") {
        let _ = RosDescription::from_yaml(&text);
        let _ = RosDescription::from_yaml(&format!("{YAML}{text}"));
    }
}

#[test]
fn every_name_of_an_image_comes_back() {
    let map = map_of(&["###"]);
    for name in ["a b.pgm", "a\u{7f}.pgm", "a\u{85}b.pgm", "\u{feff}a.pgm", "a\u{2028}\n\"#: .pgm"]
    {
        let mut yaml = Vec::new();
        map.write_yaml(name, &mut yaml).unwrap();
        assert_eq!(description(std::str::from_utf8(&yaml).unwrap()).image, name);
        assert!(yaml.is_ascii(), "{name:?}");
    }
}

#[test]
fn unknown_cells_that_are_free_give_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.pgm"), b"P5 4 1 255 \x00\xcd\xcd\xfe").unwrap();
    let path = folder.path().join("map.yaml");
    let warning = |free: f64| {
        let text = format!(
            "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
             free_thresh: {free}\n"
        );
        std::fs::write(&path, text).unwrap();
        unknown_cells_warning(&path)
    };
    assert_eq!(warning(0.196), None);
    let text = warning(0.25).unwrap();
    assert!(text.starts_with("50 % of the pixels have the grey 205"), "{text}");
    assert!(text.contains("`free_thresh: 0.25` makes them free"), "{text}");
    assert_eq!(unknown_cells_warning(&folder.path().join("map.pgm")), None);
}

#[test]
fn alpha_that_makes_unknown_cells_free_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 2, 1);
    encoder.set_color(png::ColorType::GrayscaleAlpha);
    encoder.write_header().unwrap().write_image_data(&[205, 255, 0, 255]).unwrap();
    std::fs::write(folder.path().join("map.png"), file).unwrap();
    let path = folder.path().join("map.yaml");
    let warning = |free: f64, mode: &str| {
        let text = format!(
            "image: map.png\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
             free_thresh: {free}\nmode: {mode}\n"
        );
        std::fs::write(&path, text).unwrap();
        unknown_cells_warning(&path)
    };
    let text = warning(0.196, "trinary").unwrap();
    assert!(text.ends_with("save the image without alpha"), "{text}");
    assert!(!text.contains("0.196"), "{text}");
    let text = warning(0.25, "trinary").unwrap();
    assert!(text.ends_with("with 0.196, and an image without alpha, they are unknown"), "{text}");
    // Where alpha does not count, only the threshold is named.
    assert_eq!(warning(0.196, "scale"), None);
    assert!(warning(0.25, "scale").unwrap().ends_with("with 0.196 they are unknown"));
}
