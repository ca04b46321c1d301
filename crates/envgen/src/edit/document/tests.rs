use proptest::prelude::*;

use super::*;
use crate::calibration::{Dials, Estimate};
use crate::edit::Audit;
use crate::geometry::Pose;
use crate::indoor::{Axis, Cell, Gate, IndoorSpec};
use crate::seed::Seed;
use crate::world::{Obstacle, ObstacleKind, PartId};
use crate::{Spec, forest::ForestSpec};

fn plan(seed: u64) -> Document {
    let spec = IndoorSpec { width: 9, height: 9, ..Default::default() };
    Document::from_plan(spec.generate(Seed(seed)).unwrap())
}

fn forest() -> Document {
    Document::from_world(ForestSpec::default().generate(Seed(1)).unwrap().to_world())
}

#[test]
fn worlds_of_plans_are_edited_as_plans() {
    let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
    let world = spec.generate(Seed(2)).unwrap().to_world();
    let document = Document::from_world(world.clone());
    assert_eq!(document.plan().map(FloorPlan::to_world), Some(world.clone()));
    assert!(matches!(document.blueprint(), Some(WorldBlueprint::Indoor(_))));
    // What was edited before is no longer what its spec and seed give.
    let mut edited = world;
    edited.walls.pop();
    assert!(Document::from_world(edited).plan().is_none());
    assert!(forest().plan().is_none());
}

#[test]
fn the_measured_difficulty_of_a_plan_is_kept_until_it_is_edited() {
    let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
    let mut world = spec.generate(Seed(2)).unwrap().to_world();
    let dial = Estimate { value: 5.0, standard_error: 0.4 };
    world.provenance.measured = Some(Box::new(MeasuredDifficulty {
        panel: "reference".to_owned(),
        panel_version: 1,
        dials: Dials { difficulty: dial, mapping: dial, navigation: dial },
        trials: 12,
        noise_seed: Seed(1),
    }));
    let mut document = Document::from_world(world.clone());
    assert!(document.plan().is_some());
    assert_eq!(**document.world(), world);
    let change = document.remove(Target::Plan(PlanTarget::Room(0))).unwrap();
    document.apply(change).unwrap();
    assert_eq!(document.world().provenance.measured, None);
    document.undo();
    assert_eq!(**document.world(), world);
    assert_eq!(document.certified_world().provenance, world.provenance);
}

#[test]
fn an_edited_plan_that_was_saved_is_a_plan_again() {
    let mut document = plan(3);
    let room = Target::Plan(PlanTarget::Room(0));
    let remove = |document: &mut Document| {
        let change = document.remove(room).unwrap();
        document.apply(change).unwrap();
    };
    remove(&mut document);
    remove(&mut document);
    document.undo();
    let mut file = Vec::new();
    document.certified_world().write_json(&mut file).unwrap();
    let world = crate::import::read_json(&mut file.as_slice()).unwrap();
    assert_eq!(world.provenance.edits.len(), 1);
    let mut again = Document::from_world(world);
    assert_eq!(again.plan(), document.plan());
    assert!(!again.is_changed() && !again.can_undo());
    // Further changes are added to those of the file.
    document.redo();
    remove(&mut again);
    assert_eq!(again.world(), document.world());
    assert_eq!(again.world().provenance.edits.len(), 2);
    again.undo();
    assert_eq!(again.world().provenance.edits.len(), 1);
}

#[test]
fn changes_since_the_last_save_are_known() {
    let mut document = plan(1);
    let room = |index| Target::Plan(PlanTarget::Room(index));
    let remove = |document: &mut Document| {
        let change = document.remove(room(0)).unwrap();
        assert_eq!(document.apply(change), Ok(None));
    };
    assert!(!document.is_changed() && !document.can_undo());
    remove(&mut document);
    assert!(document.is_changed());
    assert!(document.undo() && !document.is_changed());
    assert!(document.redo() && document.is_changed());
    document.mark_saved();
    assert!(!document.is_changed());
    assert!(document.undo() && document.is_changed());
    // The saved state cannot be reached any more, even with as many changes.
    remove(&mut document);
    assert!(document.is_changed());
    assert!(document.undo() && document.is_changed());
}

