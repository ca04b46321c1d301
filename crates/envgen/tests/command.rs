//! The command `envgen` as a user runs it.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use envgen::indoor::IndoorSpec;
use envgen::{Seed, Spec};
use serde_json::Value;

fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_envgen"))
}

fn run(arguments: &[&str]) -> Output {
    command().args(arguments).output().unwrap()
}

fn lines(arguments: &[&str]) -> Vec<Value> {
    let output = run(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// Exit code and stderr of a run that must not print to stdout.
fn failure(arguments: &[&str]) -> (i32, String) {
    let output = run(arguments);
    assert!(output.stdout.is_empty());
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn every_kind_is_listed_with_its_settings() {
    let output = run(&["kinds"]);
    let text = String::from_utf8(output.stdout).unwrap();
    let listed = |arguments: &[&str]| -> Vec<Value> {
        serde_json::from_slice(&run(arguments).stdout).unwrap()
    };
    let kinds = listed(&["kinds", "--json"]);
    // Those of doors, people and smoke, which are of no kind of worlds.
    assert!(kinds.iter().all(|kind| kind["kind"] != "scenario"));
    let scenario = listed(&["kinds", "scenario", "--json"]);
    assert!(scenario[0]["settings"].as_array().unwrap().iter().any(|s| s["name"] == "people"));
    for kind in kinds.iter().chain(&scenario) {
        assert!(text.contains(&format!("{}: ", kind["kind"].as_str().unwrap())));
        for setting in kind["settings"].as_array().unwrap() {
            assert!(text.contains(setting["name"].as_str().unwrap()));
            assert!(text.contains(setting["help"].as_str().unwrap()));
            if let Some(group) = setting["group"].as_str() {
                assert!(text.contains(&format!("  [{group}]\n")), "{group}");
            }
        }
    }
}

#[test]
fn sampled_lines_have_the_promised_fields() {
    let hallways =
        lines(&["sample", "hallway", "--count", "3", "--seed", "5", "--set", "segments=7"]);
    assert_eq!(hallways.len(), 3);
    for (n, line) in hallways.iter().enumerate() {
        let keys: Vec<_> = line.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(keys, ["blueprint", "kind", "metrics", "seed", "spec"]);
        assert_eq!(line["kind"], "hallway");
        assert_eq!(line["seed"], 5 + n as u64);
        assert_eq!(line["spec"]["segments"], 7);
        let states = line["blueprint"]["states"].as_array().unwrap();
        assert_eq!(states.len(), 7);
        assert!(states.iter().all(|state| (1..=8).contains(&state.as_u64().unwrap())));
    }
    let forests = lines(&["sample", "forest", "--count", "2", "--set", "width=20"]);
    let forest = &forests[1]["blueprint"];
    assert_eq!((&forest["width"], &forest["height"]), (&Value::from(20.0), &Value::from(50.0)));
    let trees = forest["trees"].as_array().unwrap();
    assert!(trees.iter().all(|tree| tree.as_array().unwrap().len() == 3 && tree[2] == 1.0));
}

#[test]
fn sampled_lines_have_the_difficulty_that_is_shown_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    let file = path.to_str().unwrap();
    let small = ["--set", "width=4", "--set", "height=4", "--seed", "3"];
    run(&[&["generate", "indoor", "--out", file], &small[..]].concat());
    let measured = ["--metrics", "difficulty", "--platform", "max_range=3"];
    let line = &lines(&[&["sample", "indoor", "--count", "1"], &small[..], &measured].concat())[0];
    let inspect = ["inspect", file, "--json"];
    let shown = |more: &[&str]| -> Value {
        serde_json::from_slice(&run(&[&inspect[..], more].concat()).stdout).unwrap()
    };
    assert!(line["difficulty"]["tour_length_95_m"].as_f64().unwrap() > 1.0, "{line}");
    assert_eq!(shown(&["--platform", "max_range=3"])["difficulty"], line["difficulty"]);
    assert_ne!(shown(&[])["difficulty"], line["difficulty"]);

    // A robot that fits nowhere has no numbers.
    let wide = ["--platform", "circumscribed_radius=2"];
    let output = run(&[&inspect[..], &wide].concat());
    let note = String::from_utf8(output.stderr).unwrap();
    assert!(note.contains("no difficulty: `start` must be on ground"), "{note}");
    let shown: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(shown["difficulty"], Value::Null);

    for (wrong, expected) in [
        (vec!["--platform", "beams=1"], "--platform beams=1: `platform.beams` must be"),
        (vec!["--platform", "wheels=4"], "`platform` must be one of circumscribed_radius, "),
        (vec!["--platform", "beams"], "is not of the form name=value"),
        (vec!["--platform", "laser_offset=1"], "`platform.laser_offset` must be"),
        (
            vec!["--platform", "beams=8", "--platform", " beams=9"],
            "--platform  beams=9: `beams` is set twice",
        ),
    ] {
        let (code, text) = failure(&[&inspect[..], &wrong].concat());
        assert!(code == 2 && text.contains(expected), "{text}");
    }
    let alone = ["sample", "indoor", "--count", "1", "--platform", "beams=9"];
    let (code, text) = failure(&alone);
    assert!(code == 2 && text.contains("`--metrics difficulty`"), "{text}");
}

#[test]
fn predictions_and_what_is_reached_are_shown_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.json");
    let file = path.to_str().unwrap();
    let made = |arguments: &[&str], more: &[&str]| -> Value {
        let output = run(&[&["generate", "--seed", "3", "--out", file], arguments].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&run(&[&["inspect", file, "--json"], more].concat()).stdout).unwrap()
    };
    let dry = [
        &["indoor", "--set", "profile=calibrated", "--set", "width=6", "--set", "height=6"][..],
        &["--set", "floor_slip=1", "--set", "difficulty=4"],
    ]
    .concat();
    let shown = made(&dry, &[]);
    let spec: IndoorSpec = serde_json::from_value(shown["provenance"]["spec"].clone()).unwrap();
    assert_eq!(spec.fixed, ["floor_slip"]);
    assert_eq!(shown["reachable"], serde_json::json!(spec.reachable()));
    let plan = spec.generate(Seed(3)).unwrap();
    assert_eq!(shown["predicted"], serde_json::json!(plan.prediction().unwrap()));
    let predicted = shown["predicted"]["dials"]["difficulty"]["value"].as_f64().unwrap();
    assert!((predicted - 4.0).abs() < 1.0, "{predicted}");
    // Another robot has features of its own, but no prediction.
    let other = made(&dry, &["--platform", "max_range=3"]);
    assert!(other["difficulty"].is_object() && other["predicted"].is_null(), "{other}");

    let guaranteed = made(&["indoor", "--set", "width=6", "--set", "height=6"], &[]);
    assert!(guaranteed["predicted"]["dials"].is_object() && guaranteed["reachable"].is_null());
    let road = made(&["road", "--set", "length=100"], &[]);
    assert!(road["predicted"].is_null() && road["reachable"].is_null(), "{road}");
}

#[test]
fn a_seed_is_the_same_alone_and_in_a_row() {
    let row = lines(&["sample", "forest", "--count", "2", "--seed", "18446744073709551614"]);
    for line in &row {
        let seed = line["seed"].to_string();
        assert_eq!(&lines(&["sample", "forest", "--count", "1", "--seed", &seed])[0], line);
    }
}

#[test]
fn seeds_without_a_blueprint_do_not_stop_the_others() {
    let arguments = ["sample", "road", "--count", "40", "--set", "lengths=as_published"];
    let output = run(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let made = String::from_utf8(output.stdout).unwrap().lines().count();
    let said = String::from_utf8(output.stderr).unwrap();
    let failed = said.lines().filter(|line| line.starts_with("seed ")).count();
    assert!(made > 25 && failed > 0 && made + failed == 40, "{made} made: {said}");
    assert!(said.contains(&format!("{failed} of 40 seeds have no road")), "{said}");
}

#[test]
fn settings_without_effect_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("world.json");
    let noted = |arguments: &[&str]| -> Vec<String> {
        let output = run(&[&["generate", "--out", file.to_str().unwrap()], arguments].concat());
        assert!(output.status.success(), "{output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        let notes = said.lines().filter_map(|line| {
            line.strip_prefix("note: ")?.strip_suffix(" changes nothing in this world")
        });
        notes.map(str::to_owned).collect()
    };
    let alcoves = ["hallway", "--set", "segments=20", "--set", "alcove_depth=0.5"];
    assert_eq!(noted(&alcoves), ["alcove_depth=0.5"]);
    let dug = [&alcoves[..], &["--set", "alcove_rate=0.2"]].concat();
    assert_eq!(noted(&dug), [""; 0]);
    // A default changes nothing by itself, and the radius changes what is promised.
    let plain = ["indoor", "--set", "width=5", "--set", "height=5", "--set", "profile=thesis"];
    assert_eq!(noted(&plain), [""; 0]);
    assert_eq!(noted(&["forest", "--set", "robot_radius=0.3"]), [""; 0]);
    assert_eq!(noted(&["hallway", "--set", "segments=50"]), [""; 0]);
    let road =
        ["road", "--set", "prefabs=straight", "--set", " theta_max = 60", "--set", "people=1"];
    assert_eq!(noted(&road), [" theta_max = 60"]);
}

