//! Pictures compared with those that a person has looked at, and pictures of odd worlds.
//!
//! `ENVGEN_UPDATE_PICTURES=1 cargo test -p envgen --test pictures` writes the pictures again; look at
//! them before they are committed.
#![cfg(feature = "picture")]

mod common;

use std::fs;
use std::path::Path;

use envgen::export::{Format, Job};
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::hallway::HallwaySpec;
use envgen::picture::{self, MAX_PIXELS, PictureError, PictureOptions};
use envgen::scenario::{Scenario, ScenarioSpec};
use envgen::world::{
    Contents, Digest, Doorway, Obstacle, ObstacleKind, RoadPoint, RoadStrip, Room, Surface,
    SurfaceKind, Tree, Wall, WallKind,
};
use envgen::{Blueprint, Seed, Spec, World};
use proptest::prelude::*;
use resvg::usvg;

/// Pixels of other processors may differ by this much in one channel: rounding.
const TOLERANCE: u8 = 2;

const PICTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pictures");

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn small(width: u32) -> PictureOptions {
    PictureOptions { width, height: width, ..Default::default() }
}

fn hallway(segments: u64) -> World {
    let spec = HallwaySpec {
        segments,
        alcove_rate: 0.06,
        door_frame_rate: 0.05,
        narrowing_rate: 0.05,
        ..Default::default()
    };
    spec.generate(Seed(3)).unwrap().to_world()
}

fn moving(world: &World) -> PictureOptions {
    let spec = ScenarioSpec { doors: 0.6, people: 3, smoke: 0.5, ..Default::default() };
    let scenario = Some(Scenario::new(world, &spec, Seed(1)).unwrap());
    PictureOptions { scenario, ..small(560) }
}

/// The pictures that are kept, by name.
fn kept() -> Vec<(&'static str, World, PictureOptions)> {
    let grid = PictureOptions { grid: true, ..small(400) };
    let profile = PictureOptions { curvature_profile: true, ..small(560) };
    let bare = PictureOptions {
        title: Some(String::new()),
        legend: false,
        names: false,
        margin: 0,
        ..small(300)
    };
    let dense = PictureOptions { pixel_ratio: 2.0, ..small(200) };
    let title = PictureOptions { title: Some("Café 中 & <co>".to_owned()), ..small(320) };
    vec![
        ("hallway", hallway(40), small(500)),
        ("indoor", common::indoor(), small(640)),
        ("indoor-bare", common::indoor(), bare),
        ("forest", common::forest(120, 30.0), grid),
        ("forest-shadow", common::forest(40_000, 800.0), small(160)),
        ("road", common::road(), profile),
        ("landscape", common::landscape(), title),
        ("everything", common::everything(), small(480)),
        ("moving", common::indoor(), moving(&common::indoor())),
        ("empty", common::empty(3.0, 1.0), dense),
    ]
}

#[derive(Clone, PartialEq)]
struct Pixels {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Pixels {
    fn read(file: &[u8]) -> Pixels {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut rgb).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        Pixels { width: info.width as usize, height: info.height as usize, rgb }
    }

    fn of(world: &World, options: &PictureOptions) -> Pixels {
        Pixels::read(&picture::png(world, options).unwrap())
    }

    fn at(&self, p: DVec2) -> [u8; 3] {
        let i = 3 * (p.y as usize * self.width + p.x as usize);
        [self.rgb[i], self.rgb[i + 1], self.rgb[i + 2]]
    }

