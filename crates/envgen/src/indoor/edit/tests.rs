use super::*;
use crate::generate::{Blueprint, Spec};
use crate::geometry::Shape;
use crate::indoor::{Catalogue, IndoorSpec, SharedRoom};
use crate::seed::Seed;
use crate::world::{Claim, Obstacle, ObstacleKind, PartId, PartKind};
use glam::DVec2;
use proptest::prelude::*;

fn room(name: &str) -> SharedRoom {
    Catalogue::builtin().get(name).unwrap().clone()
}

fn editor(seed: u64) -> PlanEditor {
    let spec = IndoorSpec { width: 10, height: 9, difficulty: 4.0, ..Default::default() };
    PlanEditor::new(spec.generate(Seed(seed)).unwrap())
}

/// A bare plan: one hallway along the top, the rest open area.
fn bare() -> PlanEditor {
    let mut editor = editor(1);
    while !editor.plan().rooms().is_empty() {
        editor.apply(Edit::RemoveRoom { room: 0 }).unwrap();
    }
    for y in 1..9 {
        for x in 0..10 {
            if editor.plan().grid().get(x, y) == Some(Cell::Hallway) {
                editor.apply(Edit::RemoveHallway { x, y }).unwrap();
            }
        }
    }
    editor
}

#[test]
fn rooms_are_added_moved_turned_and_removed() {
    let mut editor = bare();
    let multi = room("multi office");
    editor.apply(Edit::AddRoom { room: multi.clone(), x: 2, y: 1, quarters: 0 }).unwrap();
    let gate = Gate { wall: Axis::Horizontal, line: 1, at: 5 };
    editor.apply(Edit::OpenDoorway(gate)).unwrap();
    assert_eq!(editor.plan().access().doors_by_room(), [1]);
    assert_eq!(editor.apply(Edit::OpenDoorway(gate)), Err(EditError::AlreadyOpen(gate)));
    // Two cells to the right the doorway moves too.
    editor.apply(Edit::MoveRoom { room: 0, x: 4, y: 1 }).unwrap();
    assert_eq!(editor.plan().openings()[0].gate, Gate { at: 9, ..gate });
    assert_eq!(editor.plan().grid().get(2, 1), Some(Cell::Open));
    // A quarter counter-clockwise brings its left upper doorway to the lower end of the left.
    let upright = Edit::TurnRoom { room: 0, quarters: 1 };
    editor.apply(upright).unwrap();
    assert_eq!(editor.plan().rooms()[0].size(), (1, 2));
    let left = Gate { wall: Axis::Vertical, line: 4, at: 5 };
    let open = editor.plan().grid().get(3, 2).unwrap().is_floor();
    let gates: Vec<_> = editor.plan().openings().iter().map(|o| o.gate).collect();
    assert_eq!(gates, if open { vec![left] } else { vec![] });
    let world = editor.plan().to_world();
    assert_eq!(world.check(), Ok(()));
    assert!(world.provenance.edited);
    assert_eq!(world.provenance.difficulty_requested, Some(4.0));
    editor.apply(Edit::RemoveRoom { room: 0 }).unwrap();
    assert!(editor.plan().rooms().is_empty() && editor.plan().openings().is_empty());
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let mut editor = bare();
    let room = room("bisquare");
    editor.apply(Edit::AddRoom { room: room.clone(), x: 3, y: 3, quarters: 0 }).unwrap();
    let before = editor.plan().clone();
    let gate = |line, at| Gate { wall: Axis::Vertical, line, at };
    let refused = [
        Edit::AddRoom { room: room.clone(), x: 4, y: 4, quarters: 0 },
        Edit::AddRoom { room: room.clone(), x: 5, y: 0, quarters: 0 },
        Edit::AddRoom { room: room.clone(), x: 9, y: 5, quarters: 0 },
        Edit::AddRoom { room, x: u32::MAX, y: 5, quarters: 0 },
        Edit::MoveRoom { room: 0, x: 3, y: 8 },
        Edit::MoveRoom { room: 0, x: 3, y: 0 },
        Edit::MoveRoom { room: 7, x: 1, y: 1 },
        Edit::TurnRoom { room: 1, quarters: 1 },
        Edit::RemoveRoom { room: 1 },
        Edit::AddHallway { x: 3, y: 3 },
        Edit::AddHallway { x: 0, y: 0 },
        Edit::AddHallway { x: 10, y: 0 },
        Edit::RemoveHallway { x: 3, y: 3 },
        Edit::RemoveHallway { x: 0, y: 9 },
        Edit::OpenDoorway(gate(0, 7)),
        Edit::OpenDoorway(gate(4, 7)),
        Edit::OpenDoorway(gate(3, 0)),
        Edit::OpenDoorway(gate(11, 3)),
        Edit::OpenDoorway(gate(3, u32::MAX)),
        Edit::CloseDoorway(gate(3, 8)),
    ];
    for edit in refused {
        assert!(editor.apply(edit.clone()).is_err(), "{edit:?}");
        assert_eq!(editor.plan(), &before, "{edit:?}");
    }
    let error = editor
        .apply(Edit::AddRoom { room: super::tests::room("dark"), x: 4, y: 4, quarters: 0 })
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "the room `dark` would overlap the room `bisquare` at column 4, row 4"
    );
}

