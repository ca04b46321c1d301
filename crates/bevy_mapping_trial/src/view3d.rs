//! Draws robots in three dimensions, as cameras on other robots see them.

use std::f32::consts::FRAC_PI_2;

use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::transform::TransformSystems;
use bevy_envgen::visuals::require_visibility;
use mapping_trial::robot::{Footprint, Robot};

use crate::robot::RobotModel;
use crate::trial::TrialRobot;
use crate::view::TrialPalette;

/// The clearance between a body and the floor, as a fraction of the radius of the wheels.
const CLEARANCE: f32 = 0.4;

/// The height of the housing of a laser below and above the plane of the laser in metres.
const HOUSING: [f32; 2] = [0.08, 0.03];

/// Draws robots in three dimensions, for `Camera3d`: body, laser and wheels, in the colours of
/// [`TrialPalette`]. The sizes are those of the model, except that the wheels, and the top of the body below
/// the laser, are estimated.
///
/// Needs Bevy's plugins for meshes and `StandardMaterial`s, and draws nothing without them.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_mapping_trial::prelude::*;
/// use bevy_mapping_trial::view3d::{RobotPart, RobotVisuals3dPlugin};
///
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, AssetPlugin::default(), RobotVisuals3dPlugin));
/// app.init_asset::<Mesh>().init_asset::<StandardMaterial>();
/// app.world_mut().spawn(RobotModel::default());
/// app.update();
/// let mut parts = app.world_mut().query::<&RobotPart>();
/// assert_eq!(parts.iter(app.world()).filter(|part| **part == RobotPart::Wheel).count(), 4);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct RobotVisuals3dPlugin;

impl Plugin for RobotVisuals3dPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<RobotPart>()
            .add_observer(draw_inserted)
            .add_observer(remove_parts)
            .add_systems(
                PostUpdate,
                (draw_present.run_if(run_once), remove_clones)
                    .chain()
                    .before(TransformSystems::Propagate)
                    .before(VisibilitySystems::VisibilityPropagate),
            );
        require_visibility(app);
    }
}

/// A component with the part of a robot that a mesh shows, on a child of the robot.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub enum RobotPart {
    /// The body.
    Body,
    /// The housing of the laser.
    Laser,
    /// A wheel.
    Wheel,
}

/// A component with the meshes that draw a robot.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
struct DrawnParts(Vec<Entity>);

/// Despawns the meshes that were spawned from a scene, or cloned, together with their robot, which has meshes
/// of its own.
fn remove_clones(
    added: Query<(Entity, &ChildOf), Added<RobotPart>>,
    robots: Query<&DrawnParts>,
    mut commands: Commands,
) {
    for (part, below) in &added {
        if let Ok(drawn) = robots.get(below.parent())
            && !drawn.0.contains(&part)
        {
            commands.entity(part).try_despawn();
            // The list of children in a scene may have replaced the new children.
            for &drawn in &drawn.0 {
                commands.entity(drawn).try_insert(ChildOf(below.parent()));
            }
        }
    }
}

