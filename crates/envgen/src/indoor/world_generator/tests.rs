use super::*;
use crate::generate::{Blueprint, Spec};
use crate::indoor::{Catalogue, Cell, IndoorSpec, Profile};
use crate::seed::Seed;
use proptest::prelude::*;

const OFFICE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<!-- By hand: a hallway of three cells from north to south, two rooms beside it. -->
<world depth="3" width="3" name="office &amp; lab">
  <room name="hallway" x="0" y="0" theta="0"/>
  <room name="hallway" x="1" y="0" theta="0"/>
  <room name="hallway" x="2" y="0" theta="0"></room>
  <room name="multi office" x="0" y="1" theta="0"/>
  <room name="vault" x="1" y="1" theta="1"/>
  <door x="0" y="1" direction="1"/>
  <door x="1" y="2" direction="0"/>
  <door x="2" y="3" direction="1"/>
</world>
"#;

const LIBRARY: &str = r#"<roomList>
  <room name="vault" src="vault.xml" size="2, 1, 1" tag="bank"/>
  <room name="hallway" src="hallway.xml" size="1,1,1" tag="hall"/>
</roomList>"#;

fn read(text: &str) -> Result<Project, WorldGeneratorError> {
    read_project(text, Catalogue::builtin(), &read_library(LIBRARY).unwrap())
}

#[test]
fn a_project_by_hand() {
    let project = read(OFFICE).unwrap();
    assert_eq!((project.name.as_str(), project.doors_ignored), ("office & lab", 1));
    assert_eq!(project.elements_ignored, 0);
    let lamp = OFFICE.replace("</world>", "<lamp x=\"1\"/></world>");
    assert_eq!(read(&lamp).unwrap().elements_ignored, 1);
    assert_eq!(project.attributes_ignored, 0);
    let colored = ["<world ", "<room ", "<door "].iter().fold(OFFICE.to_owned(), |text, start| {
        text.replacen(start, &format!("{start}color=\"red\" "), 1)
    });
    assert_eq!(read(&colored).unwrap().attributes_ignored, 3);
    let plan = &project.plan;
    // x runs from north to south: the hallway is the left column.
    assert!((0..3).all(|y| plan.grid().get(0, y) == Some(Cell::Hallway)));
    assert_eq!(plan.grid().get(1, 0), Some(Cell::Room(0)));
    assert_eq!((plan.rooms()[1].x, plan.rooms()[1].y), (1, 1));
    // The vault is two deep and one wide; a quarter turn lays it along the width.
    assert_eq!(plan.rooms()[1].size(), (2, 1));
    assert_eq!(plan.openings().len(), 2);
    assert_eq!(plan.access().doors_by_room(), [2, 1]);
    let world = plan.to_world();
    assert_eq!(world.check(), Ok(()));
    assert_eq!(world.provenance.kind, "import");
    assert_eq!(world.rooms[1].name, "vault");
}

#[test]
fn libraries_are_read_and_written() {
    let rooms = read_library(LIBRARY).unwrap();
    assert_eq!((rooms[0].depth, rooms[0].width, rooms[0].tag.as_str()), (2, 1, "bank"));
    let mut text = Vec::new();
    write_library(Catalogue::builtin(), &mut text).unwrap();
    let back = read_library(std::str::from_utf8(&text).unwrap()).unwrap();
    assert_eq!(back.len(), 21);
    for (room, written) in Catalogue::builtin().rooms().iter().zip(&back[1..]) {
        assert_eq!(
            (&room.name, room.height, room.width),
            (&written.name, written.depth, written.width)
        );
    }
}

