//! The files from which mutations start. All are small, and generated here.

use std::ops::ControlFlow;
use std::path::Path;

use envgen::cellular::CellularSpec;
use envgen::certificate::Claim;
use envgen::export::{Format, Job};
use envgen::forest::ForestSpec;
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::hallway::HallwaySpec;
use envgen::indoor::{Catalogue, IndoorSpec, room_to_ron};
use envgen::landscape::LandscapeSpec;
use envgen::road::RoadSpec;
use envgen::scenario::{Scenario, ScenarioSpec};
use envgen::world::{
    ClassRaster, Contents, Doorway, Extent, Obstacle, ObstacleKind, Room, Surface, SurfaceKind,
    Tree, Wall, WallKind,
};
use envgen::{Blueprint, Provenance, Seed, Spec, World, WorldBlueprint, WorldKind, WorldSpec};
use mapping_trial::difficulty::levers::LeverDesign;
use mapping_trial::difficulty::{Anchors, AtlasDesign, Panel};
use mapping_trial::driver::PROTOCOL;
use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::{Survey, SurveyFolder};
use mapping_trial::trial::{Trial, TrialSettings};
use mapping_trial::tum;
use serde::de::DeserializeOwned;

/// The names of the files with the description and the trials in the folder of a survey.
pub const SURVEY_FILES: [&str; 2] = ["survey.json", "trials.jsonl"];

/// The files of a format.
pub type Corpus = Vec<Vec<u8>>;

/// A small spec of every kind.
pub fn specs() -> Vec<WorldSpec> {
    let landscape = LandscapeSpec { rows: 6, cols: 7, ..Default::default() };
    let cellular = CellularSpec { rows: 9, cols: 8, robot_cells: 1, ..Default::default() };
    vec![
        HallwaySpec { segments: 5, p_st: 0.5, narrowing_rate: 0.3, ..Default::default() }.into(),
        ForestSpec { width: 10.0, height: 8.0, ..Default::default() }.into(),
        RoadSpec { length: 60.0, ..Default::default() }.into(),
        IndoorSpec { width: 6, height: 6, ..Default::default() }.into(),
        landscape.into(),
        cellular.into(),
    ]
}

fn blueprints() -> Vec<WorldBlueprint> {
    specs().iter().filter_map(|spec| spec.generate(Seed(3)).ok()).collect()
}

/// Returns a world of every kind, and one with every kind of part and shape.
pub fn worlds() -> Vec<World> {
    blueprints().iter().map(WorldBlueprint::to_world).chain([every_part()]).collect()
}

/// Returns every value of an enum, from the names that its deserializer lists in the error for an unknown
/// name.
pub fn every<T: DeserializeOwned>() -> Vec<T> {
    let Err(error) = serde_json::from_str::<T>("\"\"") else { return Vec::new() };
    let text = error.to_string();
    // The first name is the unknown one, so it is skipped.
    let names = text.split('`').skip(1).step_by(2).skip(1);
    names.filter_map(|name| serde_json::from_value(name.into()).ok()).collect()
}