#[test]
fn the_certificate_follows_the_edit() {
    let mut editor = editor(3);
    let claim = Claim::EveryPlaceReachable { radius: 0.36 };
    assert!(editor.plan().to_world().certificate.contains(&claim));
    let shut: Vec<Gate> = editor
        .plan()
        .openings()
        .iter()
        .filter(|o| editor.plan().rooms()[0].side_of(o.gate).is_some())
        .map(|o| o.gate)
        .collect();
    for gate in shut {
        editor.apply(Edit::CloseDoorway(gate)).unwrap();
    }
    assert!(!editor.plan().to_world().certificate.contains(&claim));
    while editor.undo() {}
    assert!(editor.plan().to_world().certificate.contains(&claim));
    assert!(!editor.plan().is_edited());
}

#[test]
fn objects_are_added_moved_turned_and_removed() {
    let mut editor = bare();
    editor.apply(Edit::AddRoom { room: room("dark"), x: 2, y: 1, quarters: 1 }).unwrap();
    let before = editor.plan().clone();
    let design = editor.plan().rooms()[0].room.clone();
    let outline = editor.plan().outline(PlanTarget::Room(0)).unwrap();
    let (center, half_size) = (outline.bounds().center(), DVec2::new(0.4, 0.2));
    let shape = Shape::Box { center, half_size, heading: 0.0 };
    let object = Obstacle::new(ObstacleKind::Crate, shape);
    editor.apply(Edit::AddObject { room: 0, object: object.clone() }).unwrap();
    let index = design.obstacles.len();
    let found = editor.plan().object(0, index).unwrap();
    assert!(found.shape.bounds().center().distance(center) < 1e-9);
    // It is in the world, and the catalogue's room is as it was.
    let world = editor.plan().to_world();
    assert_eq!(world.check(), Ok(()));
    let part = PartId { kind: PartKind::Obstacle, index: index as u32 };
    assert_eq!(editor.plan().object_of(part), Some((0, index)));
    assert_eq!(world.obstacles[index].shape, found.shape);
    assert_eq!(world.rooms[0].contents, Contents::Edited);
    assert_eq!(editor.plan().object_of(PartId { index: index as u32 + 1, ..part }), None);
    assert_eq!(room("dark"), design);
    let by = DVec2::new(0.3, -0.2);
    editor.apply(Edit::MoveObject { room: 0, object: index, by }).unwrap();
    let moved = editor.plan().object(0, index).unwrap().shape.bounds().center();
    assert!(moved.distance(center + by) < 1e-9);
    let quarter = std::f64::consts::FRAC_PI_2;
    editor.apply(Edit::TurnObject { room: 0, object: index, angle: quarter }).unwrap();
    let turned = editor.plan().object(0, index).unwrap().shape.bounds().size();
    assert!(turned.distance(DVec2::new(0.4, 0.8)) < 1e-9, "{turned}");
    let target = PlanTarget::Object { room: 0, object: index };
    assert_eq!(editor.plan().target_at(center + by, 0.0), Some(target));
    // Outside of the room there are no objects.
    let far = Edit::MoveObject { room: 0, object: index, by: DVec2::new(9.0, 0.0) };
    let error = editor.apply(far).unwrap_err();
    assert!(error.to_string().contains("reaches outside the room"), "{error}");
    assert!(editor.apply(Edit::MoveObject { room: 0, object: index, by: DVec2::NAN }).is_err());
    editor.apply(Edit::RemoveObject { room: 0, object: index }).unwrap();
    let error = editor.apply(Edit::RemoveObject { room: 0, object: index }).unwrap_err();
    let expected = format!("the room `dark` has no object {index}; it has {index}");
    assert_eq!(error.to_string(), expected);
    (0..4).for_each(|_| assert!(editor.undo()));
    assert_eq!(editor.plan(), &before);
}

