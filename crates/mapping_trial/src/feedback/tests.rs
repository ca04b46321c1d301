use envgen::World;
use envgen::geometry::{Pose, Rect, Shape};
use envgen::world::{Doorway, Room};
use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::mappable_area::tests::room;
use crate::robot::Robot;
use crate::score::{Scores, TrajectoryPair};

const ANSWERS: &str = "Okke\n3\n\n\nDistanceOnly\n2x P3AT\n6.5\n7\n5\nwater\nmaze, narrow\nnone\n\
                       dead ends\n\n";

fn session() -> Session {
    Session::new("map765", 1, &Robot::default())
}

fn asked(answers: &str) -> Result<(Feedback, String), FeedbackError> {
    let mut out = Vec::new();
    let feedback = ask(&session(), &mut answers.as_bytes(), &mut out)?;
    Ok((feedback, String::from_utf8(out).unwrap()))
}

#[test]
fn a_person_fills_the_form() {
    let (feedback, shown) = asked(ANSWERS).unwrap();
    let expected = Feedback {
        name: "Okke".to_owned(),
        experience: Experience::SingleCompetition,
        session: Session {
            connection: Connection::DistanceOnly,
            robots: "2x P3AT".to_owned(),
            ..session()
        },
        difficulty: Rating::try_from(6.5).unwrap(),
        mapping: Rating::try_from(7.0).unwrap(),
        getting_around: Rating::try_from(5.0).unwrap(),
        contributed: "water".to_owned(),
        difficult_rooms: "maze, narrow".to_owned(),
        easy_rooms: "none".to_owned(),
        patterns: "dead ends".to_owned(),
        other: String::new(),
    };
    assert_eq!(feedback, expected);
    assert!(shown.contains("[map765]") && shown.contains("4 multiple competitions"), "{shown}");
    let json = serde_json::to_string(&feedback).unwrap();
    assert_eq!(serde_json::from_str::<Feedback>(&json).unwrap(), feedback);
    assert!(json.contains(r#""experience":"single_competition""#), "{json}");
    assert!(json.contains(r#""environment":"map765""#), "{json}");
}

#[test]
fn a_session_knows_its_robots() {
    let other = Robot { length: 0.4, width: 0.3, ..Robot::default() };
    assert_eq!(Session::new("map765", 2, &other).robots, "2x robot of 0.4 m x 0.3 m");
}

#[test]
fn answers_that_are_not_allowed_are_asked_for_again() {
    let wrong = ANSWERS.replacen("\n3\n", "\nsome\n5\n0\nSINGLE competition\n", 1).replacen(
        "6.5",
        "eleven\n10.5\n-1\nNaN\n6.5",
        1,
    );
    let (feedback, shown) = asked(&wrong).unwrap();
    assert_eq!(feedback, asked(ANSWERS).unwrap().0);
    assert!(shown.contains("`some` is unknown, expected one of: none, experimental"), "{shown}");
    assert!(shown.contains("a rating must be a number from 0 to 10, got `10.5`"), "{shown}");
    assert_eq!(shown.matches("a rating must be").count(), 4);
}

#[test]
fn a_form_that_ends_or_never_ends_is_an_error() {
    let count = ANSWERS.lines().count();
    for lines in 0..count {
        let part: String = ANSWERS.lines().take(lines).map(|line| format!("{line}\n")).collect();
        assert!(matches!(asked(&part), Err(FeedbackError::End { .. })), "{lines} lines");
    }
    assert!(matches!(asked(&"x".repeat(MAX_LINE + 1)), Err(FeedbackError::Long)));
    assert!(asked(&ANSWERS.replacen("Okke", &"x".repeat(MAX_LINE - 1), 1)).is_ok());
}

#[test]
fn ratings_of_files_are_checked() {
    for bad in ["11", "-0.5", "1e300", "null", "\"7\""] {
        assert!(serde_json::from_str::<Rating>(bad).is_err(), "{bad}");
    }
    assert_eq!(serde_json::from_str::<Rating>("10").unwrap().value(), 10.0);
}

/// Two rooms of 10 x 10 m side by side, with a doorway between them.
fn two_rooms() -> World {
    let mut world = room(20.0, 10.0);
    for (name, x) in [("left", 0.0), ("right", 10.0)] {
        let rect = Rect::new(DVec2::new(x, 0.0), DVec2::new(x + 10.0, 10.0));
        let shape = Shape::from_rect(rect);
        world.rooms.push(Room {
            name: name.to_owned(),
            shape,
            difficulty: None,
            lit: true,
            contents: Default::default(),
            height: None,
        });
    }
    let rect = Rect::new(DVec2::new(9.95, 4.5), DVec2::new(10.05, 5.5));
    let rooms = [Some(0), Some(1)];
    world.doorways.push(Doorway::new(Shape::from_rect(rect), true, rooms));
    world
}

/// From x = 2 to 18 m and back to 10 at 0.5 m/s, with an error of 5 % of the distance on the right.
fn tracks() -> (Vec<Pose>, Vec<Pose>) {
    let mut error = 0.0;
    let mut x = 2.0;
    let mut poses = (Vec::new(), Vec::new());
    for step in 0..964 {
        poses.0.push(Pose::new(x, 5.0, 0.0));
        poses.1.push(Pose::new(x, 5.0 + error, 0.0));
        x += if step < 640 { 0.025 } else { -0.025 };
        error += if x > 10.0 { 0.05 * 0.025 } else { 0.0 };
    }
    poses
}

#[test]
fn a_program_states_what_it_measured() {
    let world = two_rooms();
    let (truth, estimated) = tracks();
    let scores = Scores {
        difficulty: 2.5,
        mapping: 3.5,
        navigation: 1.0,
        e_wall: 0.5,
        e_pose: 0.7,
        collisions: 3,
        ..Scores::default()
    };
    let tracks = [TrajectoryPair { truth: &truth, estimated: &estimated }];
    let measured = Measured { policy: "nearest", world: &world, scores: &scores, tracks: &tracks };
    let form = measured.fill(&session()).unwrap();
    assert_eq!(form.name, "nearest");
    let ratings = [form.difficulty, form.mapping, form.getting_around].map(Rating::value);
    assert_eq!(ratings, [2.5, 3.5, 1.0]);
    // 0.50 x 0.7 and 0.20 x 0.5, times ten.
    let part = "drift of the pose 3.50, walls out of place 1.00";
    assert!(form.contributed.starts_with(&format!("Mapping 3.50: {part}")), "{}", form.contributed);
    // 16 m on the right at 5 %, in 32 s; 8 m on the left without, in 16 s.
    let right = "right (room 1): +0.80 m of position error in 32 s";
    assert_eq!(form.difficult_rooms, format!("The error rose most in {right}."));
    let left = "left (room 0): +0.00 m of position error in 16 s";
    assert_eq!(form.easy_rooms, format!("The error rose least in {left}."));
    assert!(form.patterns.contains("Within 1 m of a doorway, 2 times"), "{}", form.patterns);
    assert!(form.patterns.contains("Turned back 1 times: +0.20 m"), "{}", form.patterns);
    assert!(form.other.starts_with("3 collisions"), "{}", form.other);
}

#[test]
fn a_program_claims_nothing_of_what_is_not_there() {
    let world = room(20.0, 10.0);
    let scores = Scores::default();
    let measured = Measured { policy: "nearest", world: &world, scores: &scores, tracks: &[] };
    let form = measured.fill(&session()).unwrap();
    assert_eq!(form.difficult_rooms, "The world has no rooms.");
    let world = two_rooms();
    let form = Measured { world: &world, ..measured }.fill(&session()).unwrap();
    assert_eq!(form.easy_rooms, "No room was visited for 5 s.");
    let scores = Scores { mapping: f64::NAN, ..scores };
    assert!(Measured { scores: &scores, ..measured }.fill(&session()).is_err());
}

proptest! {
    #[test]
    fn no_answers_panic(answers in prop::collection::vec("[ -~\u{e4}]{0,12}", 0..40)) {
        let mut out = Vec::new();
        let _ = ask(&session(), &mut answers.join("\n").as_bytes(), &mut out);
    }

    #[test]
    fn every_rating_from_0_to_10_comes_back(value in 0.0..=10.0_f64) {
        let rating: Rating = value.to_string().parse().unwrap();
        prop_assert_eq!(rating.value(), value);
    }
}