fn every_part() -> World {
    let v = DVec2::new;
    let rect = |x0, y0, x1, y1| Shape::from_rect(Rect::new(v(x0, y0), v(x1, y1)));
    let source = serde_json::json!({ "made": "by hand", "list": [1, 2.5, null], "deep": {} });
    let bounds = Rect::new(DVec2::ZERO, v(12.0, 10.0));
    let mut world = World::new(Provenance::other("manual", source), bounds);
    world.start = Some(Pose::new(6.0, 1.5, 0.5));
    world.goal = Some(Pose::new(11.0, 9.0, -1.0));
    for (kind, i) in every::<WallKind>().into_iter().zip(0..) {
        let y = 0.2 + f64::from(i);
        let shape = Shape::Segment { a: v(0.2, y), b: v(3.0, y + 0.4) };
        world.walls.push(Wall { visible_range: Some(2.0), ..Wall::new(kind, shape) });
    }
    world.trees.push(Tree { height: Extent::new(0.5, 7.0).ok(), ..Tree::new(v(9.0, 3.0), 0.7) });
    let polygon = vec![v(7.0, 6.0), v(9.0, 6.2), v(8.4, 7.0), v(9.0, 8.0), v(7.2, 7.8)];
    let box_ = Shape::Box { center: v(4.0, 7.0), half_size: v(0.8, 0.3), heading: 0.7 };
    let shapes = [Shape::Polygon { vertices: polygon }, box_];
    let discs =
        (0..).map(|i| Shape::Disc { center: v(0.5 + 0.6 * f64::from(i), 9.6), radius: 0.2 });
    let kinds = every::<ObstacleKind>().into_iter().zip(shapes.into_iter().chain(discs));
    world.obstacles = kinds.map(|(kind, shape)| Obstacle::new(kind, shape)).collect();
    for (kind, i) in every::<SurfaceKind>().into_iter().zip(0..) {
        let x = 4.0 + 0.8 * f64::from(i);
        let shape = if i == 0 {
            Shape::Disc { center: v(6.0, 4.0), radius: 1.0 }
        } else {
            rect(x, 5.0, x + 1.5, 6.0)
        };
        world.surfaces.push(Surface {
            speed: 0.5,
            odometry_noise: 4.0,
            wheel_bias: 0.1,
            ..Surface::new(kind, shape)
        });
    }
    for (contents, i) in every::<Contents>().into_iter().zip(0..) {
        let y = 4.5 + f64::from(i);
        world.rooms.push(Room {
            name: format!("office \"{i}\""),
            shape: rect(0.0, y, 3.0, y + 1.0),
            difficulty: Some(2.5).filter(|_| i > 0),
            lit: i != 1,
            contents,
            height: Extent::new(0.0, 3.0).ok().filter(|_| i == 1),
        });
    }
    let door = |y, open, rooms| Doorway::new(rect(2.9, y, 3.1, y + 0.9), open, rooms);
    world.doorways = vec![door(6.0, true, [Some(0), None]), door(8.0, false, [None, Some(0)])];
    world.victims.push(Pose::new(2.0, 9.0, 3.0));
    world.raster = Some(ClassRaster {
        rows: 2,
        cols: 3,
        cell: 4.0,
        origin: DVec2::ZERO,
        cells: vec![1, 2, 0, 2, 1, 300],
        speeds: vec![0.0, 1.0, 0.5],
    });
    world.certificate = vec![
        Claim::Connected { radius: 0.3 },
        Claim::TreeDistance { distance: 0.5, torus: Some(v(12.0, 10.0)) },
    ];
    world
}

fn written(format: Format, ending: &str) -> Corpus {
    let worlds: Vec<_> =
        blueprints().into_iter().map(|plan| (plan.to_world(), Some(plan))).collect();
    let worlds = worlds.iter().map(|(world, plan)| (world, plan.as_ref()));
    let by_hand = every_part();
    let writers = format.files().iter().filter(|file| file.0 == ending);
    let writers: Vec<_> = writers.map(|file| file.1).collect();
    let mut files = Vec::new();
    for (world, blueprint) in worlds.chain([(&by_hand, None)]) {
        for writer in &writers {
            let mut file = Vec::new();
            let job = Job { blueprint, ..Job::new(world) };
            if writer(&job, &mut file).is_ok() && file.len() < 60_000 {
                files.push(file);
            }
        }
    }
    files
}

/// Worlds as JSON.
pub fn world_json() -> Corpus {
    written(Format::Json, "json")
}

/// Worlds as RON.
pub fn world_ron() -> Corpus {
    written(Format::Ron, "ron")
}