/// What drawing robots needs.
#[derive(SystemParam)]
struct Drawing<'w, 's> {
    robots: Query<
        'w,
        's,
        (&'static RobotModel, Option<&'static TrialRobot>, Option<&'static Children>),
    >,
    parts: Query<'w, 's, (), With<RobotPart>>,
    palette: Option<Res<'w, TrialPalette>>,
    meshes: Option<ResMut<'w, Assets<Mesh>>>,
    materials: Option<ResMut<'w, Assets<StandardMaterial>>>,
    commands: Commands<'w, 's>,
}

/// Draws a robot when its model is inserted or replaced.
fn draw_inserted(inserted: On<Insert, RobotModel>, mut drawing: Drawing<'_, '_>) {
    drawing.draw(inserted.entity);
}

/// Despawns the meshes of a robot whose model is removed.
fn remove_parts(
    removed: On<Remove, RobotModel>,
    robots: Query<&DrawnParts>,
    mut commands: Commands,
) {
    let Ok(drawn) = robots.get(removed.entity) else { return };
    for &part in &drawn.0 {
        commands.entity(part).try_despawn();
    }
    commands.entity(removed.entity).try_remove::<DrawnParts>();
}

/// Draws the robots that an app spawned before it added the plugin.
fn draw_present(
    robots: Query<Entity, (With<RobotModel>, Without<DrawnParts>)>,
    mut drawing: Drawing<'_, '_>,
) {
    for robot in &robots {
        drawing.draw(robot);
    }
}

impl Drawing<'_, '_> {
    fn draw(&mut self, robot: Entity) {
        let (Some(meshes), Some(materials)) = (&mut self.meshes, &mut self.materials) else {
            return;
        };
        let Ok((model, number, children)) = self.robots.get(robot) else { return };
        for &child in children.into_iter().flatten().filter(|child| self.parts.contains(**child)) {
            self.commands.entity(child).try_despawn();
        }
        if model.validate().is_err() {
            return;
        }
        let palette = self.palette.as_deref().cloned().unwrap_or_default();
        let color = palette.robot(number.map_or(0, |robot| robot.index));
        let mut paint = |color: Color| {
            materials.add(StandardMaterial {
                base_color: color,
                perceptual_roughness: 0.6,
                ..default()
            })
        };
        let (body, dark) = (paint(color), paint(Color::srgb_u8(0x20, 0x22, 0x26)));
        let parts = bodies(model).into_iter().map(|(part, mesh, at)| {
            let material = if part == RobotPart::Body { &body } else { &dark };
            let mesh = (Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()));
            (Name::new(format!("{part:?}")), part, mesh, at)
        });
        let parts: Vec<_> = parts.collect();
        self.commands.queue(move |world: &mut World| {
            if let Ok(mut robot) = world.get_entity_mut(robot) {
                robot.insert_if_new(Visibility::default());
            }
            let mut drawn = Vec::new();
            for part in parts {
                // Another observer may have despawned the robot.
                if world.get_entity(robot).is_ok() {
                    drawn.push(world.spawn((part, ChildOf(robot))).id());
                }
            }
            if let Ok(mut robot) = world.get_entity_mut(robot) {
                robot.insert(DrawnParts(drawn));
            }
        });
    }
}

/// Returns the bodies of a robot on the floor, with its centre at the origin and its heading along x.
fn bodies(robot: &Robot) -> Vec<(RobotPart, Mesh, Transform)> {
    let (length, width) = (robot.length as f32, robot.width as f32);
    let (height, plane) = (robot.height as f32, robot.laser_mount.height as f32);
    // The axis of Bevy's cylinders is y.
    let upright = Quat::from_rotation_x(FRAC_PI_2);
    let wheel = (0.22 * length).min(0.4 * height);
    let tread = 0.14 * width;
    let (bottom, top) = (CLEARANCE * wheel, (plane - HOUSING[0]).clamp(0.5 * height, height));
    let body = match robot.footprint {
        Footprint::Box => Cuboid::new(length, width - 2.0 * tread, top - bottom).mesh().build(),
        Footprint::Disc => {
            let radius = robot.circumscribed_radius as f32;
            Cylinder::new(radius, top - bottom).mesh().build().rotated_by(upright)
        }
    };
    let at = Transform::from_xyz(0.0, 0.0, 0.5 * (bottom + top));
    let mut bodies = vec![(RobotPart::Body, body, at)];
    let housing = height.max(plane + HOUSING[1]) - top;
    if housing > 0.01 {
        let mesh = Cylinder::new((0.16 * length).min(0.08), housing).mesh().build();
        let place = [robot.laser_offset, robot.laser_mount.left].map(|metres| metres as f32);
        let at = Transform::from_xyz(place[0], place[1], top + 0.5 * housing);
        bodies.push((RobotPart::Laser, mesh.rotated_by(upright), at));
    }
    if robot.footprint == Footprint::Box {
        for (ahead, side) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mesh = Cylinder::new(wheel, tread).mesh().build();
            let (x, y) = (ahead * (0.5 * length - wheel), side * 0.5 * (width - tread));
            bodies.push((RobotPart::Wheel, mesh, Transform::from_xyz(x, y, wheel)));
        }
    }
    bodies
}

#[cfg(test)]
mod tests {
    use bevy::mesh::VertexAttributeValues;
    use mapping_trial::robot::LaserMount;

