use proptest::prelude::*;

use super::*;
use crate::geometry::{Rect, Shape};
use crate::seed::Seed;
use crate::spec::WorldKind;
use crate::world::{ObstacleKind, SurfaceKind, WallKind};

fn yard() -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 6.0));
    let mut world = World::new(Provenance::other("manual", "a yard".into()), bounds);
    world.trees.push(Tree::new(DVec2::new(5.0, 3.0), 0.25));
    world.walls.push(Wall::new(WallKind::Wall, rect(0.0, 0.0, 10.0, 0.2)));
    let door = |x| Doorway::new(rect(x, 4.0, x + 1.0, 4.2), true, [None, None]);
    world.doorways = vec![door(1.0), door(3.0), door(5.0)];
    world.certificate = [0, 1, 2].map(|doorway| Claim::AddedDoorway { doorway }).to_vec();
    world.start = Some(Pose::new(1.0, 3.0, 0.0));
    assert_eq!(world.check(), Ok(()));
    world
}

fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Shape {
    Shape::from_rect(Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1)))
}

fn part(kind: PartKind, index: u32) -> WorldTarget {
    WorldTarget::Part(PartId { kind, index })
}

#[test]
fn what_breaks_the_world_is_refused_and_changes_nothing() {
    let world = yard();
    let mut editor = WorldEditor::new(world.clone());
    let onto_the_start = DVec2::new(-4.0, 0.0);
    let tree = part(PartKind::Tree, 0);
    let refused = [
        (WorldEdit::Move { target: tree, by: onto_the_start }, "the start pose lies inside tree 0"),
        (WorldEdit::Move { target: tree, by: DVec2::new(9.0, 0.0) }, "tree 0 reaches over"),
        (WorldEdit::Move { target: tree, by: DVec2::NAN }, "tree 0 holds a number"),
        (WorldEdit::Turn { target: WorldTarget::Start, angle: f64::NAN }, "the start pose"),
        (WorldEdit::Remove(part(PartKind::Tree, 1)), "there is no tree 1"),
        (WorldEdit::Remove(WorldTarget::Goal), "there is no goal"),
        (WorldEdit::Remove(part(PartKind::Start, 0)), "there is no start 0"),
        (WorldEdit::Remove(part(PartKind::Room, 0)), "room 0 cannot be edited"),
        (WorldEdit::SetOpen { doorway: 9, open: true }, "there is no doorway 9"),
        (WorldEdit::Add(NewPart::Tree(Tree::new(DVec2::ONE, -1.0))), "tree 1 holds a size"),
        (WorldEdit::Add(NewPart::Goal(Pose::new(5.0, 0.1, 0.0))), "the goal pose lies inside"),
    ];
    for (edit, reason) in refused {
        let error = editor.apply(edit.clone()).unwrap_err().to_string();
        assert!(error.contains(reason), "{edit:?}: {error}");
        assert_eq!(editor.world(), &world, "{edit:?}");
    }
}

#[test]
fn doorways_are_closed_and_removed_with_their_claims() {
    let mut editor = WorldEditor::new(yard());
    editor.apply(WorldEdit::SetOpen { doorway: 2, open: false }).unwrap();
    assert!(!editor.world().doorways[2].open);
    editor.apply(WorldEdit::Remove(part(PartKind::Doorway, 1))).unwrap();
    let claims = [0, 1].map(|doorway| Claim::AddedDoorway { doorway });
    assert_eq!(editor.world().certificate, claims);
    assert!(!editor.world().doorways[1].open);
    assert!(editor.undo() && editor.undo() && !editor.undo());
    assert_eq!(editor.world(), &yard());
}

#[test]
fn measured_and_predicted_difficulties_are_of_the_world_before() {
    let spec = crate::indoor::IndoorSpec {
        profile: crate::indoor::Profile::Calibrated,
        width: 10,
        height: 10,
        ..Default::default()
    };
    let world = crate::generate::Spec::generate(&spec, Seed(1)).unwrap();
    let world = crate::generate::Blueprint::to_world(&world);
    let predicts = |world: &World| {
        world.certificate.iter().any(|claim| matches!(claim, Claim::PredictedDifficulty { .. }))
    };
    assert!(predicts(&world));
    let mut editor = WorldEditor::new(world.clone());
    editor.apply(WorldEdit::Remove(part(PartKind::Wall, 0))).unwrap();
    assert!(!predicts(editor.world()) && editor.world().provenance.edited);
    assert_eq!(editor.world().walls[..], world.walls[1..]);
    assert!(editor.undo());
    assert_eq!(editor.world(), &world);
}

