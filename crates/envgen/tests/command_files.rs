//! Files that the command reads and writes: what it names, follows, keeps and refuses.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use envgen::export::ros_map::{RosCell, RosMap};
use envgen::geometry::{Pose, Rect, Shape};
use envgen::glam::DVec2;
use envgen::import::{read_world, ros_map::read_ros_map};
use envgen::world::{Claim, Doorway, Room, Surface, SurfaceKind, Wall, WallKind};
use envgen::{Provenance, World};
use serde_json::Value;
use tempfile::TempDir;

/// A folder to run the command in.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn names(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> =
            names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the command with arguments that spaces divide.
    fn run(&self, arguments: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_envgen"))
            .args(arguments.split(' '))
            .current_dir(self.0.path())
            .output()
            .unwrap()
    }

    /// What is on stderr of a run that succeeds.
    fn notes(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{arguments}: {text}");
        text
    }

    /// What is on stderr of a run that ends with this exit code.
    fn error(&self, arguments: &str, code: i32) -> String {
        let output = self.run(arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}: {text}");
        text
    }
}

const TREES: &str = "forest --set width=10 --set height=10";

#[test]
#[cfg(unix)]
fn links_are_followed_and_modes_kept() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Folder::new();
    let mode = |name: &str| fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o777;
    folder.write("usual", "");
    folder.write("b.json", "");
    fs::set_permissions(folder.path("b.json"), PermissionsExt::from_mode(0o600)).unwrap();
    fs::create_dir(folder.path("far")).unwrap();
    symlink("b.json", folder.path("l.json")).unwrap();
    symlink("far/new.json", folder.path("first.json")).unwrap();
    symlink("first.json", folder.path("second.json")).unwrap();
    symlink("loop.json", folder.path("loop.json")).unwrap();
    folder.notes(&format!("generate {TREES} --out l.json --out second.json"));
    assert!(fs::symlink_metadata(folder.path("l.json")).unwrap().is_symlink());
    assert!(read_world(&folder.path("b.json")).is_ok());
    assert_eq!((mode("b.json"), mode("far/new.json")), (0o600, mode("usual")));
    assert!(fs::symlink_metadata(folder.path("first.json")).unwrap().is_symlink());
    let error = folder.error(&format!("generate {TREES} --out loop.json"), 1);
    assert!(
        error.contains("--out loop.json: is a link that leads through too many links"),
        "{error}"
    );
}

#[test]
#[cfg(unix)]
fn what_may_not_be_replaced_stays() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Folder::new();
    folder.write("fixed.json", "mine");
    fs::set_permissions(folder.path("fixed.json"), PermissionsExt::from_mode(0o444)).unwrap();
    symlink("/dev/null", folder.path("null.json")).unwrap();
    fs::create_dir(folder.path("folder.json")).unwrap();
    let before = folder.names();
    for (name, what) in [
        ("fixed.json", "exists and is read-only"),
        ("null.json", "is a device and not a file"),
        ("folder.json", "is a folder"),
        ("none/a.json", "there is no folder `none`"),
    ] {
        let error = folder.error(&format!("generate {TREES} --out a.svg --out {name}"), 1);
        assert!(error.contains(&format!("error: --out {name}: {what}")), "{error}");
    }
    assert_eq!(folder.names(), before);
    assert_eq!(fs::read_to_string(folder.path("fixed.json")).unwrap(), "mine");
}

