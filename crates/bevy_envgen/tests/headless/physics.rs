//! Rapier and the crate `envgen` agree on the world.

use std::f32::consts::{FRAC_PI_2, PI};

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_envgen::bevy_rapier2d::prelude::*;
use bevy_envgen::envgen::geometry::{Shape, unit_vector};
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::envgen::hallway::HallwaySpec;
use bevy_envgen::envgen::raycast::Raycaster;
use bevy_envgen::envgen::world::{Extent, Obstacle, ObstacleKind, Wall as EnvgenWall};
use bevy_envgen::envgen::{Blueprint, Seed, Spec, World as EnvgenWorld};
use bevy_envgen::physics::ColliderMerging;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{in_rapier, spawn_ready, step, test_app, truth, wait_until_ready};

use super::{spawned, specs};

const RANGE: f64 = 15.0;
const MILLIMETRE: f64 = 1e-3;

/// Returns the ranges of rapier's rays, without sensors, or `RANGE` for rays that hit nothing.
fn ranges(app: &mut App, rays: Vec<(Vec2, Vec2)>) -> Vec<f64> {
    let cast = move |context: ReadRapierContext| {
        let context = context.single().unwrap();
        let filter = QueryFilter::default().exclude_sensors();
        let range = RANGE as f32;
        rays.iter()
            .map(|&(from, direction)| {
                let hit = context.cast_ray(from, direction, range, true, filter);
                hit.map_or(RANGE, |(_, distance)| f64::from(distance))
            })
            .collect::<Vec<_>>()
    };
    app.world_mut().run_system_once(cast).unwrap()
}

/// Returns random rays of a world, from anywhere in its bounds, including the inside of walls.
fn rays(world: &EnvgenWorld, count: usize) -> Vec<(DVec2, f64)> {
    let mut stream = Seed(11).stream("test/rays", 0);
    let bounds = world.bounds;
    (0..count)
        .map(|_| {
            let x = stream.between(bounds.min.x, bounds.max.x);
            let y = stream.between(bounds.min.y, bounds.max.y);
            (DVec2::new(x, y), stream.between(-3.2, 3.2))
        })
        .collect()
}