/// Specs as RON, with all fields and with few.
pub fn spec_ron() -> Corpus {
    let whole = specs().into_iter().map(|spec| spec.to_ron());
    let short = ["Hallway(segments: 8, p_st: 0.2)", "forest(width: 9, height: 9, intensity: 0.2)"];
    whole.chain(short.map(str::to_owned)).map(String::into_bytes).collect()
}

/// Settings as on the command line: a kind, then one `name=value` per line.
pub fn settings() -> Corpus {
    let mut files = Vec::new();
    for (kind, spec) in WorldKind::ALL.iter().zip(specs()) {
        let fields = spec.settings_json();
        let mut file = format!("{kind}\n");
        for setting in kind.settings() {
            file += &format!("{}={}\n", setting.name, setting.text_of(&fields[setting.name]));
        }
        files.push(file.into_bytes());
    }
    files
}

/// Rooms as RON.
pub fn room_ron() -> Corpus {
    let rooms = Catalogue::builtin().rooms().iter().step_by(3);
    rooms.map(|room| room_to_ron(room).into_bytes()).collect()
}

/// ESRI ASCII grids.
pub fn asc() -> Corpus {
    let by_hand = "ncols 3\nNROWS 2\nxllcenter 10.5\nyllcorner 20\ncellsize 1.0\n\
                   NODATA_value -1\n1 2 -1\n 3 311 0\n";
    let mut files = written(Format::Asc, "asc");
    files.push(by_hand.into());
    files
}

/// `MovingAI` maps.
pub fn map() -> Corpus {
    let mut files = written(Format::MovingAi, "map");
    files.push(b"type octile\r\nheight 3\r\nwidth 5\r\nmap\r\n..GSW\r\n.@@TO\r\n.....\r\n".into());
    files
}

/// `MovingAI` scenarios.
pub fn scen() -> Corpus {
    let mut files = written(Format::MovingAi, "scen");
    files.push(
        b"version 1\n0\ta.map\t5\t3\t0\t0\t4\t2\t5.41421356\n1\ta\t5\t3\t1\t1\t1\t1\t0\n".into(),
    );
    files
}

/// Rasters as JSON.
pub fn raster_json() -> Corpus {
    let texts = [
        "[[1, 2, 0], [3, null, 1]]",
        r#"{"rows": 1, "cols": 2, "cell": 0.5, "cells": [[7, 8]]}"#,
        r#"{"kind": "landscape", "blueprint": {"cells": [[7], [-8]]}}"#,
    ];
    let world = every_part().to_json().unwrap_or_default();
    texts.map(str::to_owned).into_iter().chain([world]).map(String::into_bytes).collect()
}

/// PGM images.
pub fn pgm() -> Corpus {
    vec![
        b"P2\n# by hand\n4 3\n255\n0 205 254 254\n254 254 0 254\n0 0 0 205\n".into(),
        b"P5\n4 3\n255\n\x00\xcd\xfe\xfe\xfe\xfe\x00\xfe\x00\x00\x00\xcd".into(),
        b"P5 2 2 65535 \x00\x00\xff\xff\x12\x34\xff\xfe".into(),
        b"P2 3 2 100 0 50 100 99 3 7".into(),
    ]
}

/// PNG images of every kind of colour and some depths, with texts and transparency.
pub fn png() -> Corpus {
    use png::{BitDepth, ColorType};
    let kinds = [
        (ColorType::Grayscale, BitDepth::One, 1),
        (ColorType::Grayscale, BitDepth::Eight, 5),
        (ColorType::Grayscale, BitDepth::Sixteen, 10),
        (ColorType::Rgb, BitDepth::Eight, 15),
        (ColorType::Indexed, BitDepth::Four, 3),
        (ColorType::Indexed, BitDepth::Eight, 5),
        (ColorType::GrayscaleAlpha, BitDepth::Eight, 10),
        (ColorType::Rgba, BitDepth::Sixteen, 40),
    ];
    let mut files = Vec::new();
    for (color, depth, line) in kinds {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 5, 4);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette((0..48).collect::<Vec<u8>>());
            encoder.set_trns(vec![0, 255, 128]);
        }
        let whole = encoder.add_text_chunk("envgen-cell".to_owned(), "0.5".to_owned());
        let written = encoder.write_header().and_then(|mut writer| {
            let data: Vec<u8> = (0..4 * line).map(|i| (i * 37 % 13) as u8).collect();
            writer.write_image_data(&data)
        });
        if whole.is_ok() && written.is_ok() {
            files.push(file);
        }
    }
    files.extend(written(Format::ClassPng, "classes.png"));
    files
}