#[test]
fn sizes_in_metres_come_back() {
    let spec = IndoorSpec {
        width: 8,
        height: 8,
        cell_size: 6.0,
        wall_thickness: 0.3,
        wall_height: 3.5,
        doorway: 1.5,
        doorway_height: 2.0,
        robot_radius: 0.3,
        ..Default::default()
    };
    let written = |plan: &crate::indoor::FloorPlan| {
        let mut text = Vec::new();
        write_project(plan, "w", &mut text).unwrap();
        String::from_utf8(text).unwrap()
    };
    let plan = spec.generate(Seed(3)).unwrap();
    let text = written(&plan);
    let back = read(&text).unwrap().plan;
    assert_eq!(written(&back), text);
    let (world, read_back) = (plan.to_world(), back.to_world());
    assert_eq!(read_back.bounds, world.bounds);
    assert_eq!(read_back.wall_top(), 3.5);
    assert_eq!(read_back.doorways[0].extent().top(), 2.0);
    assert_eq!(read_back.rooms[0].shape, world.rooms[0].shape);
    // Usual sizes are not stated.
    let usual = IndoorSpec { width: 8, height: 8, ..Default::default() };
    let usual = written(&usual.generate(Seed(3)).unwrap());
    assert_eq!(usual.lines().next(), Some(r#"<world depth="8" width="8" name="w">"#));
    let error = |attributes: &str| {
        let text = format!("<world depth=\"4\" width=\"4\" name=\"w\" {attributes}/>");
        read(&text).unwrap_err().to_string()
    };
    assert_eq!(
        error("cell_size=\"0\""),
        "`world` 1: `cell_size` must be a number from 1.2 to 12, got `0`"
    );
    assert!(error("wall_height=\"NaN\"").contains("`wall_height` must be a number"));
    assert!(error("doorway=\"\"").contains("got ``"));
    let error = error("cell_size=\"1.2\" wall_thickness=\"0.4\"");
    assert!(error.contains("`doorway` must be at most 0.4 m"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn what_is_written_is_read_back(seed: u64, difficulty in 0.0..=10.0_f64, w in 4..30_u32, h in 4..30_u32) {
        let spec = IndoorSpec {
            difficulty, width: w, height: h, profile: Profile::Guaranteed, ..Default::default()
        };
        let plan = spec.generate(Seed(seed)).unwrap();
        let mut text = Vec::new();
        write_project(&plan, "round <trip>", &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let back = read(&text).unwrap();
        prop_assert_eq!(&back.name, "round <trip>");
        for (a, b) in plan.rooms().iter().zip(back.plan.rooms()) {
            prop_assert_eq!((&a.room.name, a.x, a.y, a.quarters), (&b.room.name, b.x, b.y, b.quarters));
        }
        prop_assert_eq!(plan.rooms().len(), back.plan.rooms().len());
        for (a, b) in plan.grid().cells().iter().zip(back.plan.grid().cells()) {
            prop_assert!(a == b || (*a == Cell::Open && *b == Cell::Hallway));
        }
        // Doorways in the middle of a cell come back, all others near by.
        prop_assert_eq!(back.doors_ignored, 0);
        for opening in plan.openings() {
            let there = back.plan.openings().iter().any(|other| {
                let (a, b) = (opening.gate, other.gate);
                (a.wall, a.line) == (b.wall, b.line) && a.at - b.at <= 1 - a.at % 2
            });
            prop_assert!(there, "{opening:?}");
        }
        // A second trip changes nothing.
        let mut again = Vec::new();
        write_project(&back.plan, "round <trip>", &mut again).unwrap();
        prop_assert_eq!(String::from_utf8(again).unwrap(), text);
    }

    #[test]
    fn half_a_file_is_an_error(cut in 0.0..1.0_f64) {
        let end = OFFICE.trim_end().len();
        let cut = (cut * (end - 1) as f64) as usize;
        prop_assume!(OFFICE.is_char_boundary(cut));
        prop_assert!(read(&OFFICE[..cut]).is_err());
    }
}

#[test]
fn bad_files_are_refused_with_the_reason() {
    let error = |text: &str| read(text).unwrap_err().to_string();
    let with = |inside: &str| {
        error(&format!("<world depth=\"4\" width=\"5\" name=\"w\">{inside}</world>"))
    };
    let bomb = "<!DOCTYPE w [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]>\
                <world depth=\"4\" width=\"4\" name=\"&b;\"/>";
    assert!(error(bomb).contains("document type"));
    assert!(error("<world depth=\"4\" width=\"4\" name=\"&b;\"/>").contains("not XML"));
    assert!(with("&b;").contains("entity"));
    assert!(error("").contains("no element"));
    assert!(error("{\"world\": 3}").contains("no element"));
    assert!(error("<roomList/>").contains("`roomList`"));
    assert!(error("<world width=\"4\"/>").contains("`depth` must be"));
    assert!(error("<world depth=\"0\" width=\"4\"/>").contains("from 1 to 1024"));
    assert!(error("<world depth=\"1e9\" width=\"4\"/>").contains("from 1 to 1024"));
    assert!(error("<world depth=\"4\" width=\"4\"></room>").contains("not XML"));
    assert!(error("<world depth=\"4\" width=\"4\"/><world/>").contains("after the root"));
    assert!(with("<room x=\"1\" y=\"1\"/>").contains("`name` must be"));
    assert!(with("<room name=\"dark\" x=\"-1\" y=\"1\"/>").contains("got `-1`"));
    assert!(with("<room name=\"dark\" x=\"1\" y=\"5\"/>").contains("got `5`"));
    assert!(with("<room name=\"dark\" x=\"1\" y=\"1\" theta=\"4\"/>").contains("`theta`"));
    assert!(with("<room name=\"sauna\" x=\"1\" y=\"1\"/>").contains("`sauna`"));
    assert!(with("<room name=\"water room\" x=\"1\" y=\"3\"/>").contains("outside"));
    let twice = "<room name=\"bisquare\" x=\"0\" y=\"0\"/><room name=\"dark\" x=\"1\" y=\"1\"/>";
    assert!(with(twice).contains("`dark`, overlaps another at x 1, y 1"));
    let hall = "<room name=\"hallway\" x=\"0\" y=\"0\"/>";
    assert!(with(&hall.repeat(2)).contains("overlaps"));
    assert!(with("<door x=\"1\" y=\"1\" direction=\"2\"/>").contains("`direction`"));
    assert!(with("<door x=\"5\" y=\"1\" direction=\"0\"/>").contains("got `5`"));
    for size in ["1, 1", "1, 1, 0", "a, b, c", "-1, 1, 1", "1,1,65"] {
        let text = format!("<roomList><room name=\"a\" size=\"{size}\"/></roomList>");
        assert!(read_library(&text).unwrap_err().to_string().contains("depth, width, height"));
    }
    let twice = "<room name=\"a\" size=\"1,1,1\"/>".repeat(2);
    let error = read_library(&format!("<roomList>{twice}</roomList>"));
    assert_eq!(error, Err(WorldGeneratorError::Duplicate("a".to_owned())));
}