    fn write(&self, path: &Path) {
        let file = fs::File::create(path).unwrap();
        let mut encoder = png::Encoder::new(file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(&self.rgb).unwrap();
    }
}

#[test]
fn pictures_are_as_they_were() {
    let update = std::env::var_os("ENVGEN_UPDATE_PICTURES").is_some();
    let folder = Path::new(PICTURES);
    fs::create_dir_all(folder).unwrap();
    let mut digests = String::new();
    let mut wrong = Vec::new();
    for (name, world, options) in kept() {
        digests +=
            &format!("{name}.svg {}\n", Digest::of(&picture::svg(&world, &options).unwrap()));
        let file = picture::png(&world, &options).unwrap();
        assert!(file.len() < 60_000, "{name}: {} bytes", file.len());
        let path = folder.join(name).with_extension("png");
        if update {
            fs::write(&path, file).unwrap();
            continue;
        }
        let is = Pixels::read(&file);
        let was = fs::read(&path).map(|file| Pixels::read(&file)).unwrap_or_else(|error| {
            panic!("{}: {error}; see the head of this file", path.display())
        });
        let same_size = (is.width, is.height) == (was.width, was.height);
        let differs = |(a, b): (&u8, &u8)| a.abs_diff(*b) > TOLERANCE;
        if same_size && !is.rgb.iter().zip(&was.rgb).any(differs) {
            continue;
        }
        let out = Path::new(env!("CARGO_TARGET_TMPDIR"));
        is.write(&out.join(format!("{name}-actual.png")));
        if same_size {
            // Amplified, on black.
            let rgb = is.rgb.iter().zip(&was.rgb).map(|(a, b)| a.abs_diff(*b).saturating_mul(8));
            Pixels { rgb: rgb.collect(), ..is }.write(&out.join(format!("{name}-difference.png")));
        }
        wrong.push(format!("{}/{name}-actual.png", out.display()));
    }
    let path = folder.join("digests.txt");
    if update {
        fs::write(path, digests).unwrap();
        return;
    }
    assert!(
        wrong.is_empty(),
        "pictures changed, see {wrong:?} and the -difference.png beside them"
    );
    assert_eq!(digests, fs::read_to_string(path).unwrap(), "the same pixels from another SVG");
}

/// Reads an SVG, so that it is well-formed and every path and image in it understood, and checks
/// that it needs nothing from outside.
fn parse(svg: &str) -> usvg::Tree {
    // Embedded images may hold any word.
    let pieces = svg.split("base64,").enumerate();
    let text: String = pieces
        .map(|(i, piece)| if i == 0 { piece } else { piece.split_once('"').unwrap().1 })
        .collect();
    assert!(!text.contains("<text") && !text.contains("font"), "labels are outlines");
    assert!(!text.contains("NaN") && !text.contains("inf"), "numbers are finite");
    let urls = text.match_indices("http").count();
    assert_eq!(urls, 1, "the name space and no other address");
    usvg::Tree::from_str(svg, &usvg::Options::default()).unwrap()
}

#[test]
fn smoke_is_drawn_where_it_is() {
    // 100 px per metre, and 14 px around the world.
    let mut world = common::empty(8.0, 4.0);
    for (from, to) in [(v(0.0, 0.0), v(3.0, 1.0)), (v(5.0, 2.0), v(8.0, 4.0))] {
        let shape = Shape::from_rect(Rect::new(from, to));
        world.surfaces.push(Surface::new(SurfaceKind::Hallway, shape));
    }
    let drawn = |region: &str| {
        let mut scenario = Scenario::new(&world, &ScenarioSpec::default(), Seed(1)).unwrap();
        let source = format!("(region: {region}, extinction: 0.5, growth: 0.0, kind: regional)");
        scenario.smoke = vec![ron::from_str(&source).unwrap()];
        let options = PictureOptions {
            title: Some(String::new()),
            legend: false,
            names: false,
            margin: 0,
            scenario: Some(scenario),
            ..small(828)
        };
        let svg = picture::svg(&world, &options).unwrap();
        let group = svg.split("id=\"smoke\"").nth(1).unwrap();
        group.split('"').nth(1).unwrap().to_owned()
    };
    let shown = drawn("box(min: (1.0, 1.0), max: (5.0, 3.0))");
    assert_eq!(shown, "M114 314h400v-200h-400z");
    assert_eq!(drawn("halls"), "M14 414h300v-100h-300zm500-200h300v-200h-300z");
}

#[test]
fn svgs_are_well_formed() {
    for (name, world, options) in kept() {
        let svg = picture::svg(&world, &options).unwrap();
        let tree = parse(&svg);
        assert!(tree.size().width() <= options.width as f32, "{name}");
        assert!(tree.root().has_children(), "{name}");
        assert_eq!(svg, picture::svg(&world, &options).unwrap(), "{name} differs when drawn again");
    }
}

#[test]
fn export_writes_the_pictures() {
    let world = common::indoor();
    let job = Job { picture: small(200), ..Job::new(&world) };
    let [mut svg, mut png] = [Vec::new(), Vec::new()];
    Format::Svg.write(&job, &mut svg).unwrap();
    Format::Png.write(&job, &mut png).unwrap();
    assert_eq!(svg, picture::svg(&world, &small(200)).unwrap().into_bytes());
    assert_eq!(png, picture::png(&world, &small(200)).unwrap());
}

/// A world of 10 m x 10 m with one part around its middle.
fn with(change: impl FnOnce(&mut World)) -> World {
    let mut world = common::empty(10.0, 10.0);
    change(&mut world);
    assert_eq!(world.check(), Ok(()));
    world
}

#[test]
fn every_kind_of_part_is_seen() {
    let block = || Shape::from_rect(Rect::new(v(3.0, 3.0), v(7.0, 7.0)));
    let mut worlds: Vec<(String, World)> = Vec::new();
    for (kind, id) in [
        (WallKind::Wall, "wall"),
        (WallKind::EndCap, "end-cap"),
        (WallKind::Alcove, "alcove"),
        (WallKind::Partition, "partition"),
        (WallKind::Kerb, "kerb"),
    ] {
        let world = with(|w| w.walls.push(Wall::new(kind, block())));
        worlds.push((format!("walls-{id}"), world));
    }
    for (kind, id) in [
        (ObstacleKind::DoorPost, "door-post"),
        (ObstacleKind::Crate, "crate"),
        (ObstacleKind::Other, "obstacle"),
    ] {
        let world = with(|w| w.obstacles.push(Obstacle::new(kind, block())));
        worlds.push((format!("obstacles-{id}"), world));
    }
    for (kind, id) in [
        (SurfaceKind::Uneven, "uneven"),
        (SurfaceKind::Debris, "debris"),
        (SurfaceKind::Water, "water"),
        (SurfaceKind::Stairs, "stairs"),
        (SurfaceKind::Slippery, "slippery"),
        (SurfaceKind::Loose, "loose"),
        (SurfaceKind::Class(3), "class"),
    ] {
        let surface = Surface { speed: 0.5, ..Surface::new(kind, block()) };
        worlds.push((format!("surfaces-{id}"), with(|w| w.surfaces.push(surface))));
    }
    let visible_range = Some(2.0);
    let dark = Wall { visible_range, ..Wall::new(WallKind::Wall, block()) };
    worlds.push(("walls-dark-wall".to_owned(), with(|w| w.walls.push(dark))));
    let dark = Obstacle { visible_range, ..Obstacle::new(ObstacleKind::Crate, block()) };
    worlds.push(("obstacles-dark-obstacle".to_owned(), with(|w| w.obstacles.push(dark))));
    for (open, id) in [(true, "doorways-open-doorway"), (false, "doorways-closed-door")] {
        let door = Doorway::new(block(), open, [None, None]);
        worlds.push((id.to_owned(), with(|w| w.doorways.push(door))));
    }
    let room = |difficulty, lit| {
        let (name, shape, contents) = (String::new(), block(), Contents::AsDesigned);
        Room { name, shape, difficulty, lit, contents, height: None }
    };
    worlds.push(("rooms-e8eaee".to_owned(), with(|w| w.rooms.push(room(None, true)))));
    worlds.push(("rooms-unlit".to_owned(), with(|w| w.rooms.push(room(None, false)))));
    worlds.push(("rooms-fffbdc".to_owned(), with(|w| w.rooms.push(room(Some(0.0), true)))));
    worlds.push(("rooms-9c2242".to_owned(), with(|w| w.rooms.push(room(Some(10.0), true)))));
    let tree = Tree::new(v(5.0, 5.0), 1.0);
    worlds.push(("trees".to_owned(), with(|w| w.trees.push(tree))));
    let point = |x, curvature| RoadPoint { pose: Pose::new(x, 5.0, 0.0), curvature };
    let centreline = vec![point(1.0, 0.1), point(5.0, -0.2), point(9.0, 0.0)];
    let strip = RoadStrip { centreline, pieces: Vec::new(), width: 3.0, lanes: 2, closed: false };
    worlds.push(("roads".to_owned(), with(|w| w.road_strips.push(strip))));
    worlds.push(("start".to_owned(), with(|w| w.start = Some(Pose::new(5.0, 5.0, 0.0)))));
    worlds.push(("goal".to_owned(), with(|w| w.goal = Some(Pose::new(5.0, 5.0, 0.0)))));

    let options = PictureOptions { legend: false, curvature_profile: true, ..small(200) };
    let empty = Pixels::of(&common::empty(10.0, 10.0), &options);
    let mut seen = Vec::new();
    for (id, world) in &worlds {
        let svg = picture::svg(world, &options).unwrap();
        assert!(svg.contains(&format!("id=\"{id}\"")), "no {id} in {svg}");
        let pixels = Pixels::of(world, &options);
        let rows = 190 * 3 * pixels.width..;
        assert_ne!(pixels.rgb[..rows.start], empty.rgb[..rows.start], "{id} is not seen");
        for (other, others) in &seen {
            assert_ne!(&pixels.rgb, others, "{id} looks like {other}");
        }
        seen.push((id, pixels.rgb));
        // The legend lists the parts that occur, which changes the foot of the picture.
        if !id.starts_with("rooms-") {
            let with_legend = PictureOptions { legend: true, ..options.clone() };
            assert_ne!(svg, picture::svg(world, &with_legend).unwrap(), "{id} in no legend");
        }
    }
}

#[test]
fn up_in_the_world_is_up_in_the_picture() {
    let mut world = common::empty(10.0, 10.0);
    world.trees.push(Tree::new(v(2.0, 9.0), 0.9));
    let bare =
        PictureOptions { title: Some(String::new()), legend: false, margin: 0, ..small(228) };
    let pixels = Pixels::of(&world, &bare);
    // 14 px of border, 20 px a metre.
    assert_eq!(pixels.at(v(14.0 + 40.0, 14.0 + 20.0)), [0x74, 0xb8, 0x87]);
    assert_eq!(pixels.at(v(14.0 + 40.0, 14.0 + 180.0)), [0xfa, 0xf9, 0xf6]);
    // The arrow of a start that looks up.
    world.start = Some(Pose::new(5.0, 5.0, std::f64::consts::FRAC_PI_2));
    let pixels = Pixels::of(&world, &bare);
    assert_eq!(pixels.at(v(114.0, 114.0)), [0x00, 0x72, 0xb2]);
    assert_eq!(pixels.at(v(114.0, 114.0 - 16.0)), [0x00, 0x72, 0xb2]);
    assert_eq!(pixels.at(v(114.0, 114.0 + 16.0)), [0xfa, 0xf9, 0xf6]);
}

#[test]
fn landscapes_keep_their_cells() {
    let world = common::landscape();
    let bare =
        PictureOptions { title: Some(String::new()), legend: false, margin: 0, ..small(748) };
    let pixels = Pixels::of(&world, &bare);
    let raster = world.raster.as_ref().unwrap();
    // 720 px for 72 cells; the same colour where the class is, and only there.
    let mut colors = std::collections::BTreeMap::new();
    for row in 0..raster.rows {
        for col in 0..raster.cols {
            let middle = v(f64::from(col) * 10.0 + 19.0, f64::from(row) * 10.0 + 19.0);
            let metres = v(f64::from(col) + 0.5, f64::from(raster.rows - row) - 0.5) * raster.cell;
            let hidden = world.surfaces.iter().any(|s| s.shape.distance(metres) < 0.5)
                || [world.start, world.goal]
                    .into_iter()
                    .flatten()
                    .any(|pose| pose.position.distance(metres) < 2.0);
            if !hidden {
                let class = raster.class_at(metres).unwrap();
                let color = *colors.entry(class).or_insert(pixels.at(middle));
                assert_eq!(pixels.at(middle), color, "class {class} in row {row}, column {col}");
            }
        }
    }
    let mut distinct: Vec<_> = colors.values().collect();
    distinct.sort();
    distinct.dedup();
    assert_eq!(distinct.len(), 7, "{colors:?}");
}

#[test]
fn large_rasters_are_sampled() {
    let mut world = common::empty(3000.0, 2000.0);
    let cells = (0..6_000_000_u32).map(|i| (i % 3000 / 1000 + 1) as u16).collect();
    let origin = DVec2::ZERO;
    world.raster = Some(envgen::world::ClassRaster {
        rows: 2000,
        cols: 3000,
        cell: 1.0,
        origin,
        cells,
        speeds: Vec::new(),
    });
    let svg = picture::svg(&world, &small(300)).unwrap();
    assert!(svg.len() < 60_000, "{}", svg.len());
    let pixels = Pixels::of(&world, &small(300));
    let row = pixels.height as f64 * 0.5;
    let [a, b, c] = [60.0, 150.0, 240.0].map(|x| pixels.at(v(x, row)));
    assert!(a != b && b != c && a != c);
}

#[test]
fn a_million_trees_stay_small() {
    let world = common::forest(1_000_000, 3000.0);
    let svg = picture::svg(&world, &PictureOptions::default()).unwrap();
    assert!(svg.len() < 1_500_000, "{} bytes", svg.len());
    parse(&svg);
    let pixels = Pixels::of(&world, &small(400));
    // A dense forest is dark: trees of less than a pixel do not vanish.
    let middle = pixels.at(v(0.5 * pixels.width as f64, 0.45 * pixels.height as f64));
    assert!(middle[0] < 0xe0, "{middle:?}");
}

#[test]
fn a_lone_tree_of_many_does_not_vanish() {
    let mut world = common::forest(40_000, 4000.0);
    world.trees.retain(|tree| tree.center.x > 500.0);
    world.trees.push(Tree::new(v(250.0, 2000.0), 0.3));
    let options = PictureOptions { legend: false, ..small(200) };
    let seen = Pixels::of(&world, &options);
    world.trees.pop();
    let unseen = Pixels::of(&world, &options);
    let strongest = seen.rgb.iter().zip(&unseen.rgb).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(strongest > 10, "{strongest}");
}

#[test]
fn long_hallways_stay_small() {
    let world = hallway(60_000);
    assert!(world.walls.len() > 30_000);
    let svg = picture::svg(&world, &PictureOptions::default()).unwrap();
    assert!(svg.len() < 1_000_000, "{} bytes", svg.len());
    parse(&svg);
}

#[test]
fn bounds_of_any_size_are_drawn_or_refused() {
    for (width, height) in [
        (1e-300, 1e-300),
        (1e-9, 1e-9),
        (1.0, 1e-12),
        (1e12, 1.0),
        (1e15, 1e15),
        (1e300, 1e300),
        (f64::MIN_POSITIVE, f64::MAX),
    ] {
        let mut world = common::empty(width, height);
        world.start = Some(Pose::new(0.5 * width, 0.5 * height, 1.0));
        world.trees.push(Tree::new(v(0.2 * width, 0.2 * height), 1e-3 * width.min(height)));
        let options = PictureOptions { grid: true, ..small(200) };
        if world.check().is_ok() {
            parse(&picture::svg(&world, &options).unwrap());
            picture::png(&world, &options).unwrap();
        }
    }
    let mut world = common::empty(1.0, 1.0);
    world.bounds = Rect::new(DVec2::splat(-f64::MAX), DVec2::splat(f64::MAX));
    assert!(matches!(picture::svg(&world, &small(200)), Err(PictureError::World(_))));
    world.bounds = Rect::new(DVec2::splat(-1e8), DVec2::splat(1e8));
    parse(&picture::svg(&world, &small(200)).unwrap());
    world.bounds = Rect::new(DVec2::ZERO, DVec2::splat(5e-324));
    assert!(matches!(picture::svg(&world, &small(200)), Err(PictureError::Scale(_))));
    world.bounds = Rect::new(DVec2::splat(1e8 - 1.0), DVec2::splat(1e8));
    parse(&picture::svg(&world, &PictureOptions { grid: true, ..small(200) }).unwrap());
}

#[test]
fn broken_worlds_and_options_are_refused() {
    let mut world = common::forest(3, 10.0);
    let refused = |options: PictureOptions, name: &str| {
        let error = picture::png(&common::empty(1.0, 1.0), &options).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    };
    refused(
        PictureOptions { width: 3, ..Default::default() },
        "width must be from 100 to 16384, got 3",
    );
    refused(
        PictureOptions { height: 1 << 20, ..Default::default() },
        "height must be from 50 to 16384, got 1048576",
    );
    refused(PictureOptions { margin: 2000, ..Default::default() }, "margin must be");
    for ratio in [0.0, f64::NAN, f64::INFINITY, 11.0] {
        refused(PictureOptions { pixel_ratio: ratio, ..Default::default() }, "pixel_ratio must be");
    }
    refused(small(16_384), &format!("at most {MAX_PIXELS} pixels"));
    let many = PictureOptions { pixel_ratio: 10.0, ..small(4000) };
    refused(many, "at most 67108864 pixels");

    world.trees[1].center.y = f64::NAN;
    let error = picture::svg(&world, &small(100)).unwrap_err();
    assert!(error.to_string().contains("tree 1"), "{error}");
}

#[test]
fn narrow_pictures_hold_together() {
    for margin in [0, 16, 200] {
        for width in [100, 150, 230, 410] {
            let options = PictureOptions {
                margin,
                curvature_profile: true,
                title: Some("a title that is far too long for a picture of this size".to_owned()),
                ..small(width)
            };
            for world in [common::everything(), hallway(60)] {
                let tree = parse(&picture::svg(&world, &options).unwrap());
                assert!(tree.size().width() <= (width.max(2 * margin + 40)) as f32 + 130.0);
            }
        }
    }
}

/// Shapes anywhere in a square of 100 m.
fn shape() -> impl Strategy<Value = Shape> {
    let at = || (10.0..90.0_f64, 10.0..90.0_f64).prop_map(|(x, y)| v(x, y));
    prop_oneof![
        (at(), at()).prop_map(|(a, b)| Shape::Segment { a, b }),
        (at(), 1e-6..10.0_f64).prop_map(|(center, radius)| Shape::Disc { center, radius }),
        (at(), 1e-9..5.0_f64, 1e-9..5.0_f64, -9.0..9.0_f64).prop_map(|(center, x, y, heading)| {
            Shape::Box { center, half_size: v(x, y), heading }
        }),
        (at(), at(), at()).prop_map(|(a, b, c)| {
            let turned = (b - a).perp_dot(c - a) < 0.0;
            Shape::Polygon { vertices: if turned { vec![a, c, b] } else { vec![a, b, c] } }
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_world_is_drawn(
        shapes in prop::collection::vec(shape(), 8..24),
        name in any::<String>(),
        title in any::<Option<String>>(),
        difficulty in any::<f64>(),
        lanes in 1_u32..40,
        road in prop::collection::vec((10.0..90.0_f64, 10.0..90.0_f64, any::<f64>()), 2..9),
        scale in -20..20_i32,
        options in (100..400_u32, 50..400_u32, 0..200_u32, any::<[bool; 4]>()),
    ) {
        let mut world = common::empty(100.0, 100.0);
        for (i, shape) in shapes.into_iter().enumerate() {
            match i % 8 {
                0 => world.walls.push(Wall::new(WallKind::Wall, shape)),
                1 => world.obstacles.push(Obstacle::new(ObstacleKind::Crate, shape)),
                2 => world.rooms.push(Room {
                    name: name.clone(),
                    shape,
                    difficulty: Some(difficulty).filter(|d| d.is_finite()),
                    lit: false,
                    contents: Contents::AsDesigned,
                    height: None,
                }),
                3 => world.doorways.push(Doorway::new(shape, i < 8, [None, None])),
                n => world.surfaces.push(Surface::new([SurfaceKind::Stairs, SurfaceKind::Debris, SurfaceKind::Water, SurfaceKind::Class(n as u16)][n - 4], shape)),
            }
        }
        let centreline = road
            .into_iter()
            .filter(|point| point.2.is_finite())
            .map(|(x, y, curvature)| RoadPoint { pose: Pose::new(x, y, x), curvature })
            .collect::<Vec<_>>();
        if centreline.len() > 1 {
            world.road_strips.push(RoadStrip { centreline, pieces: Vec::new(), width: 7.0, lanes, closed: lanes % 2 == 0 });
        }
        if scale != 0 {
            // Another scale: the same world in a much larger area.
            world.bounds = world.bounds.union(Rect::new(DVec2::ZERO, DVec2::splat(libm::exp2(f64::from(scale)))));
        }
        let (width, height, margin, [legend, names, grid, curvature_profile]) = options;
        let options = PictureOptions {
            width, height, margin, title, legend, names, grid, curvature_profile, pixel_ratio: 1.0, scenario: None,
        };
        match world.check() {
            Ok(()) => {
                let svg = picture::svg(&world, &options).unwrap();
                prop_assert!(usvg::Tree::from_str(&svg, &usvg::Options::default()).is_ok());
                prop_assert!(picture::png(&world, &options).is_ok());
            }
            Err(_) => prop_assert!(matches!(picture::svg(&world, &options), Err(PictureError::World(_)))),
        }
    }
}