#[test]
fn no_output_is_an_input_or_another_output() {
    let folder = Folder::new();
    let text = "Forest(width: 10, height: 10)";
    folder.write("s.ron", text);
    fs::create_dir(folder.path("rooms")).unwrap();
    folder.write("rooms/v.room.ron", "(name: \"v\", width: 1, height: 1, difficulty: 3)");
    #[cfg(unix)]
    std::os::unix::fs::symlink("s.ron", folder.path("l.ron")).unwrap();
    #[cfg(not(unix))]
    fs::hard_link(folder.path("s.ron"), folder.path("l.ron")).unwrap();
    fs::hard_link(folder.path("s.ron"), folder.path("h.ron")).unwrap();
    let before = folder.names();
    for out in ["s.ron", "./s.ron", "l.ron", "h.ron", "rooms/../s.ron"] {
        let error = folder.error(&format!("generate s.ron --out a.svg --out {out}"), 2);
        assert!(
            error.contains(&format!("--out {out}: is the input s.ron, which would")),
            "{error}"
        );
    }
    let room = "generate indoor --rooms rooms --out rooms/v.room.ron";
    assert!(folder.error(room, 2).contains("is the input rooms/v.room.ron"));
    let map = Folder::new();
    map.notes(&format!("generate {TREES} --out office.yaml"));
    let yaml = fs::read_to_string(map.path("office.yaml")).unwrap();
    map.write("map.yaml", &yaml.replace("office.pgm", "map.png"));
    fs::rename(map.path("office.pgm"), map.path("map.png")).unwrap();
    for out in ["map.png", "./map.png"] {
        let error = map.error(&format!("convert map.yaml --out {out}"), 2);
        assert!(error.contains(&format!("--out {out}: is the input map.png, which")), "{error}");
    }
    for (one, other) in [("a.json", "./a.json"), ("b.yaml", "rooms/../b.YAML")] {
        let error = folder.error(&format!("generate s.ron --out {one} --out {other}"), 2);
        assert!(error.contains("is the same file as --out "), "{error}");
    }
    assert_eq!(
        (folder.names(), fs::read_to_string(folder.path("s.ron")).unwrap()),
        (before, text.to_owned())
    );
}

#[test]
fn the_longest_names_can_be_written() {
    let folder = Folder::new();
    for length in [246, 255] {
        let name = format!("{}.json", "n".repeat(length - 5));
        folder.notes(&format!("generate {TREES} --out {name}"));
        // Once more, over the existing file.
        folder.notes(&format!("generate {TREES} --out {name}"));
        assert!(read_world(&folder.path(&name)).is_ok());
    }
    assert_eq!(folder.names().len(), 2);
}

#[test]
#[cfg(target_os = "linux")]
fn a_killed_run_leaves_nothing() {
    let folder = Folder::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_envgen"))
        .args(
            "generate forest --set width=3000 --set height=3000 --out k.json --out k.svg"
                .split(' '),
        )
        .current_dir(folder.0.path())
        .spawn()
        .unwrap();
    // Until it has opened its files.
    let open = || {
        let files = fs::read_dir(format!("/proc/{}/fd", child.id())).unwrap();
        files
            .filter_map(|file| fs::read_link(file.ok()?.path()).ok())
            .any(|path| path.starts_with(folder.0.path()))
    };
    while !open() {
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(folder.names(), Vec::<String>::new());
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_named() {
    // Stdout first: the device that is always full.
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_envgen"))
        .args(["sample", "hallway", "--count", "3"])
        .stdout(full)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text.contains("error: stdout: No space left"), "{text}");
    // Files: a limit on their size has the same effect as a full disk.
    let folder = Folder::new();
    let limited = "trap '' XFSZ; ulimit -f 64; exec \"$0\" \"$@\"";
    let output = Command::new("sh")
        .args(["-c", limited, env!("CARGO_BIN_EXE_envgen")])
        .args(
            "generate forest --set width=300 --set height=300 --out a.svg --out b.json".split(' '),
        )
        .current_dir(folder.0.path())
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("error: --out a.svg: File too large"), "{text}");
    assert_eq!(folder.names(), Vec::<String>::new());
}

#[test]
#[cfg(target_os = "linux")]
fn files_are_written_though_notes_cannot_be() {
    let folder = Folder::new();
    folder.notes(&format!("generate {TREES} --out a.json"));
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_envgen"))
        .args("convert a.json --out a.yaml".split(' '))
        .current_dir(folder.0.path())
        .stderr(full)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(folder.path("a.pgm").exists());
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_envgen"))
        .args(["generate", "desert", "--out", "b.json"])
        .stderr(full)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
}

#[test]
#[cfg(target_os = "linux")]
fn what_has_no_end_is_not_read() {
    let folder = Folder::new();
    fs::create_dir(folder.path("rooms")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path("rooms/x.room.ron")).unwrap();
    let text = folder.error("generate indoor --rooms rooms --out a.json", 1);
    assert!(text.contains("x.room.ron: it is not a file"), "{text}");
    // A description of a map that can be read only once is read once.
    folder.notes(&format!("generate {TREES} --out a.yaml"));
    let text = fs::read_to_string(folder.path("a.yaml")).unwrap();
    std::os::unix::fs::symlink("/dev/stdin", folder.path("b.yaml")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_envgen"))
        .args("convert b.yaml --out b.json".split(' '))
        .current_dir(folder.0.path())
        .stdin(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), text.as_bytes()).unwrap();
    assert!(child.wait().unwrap().success());
    assert!(folder.path("b.json").exists());
}

