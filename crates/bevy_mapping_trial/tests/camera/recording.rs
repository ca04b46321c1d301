//! Trials whose pictures are written to files.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use bevy_envgen::envgen::forest::ForestSpec;
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::envgen::scenario::{Scenario, ScenarioSpec};
use bevy_envgen::envgen::{Blueprint, Seed, Spec, World};
use bevy_mapping_trial::camera::{
    CameraImages, CameraRecording, CameraTrial, RecordingError, RobotCamera,
};
use bevy_mapping_trial::trial::run_headless_with;
use mapping_trial::trial::{TrialLog, TrialParts, TrialSettings};
use serde_json::Value;

fn world() -> World {
    IndoorSpec { width: 5, height: 5, ..Default::default() }.generate(Seed(4)).unwrap().to_world()
}

fn settings(world: &World) -> TrialSettings {
    TrialSettings { time_limit: 6.0, robots: 2, start: world.start, ..Default::default() }
}

/// Returns all files below a folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

fn png(data: &[u8]) -> (png::OutputInfo, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(data)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info, pixels)
}

#[test]
fn a_recorded_trial_is_the_same_trial() {
    let folder = tempfile::tempdir().unwrap();
    let world = world();
    let spec = ScenarioSpec { doors: 1.0, people: 3, ..Default::default() };
    let scenario = Some(Scenario::new(&world, &spec, Seed(4)).unwrap());
    let parts = TrialParts::default;
    let plain =
        run_headless_with(&world, settings(&world), parts(), scenario.clone(), |_| ()).unwrap();
    let mut log = Vec::new();
    plain.log().write(&mut log).unwrap();

    let camera = RobotCamera { width: 60, height: 44, ..Default::default() };
    let recording = |name: &str| CameraRecording { camera, folder: folder.path().join(name) };
    let first = recording("first");
    let (trial, descriptions) = CameraTrial::new(&world, settings(&world), parts(), scenario)
        .record(&first, |_| ())
        .unwrap();
    let mut recorded = Vec::new();
    trial.log().write(&mut recorded).unwrap();
    assert!(log == recorded, "the camera changes the trial");
    let expected = ["robot_1", "robot_2"].map(|robot| first.folder.join(robot).join("frames.json"));
    assert_eq!(descriptions, expected);

    let again = recording("again");
    let log = TrialLog::read(&mut recorded.as_slice()).unwrap();
    CameraTrial::replay(&world, log, parts()).record(&again, |_| ()).unwrap();
    let (first, again) = (files(&first.folder), files(&again.folder));
    assert_eq!(first.keys().collect::<Vec<_>>(), again.keys().collect::<Vec<_>>());
    assert!(first == again, "the pictures of the replay differ");

    let json: Value = serde_json::from_slice(&first[Path::new("robot_1/frames.json")]).unwrap();
    // Pictures are taken at 0, 0.5, .. 6 s, the last one when the trial is over.
    let frames = json["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 13);
    for (i, frame) in frames.iter().enumerate() {
        assert!((frame["time"].as_f64().unwrap() - 0.5 * i as f64).abs() < 1e-9);
        for (key, folder, bytes) in [
            ("file_path", "rgb", 3),
            ("depth_file_path", "depth", 2),
            ("label_file_path", "labels", 2),
        ] {
            let path = frame[key].as_str().unwrap();
            assert_eq!(path, format!("{folder}/{:06}.png", i + 1));
            let (info, pixels) = png(&first[&Path::new("robot_1").join(path)]);
            assert_eq!((info.width, info.height), (60, 44));
            assert_eq!(pixels.len(), 60 * 44 * bytes);
        }
    }
    // The colour image shows a scene, and is not uniform.
    let colors = png(&first[Path::new("robot_1/rgb/000013.png")]).1;
    let different: std::collections::BTreeSet<&[u8]> = colors.chunks_exact(3).collect();
    assert!(different.len() > 50, "{} colours", different.len());
    // Every label has a meaning, and the floor is among the labels.
    let named: BTreeMap<u64, &str> = json["labels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|label| (label["id"].as_u64().unwrap(), label["kind"].as_str().unwrap()))
        .collect();
    let labels = png(&first[Path::new("robot_1/labels/000013.png")]).1;
    for label in labels.as_chunks::<2>().0 {
        assert!(named.contains_key(&u16::from_be_bytes(*label).into()));
    }
    assert!(
        named.values().any(|kind| *kind == "room") && named.values().any(|kind| *kind == "ceiling")
    );
    // The pose of the camera at the start is 0.55 m up and 0.2 m ahead.
    let start = trial.trajectory(0).poses[0];
    let position = frames[0]["position"].as_array().unwrap();
    let at = start.to_world(bevy_envgen::envgen::glam::DVec2::new(0.2, 0.0));
    for (found, expected) in position.iter().zip([at.x, at.y, 0.55]) {
        assert!((found.as_f64().unwrap() - expected).abs() < 1e-4);
    }
    assert_eq!(frames[0]["transform_matrix"][2][3].as_f64(), Some(0.55));
    assert_eq!(json["depth_unit_scale_factor"].as_f64(), Some(1e-3));
}

#[test]
fn an_earlier_recording_is_replaced_and_other_files_stay() {
    let folder = tempfile::tempdir().unwrap();
    let world = world();
    let images = CameraImages { color: false, ..Default::default() };
    let camera = RobotCamera { images, width: 8, height: 6, ..Default::default() };
    let run = |rate: f64| {
        let settings = TrialSettings { robots: 1, time_limit: 2.0, ..settings(&world) };
        let camera = RobotCamera { rate, ..camera };
        let recording = CameraRecording { camera, folder: folder.path().to_owned() };
        CameraTrial::new(&world, settings, TrialParts::default(), None).record(&recording, |_| ())
    };
    run(4.0).unwrap();
    fs::write(folder.path().join("depth/notes.txt"), "kept").unwrap();
    run(1.0).unwrap();
    let names: Vec<String> =
        files(folder.path()).into_keys().map(|name| name.to_string_lossy().into_owned()).collect();
    let expected = [
        "depth/000001.png",
        "depth/000002.png",
        "depth/000003.png",
        "depth/notes.txt",
        "frames.json",
        "labels/000001.png",
        "labels/000002.png",
        "labels/000003.png",
    ];
    assert_eq!(names, expected);
    let wrong = run(0.0);
    assert!(matches!(wrong, Err(RecordingError::Camera(_))));
}

#[test]
fn an_error_ends_the_trial() {
    let world = world();
    let images = CameraImages { color: false, ..Default::default() };
    let camera = RobotCamera { images, width: 8, height: 6, ..Default::default() };
    let settings = TrialSettings { robots: 1, time_limit: 1000.0, ..settings(&world) };
    let trial = CameraTrial::new(&world, settings, TrialParts::default(), None);
    let mut times = Vec::new();
    let ended = trial.watch(
        camera,
        |_| (),
        |robot, frame| {
            assert_eq!((robot, frame.number), (0, times.len() as u64));
            times.push(frame.time);
            let source = std::io::Error::other("the disk is full");
            let error = RecordingError::File { path: "frames".into(), source };
            if times.len() < 3 { Ok(()) } else { Err(error) }
        },
    );
    assert_eq!(
        ended.err().map(|error| error.to_string()).as_deref(),
        Some("frames: the disk is full")
    );
    assert_eq!(times.len(), 3);
}

#[test]
fn films_show_what_the_first_robot_sees() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("eyes.gif");
    let world = world();
    let camera = RobotCamera { width: 40, height: 30, rate: 4.0, ..Default::default() };
    let settings = TrialSettings { time_limit: 3.0, ..settings(&world) };
    let trial = || CameraTrial::new(&world, settings.clone(), TrialParts::default(), None);
    trial().film(camera, (&path, 4.0), |_| ()).unwrap();
    let film = fs::read(&path).unwrap();
    assert!(film.starts_with(b"GIF89a") && film.len() > 2000, "{} bytes", film.len());
    assert_eq!(film[6..10], [40, 0, 30, 0]);
    let wrong = trial().film(camera, (&path, 0.0), |_| ());
    assert!(matches!(wrong, Err(RecordingError::Drawing(_))));
}

/// A trial outdoors, where the sun casts shadows.
#[test]
fn colours_are_taken_under_the_sun() {
    let spec = ForestSpec { width: 20.0, height: 20.0, intensity: 0.05, ..Default::default() };
    let world = spec.generate(Seed(2)).unwrap().to_world();
    let settings = TrialSettings { time_limit: 2.0, start: world.start, ..Default::default() };
    let camera = RobotCamera { width: 60, height: 44, ..Default::default() };
    let mut colours = std::collections::BTreeSet::new();
    let mut frames = 0;
    CameraTrial::new(&world, settings, TrialParts::default(), None)
        .watch(
            camera,
            |_| (),
            |_, frame| {
                frames += 1;
                colours.extend(frame.color.iter().flatten().copied());
                Ok(())
            },
        )
        .unwrap();
    assert!(frames >= 4 && colours.len() > 50, "{frames} frames of {} tones", colours.len());
}

#[test]
fn a_trial_that_cannot_begin_leaves_an_earlier_recording() {
    let folder = tempfile::tempdir().unwrap();
    let world = world();
    let camera = RobotCamera { width: 20, height: 16, ..Default::default() };
    let recording = CameraRecording { camera, folder: folder.path().to_owned() };
    let settings = TrialSettings { time_limit: 1.0, robots: 1, ..settings(&world) };
    let trial = |settings| CameraTrial::new(&world, settings, TrialParts::default(), None);
    trial(settings.clone()).record(&recording, |_| ()).unwrap();
    let before = files(folder.path());
    assert!(before.len() > 3);
    let bad = TrialSettings { time_limit: -1.0, ..settings };
    assert!(trial(bad).record(&recording, |_| ()).is_err());
    assert!(files(folder.path()) == before, "the earlier recording is changed");
}