#[test]
fn sample_ends_quietly_when_its_reader_has_enough() {
    let mut child = command()
        .args(["sample", "hallway", "--count", "1000000000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert!(line.starts_with('{'));
    let mut complaints = String::new();
    child.stderr.take().unwrap().read_to_string(&mut complaints).unwrap();
    assert_eq!((child.wait().unwrap().code(), complaints.as_str()), (Some(0), ""));
}

#[test]
#[cfg(target_os = "linux")]
fn sampling_keeps_its_memory_flat() {
    // Peak memory after 1000 and after 200,000 lines.
    let peak = |count: u64| {
        let mut child = command()
            .args(["sample", "hallway", "--count", &(count + 1_000_000).to_string()])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        for _ in 0..count {
            line.clear();
            out.read_line(&mut line).unwrap();
        }
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        drop(out);
        child.wait().unwrap();
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        peak.trim().trim_end_matches(" kB").parse::<u64>().unwrap()
    };
    let (few, many) = (peak(1000), peak(200_000));
    assert!(many < few + 10_000 && many < 50_000, "{few} kB, then {many} kB");
}

#[test]
fn several_files_come_of_one_world() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mut arguments = vec!["generate".to_owned(), "hallway".to_owned(), "--seed=7".to_owned()];
    for name in ["h.svg", "h.png", "h.ron", "h.json"] {
        arguments.extend(["--out".to_owned(), at(name)]);
    }
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    assert!(run(&arguments).status.success());
    assert_eq!(names(folder.path()), ["h.json", "h.png", "h.ron", "h.svg"]);

    let report = |name: &str| -> Value {
        let output = run(&["inspect", "--json", &at(name)]);
        assert!(output.status.success());
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (json, ron) = (report("h.json"), report("h.ron"));
    assert_eq!(json, ron);
    assert_eq!(json["provenance"]["seed"], 7);
    assert_eq!(json["reproducible"], true);
    assert_eq!(json["certificate"][0]["verdict"], "holds");
    assert!(json["metrics"]["turns"].as_u64().unwrap() > 0);
    assert!(run(&["check", &at("h.ron")]).status.success());
}

#[test]
fn a_spec_file_is_a_source_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("narrow.ron");
    std::fs::write(&path, "Hallway(segments: 12, width: 1.0)").unwrap();
    let path = path.to_str().unwrap();
    let line = &lines(&["sample", path, "--count", "1", "--set", "pitch=3"])[0];
    assert_eq!((&line["spec"]["width"], &line["spec"]["pitch"]), (&1.0.into(), &3.0.into()));

    std::fs::write(path, "Hallway(segments: 12, widht: 1.0)").unwrap();
    let (code, text) = failure(&["sample", path, "--count", "1"]);
    assert_eq!(code, 2);
    assert!(text.contains("narrow.ron") && text.contains("widht"), "{text}");
}

#[test]
fn indoor_maps_take_rooms_from_a_folder_and_go_to_the_world_generator() {
    let folder = tempfile::tempdir().unwrap();
    let rooms = folder.path().join("rooms");
    std::fs::create_dir(&rooms).unwrap();
    let room = rooms.join("vault.room.ron");
    std::fs::write(&room, "(name: \"vault\", width: 1, height: 1, difficulty: 3)").unwrap();
    let rooms = rooms.to_str().unwrap();
    let [map, again] = ["map.xml", "again.svg"].map(|name| folder.path().join(name));
    let arguments = ["generate", "indoor", "--rooms", rooms, "--set", "rooms=vault"];
    let out = ["--out", map.to_str().unwrap(), "--out", again.to_str().unwrap()];
    let output = run(&[&arguments[..], &out].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&map).unwrap();
    assert!(text.contains("<room name=\"vault\"") && text.contains("<door "));
    // The room is in no catalogue that `inspect` knows by itself.
    let map = map.to_str().unwrap();
    let (code, error) = failure(&["inspect", map]);
    assert!(code != 0 && error.contains("`vault`"), "{error}");
    for command in ["inspect", "check"] {
        let output = run(&[command, map, "--rooms", rooms]);
        assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    }

    let before = names(folder.path());
    std::fs::write(&room, "(name: \"vault\", width: -1, height: 1, difficulty: 3)").unwrap();
    let new = folder.path().join("new.xml");
    let (code, error) = failure(&[&arguments[..], &["--out", new.to_str().unwrap()]].concat());
    assert!(code == 2 && error.contains("vault.room.ron"), "{error}");
    let (code, error) = failure(&["sample", "hallway", "--count", "1", "--rooms", rooms]);
    assert!(code == 2 && error.contains("indoor"), "{error}");
    let (code, error) = failure(&["generate", "hallway", "--out", new.to_str().unwrap()]);
    assert!(code == 1 && error.contains("plan of an indoor map"), "{error}");
    let (code, error) = failure(&["check", map, "--rooms", "no/such/folder"]);
    assert!(code == 1 && error.contains("there is no folder `no/such/folder`"), "{error}");
    let nowhere = folder.path().join("nowhere/map.svg");
    let (code, error) = failure(&["generate", "indoor", "--out", nowhere.to_str().unwrap()]);
    assert!(code == 1 && error.contains("there is no folder `") && error.contains("nowhere"));
    assert_eq!(names(folder.path()), before);
}

#[test]
fn room_libraries_describe_what_the_catalogue_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let library =
        file("library.xml", "<roomList><room name=\"sauna\" size=\"1, 2, 1\"/></roomList>");
    let project = file(
        "project.xml",
        "<world depth=\"2\" width=\"3\" name=\"spa\">
           <room name=\"hallway\" x=\"0\" y=\"0\"/><room name=\"sauna\" x=\"0\" y=\"1\"/>
           <door x=\"0\" y=\"1\" direction=\"1\"/><door x=\"1\" y=\"1\" direction=\"1\"/><lamp/>
         </world>",
    );
    let output = run(&["inspect", &project, "--library", &library, "--json"]);
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{notes}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["parts"]["rooms"], &report["parts"]["doorways"]), (&1.into(), &1.into()));
    for says in
        ["1 doors lead nowhere", "1 elements are neither rooms nor doors", "1 rooms are empty"]
    {
        assert!(notes.contains(&format!("note: {project}: {says}")), "{notes}");
    }
    let (code, error) = failure(&["check", &project]);
    assert!(code == 1 && error.contains("`sauna`"), "{error}");
    let (code, error) = failure(&["check", &project, "--library", &project]);
    assert!(code == 2 && error.contains("roomList"), "{error}");

    let world = folder.path().join("world.ron");
    let world = world.to_str().unwrap();
    let arguments = ["generate", "indoor", "--set", "rooms=sauna", "--out", world];
    assert_eq!(failure(&arguments).0, 2);
    let output = run(&[&arguments[..], &["--library", &library]].concat());
    assert!(output.status.success());
    assert!(String::from_utf8(output.stderr).unwrap().contains("difficulty 0"));
    let (code, error) = failure(&["inspect", world, "--library", &library]);
    assert!(code == 2 && error.contains("projects of the World Generator"), "{error}");
}

