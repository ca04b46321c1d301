//! Every world that can be asked for keeps its promises, and that can be checked.

#[path = "common/random_spec.rs"]
mod random_spec;

use envgen::certificate::{Claim, Verdict, verify};
use envgen::geometry::Shape;
use envgen::indoor::IndoorSpec;
use envgen::landscape::LandscapeSpec;
use envgen::world::Extent;
use envgen::{Blueprint, Seed, Spec, World, WorldKind};

/// The example `check_sweep` does the same for thousands.
#[test]
fn random_specs_make_worlds_whose_promises_hold() {
    let (mut worlds, mut promises) = (0, 0);
    for index in 0..45 {
        let kind = WorldKind::ALL[index as usize % WorldKind::ALL.len()];
        let spec = random_spec::random_spec(kind, index, random_spec::MAX_COST);
        let Ok(blueprint) = spec.generate(Seed(index)) else { continue };
        let world = blueprint.to_world();
        assert_eq!(world.check(), Ok(()), "{index}: {spec:?}");
        worlds += 1;
        for (claim, verdict) in verify(&world) {
            assert_eq!(verdict, Verdict::Holds, "{index}: {claim}: {spec:?}");
            promises += 1;
        }
    }
    assert!(worlds > 30 && promises > 30, "{worlds} worlds, {promises} promises");
}

/// Many small pieces near each other.
#[test]
fn laps_of_roads_are_decided() {
    is_decided(WorldKind::Road, 6582);
}

/// Many small pieces near each other.
#[test]
fn hallways_of_rounded_corners_are_decided() {
    is_decided(WorldKind::Hallway, 7185);
}

/// All that a world of the example `check_sweep` promises is found to hold.
fn is_decided(kind: WorldKind, index: u64) {
    let spec = random_spec::random_spec(kind, index, random_spec::MAX_COST);
    let world = spec.generate(Seed(index)).unwrap().to_world();
    for (claim, verdict) in verify(&world) {
        assert_eq!(verdict, Verdict::Holds, "{index}: {claim}");
    }
}

fn indoor(footprint: f64) -> World {
    let spec = IndoorSpec {
        width: 4,
        height: 4,
        difficulty: 6.0,
        robot_radius: footprint,
        ..Default::default()
    };
    spec.generate(Seed(1)).unwrap().to_world()
}

#[test]
fn doorways_of_another_height_are_promised() {
    let promised = |height: f64| {
        let spec = IndoorSpec { width: 4, height: 4, doorway_height: height, ..Default::default() };
        let world = spec.generate(Seed(1)).unwrap().to_world();
        let is_headroom = |claim: &&Claim| matches!(claim, Claim::Headroom { .. });
        let claim = world.certificate.iter().find(is_headroom).copied();
        (world, claim)
    };
    assert_eq!(promised(2.1).1, None);
    let (mut world, claim) = promised(1.9);
    assert_eq!(claim, Some(Claim::Headroom { height: 1.9 }));
    let verdict = |world: &World| {
        let mut checked = verify(world).into_iter();
        checked.find_map(|(found, verdict)| (Some(found) == claim).then_some(verdict))
    };
    assert_eq!(verdict(&world), Some(Verdict::Holds));
    world.doorways[2].height = Some(Extent::new(0.0, 1.8).unwrap());
    assert_eq!(verdict(&world), Some(Verdict::Broken));
    // Nothing is above a doorway as high as the walls.
    let (world, claim) = promised(2.6);
    assert_eq!(claim, Some(Claim::Headroom { height: 2.6 }));
    assert_eq!(verify(&world).last().map(|(_, verdict)| *verdict), Some(Verdict::Holds));
}

#[test]
fn a_wall_at_an_angle_is_decided() {
    for footprint in [0.01, 0.1, 0.36] {
        let mut world = indoor(footprint);
        for turned in (0..world.walls.len()).step_by(5) {
            let mut world = world.clone();
            if let Shape::Box { heading, .. } = &mut world.walls[turned].shape {
                *heading += 0.8;
            }
            // A wall that reaches over the bounds is no less of a wall.
            for (claim, verdict) in verify(&world) {
                assert_eq!(verdict.doubt(), None, "wall {turned}: {claim}");
            }
        }
        world.walls.clear();
        assert!(verify(&world).iter().all(|(_, verdict)| *verdict == Verdict::Holds));
    }
}

#[test]
fn wide_bounds_cost_nothing() {
    let mut world = indoor(0.01);
    world.bounds.min.x = -1e8;
    world.bounds.max.y = 1e8;
    assert_eq!(world.check(), Ok(()));
    for (claim, verdict) in verify(&world) {
        assert_eq!(verdict, Verdict::Holds, "{claim}");
    }
    world.certificate = vec![Claim::Connected { radius: 1e-6 }];
    world.start.as_mut().unwrap().position.x = -1e8;
    assert_eq!(verify(&world)[0].1, Verdict::Broken, "the goal is in a building");
}

#[test]
fn cells_that_no_robot_can_enter_stop_a_disc() {
    let spec = LandscapeSpec { rows: 20, cols: 20, classes: 2, entropy: 0.5, ..Default::default() };
    let mut world = spec.generate(Seed(1)).unwrap().to_world();
    let connected = |world: &World| verify(world)[0].1;
    assert_eq!(connected(&world), Verdict::Holds);
    // A column without data, between the start at the lower left and the goal at the upper right.
    let cells = |world: &mut World, class: u16| {
        let raster = world.raster.as_mut().unwrap();
        raster.cells.iter_mut().skip(10).step_by(20).for_each(|cell| *cell = class);
    };
    cells(&mut world, 0);
    assert_eq!(connected(&world), Verdict::Broken);
    // Through a gap of one cell in it a disc of 0.4 m gets.
    world.raster.as_mut().unwrap().cells[7 * 20 + 10] = 1;
    assert_eq!(connected(&world), Verdict::Holds);
    // A class that cannot be passed is as no data.
    cells(&mut world, 9);
    world.raster.as_mut().unwrap().speeds = [vec![0.0], vec![1.0; 8], vec![0.0]].concat();
    assert_eq!(connected(&world), Verdict::Broken);
}