/// Descriptions of ROS maps.
pub fn yaml() -> Corpus {
    let mut files = written(Format::RosMap, "yaml");
    files.truncate(2);
    let texts = [
        "image: map.pgm\nresolution: 0.050000\norigin: [-15.1, -25.0, 0.3]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\nmode: scale\n",
        "# saved\nimage: \"a.png\"\nresolution: 0.1\norigin:\n  - 1.0\n  - -2\n  - 0\n\
         negate: true\noccupied_thresh: 0.9\nfree_thresh: 0.1\nmode: raw\nextra: {a: [b, c]}\n",
    ];
    files.extend(texts.map(|text| text.as_bytes().to_vec()));
    files
}

/// Projects of the World Generator.
pub fn project_xml() -> Corpus {
    written(Format::WorldGenerator, "xml")
}

/// Libraries of rooms of the World Generator.
pub fn library_xml() -> Corpus {
    let mut file = Vec::new();
    let written = envgen::indoor::world_generator::write_library(Catalogue::builtin(), &mut file);
    if written.is_ok() { vec![file] } else { Vec::new() }
}

/// Worlds as GeoJSON, and one as other programs could have made it.
pub fn geojson() -> Corpus {
    let ring = r#"{"type": "FeatureCollection", "bbox": [-1, -1, 0, 12, 12, 0], "features": [
        {"type": "Feature", "properties": null, "geometry": {"type": "MultiPolygon", "coordinates":
            [[[[0,0],[0,10],[10,10],[10,0],[0,0]], [[1,1],[9,1],[9,9],[1,9],[1,1]]]]}},
        {"type": "Feature", "properties": {"radius": 0.5}, "geometry":
            {"type": "MultiPoint", "coordinates": [[5, 5, 0], [3, 7]]}},
        {"type": "Feature", "properties": {"kind": "bench"}, "geometry": {"type":
            "GeometryCollection", "geometries": [{"type": "LineString", "coordinates":
            [[2,2],[3,2],[3,3]]}, {"type": "MultiLineString", "coordinates": [[[4,4],[5,4]]]}]}}]}"#;
    let mut files = written(Format::GeoJson, "geojson");
    files.push(ring.into());
    files
}

/// Houses of the data set HouseExpo.
pub fn house_json() -> Corpus {
    let house = r#"{"id": "0042", "room_num": 2, "bbox": {"min": [0, 0], "max": [6, 4]},
        "verts": [[0, 0], [6, 0], [6, 4], [3, 4], [3, 2], [0, 2]],
        "room_category": {"Bedroom": [[0, 0, 3, 2]], "Kitchen": [[3, 0, 6, 4]]}}"#;
    let mut files = written(Format::HouseExpo, "house.json");
    files.push(house.into());
    files
}

/// A Gazebo world as in the data set BARN.
pub fn barn_world() -> Corpus {
    let models: String = [(-0.075, 0.075), (-0.225, 0.075), (-0.375, 5.325), (-0.525, 5.475)]
        .iter()
        .enumerate()
        .map(|(i, (x, y))| {
            format!(
                "<model name='unit_cylinder_{i}'>
<static>1</static>
                 <pose frame=''>{x:.6} {y:.6} 0.000000 0.000000 0.000000 0.000000</pose>
                 <link name='link'><collision name='collision'>
<geometry><cylinder>
                 <radius>0.075000</radius>
<length>1</length></cylinder></geometry>
                 </collision></link></model>
"
            )
        })
        .collect();
    let plane = "<model name='ground_plane'><link name='link'><collision name='collision'>
                 <geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
";
    let text = format!(
        "<?xml version='1.0'?>
<sdf version='1.6'>
<world name='default'>
<light name='sun'/>
         {plane}{models}</world>
</sdf>
"
    );
    vec![text.into_bytes()]
}