#[test]
fn a_world_generator_project_is_a_world() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("map.xml");
    let path = map.to_str().unwrap();
    assert!(run(&["generate", "indoor", "--seed", "3", "--out", path]).status.success());
    assert!(run(&["inspect", path]).status.success());
    let whole = std::fs::read_to_string(&map).unwrap();
    std::fs::write(&map, &whole[..whole.len() / 2]).unwrap();
    let (code, error) = failure(&["inspect", path]);
    assert!(code != 0 && error.contains("map.xml"), "{error}");
}

#[test]
fn a_certificate_that_does_not_hold_is_exit_code_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("h.json");
    let path = path.to_str().unwrap();
    assert!(run(&["generate", "hallway", "--out", path]).status.success());
    let mut world: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    // The hallway is 2 m wide.
    world["certificate"][0]["connected"]["radius"] = 1.2.into();
    std::fs::write(path, world.to_string()).unwrap();
    let output = run(&["check", path]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stdout).unwrap().contains("broken: a disc of radius 1.2"));
    // The same when the reader has closed the pipe.
    let mut child = command().args(["check", path]).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

#[test]
fn check_says_whether_a_file_is_what_its_spec_and_seed_make() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.json");
    let path = path.to_str().unwrap();
    assert!(run(&["generate", "forest", "--seed", "5", "--out", path]).status.success());
    let made: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let check = |change: &dyn Fn(&mut Value)| {
        let mut world = made.clone();
        change(&mut world);
        std::fs::write(path, world.to_string()).unwrap();
        let output = run(&["check", path]);
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    type Change = dyn Fn(&mut Value);
    let cases: [(&Change, i32, &str); 9] = [
        (&|_| (), 0, "reproducible: its spec and seed make this"),
        (&|w| w["trees"][3]["center"][0] = 17.5.into(), 1, "not reproducible: its spec and seed"),
        (
            &|w| w["provenance"]["seed"] = 6.into(),
            1,
            "not reproducible: its spec and seed make ano",
        ),
        (&|w| w["provenance"]["spec"]["intensity"] = (-1).into(), 1, "`intensity` must be"),
        (&|w| w["provenance"]["spec"]["width"] = 1e6.into(), 1, "make another world"),
        (
            &|w| w["provenance"]["value_version"] = 9.into(),
            0,
            "made by value version 9, this program",
        ),
        (
            &|w| w["provenance"]["edited"] = true.into(),
            0,
            "not compared: it says that it was edited",
        ),
        (
            &|w| w["provenance"]["kind"] = "manual".into(),
            0,
            "not compared: it has no spec and seed",
        ),
        (
            &|w| w["certificate"] = Value::Array(Vec::new()),
            1,
            "its spec and seed make this world, with another certificate",
        ),
    ];
    for (change, code, says) in cases {
        let (found, text) = check(change);
        assert!(found == Some(code) && text.contains(says), "{found:?}, {says}: {text}");
    }
    for (value, says) in [
        (
            18446744073709551616.0,
            "`bounds.max.x` must be from -1e8 to 1e8 m, got 1.8446744073709552e19 m",
        ),
        (2147483647.0, "`bounds.max.x` must be from -1e8 to 1e8 m, got 2.147483647e9 m"),
    ] {
        assert_eq!(check(&|w| w["bounds"]["max"][0] = value.into()).0, Some(1));
        for command in ["check", "inspect"] {
            let (code, text) = failure(&[command, path]);
            assert!(code == 1 && text.contains(says), "{code}: {text}");
        }
    }
}