/// Returns whether the range of a ray is within a millimetre of the exact range. A ray that grazes an edge
/// may hit or miss it, so it also agrees with the exact range of a ray half a millimetre to one of its sides.
fn agrees(caster: &Raycaster, (from, heading): (DVec2, f64), range: f64) -> (bool, bool) {
    let exact = |from| caster.cast(from, heading, RANGE).map_or(RANGE, |hit| hit.distance);
    let close = |a: f64| (a - range).abs() <= MILLIMETRE;
    let side = unit_vector(heading).perp() * (0.5 * MILLIMETRE);
    let direction = unit_vector(heading) * (0.5 * MILLIMETRE);
    let direct = close(exact(from));
    let beside: Vec<f64> =
        [side, -side, direction, -direction].map(|shift| exact(from + shift)).to_vec();
    let (low, high) = beside.iter().fold((RANGE, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
    (direct, direct || (low - MILLIMETRE..=high + MILLIMETRE).contains(&range))
}

#[test]
fn a_rapier_ray_and_an_exact_ray_agree_within_a_millimetre() {
    const RAYS: usize = 4000;
    for spec in specs() {
        for (merge, solids) in [
            (ColliderMerging::Never, SolidStorage::Entities),
            (ColliderMerging::Always, SolidStorage::Entities),
            (ColliderMerging::Never, SolidStorage::TileData),
        ] {
            let mut app = test_app();
            let settings = ColliderSettings { merge, ..default() };
            let environment = Environment::new(spec.clone(), 2).with_solids(solids);
            let colliders = EnvironmentColliders(settings);
            let root = app.world_mut().spawn((environment, colliders)).id();
            wait_until_ready(&mut app, root).unwrap();
            step(&mut app, 2);
            let world = truth(&app, root);
            let caster = Raycaster::new(&world);
            let rays = rays(&world, RAYS);
            let flat =
                |&(from, heading): &(DVec2, f64)| (from.as_vec2(), unit_vector(heading).as_vec2());
            let found = ranges(&mut app, rays.iter().map(flat).collect());
            let mut grazing = 0;
            for (&ray, &range) in rays.iter().zip(&found) {
                let (direct, agreed) = agrees(&caster, ray, range);
                let exact = caster.cast(ray.0, ray.1, RANGE);
                assert!(
                    agreed,
                    "{spec:?} {merge:?} {solids:?}: {ray:?} {range} m, exactly {exact:?}"
                );
                grazing += usize::from(!direct);
            }
            assert!(grazing <= RAYS / 200, "{grazing} of {RAYS} rays graze, {spec:?}");
            let met = found.iter().filter(|&&range| range < RANGE).count();
            assert!(met > RAYS / 100, "{met} rays meet anything, {spec:?}");
        }
    }
}

#[test]
fn a_clone_that_is_moved_leaves_the_colliders_of_the_original() {
    let mut app = test_app();
    let environment = Environment::new(IndoorSpec::default(), 4).with_pace(GenerationMode::Async);
    let moving = ScenarioSpec { doors: 0.5, people: 4, ..default() };
    let scenario = EnvironmentScenario::new(moving, 1);
    let root = app.world_mut().spawn((environment, scenario)).id();
    wait_until_ready(&mut app, root).unwrap();
    step(&mut app, 2);
    app.world_mut().get_mut::<ScenarioRun>(root).unwrap().set_paused(true);
    step(&mut app, 2);
    let rays: Vec<_> = rays(&truth(&app, root), 1000)
        .iter()
        .map(|&(from, heading)| (from.as_vec2(), unit_vector(heading).as_vec2()))
        .collect();
    let before = (ranges(&mut app, rays.clone()), in_rapier(&mut app));
    let clone = app.world_mut().entity_mut(root).clone_and_spawn_with_opt_out(|builder| {
        builder.linked_cloning(true);
    });
    app.world_mut().get_mut::<Transform>(clone).unwrap().translation.x = 500.0;
    // Before the clone has a world of its own.
    app.world_mut().run_schedule(PostUpdate);
    step(&mut app, 1);
    assert_eq!(ranges(&mut app, rays.clone()), before.0);
    wait_until_ready(&mut app, clone).unwrap();
    step(&mut app, 2);
    let (colliders, bodies) = before.1;
    assert_eq!(in_rapier(&mut app), (2 * colliders, 2 * bodies));
    app.world_mut().despawn(clone);
    step(&mut app, 2);
    assert_eq!((ranges(&mut app, rays), in_rapier(&mut app)), before);
}

#[test]
fn rays_agree_in_an_environment_that_was_moved_and_turned() {
    for spec in specs() {
        let mut app = test_app();
        let root = spawn_ready(&mut app, Environment::new(spec.clone(), 2)).unwrap();
        step(&mut app, 2);
        let at = Transform::from_xyz(40.0, -25.0, 0.0).with_rotation(Quat::from_rotation_z(0.8));
        *app.world_mut().get_mut::<Transform>(root).unwrap() = at;
        step(&mut app, 3);
        let world = truth(&app, root);
        let caster = Raycaster::new(&world);
        let rays = rays(&world, 1000);
        let turned = |&(from, heading): &(DVec2, f64)| {
            let from = at.transform_point(from.as_vec2().extend(0.0)).truncate();
            let direction = at.rotation * unit_vector(heading).as_vec2().extend(0.0);
            (from, direction.truncate())
        };
        let found = ranges(&mut app, rays.iter().map(turned).collect());
        for (&ray, &range) in rays.iter().zip(&found) {
            let exact = caster.cast(ray.0, ray.1, RANGE);
            assert!(agrees(&caster, ray, range).1, "{spec:?}: {ray:?} {range} m, {exact:?}");
        }
    }
}

#[test]
fn bodies_below_a_turned_entity_are_where_rapier_moves_them() {
    for (turn, scale) in [(0.0, 1.0), (0.8, 1.0), (FRAC_PI_2, 1.0), (PI, 1.0), (-2.0, 2.0)] {
        let mut app = test_app();
        let above = Transform::from_xyz(40.0, -25.0, 0.0)
            .with_rotation(Quat::from_rotation_z(turn))
            .with_scale(Vec3::new(scale, scale, 1.0));
        let root = app.world_mut().spawn(above).id();
        let body = (RigidBody::Dynamic, Collider::ball(0.2), Velocity::linear(Vec2::X));
        let body = (body, Transform::from_xyz(2.0, 3.0, 0.5), ChildOf(root));
        let body = app.world_mut().spawn(body).id();
        let global = |app: &App| app.world().get::<GlobalTransform>(body).unwrap().translation();
        let start = above.transform_point(Vec3::new(2.0, 3.0, 0.5));
        step(&mut app, 65);
        let driven = global(&app) - start;
        assert!(driven.distance(Vec3::X) < 0.03, "{turn}: {driven}");
        // If the parent moves, its children do.
        let before = global(&app);
        app.world_mut().get_mut::<Transform>(root).unwrap().translation.y += 1.0;
        step(&mut app, 2);
        let moved = global(&app) - before;
        assert!(moved.distance(Vec3::new(0.0, 1.0, 0.0)) < 0.05, "{turn}: {moved}");
    }
}

#[test]
fn bodies_at_rest_below_a_turned_entity_stay_where_they_are() {
    // If rapier read their rounded transforms, they would creep by micrometres in each step.
    for ((x, y), turn, at, heading) in [
        ((16.0, 32.0), -1.7, Vec2::new(29.81, 17.63), -1.86),
        ((-34.0, 40.0), 2.9, Vec2::new(-19.7, 39.06), -2.28),
    ] {
        let mut app = test_app();
        let above = Transform::from_xyz(x, y, 0.0).with_rotation(Quat::from_rotation_z(turn));
        let root = app.world_mut().spawn(above).id();
        let local =
            GlobalTransform::from(above).affine().inverse().transform_point3(at.extend(0.0));
        let place =
            Transform::from_translation(local).with_rotation(Quat::from_rotation_z(heading - turn));
        let body = (RigidBody::Dynamic, Collider::ball(0.2), place, ChildOf(root));
        let body = app.world_mut().spawn(body).id();
        let place = |app: &App| *app.world().get::<Transform>(body).unwrap();
        step(&mut app, 3);
        let before = place(&app);
        step(&mut app, 1000);
        assert_eq!(place(&app), before);
    }
}

/// Throws a body at every wall that has free space in front of it, and returns the number of those that got
/// through.
fn throw(spec: &HallwaySpec, merge: ColliderMerging) -> usize {
    const SPEED: f32 = 10.0;
    const RADIUS: f64 = 0.15;
    let world = spec.generate(Seed(3)).unwrap().to_world();
    let mut app = test_app();
    let root = app
        .world_mut()
        .spawn((
            Environment::prebuilt(world.clone()),
            EnvironmentColliders(ColliderSettings { merge, ..default() }),
        ))
        .id();
    wait_until_ready(&mut app, root).unwrap();
    // The bodies do not collide with each other, so that all walls are tested at once.
    let groups = CollisionGroups::new(Group::GROUP_1, !Group::GROUP_1);
    let mut thrown = Vec::new();
    for EnvgenWall { shape, .. } in &world.walls {
        let corners = shape.corners();
        let sides: Vec<_> = corners.iter().zip(corners.iter().cycle().skip(1)).collect();
        for (&a, &b) in sides {
            let out = -(b - a).normalize().perp();
            let middle = (a + b) * 0.5;
            let from = middle + out * (RADIUS + 0.2);
            // Faces that touch another wall cannot be reached.
            if world.clearance(from) < RADIUS + 0.1 {
                continue;
            }
            let body = (
                Transform::from_translation(from.as_vec2().extend(0.0)),
                RigidBody::Dynamic,
                Collider::ball(RADIUS as f32),
                Velocity { linear: -out.as_vec2() * SPEED, angular: 0.0 },
                Restitution::coefficient(0.0),
                Ccd::enabled(),
                groups,
            );
            thrown.push((app.world_mut().spawn(body).id(), middle, out));
        }
    }
    assert!(thrown.len() >= world.walls.len(), "every wall has a free face");
    let mut through = 0;
    for _ in 0..64 {
        step(&mut app, 1);
        for &(body, middle, out) in &thrown {
            let at = app.world().get::<Transform>(body).unwrap().translation.truncate().as_dvec2();
            // The centre of the body must not be behind the face while the body is still in front of it.
            let (depth, aside) = ((at - middle).dot(out), (at - middle).perp_dot(out));
            let inside = world.solids().any(|solid| solid.shape.contains(at));
            through += usize::from(inside || depth < -1.0 && aside.abs() < 0.05);
        }
        // The bodies are driven on as if by a motor, whatever speed the contact took.
        for &(body, _, out) in &thrown {
            let mut velocity = app.world_mut().get_mut::<Velocity>(body).unwrap();
            velocity.linear = -out.as_vec2() * SPEED;
        }
    }
    through
}

#[test]
fn a_body_at_ten_metres_a_second_never_gets_through_a_wall() {
    let plain = HallwaySpec { segments: 30, p_st: 0.3, ..default() };
    let thin = HallwaySpec { wall_thickness: 0.02, ..plain.clone() };
    for spec in [plain, thin] {
        for merge in [ColliderMerging::Never, ColliderMerging::Always] {
            assert_eq!(throw(&spec, merge), 0, "{merge:?} {spec:?}");
        }
    }
}

#[test]
fn nothing_falls_and_time_is_counted_in_steps() {
    let mut app = test_app();
    let body = (Transform::default(), RigidBody::Dynamic, Collider::ball(0.2));
    let still = app.world_mut().spawn((body, Velocity::zero())).id();
    let body = (Transform::from_xyz(0.0, 5.0, 0.0), RigidBody::Dynamic, Collider::ball(0.2));
    let moving = app.world_mut().spawn((body, Velocity::linear(Vec2::X))).id();
    step(&mut app, 129);
    let at = |entity| app.world().get::<Transform>(entity).unwrap().translation.truncate();
    assert_eq!(at(still), Vec2::ZERO);
    assert!(at(moving).distance(Vec2::new(2.0, 5.0)) < 0.02, "{}", at(moving));
}

#[test]
fn colliders_are_merged_and_left_alone_as_asked() {
    let trees = |count: usize| {
        let mut world = bevy_envgen::envgen::forest::ForestSpec { intensity: 0.6, ..default() }
            .generate(Seed(1))
            .unwrap()
            .to_world();
        world.trees.truncate(count);
        assert_eq!(world.trees.len(), count);
        world.certificate.clear();
        world
    };
    for (merge, count, merged) in [
        (ColliderMerging::default(), 1000, false),
        (ColliderMerging::default(), 1001, true),
        (ColliderMerging::Always, 10, true),
        (ColliderMerging::Never, 1200, false),
    ] {
        let mut app = test_app();
        let colliders = EnvironmentColliders(ColliderSettings { merge, ..default() });
        let root = app.world_mut().spawn((Environment::prebuilt(trees(count)), colliders)).id();
        wait_until_ready(&mut app, root).unwrap();
        step(&mut app, 1);
        let (colliders, bodies) = in_rapier(&mut app);
        assert_eq!((colliders == count, bodies), (!merged, 0), "{merge:?} {count}");
    }
}

#[test]
fn sensors_tell_who_is_in_a_room() {
    let mut app = test_app();
    let spec = bevy_envgen::envgen::indoor::IndoorSpec::default();
    let root = spawn_ready(&mut app, Environment::new(spec, 4)).unwrap();
    let world = truth(&app, root);
    let room = world.rooms.first().unwrap();
    let Shape::Box { center, .. } = room.shape else { panic!("{:?}", room.shape) };
    for body in [RigidBody::Dynamic, RigidBody::KinematicPositionBased] {
        let at = Transform::from_translation(center.as_vec2().extend(0.0));
        let robot = app.world_mut().spawn((at, body, Collider::ball(0.01))).id();
        step(&mut app, 2);
        let inside = app
            .world_mut()
            .run_system_once(move |context: ReadRapierContext, rooms: Query<&Room>| {
                let context = context.single().unwrap();
                let pairs = context.intersection_pairs_with(robot);
                let others = pairs.map(|(a, b, _)| if a == robot { b } else { a });
                others.filter_map(|other| rooms.get(other).ok()).count()
            })
            .unwrap();
        assert_eq!(inside, 1, "{body:?}");
        app.world_mut().despawn(robot);
        step(&mut app, 1);
    }
}

#[test]
fn bodies_that_rise_pass_above_what_is_lower() {
    // A box of 0.5 m is in the path.
    let spec = ForestSpec { width: 10.0, height: 10.0, intensity: 0.0, ..default() };
    let mut world = spec.generate(Seed(1)).unwrap().to_world();
    let center = DVec2::new(5.0, 5.0);
    let shape = Shape::Box { center, half_size: DVec2::splat(0.5), heading: 0.0 };
    let mut obstacle = Obstacle::new(ObstacleKind::Other, shape);
    obstacle.height = Extent::new(0.0, 0.5).ok();
    world.obstacles.push(obstacle);
    for (is_child, is_late) in [(false, false), (false, true), (true, false), (true, true)] {
        let mut app = test_app();
        spawn_ready(&mut app, Environment::prebuilt(world.clone())).unwrap();
        let height = |bottom| HeightRange { bottom, top: bottom + 0.2 };
        let at = Transform::from_xyz(2.0, 5.0, 0.0);
        let first = if is_late { height(0.0) } else { height(2.0) };
        let body = (at, RigidBody::Dynamic, Velocity::linear(Vec2::X), first);
        let body = app.world_mut().spawn(body).id();
        if is_child {
            app.world_mut().spawn((Collider::ball(0.2), Transform::default(), ChildOf(body)));
        } else {
            app.world_mut().entity_mut(body).insert(Collider::ball(0.2));
        }
        step(&mut app, 10);
        *app.world_mut().get_mut::<HeightRange>(body).unwrap() = height(2.0);
        step(&mut app, 350);
        let at = app.world().get::<Transform>(body).unwrap().translation.x;
        assert!(at > 7.0, "child {is_child}, late {is_late}: stopped at {at}");
    }
}

#[test]
fn what_is_below_the_floor_passes_what_is_on_it() {
    let mut app = test_app();
    let body = |x: f32, speed: f32, bottom: f64, top: f64| {
        let velocity = Velocity::linear(Vec2::new(speed, 0.0));
        let height = HeightRange { bottom, top };
        (
            Transform::from_xyz(x, 0.0, 0.0),
            RigidBody::Dynamic,
            Collider::ball(0.2),
            velocity,
            height,
        )
    };
    let below = app.world_mut().spawn(body(0.0, 1.0, -1.0, -0.1)).id();
    app.world_mut().spawn(body(2.0, 0.0, 0.0, 0.5));
    step(&mut app, 256);
    assert!(app.world().get::<Transform>(below).unwrap().translation.x > 3.5);
}

#[test]
fn a_collider_that_is_moved_below_a_raised_body_passes_above_what_is_lower() {
    let mut app = test_app();
    let height = |bottom| HeightRange { bottom, top: bottom + 0.2 };
    let at = |x: f32| Transform::from_xyz(x, 0.0, 0.0);
    let body = (at(0.0), RigidBody::Dynamic, Velocity::linear(Vec2::X), height(2.0));
    let body = app.world_mut().spawn(body).id();
    let collider = app.world_mut().spawn((Collider::ball(0.2), Transform::default())).id();
    app.world_mut().spawn((at(2.0), RigidBody::Fixed, Collider::ball(0.2), height(0.0)));
    step(&mut app, 2);
    app.world_mut().entity_mut(collider).insert(ChildOf(body));
    step(&mut app, 2);
    assert!(app.world().get::<ActiveHooks>(collider).is_some());
    step(&mut app, 256);
    assert!(app.world().get::<Transform>(body).unwrap().translation.x > 3.5);
}

#[test]
fn parts_that_rise_let_pass_what_is_lower() {
    let spec = ForestSpec { width: 10.0, height: 10.0, intensity: 0.0, ..default() };
    let mut world = spec.generate(Seed(1)).unwrap().to_world();
    let (a, b) = (DVec2::new(5.0, 0.0), DVec2::new(5.0, 10.0));
    world.walls.push(EnvgenWall::new(WallKind::Wall, Shape::Segment { a, b }));
    let mut app = test_app();
    spawn_ready(&mut app, Environment::prebuilt(world)).unwrap();
    step(&mut app, 2);
    let mut parts = app.world_mut().query_filtered::<&mut HeightRange, With<PartId>>();
    for mut height in parts.iter_mut(app.world_mut()) {
        *height = HeightRange { bottom: 1.0, top: 2.0 };
    }
    let height = HeightRange { bottom: 0.0, top: 0.5 };
    let at = Transform::from_xyz(3.0, 5.0, 0.0);
    let body = (at, RigidBody::Dynamic, Collider::ball(0.2), Velocity::linear(Vec2::X), height);
    let body = app.world_mut().spawn(body).id();
    step(&mut app, 256);
    assert!(app.world().get::<Transform>(body).unwrap().translation.x > 6.5);
}

/// Returns whether a message of rapier is cleared after some frames.
fn is_cleared<M: Message>(app: &mut App, message: M) -> bool {
    app.world_mut().write_message(message);
    assert!(!app.world().resource::<Messages<M>>().is_empty());
    step(app, 4);
    app.world().resource::<Messages<M>>().is_empty()
}

#[test]
fn rapiers_messages_are_cleared() {
    use bevy_envgen::bevy_rapier2d::rapier::geometry::CollisionEventFlags;
    let mut app = test_app();
    let body = (RigidBody::Dynamic, Collider::ball(1.0), Transform::default());
    let body = app.world_mut().spawn(body).id();
    step(&mut app, 4);
    let contact = ContactForceEvent {
        collider1: body,
        collider2: body,
        total_force: Vec2::ZERO,
        total_force_magnitude: 0.0,
        max_force_direction: Vec2::ZERO,
        max_force_magnitude: 0.0,
    };
    assert!(is_cleared(&mut app, contact));
    assert!(is_cleared(&mut app, MassModifiedMessage(body)));
    let flags = CollisionEventFlags::empty();
    assert!(is_cleared(&mut app, CollisionEvent::Stopped(body, body, flags)));
}

#[test]
fn an_observer_of_a_collider_may_despawn_its_environment() {
    for solids in [SolidStorage::Entities, SolidStorage::TileData] {
        let mut app = test_app();
        let despawn = |_: On<Add, Collider>,
                       environments: Query<Entity, With<Environment>>,
                       mut commands: Commands| {
            for environment in &environments {
                commands.entity(environment).try_despawn();
            }
        };
        app.add_observer(despawn);
        let environment = Environment::new(IndoorSpec::default(), 4).with_solids(solids);
        app.world_mut().spawn(environment.with_pace(GenerationMode::Blocking));
        step(&mut app, 3);
        assert_eq!((spawned(&mut app), in_rapier(&mut app)), (0, (0, 0)), "{solids:?}");
    }
}