#[test]
fn points_have_what_is_there() {
    let mut editor = bare();
    editor.apply(Edit::AddRoom { room: room("bisquare"), x: 3, y: 1, quarters: 0 }).unwrap();
    let gate = Gate { wall: Axis::Horizontal, line: 1, at: 7 };
    editor.apply(Edit::OpenDoorway(gate)).unwrap();
    let (plan, cell) = (editor.plan(), editor.plan().spec().cell_size);
    let at = |x: f64, y: f64| DVec2::new(x, 9.0 - y) * cell;
    assert_eq!(plan.cell_at(at(3.5, 1.5)), Some((3, 1)));
    assert_eq!(plan.target_at(at(0.5, 0.5), 0.1), Some(PlanTarget::Hallway { x: 0, y: 0 }));
    assert_eq!(plan.target_at(at(3.5, 1.01), 0.1), Some(PlanTarget::Doorway(gate)));
    assert_eq!(plan.target_at(at(3.1, 1.1), 0.1), Some(PlanTarget::Room(0)));
    assert_eq!(plan.target_at(at(8.5, 5.5), 0.1), None);
    for p in [at(-0.1, 2.0), at(2.0, 9.1), DVec2::NAN, DVec2::INFINITY] {
        assert_eq!(
            (plan.cell_at(p), plan.target_at(p, 1.0), editor.gate_at(p)),
            (None, None, None)
        );
    }
    assert_eq!(editor.gate_at(at(3.6, 1.2)), Some(gate));
    let west = Gate { wall: Axis::Vertical, line: 3, at: 3 };
    assert_eq!(editor.gate_at(at(3.1, 1.4)), Some(west));
    assert_eq!(editor.test(Edit::OpenDoorway(west)), Ok(()));
    assert_eq!(editor.test(Edit::OpenDoorway(gate)), Err(EditError::AlreadyOpen(gate)));
    assert_eq!(editor.plan().outline(PlanTarget::Doorway(west)), None);
}