#[test]
fn bad_arguments_are_exit_code_two_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("world.svg");
    let out = out.to_str().unwrap();
    for (arguments, expected) in [
        (vec!["generate", "lake", "--out", out], "hallway, forest"),
        (vec!["generate", "forest", "--set", "widht=3", "--out", out], "width, height, intensity"),
        (vec!["generate", "forest", "--set", "width=wide", "--out", out], "from 0.01 to 1000000"),
        (vec!["generate", "forest", "--set", "width=NaN", "--out", out], "`width` must be"),
        (vec!["generate", "forest", "--set", "width=1e300", "--out", out], "`width` must be"),
        (vec!["generate", "forest", "--set", "border=round", "--out", out], "open, inset, torus"),
        (
            vec!["generate", "forest", "--set", "width", "--out", out],
            "--set width: is not of the form",
        ),
        (
            vec!["generate", "hallway", "--set", "p_st=0.5", "--set", "p_st=0.6", "--out", out],
            "--set p_st=0.6: `p_st` is set twice",
        ),
        // The former name of `cell_size`.
        (
            vec!["generate", "indoor", "--set", "cell_size=2", "--set", "unit=4", "--out", out],
            "--set unit=4: `cell_size` is set twice",
        ),
        (
            vec!["generate", "indoor", "--scenario-seed", "5", "--out", out],
            "--scenario-seed 5: applies to scenario settings",
        ),
        (
            vec!["generate", "forest", "--grid", "--out", "forest.csv"],
            "--grid: applies to pictures",
        ),
        (
            vec!["generate", "landscape", "--set", "rows=9999", "--set", "cols=9999", "--out", out],
            "--set rows=9999 --set cols=9999: `rows * cols` must be",
        ),
        (vec!["generate", "hallway", "--seed", "-1", "--out", out], "`seed` must be a whole"),
        (
            vec!["generate", "hallway", "--resolution", "0.1", "--out", out],
            "--resolution 0.1: applies to ROS maps",
        ),
        (
            vec!["generate", "hallway", "--resolution", "0", "--out", "a.yaml"],
            "--resolution 0: `res",
        ),
        (
            vec!["sample", "hallway", "--count", "3", "--seed", "18446744073709551614"],
            "--count 3: only 2 seeds are left from seed 18446744073709551614 on",
        ),
        (vec!["generate", "forest", "--set", "intensity=1e5", "--out", out], "`intensity`"),
        (vec!["generate", "hallway", "--set", "p_st=1.0000001", "--out", out], "from 0 to 1"),
        (vec!["generate", "hallway", "--set", "width=6", "--out", out], "at most 4.9 m"),
        (vec!["generate", "hallway", "--set", "start=9", "--out", out], "1 to 8 or stationary"),
        (vec!["generate", "hallway", "--out", "world.xyz"], ".json, .ron"),
        (vec!["generate", "hallway"], "--out"),
        (vec!["inspect", "world.xyz"], ".json, .ron"),
        (vec!["generate", "hallway", "--picture-width", "1", "--out", out], "--picture-width 1: "),
        (vec!["sample", "hallway", "--count", "-1"], "`count` must be a whole number from 0"),
    ] {
        let (code, text) = failure(&arguments);
        assert_eq!(code, 2, "{arguments:?}: {text}");
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
    // The size of the world decides.
    let file = folder.path().join("a.house.json");
    let fine = ["generate", "indoor", "--resolution", "0.003", "--out", file.to_str().unwrap()];
    let (code, text) = failure(&fine);
    assert!(code == 1 && text.contains("67108864"), "{code} {text}");
    assert!(names(folder.path()).is_empty());
}