    use super::*;

    fn corners(mesh: &Mesh, at: Transform) -> Vec<Vec3> {
        let Some(VertexAttributeValues::Float32x3(corners)) =
            mesh.attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("a mesh has positions");
        };
        corners.iter().map(|corner| at.transform_point(Vec3::from(*corner))).collect()
    }

    #[test]
    fn a_clone_is_drawn_once() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), RobotVisuals3dPlugin));
        app.init_asset::<Mesh>().init_asset::<StandardMaterial>();
        let robot = app.world_mut().spawn(RobotModel::default()).id();
        app.update();
        let parts = app.world().get::<Children>(robot).unwrap().len();
        let clone = app.world_mut().entity_mut(robot).clone_and_spawn_with_opt_out(|builder| {
            builder.linked_cloning(true);
        });
        app.update();
        for robot in [robot, clone] {
            assert_eq!(app.world().get::<Children>(robot).unwrap().len(), parts);
        }
    }

    #[test]
    fn robots_from_before_the_plugin_are_drawn_once() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()));
        app.init_asset::<Mesh>().init_asset::<StandardMaterial>();
        let early = app.world_mut().spawn(RobotModel::default()).id();
        app.add_plugins(RobotVisuals3dPlugin);
        let late = app.world_mut().spawn(RobotModel::default()).id();
        app.update();
        app.update();
        let [early, late] =
            [early, late].map(|robot| app.world().get::<Children>(robot).expect("its parts").len());
        assert!(late > 0 && early == late, "{early} {late}");
    }

    #[test]
    fn a_robot_without_its_model_is_no_longer_drawn() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), RobotVisuals3dPlugin));
        app.init_asset::<Mesh>().init_asset::<StandardMaterial>();
        let robot = app.world_mut().spawn(RobotModel::default()).id();
        let drawn = |app: &mut App| app.world_mut().query::<&RobotPart>().iter(app.world()).count();
        app.update();
        let parts = drawn(&mut app);
        assert!(parts > 0);
        app.world_mut().entity_mut(robot).remove::<RobotModel>();
        app.update();
        assert_eq!(drawn(&mut app), 0);
        for _ in 0..2 {
            app.world_mut().entity_mut(robot).insert(RobotModel::default());
            app.update();
            assert_eq!(drawn(&mut app), parts);
        }
        app.world_mut().despawn(robot);
        app.update();
        assert_eq!(drawn(&mut app), 0);
    }

    #[test]
    fn robots_are_as_large_as_their_models() {
        let disc = Robot {
            length: 0.28,
            width: 0.28,
            height: 0.2,
            circumscribed_radius: 0.14,
            footprint: Footprint::Disc,
            laser_offset: -0.03,
            laser_mount: LaserMount { height: 0.17, ..LaserMount::default() },
            ..Robot::default()
        };
        // A robot with a laser on a mast.
        let mast = LaserMount { height: 1.2, ..LaserMount::default() };
        let mast = Robot { laser_mount: mast, ..Robot::default() };
        for robot in [Robot::default(), disc, mast] {
            assert_eq!(robot.validate(), Ok(()));
            let radius = robot.circumscribed_radius as f32 + 1e-3;
            let half = 0.5 * Vec2::new(robot.length as f32, robot.width as f32);
            let mut highest = 0.0_f32;
            let (mut least, mut most) = (Vec2::MAX, Vec2::MIN);
            for (part, mesh, at) in bodies(&robot) {
                for corner in corners(&mesh, at) {
                    assert!(corner.z > -1e-5, "{part:?} {corner}");
                    highest = highest.max(corner.z);
                    if part != RobotPart::Laser {
                        assert!(corner.truncate().length() < radius, "{part:?} {corner}");
                        least = least.min(corner.truncate());
                        most = most.max(corner.truncate());
                    }
                }
            }
            assert!((most - half).abs().max_element() < 1e-3, "{most} {half}");
            assert!((least + half).abs().max_element() < 1e-3, "{least} {half}");
            let top = robot.height.max(robot.laser_mount.height + f64::from(HOUSING[1])) as f32;
            assert!((highest - top).abs() < 1e-4, "{highest} {top}");
        }
    }
}