/// A NumPy array, with eight-byte and with one-byte numbers.
fn arrays(rows: usize, cols: usize, values: &[i64]) -> Corpus {
    let file = |descr: &str, data: Vec<u8>| {
        let header = format!(
            "{{'descr': '{descr}', 'fortran_order': False, 'shape': ({rows}, {cols}), }}   \n"
        );
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.into_bytes());
        file.extend(data);
        file
    };
    vec![
        file("<i8", values.iter().flat_map(|value| value.to_le_bytes()).collect()),
        file("|u1", values.iter().map(|&value| value as u8).collect()),
    ]
}

/// Grids of the data set BARN.
pub fn barn_grid() -> Corpus {
    let cells: Vec<i64> = (0..48).map(|i| i64::from(!(6..42).contains(&i) || i == 22)).collect();
    arrays(8, 6, &cells)
}

/// Paths of the data set BARN.
pub fn barn_path() -> Corpus {
    arrays(4, 2, &[3, 0, 3, 1, 4, 2, 4, 3])
}

/// Robots as RON.
pub fn robot_ron() -> Corpus {
    let whole = include_str!("../../../assets/robots/pioneer_3at.ron");
    ["(length: 0.4, width: 0.4, max_speed: 1.2)", "()", whole]
        .map(|text| text.as_bytes().to_vec())
        .to_vec()
}

/// Logs of short trials: in worlds that can be generated again, and in worlds that the log contains.
pub fn trial_log() -> Corpus {
    let worlds = worlds();
    let mut files = Vec::new();
    for (i, robots) in [(0, 1), (6, 1), (6, 2)] {
        let Some(world) = worlds.get(i) else { continue };
        let settings = TrialSettings { time_limit: 4.0, robots, ..Default::default() };
        let Ok(mut trial) = Trial::flat(world, settings) else { continue };
        while trial.step() {}
        let mut file = Vec::new();
        if trial.log().write(&mut file).is_ok() {
            files.push(file);
        }
    }
    files
}

/// The world of the scenarios.
pub fn scenario_world() -> World {
    let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
    spec.generate(Seed(3)).map_or_else(|_| every_part(), |plan| plan.to_world())
}

/// Scenarios as RON.
pub fn scenario_ron() -> Corpus {
    let world = scenario_world();
    let spec = ScenarioSpec { doors: 0.7, people: 3, smoke: 0.3, ..Default::default() };
    let drawn = (0..2).filter_map(|seed| Scenario::new(&world, &spec, Seed(seed)).ok());
    drawn.filter_map(|scenario| scenario.to_ron().ok()).map(String::into_bytes).collect()
}

/// Trajectories in the format of TUM.
pub fn tum() -> Corpus {
    let poses = (0..20).map(|i| {
        let time = 0.5 * f64::from(i);
        tum::TimedPose { time, pose: Pose::new(0.2 * time, 1.0 - 0.1 * time, 0.3 * time) }
    });
    let mut file = Vec::new();
    let written = tum::write(poses, &mut file);
    let by_hand = "# time x y z qx qy qz qw\n1,0,0,0,0,0,0,1\n2.5 1e1 -3 0.5 0.1 0.2 0.3 0.9\n";
    written.map(|()| file).into_iter().chain([by_hand.into()]).collect()
}