#[test]
fn what_fails_later_is_exit_code_one_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (code, text) =
        failure(&["generate", "forest", "--set", "min_distance=4", "--out", &at("f.svg")]);
    assert_eq!(code, 1);
    assert!(text.contains("the area holds at most"), "{text}");
    // The second file cannot be written, so the first is not either.
    std::fs::create_dir(at("folder.svg")).unwrap();
    let (code, text) =
        failure(&["generate", "forest", "--out", &at("f.svg"), "--out", &at("folder.svg")]);
    assert_eq!((code, text.contains("is a folder")), (1, true), "{text}");
    std::fs::remove_dir(at("folder.svg")).unwrap();
    let (code, text) =
        failure(&["generate", "forest", "--out", &at("f.svg"), "--out", &at("no/where.svg")]);
    assert_eq!(code, 1);
    assert!(text.contains("where.svg"), "{text}");
    let (code, text) = failure(&["inspect", &at("missing.ron")]);
    assert_eq!(code, 1);
    assert!(text.contains("missing.ron"), "{text}");
    assert!(names(folder.path()).is_empty());
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn maps_for_robots_are_two_files_that_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hall.yaml");
    let file = path.to_str().unwrap();
    let output = run(&["generate", "hallway", "--seed", "7", "--out", file]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let image = std::fs::read(folder.path().join("hall.pgm")).unwrap();
    assert!(image.starts_with(b"P5\n"));
    let world: Value = serde_json::from_slice(&run(&["inspect", "--json", file]).stdout).unwrap();
    assert_eq!(world["provenance"]["spec"]["format"], "ros_map");
    assert!(world["parts"]["walls"].as_u64().unwrap() > 10);
    assert!(world["start"].is_object());

    std::fs::write(folder.path().join("hall.pgm"), &image[..image.len() / 2]).unwrap();
    let (code, text) = failure(&["inspect", file]);
    assert_eq!(code, 1);
    assert!(text.contains("hall.pgm: the PGM must hold"), "{text}");
    std::fs::remove_file(folder.path().join("hall.pgm")).unwrap();
    let (code, text) = failure(&["inspect", file]);
    assert!(code == 1 && text.contains("hall.pgm, which cannot be read"), "{text}");
}