#[test]
fn maps_far_from_the_origin_are_read_back() {
    let folder = Folder::new();
    let square = "[[[15550000,4250000],[15550010,4250000],[15550010,4250010],[15550000,4250000]]]";
    let geometry = format!(r#"{{"type": "Polygon", "coordinates": {square}}}"#);
    folder.write("tokyo.geojson", &geometry);
    folder.notes("convert tokyo.geojson --out tokyo.yaml");
    folder.notes("convert tokyo.yaml --out back.json");
}

#[test]
fn errors_name_the_file_or_the_option() {
    let folder = Folder::new();
    folder.write("bad.envgen.ron", "Forest(width: -5)");
    folder.write("crowded.ron", "Forest(width: 50, min_distance: 4)");
    folder.write("syntax.ron", "Forest(width: )");
    folder.write("twice.yaml", "image: a.pgm\nimage: b.pgm\n");
    folder.write("a.asc", "ncols 2\n");
    for (arguments, code, expected) in [
        ("generate bad.envgen.ron --out a.svg", 2, "error: bad.envgen.ron: `width` must be"),
        ("sample bad.envgen.ron --count 1", 2, "error: bad.envgen.ron: `width` must be"),
        (
            "generate bad.envgen.ron --set width=-6 --out a.svg",
            2,
            "error: --set width=-6: `width` must be",
        ),
        (
            "generate syntax.ron --out a.svg",
            2,
            "error: syntax.ron: not the RON of a world spec such as `Hallway(segments: 80)`, at",
        ),
        ("generate world.json --out a.svg", 2, "error: world.json: is neither a kind nor a spec"),
        ("generate crowded.ron --out a.svg", 1, "error: crowded.ron: "),
        (
            "generate indoor --set profile=calibrated --set difficulty=0 --out a.svg",
            2,
            "error: --set difficulty=0: `difficulty` must be from ",
        ),
        ("generate forest --out a.xodr", 1, "error: --out a.xodr: the world has no road"),
        ("generate forest --out a.svg --out b.xml", 1, "error: --out b.xml: "),
        ("generate indoor --library none.xml --out a.svg", 1, "error: none.xml: No such file"),
        ("generate indoor --rooms none --out a.svg", 1, "error: --rooms none: "),
        ("generate none.ron --out a.svg", 1, "error: none.ron: No such file"),
        (
            "check twice.yaml",
            1,
            "error: twice.yaml: not the YAML of a map: line 2, `image: b.pgm`: the key",
        ),
        ("metrics a.asc", 1, "error: a.asc: "),
        ("metrics none.asc", 1, "error: none.asc: No such file"),
    ] {
        let error = folder.error(arguments, code);
        assert!(error.starts_with(expected), "{arguments}: {error}");
    }
    // A setting of the command line can mend one of the file.
    folder.notes("generate bad.envgen.ron --set width=6 --out a.svg");
}

#[test]
fn lists_are_set_in_either_form() {
    let folder = Folder::new();
    let sample = |arguments: &str| {
        let output = folder.run(&format!("sample {arguments} --count 1"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let line: Value = serde_json::from_slice(&output.stdout).unwrap();
        line["spec"].clone()
    };
    for (kind, bare, bracketed) in [
        ("road", "alpha=1,2,3,4,5", "alpha=[1,2,3,4,5]"),
        ("road", "prefabs=straight,left", "prefabs=[straight,left]"),
        ("landscape", "speeds=1,0,1,1", "speeds=[1,0,1,1]"),
        ("indoor", "rooms=warehouse,maze", "rooms=[\"warehouse\",\"maze\"]"),
    ] {
        let classes = if kind == "landscape" { " --set classes=4 --set entropy=1" } else { "" };
        let spec = |set: &str| sample(&format!("{kind} --set {set}{classes}"));
        assert_eq!(spec(bare), spec(bracketed), "{bare}");
    }
    let kinds = String::from_utf8(folder.run("kinds road").stdout).unwrap();
    assert!(kinds.contains(", such as straight,turn,straight; default straight,left"), "{kinds}");
    let kinds = String::from_utf8(folder.run("kinds indoor").stdout).unwrap();
    assert!(kinds.contains("together: `open_areas` is true, where `profile` is guaranteed"));
    assert!(kinds.contains("such as warehouse,maze; default empty\n"), "{kinds}");
}

fn map(folder: &Folder, name: &str) -> RosMap {
    let path = folder.path(name);
    read_ros_map(&mut fs::File::open(&path).unwrap(), &path).unwrap()
}

fn area(map: &RosMap, wanted: RosCell) -> f64 {
    let cells = map.cells.iter().filter(|cell| **cell == wanted).count();
    cells as f64 * map.resolution * map.resolution
}

#[test]
fn maps_are_free_only_where_the_start_leads() {
    let folder = Folder::new();
    // The corridor is 2 m wide.
    folder.notes("generate hallway --seed 1 --out h.yaml --out h.json");
    let written = map(&folder, "h.yaml");
    let length = {
        let output = folder.run("inspect h.json --json");
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        report["metrics"]["length"].as_f64().unwrap()
    };
    let free = area(&written, RosCell::Free);
    assert!((free / (2.0 * length) - 1.0).abs() < 0.03, "{free} m^2 of {length} m");
    assert!(area(&written, RosCell::Unknown) > free);
    // Read back it is the same free space, whole and closed.
    let world = read_world(&folder.path("h.yaml")).unwrap();
    let again = RosMap::of_world(&world, written.resolution).unwrap();
    let cells = |map: &RosMap| -> Vec<bool> {
        map.cells.iter().map(|cell| *cell == RosCell::Free).collect()
    };
    assert_eq!((again.cols, cells(&again)), (written.cols, cells(&written)));

    // A road of 200 m by 7 m; beside it nothing is known, kerbs or not.
    for kerb in ["0", "0.15"] {
        folder.notes(&format!(
            "generate road --seed 2 --set length=200 --set speed=5 --set kerb={kerb} --out r.yaml"
        ));
        let free = area(&map(&folder, "r.yaml"), RosCell::Free);
        assert!((free / 1400.0 - 1.0).abs() < 0.02, "{free} m^2 with kerbs of {kerb} m");
    }
    // A forest ends with its area.
    folder.notes("generate forest --seed 1 --out f.yaml --resolution 0.1");
    let forest = map(&folder, "f.yaml");
    let free = area(&forest, RosCell::Free);
    assert!((1900.0..2300.0).contains(&free), "{free} m^2");
    assert_eq!(forest.cells[0], RosCell::Unknown);
    // Solid cells of an indoor map are unknown.
    folder.notes("generate indoor --seed 1 --set width=6 --set height=6 --out i.yaml");
    let indoor = map(&folder, "i.yaml");
    assert!(area(&indoor, RosCell::Free) > 50.0);
}

#[test]
fn the_size_of_maps_is_said_and_can_be_chosen() {
    let folder = Folder::new();
    let said = folder.notes("generate forest --out f.yaml");
    assert!(said.contains("note: f.yaml: 1040 x 1040 cells of 0.05 m, 1082 kB\n"), "{said}");
    let said = folder.notes("generate forest --resolution 0.2 --out f.yaml");
    assert!(said.contains("note: f.yaml: 260 x 260 cells of 0.2 m"), "{said}");
    assert_eq!((map(&folder, "f.yaml").cols, map(&folder, "f.yaml").resolution), (260, 0.2));
    let before = folder.names();
    let error = folder.error("generate forest --resolution 0.005 --out g.yaml", 2);
    let expected = "--out g.yaml, --resolution 0.005: `resolution` must be about 6.35e-3 m or more";
    assert!(error.contains(expected), "{error}");
    assert_eq!(folder.names(), before);
    let said = folder.notes("generate road --set length=20000 --set kerb=0 --out b.yaml");
    assert!(
        said.contains("; coarser than 0.05 m because the world is large: see --resolution"),
        "{said}"
    );
    assert!(map(&folder, "b.yaml").resolution > 0.05);
    assert!(fs::metadata(folder.path("b.pgm")).unwrap().len() <= (1 << 24) + 100);
    assert!(Path::new(&folder.path("b.yaml")).exists());
}

#[test]
fn worlds_are_converted() {
    let folder = Folder::new();
    folder.notes(&format!("generate {TREES} --seed 3 --out a.json"));
    let outs = "--out a.ron --out a.geojson --out a.house.json --out a.building.yaml --out a.obstacles.csv";
    folder.notes(&format!("convert a.json {outs} --resolution 0.1"));
    let names =
        ["a.building.yaml", "a.geojson", "a.house.json", "a.json", "a.obstacles.csv", "a.ron"];
    assert_eq!(folder.names(), names);
    let world = read_world(&folder.path("a.json")).unwrap();
    assert_eq!(read_world(&folder.path("a.ron")).unwrap(), world);
    folder.notes("convert a.geojson --out b.json");
    let read = read_world(&folder.path("b.json")).unwrap();
    assert_eq!((read.trees, read.start, read.goal), (world.trees, world.start, world.goal));
    let house = read_world(&folder.path("a.house.json")).unwrap();
    assert_eq!((house.start, house.walls.is_empty()), (world.start, false));
    assert!(folder.run("check b.json").status.success());

    let error = folder.error("convert a.json --out a.json", 2);
    assert!(error.starts_with("error: --out a.json: "), "{error}");
    let error = folder.error("convert a.json --out b.svg --resolution 0.1", 2);
    assert!(error.contains("--resolution 0.1: applies to ROS maps and outlines"), "{error}");
    folder.write("c.geojson", "{}");
    let error = folder.error("convert c.geojson --out d.json", 1);
    assert!(error.starts_with("error: c.geojson: not GeoJSON"), "{error}");
    let error = folder.error("convert a.json --out a.xml", 1);
    assert!(error.contains("--out a.xml: a World Generator project holds"), "{error}");
    assert_eq!(folder.names().len(), names.len() + 2);
}

/// Two rooms and a hallway, each of 4 x 4 m, with a doorway of 1 m from each to the next. A box in the hallway leaves
/// 1.5 m behind its doorway. A disc of 0.45 m can move from the second room to the goal beyond the box.
fn two_rooms_and_a_hallway() -> World {
    let rect = |left: f64, low: f64, right: f64, high: f64| {
        Shape::from_rect(Rect::new(DVec2::new(left, low), DVec2::new(right, high)))
    };
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(12.0, 4.0));
    let mut world = World::new(Provenance::other("test", Value::Null), bounds);
    let outer = [
        (0.0, 0.0, 12.0, 0.1),
        (0.0, 3.9, 12.0, 4.0),
        (0.0, 0.0, 0.1, 4.0),
        (11.9, 0.0, 12.0, 4.0),
    ];
    let inner =
        [(3.9, 0.0, 4.1, 1.5), (3.9, 2.5, 4.1, 4.0), (7.9, 0.0, 8.1, 1.5), (7.9, 2.5, 8.1, 4.0)];
    for (left, low, right, high) in outer.into_iter().chain(inner).chain([(9.6, 0.0, 11.9, 2.7)]) {
        world.walls.push(Wall::new(WallKind::Wall, rect(left, low, right, high)));
    }
    for (name, left) in [("store", 0.0), ("office", 4.0)] {
        world.rooms.push(Room {
            name: name.to_owned(),
            shape: rect(left, 0.0, left + 4.0, 4.0),
            difficulty: None,
            lit: true,
            contents: Default::default(),
            height: None,
        });
    }
    world.surfaces.push(Surface::new(SurfaceKind::Hallway, rect(8.0, 0.0, 12.0, 4.0)));
    for (x, rooms) in [(4.0, [Some(0), Some(1)]), (8.0, [Some(1), None])] {
        world.doorways.push(Doorway::new(rect(x - 0.1, 1.5, x + 0.1, 2.5), true, rooms));
    }
    (world.start, world.goal) = (Some(Pose::new(6.0, 2.0, 0.0)), Some(Pose::new(11.0, 3.3, 0.0)));
    world.certificate = vec![Claim::Connected { radius: 0.45 }];
    world
}

#[test]
fn promises_that_open_doors_break_end_with_exit_code_1() {
    let folder = Folder::new();
    folder.write("map.json", &two_rooms_and_a_hallway().to_json().unwrap());
    let scenario = |kind: &str| {
        let door = |doorway: u32, kind: &str| {
            format!(
                "(doorway: {doorway}, kind: {kind}, control: timed, open: 9.0, closed: 9.0, slam: 0.0)"
            )
        };
        let doors = [door(0, "sliding"), door(1, kind)].join(", ");
        format!("(seed: 1, settings: (), doors: [{doors}], people: [], smoke: [])")
    };
    folder.write("sliding.ron", &scenario("sliding"));
    // The open leaf is across the free path around the box.
    folder.write("hinged.ron", &scenario("hinged, far_end: true, to_right: true"));
    let checked = |arguments: &str, code: i32| {
        let output = folder.run(&format!("check map.json{arguments}"));
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}: {text}");
        String::from_utf8(output.stdout).unwrap()
    };
    let promise = two_rooms_and_a_hallway().certificate[0].to_string();
    let still = checked("", 0);
    assert!(still.contains(&format!("holds: {promise}")) && !still.contains("doors["), "{still}");
    let sliding = checked(" --scenario sliding.ron", 0);
    assert!(sliding.contains(&format!("holds: {promise}")), "{sliding}");
    assert!(sliding.contains("only through doors[0] in doorway 0: room 0 (store)\n"), "{sliding}");
    let behind = "only through doors[1] in doorway 1: surfaces[0] (hallway), the goal\n";
    assert!(sliding.contains(behind), "{sliding}");
    let hinged = checked(" --scenario hinged.ron", 1);
    assert!(hinged.contains(&format!("broken: {promise}")), "{hinged}");
    // With all doors open the goal is not reached either, so that it does not depend on one.
    assert!(hinged.contains("only through doors[0] in doorway 0: room 0 (store)\n"), "{hinged}");
    assert!(
        hinged.contains("only through doors[1] in doorway 1: surfaces[0] (hallway)\n"),
        "{hinged}"
    );
}

#[test]
fn what_moves_is_generated_drawn_and_read_back() {
    const SMALL: &str = "generate indoor --seed 3 --set width=6 --set height=6";
    let folder = Folder::new();
    let text = |name: &str| fs::read_to_string(folder.path(name)).unwrap();
    let small = |more: &str| folder.notes(&format!("{SMALL} {more}"));
    let settings = "--set doors=0.6 --set people=3 --set smoke=0.4";
    assert_eq!(small(&format!("{settings} --out map.svg --out map.scenario.ron")), "");
    let drawn = text("map.svg");
    for id in ["doors", "people", "smoke"] {
        assert!(drawn.contains(&format!("id=\"{id}\"")), "no {id}");
    }
    // The same picture from the file, and nothing else without it.
    small("--scenario map.scenario.ron --out again.svg");
    assert_eq!(text("again.svg"), drawn);
    small("--out still.svg");
    assert!(!text("still.svg").contains("id=\"people\""));
    // A world file alone holds nothing that moves, which is reported.
    let note = small("--set people=3 --out map.json");
    assert!(note.starts_with("note: the files do not hold the"), "{note}");
    for (more, code, why) in [
        ("--set people=-2 --out x.png", 2, "`people` must be"),
        ("--set people=9999 --out x.png", 2, "no more fit"),
        ("--set poeple=2 --out x.png", 2, "did you mean `people`?"),
        ("--out map.scenario.ron", 1, "no doors, people or smoke that move"),
        ("--set people=2 --scenario map.scenario.ron --out x.png", 2, "cannot be used with"),
        ("--scenario map.scenario.ron --out map.scenario.ron", 2, "input"),
    ] {
        let error = folder.error(&format!("{SMALL} {more}"), code);
        assert!(error.contains(why), "{more}: {error}");
    }
    let error = folder.error("generate forest --set doors=0.5 --out x.png", 2);
    assert!(error.contains("no open doorway"), "{error}");
}

#[test]
fn an_unknown_ending_lists_what_a_world_of_a_file_can_become() {
    let folder = Folder::new();
    folder.notes("generate hallway --seed 7 --out a.json");
    let listed = folder.error("convert a.json --out b.xyz", 2);
    assert!(listed.contains(".json, .ron, .xodr") && listed.contains(".yaml"), "{listed}");
    assert!(!listed.contains(" .xml, ") && !listed.contains(".scenario.ron"), "{listed}");
    let listed = folder.error("generate hallway --seed 7 --out b.xyz", 2);
    assert!(listed.contains(" .xml, ") && listed.contains(".scenario.ron"), "{listed}");
}