#[test]
fn changes_of_one_step_are_undone_and_repeated_together() {
    let mut document = plan(1);
    let before = document.world().clone();
    let remove = || Change::from(crate::indoor::Edit::RemoveRoom { room: 0 });
    // Without a step, a part is a step.
    document.extend(remove()).unwrap();
    let first = document.world().clone();
    document.apply(remove()).unwrap();
    document.extend(remove()).unwrap();
    document.mark_saved();
    let second = document.world().clone();
    assert!(document.undo() && document.is_changed());
    assert_eq!(*document.world(), first);
    assert!(document.redo() && !document.is_changed() && !document.can_redo());
    assert_eq!(*document.world(), second);
    assert!(document.undo() && document.undo() && !document.can_undo());
    assert_eq!(*document.world(), before);
    // What is refused adds nothing, and a new change ends what can be repeated.
    let refused = Change::from(crate::indoor::Edit::RemoveRoom { room: 999 });
    assert!(document.extend(refused).is_err() && document.can_redo() && !document.can_undo());
    document.extend(remove()).unwrap();
    assert!(!document.can_redo() && !document.redo());
    assert_eq!(*document.world(), first);
}

#[test]
fn a_moved_room_keeps_its_selection() {
    let mut document = plan(2);
    let cell = document.plan().unwrap().spec().cell_size;
    // The first room that can move to the right.
    let count = document.plan().unwrap().rooms().len();
    let found = (0..count).find_map(|room| {
        let target = Target::Plan(PlanTarget::Room(room));
        let change = document.moved(target, DVec2::new(1.1, 0.2) * cell).unwrap();
        document.test(change.clone()).is_ok().then_some((target, change))
    });
    let Some((target, change)) = found else { panic!("a room that can move") };
    let (before, preview) = (document.outline(target), document.preview(&change));
    assert_ne!(before, preview);
    let moved = document.apply(change).unwrap().unwrap();
    assert_eq!(document.outline(moved), preview);
    assert!(document.describe(moved).starts_with("room `"));
    // Rooms stay in the grid, however far they are moved.
    for far in [1e9, -1e9] {
        let change = document.moved(moved, DVec2::splat(far)).unwrap();
        let there = document.preview(&change).unwrap().bounds();
        assert!(document.world().bounds.contains_rect(there));
    }
    assert_eq!(
        document.apply(WorldEdit::Remove(WorldTarget::Start).into()),
        Err(DocumentError::OtherDocument)
    );
}

#[test]
fn what_is_behind_a_closed_doorway_is_audited() {
    let mut document = plan(3);
    assert!(Audit::of(document.world(), &document.promises()).broken().is_empty());
    let gates: Vec<Gate> = document.plan().unwrap().openings().iter().map(|o| o.gate).collect();
    for gate in gates {
        let doorway = Target::Plan(PlanTarget::Doorway(gate));
        let change = document.remove(doorway).unwrap();
        assert_eq!(document.apply(change), Ok(None));
    }
    let audit = Audit::of(document.world(), &document.promises());
    assert!(audit.broken().contains(&Claim::EveryPlaceReachable { radius: 0.36 }));
    let places = audit.unreached.unwrap().unwrap();
    let rooms = document.plan().unwrap().rooms().len();
    assert_eq!(places.rooms.len(), rooms);
    // What is saved promises what holds only.
    let world = document.certified_world();
    assert!(!world.certificate.contains(&Claim::EveryPlaceReachable { radius: 0.36 }));
    assert!(verify(&world).iter().all(|(_, verdict)| *verdict == Verdict::Holds));
    while document.undo() {}
    assert_eq!(document.certified_world().certificate, document.promises());
}

#[test]
fn other_worlds_lose_the_promises_that_an_edit_breaks() {
    let mut document = forest();
    let tree = |index| Target::World(WorldTarget::Part(PartId { kind: PartKind::Tree, index }));
    let by = {
        let center = |i: usize| document.world().trees[i].center;
        center(4) - center(3)
    };
    let spec = ForestSpec { min_distance: 2.0, ..Default::default() };
    let world = spec.generate(Seed(1)).unwrap().to_world();
    let by_spaced = world.trees[4].center - world.trees[3].center + DVec2::new(0.5, 0.0);
    let mut spaced = Document::from_world(world);
    let change = spaced.moved(tree(3), by_spaced).unwrap();
    assert_eq!(spaced.apply(change), Ok(Some(tree(3))));
    let broken = Audit::of(spaced.world(), &spaced.promises()).broken();
    assert!(broken.contains(&Claim::TreeDistance { distance: 2.0, torus: None }), "{broken:?}");
    assert!(!spaced.certified_world().certificate.contains(&broken[0]));
    // A tree is found where it was moved to. What is round is not turned.
    let change = document.moved(tree(3), by).unwrap();
    document.apply(change).unwrap();
    let p = document.world().trees[3].center;
    assert!(document.target_at(p, 0.0).is_some());
    assert_eq!(document.turned(tree(3), 1.0), None);
    let crate_ = Obstacle::new(ObstacleKind::Crate, Shape::Disc { center: p, radius: 0.2 });
    let change: Change = WorldEdit::Add(NewPart::Obstacle(crate_)).into();
    let preview = document.preview(&change);
    let added = document.apply(change).unwrap().unwrap();
    assert_eq!(document.outline(added), preview);
    assert_eq!(document.describe(added), "obstacle 0 (crate)");
    assert_eq!(document.target_at(p, 0.0), Some(added));
    assert_eq!(document.turned(added, 1.0), None);
    assert!(document.turned(Target::World(WorldTarget::Start), 1.0).is_some());
}