/// Surveys as RON.
pub fn survey_ron() -> Corpus {
    let short = "(families: [(name: \"a\", spec: Hallway(segments: 9), maps: 3, first_seed: 7), \
                 (name: \"b\", spec: Forest(), maps: 2)], conditions: [(name: \"c\", \
                 time_per_area: 2, odometry: \"poor\"), (name: \"d\", slam: pose_graph)], \
                 noise_seeds: 3)";
    vec![short.into(), include_bytes!("../../../assets/surveys/lost.survey.ron").to_vec()]
}

/// Serializes a value as RON in the form that the readers of surveys expect.
fn as_ron(value: &impl serde::Serialize) -> Option<Vec<u8>> {
    use ron::extensions::Extensions;
    let extensions = Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME;
    let options = ron::Options::default().with_default_extension(extensions);
    options.to_string(value).map(String::into_bytes).ok()
}

/// Panels, anchors, levers and designs of atlases as RON.
pub fn difficulty_ron() -> Corpus {
    let (panel, anchors) = (Panel::reference(), Anchors::first());
    let designs = WorldKind::ALL.iter().filter_map(|&kind| AtlasDesign::of(kind));
    let designs = designs.chain([AtlasDesign::indoor_small()]);
    let designs = designs.map(|design| as_ron(&design));
    let others = [as_ron(&panel), as_ron(&anchors), as_ron(&LeverDesign::first())];
    designs.chain(others).flatten().collect()
}

/// Joins two files into one, separated by an empty line.
fn joined(folder: &Path, names: [&str; 2]) -> std::io::Result<Vec<u8>> {
    let [head, lines] = names.map(|name| std::fs::read(folder.join(name)));
    Ok([head?.trim_ascii_end(), b"\n\n", &lines?].concat())
}

/// The survey whose trials [`survey_folder`] contains.
pub fn short_survey() -> Option<Survey> {
    let text = "(families: [(name: \"a\", spec: Hallway(segments: 3), maps: 2)], \
                conditions: [(name: \"c\", time_limit: 1)], noise_seeds: 2)";
    Survey::from_ron(text).ok()
}

/// Folders of surveys, with the description and the trials.
pub fn survey_folder() -> Corpus {
    let (Some(survey), Ok(folder)) = (short_survey(), tempfile::tempdir()) else {
        return Vec::new();
    };
    let Ok(mut open) = SurveyFolder::open(folder.path(), &survey, Shard::WHOLE) else {
        return Vec::new();
    };
    let ended = open.run(1, &|_| ControlFlow::Continue(()));
    ended.ok().and_then(|_| joined(folder.path(), SURVEY_FILES).ok()).into_iter().collect()
}

/// Reports of trials.
pub fn report_json() -> Corpus {
    let mut files = Vec::new();
    for world in worlds().iter().take(2) {
        let settings = TrialSettings { time_limit: 2.0, ..Default::default() };
        let Ok(mut trial) = Trial::flat(world, settings) else { continue };
        while trial.step() {}
        let Ok(truth) = trial.reference(world) else { continue };
        let report = trial.report(world, &truth).ok();
        files.extend(report.and_then(|report| serde_json::to_vec_pretty(&report).ok()));
    }
    files
}

/// The output of a driver that estimates no poses, and of one that does.
pub fn driver() -> Corpus {
    let hello =
        |slam| format!("{{\"protocol\": \"{PROTOCOL}\", \"name\": \"a\", \"slam\": {slam}}}\n");
    let drive = "{\"speed\": 0.3, \"turn_rate\": -0.1}\n".repeat(60);
    let without = hello(false) + &drive + "{\"speed\": 0, \"turn_rate\": 0, \"want\": [\"map\"]}\n";
    let map = "{\"speed\": 0.1, \"turn_rate\": 0, \"pose\": [1, 2, 0.5], \"map\": {\"resolution\": 0.1, \
               \"origin\": [0, 0], \"cols\": 3, \"rows\": 2, \"cells\": \"AGQBZAAB\"}}\n";
    let with = hello(true) + map + "{\"finished\": true}\n";
    vec![without.into_bytes(), with.into_bytes()]
}