fn targets() -> impl Strategy<Value = WorldTarget> {
    let kinds = [
        PartKind::Wall,
        PartKind::Tree,
        PartKind::RoadStrip,
        PartKind::Room,
        PartKind::Doorway,
        PartKind::Obstacle,
        PartKind::Surface,
        PartKind::Start,
        PartKind::Ground,
    ];
    prop_oneof![
        4 => (prop::sample::select(kinds.to_vec()), 0..12_u32).prop_map(|(kind, i)| part(kind, i)),
        1 => (0..3_u32).prop_map(WorldTarget::Victim),
        1 => Just(WorldTarget::Start),
        1 => Just(WorldTarget::Goal),
    ]
}

fn parts() -> impl Strategy<Value = NewPart> {
    let shape = (0.0..30.0_f64, 0.0..30.0_f64, 0.1..1.0_f64, -4.0..4.0_f64).prop_map(
        |(x, y, half, heading)| Shape::Box {
            center: DVec2::new(x, y),
            half_size: DVec2::new(half, 0.2),
            heading,
        },
    );
    let pose = (-1.0..30.0_f64, -1.0..30.0_f64).prop_map(|(x, y)| Pose::new(x, y, 1.0));
    prop_oneof![
        shape.clone().prop_map(|shape| NewPart::Wall(Wall::new(WallKind::Partition, shape))),
        shape
            .clone()
            .prop_map(|shape| NewPart::Obstacle(Obstacle::new(ObstacleKind::Crate, shape))),
        shape.clone().prop_map(|shape| NewPart::Surface(Surface::new(SurfaceKind::Loose, shape))),
        shape.prop_map(|shape| NewPart::Doorway(Doorway::new(shape, true, [None, None]))),
        pose.clone().prop_map(|pose| NewPart::Tree(Tree::new(pose.position, 0.3))),
        pose.clone().prop_map(NewPart::Victim),
        pose.clone().prop_map(NewPart::Start),
        pose.prop_map(NewPart::Goal),
    ]
}

fn edits() -> impl Strategy<Value = WorldEdit> {
    prop_oneof![
        parts().prop_map(WorldEdit::Add),
        (targets(), -5.0..5.0_f64, -5.0..5.0_f64)
            .prop_map(|(target, x, y)| WorldEdit::Move { target, by: DVec2::new(x, y) }),
        (targets(), -4.0..4.0_f64).prop_map(|(target, angle)| WorldEdit::Turn { target, angle }),
        targets().prop_map(WorldEdit::Remove),
        (0..9_u32, any::<bool>()).prop_map(|(doorway, open)| WorldEdit::SetOpen { doorway, open }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn undo_and_redo_go_through_the_same_worlds(
        kind in 0..WorldKind::ALL.len(), seed in 0..20_u64,
        edits in prop::collection::vec(edits(), 1..30),
    ) {
        let kind = WorldKind::ALL[kind];
        let mut spec = kind.default_spec();
        if kind == WorldKind::Indoor {
            spec.set("width", "8").and_then(|()| spec.set("height", "8")).unwrap();
        }
        let Ok(blueprint) = spec.generate(Seed(seed)) else { return Ok(()) };
        let mut editor = WorldEditor::new(blueprint.to_world());
        let mut worlds = vec![editor.world().clone()];
        for edit in edits {
            let tested = editor.test(edit.clone());
            prop_assert_eq!(editor.world(), worlds.last().unwrap());
            let applied = editor.apply(edit);
            prop_assert_eq!(&tested, &applied);
            match applied {
                Ok(()) => worlds.push(editor.world().clone()),
                Err(_) => prop_assert_eq!(editor.world(), worlds.last().unwrap()),
            }
            prop_assert_eq!(editor.world().check(), Ok(()));
            prop_assert_eq!(editor.world().provenance.edited, worlds.len() > 1);
        }
        for world in worlds.iter().rev().skip(1) {
            prop_assert!(editor.undo());
            prop_assert_eq!(editor.world(), world);
        }
        prop_assert!(!editor.can_undo() && !editor.undo());
        for world in &worlds[1..] {
            prop_assert!(editor.can_redo() && editor.redo());
            prop_assert_eq!(editor.world(), world);
        }
        prop_assert!(!editor.redo());
    }
}