fn edits() -> impl Strategy<Value = Edit> {
    let cell = || (0..11_u32, 0..10_u32);
    let name = prop::sample::select(vec!["dark", "victims", "multi office", "water room"]);
    let gate = (any::<bool>(), 0..11_u32, 0..22_u32).prop_map(|(horizontal, line, at)| {
        let wall = if horizontal { Axis::Horizontal } else { Axis::Vertical };
        Gate { wall, line, at }
    });
    prop_oneof![
        (name, cell(), 0..5_u8).prop_map(|(name, (x, y), quarters)| Edit::AddRoom {
            room: room(name),
            x,
            y,
            quarters
        }),
        (0..20_usize, cell()).prop_map(|(room, (x, y))| Edit::MoveRoom { room, x, y }),
        (0..20_usize, 0..5_u8).prop_map(|(room, quarters)| Edit::TurnRoom { room, quarters }),
        (0..20_usize).prop_map(|room| Edit::RemoveRoom { room }),
        cell().prop_map(|(x, y)| Edit::AddHallway { x, y }),
        cell().prop_map(|(x, y)| Edit::RemoveHallway { x, y }),
        gate.clone().prop_map(Edit::OpenDoorway),
        (0..20_usize, 0.0..30.0_f64, 0.0..27.0_f64, 0.1..1.0_f64, -4.0..4.0_f64).prop_map(
            |(room, x, y, half, heading)| {
                let half_size = DVec2::new(half, 0.3);
                let shape = Shape::Box { center: DVec2::new(x, y), half_size, heading };
                Edit::AddObject { room, object: Obstacle::new(ObstacleKind::Other, shape) }
            }
        ),
        (0..20_usize, 0..6_usize, -3.0..3.0_f64, -3.0..3.0_f64).prop_map(|(room, object, x, y)| {
            Edit::MoveObject { room, object, by: DVec2::new(x, y) }
        }),
        (0..20_usize, 0..6_usize, -4.0..4.0_f64)
            .prop_map(|(room, object, angle)| Edit::TurnObject { room, object, angle }),
        (0..20_usize, 0..6_usize).prop_map(|(room, object)| Edit::RemoveObject { room, object }),
        gate.prop_map(Edit::CloseDoorway),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn undo_and_redo_go_through_the_same_plans(
        seed in 0..50_u64, edits in prop::collection::vec(edits(), 1..40),
    ) {
        let mut editor = editor(seed);
        let mut plans = vec![editor.plan().clone()];
        for edit in edits {
            let tested = editor.test(edit.clone());
            prop_assert_eq!(editor.plan(), plans.last().unwrap());
            let applied = editor.apply(edit);
            prop_assert_eq!(&tested, &applied);
            match applied {
                Ok(()) => plans.push(editor.plan().clone()),
                Err(_) => prop_assert_eq!(editor.plan(), plans.last().unwrap()),
            }
        }
        for plan in &plans {
            // Rooms and cells agree, and every opening leads from a room to somewhere.
            for (i, room) in plan.rooms().iter().enumerate() {
                let (width, height) = room.size();
                let cells = (room.x..room.x + width)
                    .flat_map(|x| (room.y..room.y + height).map(move |y| (x, y)));
                for (x, y) in cells {
                    prop_assert_eq!(plan.grid().get(x, y), Some(Cell::Room(i as u32)));
                }
            }
            let cells: u32 = plan.rooms().iter().map(|r| r.size().0 * r.size().1).sum();
            let of_rooms = plan.grid().count(|cell| matches!(cell, Cell::Room(_)));
            prop_assert_eq!(cells as usize, of_rooms);
            prop_assert!(plan.openings().iter().all(|o| is_whole(plan.grid(), o.gate)));
            prop_assert!(plan.openings().is_sorted_by(|a, b| a.gate < b.gate));
        }
        prop_assert_eq!(plans.last().unwrap().to_world().check(), Ok(()));
        for plan in plans.iter().rev().skip(1) {
            prop_assert!(editor.undo());
            prop_assert_eq!(editor.plan(), plan);
        }
        prop_assert!(!editor.undo());
        for plan in &plans[1..] {
            prop_assert!(editor.redo());
            prop_assert_eq!(editor.plan(), plan);
        }
        prop_assert!(!editor.redo());
    }
}

#[test]
fn a_plan_without_any_floor_has_a_world_without_a_start() {
    let mut editor = bare();
    for y in 0..9 {
        for x in 0..10 {
            match editor.plan().grid().get(x, y) {
                Some(Cell::Hallway) => editor.apply(Edit::RemoveHallway { x, y }).unwrap(),
                Some(Cell::Open) => {
                    editor.apply(Edit::AddHallway { x, y }).unwrap();
                    editor.apply(Edit::RemoveHallway { x, y }).unwrap();
                }
                _ => {}
            }
        }
    }
    assert!(!editor.plan().grid().cells().iter().any(|cell| cell.is_floor()));
    let world = editor.plan().to_world();
    assert_eq!((world.start, world.check()), (None, Ok(())));
}