#[test]
fn nearest_targets_are_found_by_an_independent_rule() {
    let mut world = World::clone(forest().world());
    world.victims.push(Pose { position: world.bounds.center(), heading: 0.0 });
    let document = Document::from_world(world);
    let bounds = document.world().bounds;
    let poses: Vec<DVec2> = [document.world().start, document.world().goal]
        .into_iter()
        .flatten()
        .map(|pose| pose.position)
        .collect();
    for i in 0..400_u32 {
        let p =
            bounds.min + bounds.size() * DVec2::new(f64::from(i % 20), f64::from(i / 20)) / 20.0;
        if poses.iter().chain([&bounds.center()]).any(|pose| pose.distance(p) < 1.0) {
            continue;
        }
        let near = |tree: &crate::world::Tree| (tree.center.distance(p) - tree.radius).max(0.0);
        let expected = document.world().trees.iter().map(near).fold(f64::INFINITY, f64::min);
        match document.target_at(p, 0.5) {
            Some(Target::World(WorldTarget::Part(id))) => {
                assert_eq!(id.kind, PartKind::Tree);
                let found = near(&document.world().trees[id.index as usize]);
                assert!((found - expected).abs() < 1e-12 && expected <= 0.5);
            }
            None => assert!(expected > 0.5),
            other => panic!("{other:?}"),
        }
    }
    let middle = Some(Target::World(WorldTarget::Victim(0)));
    assert_eq!(document.target_at(bounds.center(), 0.0), middle);
    assert_eq!(document.target_at(DVec2::NAN, 1.0), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn previews_are_where_changes_lead(
        seed in 0..30_u64, x in 0.0..27.0_f64, y in 0.0..27.0_f64,
        by in prop::array::uniform2(-12.0..12.0_f64), quarter: bool, removes: bool,
    ) {
        let mut document = plan(seed);
        let p = DVec2::new(x, y);
        let Some(target) = document.target_at(p, 0.2) else { return Ok(()) };
        let outline = document.outline(target).unwrap();
        prop_assert!(outline.distance(p) <= 0.2 + 1e-9);
        prop_assert!(!document.describe(target).is_empty());
        let change = if quarter {
            document.turned(target, std::f64::consts::FRAC_PI_2)
        } else if removes {
            document.remove(target)
        } else {
            document.moved(target, DVec2::from(by))
        };
        let Some(change) = change else { return Ok(()) };
        let preview = document.preview(&change).unwrap();
        let tested = document.test(change.clone());
        let applied = document.apply(change);
        prop_assert_eq!(tested.is_ok(), applied.is_ok());
        match applied {
            Ok(Some(there)) => {
                let (a, b) = (document.outline(there).unwrap().bounds(), preview.bounds());
                prop_assert!(a.min.distance(b.min) < 1e-9 && a.max.distance(b.max) < 1e-9);
            }
            Ok(None) => prop_assert_eq!(preview, outline),
            Err(_) => prop_assert!(!document.is_changed()),
        }
    }

    #[test]
    fn plans_have_cells_where_their_world_has_floors(seed in 0..20_u64, x in 0.0..27.0_f64, y in 0.0..27.0_f64) {
        let document = plan(seed);
        let (plan, p) = (document.plan().unwrap(), DVec2::new(x, y));
        let (column, row) = plan.cell_at(p).unwrap();
        let cell = plan.grid().get(column, row).unwrap();
        let world = document.world();
        let in_room = world.rooms.iter().position(|room| room.shape.contains(p));
        if let Some(room) = in_room {
            prop_assert_eq!(cell, Cell::Room(room as u32));
        }
        let outline = plan.cells_outline(column, row, (1, 1));
        prop_assert!(outline.contains(p));
        if let Some(gate) = document.plan_editor().unwrap().gate_at(p) {
            // Not farther than from a corner of the cell to the middle of its side.
            let middle = plan.doorway_outline(gate).bounds().center();
            prop_assert!(middle.distance(p) <= 1.2 * plan.spec().cell_size);
            let along = if gate.wall == Axis::Horizontal { middle.y } else { middle.x };
            let lines = along / plan.spec().cell_size;
            prop_assert!((lines - lines.round()).abs() < 1e-9);
        }
    }
}
