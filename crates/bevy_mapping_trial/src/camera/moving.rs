//! The moving bodies that cameras see: doors and people of scenarios, and robots.

use std::borrow::Cow;
use std::collections::BTreeSet;

use bevy::ecs::system::SystemParam;
use bevy::math::DAffine3;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use bevy_envgen::ScenarioRun;
use bevy_envgen::scenario::{Door, DoorLeaf, Person};
use envgen::geometry::{Pose, Shape};
use envgen::glam::{DVec2, DVec3};
use envgen::pieces::Form;
use envgen::scenario::Target;
use envgen::world::{Extent, WallKind};
use mapping_trial::robot::{Footprint, Robot};

use super::labels::Labels;
use super::scene::Triangles;
use crate::robot::RobotModel;
use crate::trial::TrialRobot;

/// The bottom of a robot's body in metres above the floor.
const CLEARANCE: f64 = 0.05;

/// The components of a robot that cameras may see.
type Seen = (
    Entity,
    Option<&'static TrialRobot>,
    &'static RobotModel,
    Option<&'static ChildOf>,
    &'static GlobalTransform,
);

/// The moving entities and their meshes. Entities that the app draws in three dimensions are seen as they are
/// drawn, and all others as simple bodies.
#[derive(SystemParam)]
pub(super) struct Movers<'w, 's> {
    people: Query<'w, 's, &'static Person>,
    leaves: Query<'w, 's, &'static ChildOf, With<DoorLeaf>>,
    doors: Query<'w, 's, (&'static Door, &'static Children)>,
    robots: Query<'w, 's, Seen>,
    children: Query<'w, 's, &'static Children>,
    drawn: Query<'w, 's, (&'static Mesh3d, &'static GlobalTransform)>,
    meshes: Option<Res<'w, Assets<Mesh>>>,
}

/// Converts global coordinates of the app to positions relative to the origin of a scene.
pub(super) struct SceneFrame {
    /// Converts from global coordinates of the app to the frame of the world.
    pub(super) to_world: DAffine3,
    /// The origin of the scene in the frame of the world.
    pub(super) origin: DVec3,
}

impl Movers<'_, '_> {
    /// Returns the triangles of everything that moves in an environment. This includes the robot with the
    /// camera, which may see itself. `is_here` tells by the parent of a robot whether the robot is in the environment.
    pub(super) fn triangles(
        &self,
        is_here: impl Fn(Option<Entity>) -> bool,
        (world, run): (&envgen::World, Option<&ScenarioRun>),
        names: &Labels,
        frame: &SceneFrame,
    ) -> Triangles {
        let mut all = Triangles::default();
        if let Some(run) = run {
            let drawn = self.add_drawn_scenario(run, names, frame, &mut all);
            for (target, form) in run.now().bodies(world) {
                if let Some(label) = names.of_moving(target).filter(|label| !drawn.contains(label))
                {
                    all.add_form(&form, frame.origin, label);
                }
            }
        }
        let mut robots: Vec<_> = self
            .robots
            .iter()
            .filter(|(_, _, _, parent, _)| is_here(parent.map(ChildOf::parent)))
            .collect();
        // Robots of the app follow those of the trial.
        robots.sort_unstable_by_key(|(robot, number, ..)| {
            (number.map_or(usize::MAX, |number| number.index), robot.index_u32())
        });
        let mut next = 0;
        for (robot, number, model, _, at) in robots {
            let number = number.map_or(next, |number| number.index);
            next = number.saturating_add(1);
            let label = names.of_robot(number);
            if !self.add_drawn(robot, label, frame, &mut all) {
                let at = frame.to_world * at.affine().as_daffine3();
                let heading = libm::atan2(at.matrix3.x_axis.y, at.matrix3.x_axis.x);
                let pose = Pose { position: at.translation.truncate(), heading };
                all.add_form(&body(model, pose), frame.origin, label);
            }
        }
        all
    }

    /// Adds the leaves and the people that the app draws, and returns their labels.
    fn add_drawn_scenario(
        &self,
        run: &ScenarioRun,
        names: &Labels,
        frame: &SceneFrame,
        all: &mut Triangles,
    ) -> BTreeSet<u32> {
        let mut drawn = BTreeSet::new();
        for (door, children) in run.doors().filter_map(|door| self.doors.get(door).ok()) {
            let Some(label) = names.of_moving(Target::Leaf(door.index())) else { continue };
            for leaf in children.iter().filter(|child| self.leaves.contains(*child)) {
                if self.add_drawn(leaf, label, frame, all) {
                    drawn.insert(label);
                }
            }
        }
        for &entity in run.people() {
            let Ok(person) = self.people.get(entity) else { continue };
            let Some(label) = names.of_moving(Target::Person(person.index)) else { continue };
            if self.add_drawn(entity, label, frame, all) {
                drawn.insert(label);
            }
        }
        drawn
    }

    /// Adds the meshes of an entity and its descendants, and returns whether there are any.
    fn add_drawn(&self, root: Entity, label: u32, frame: &SceneFrame, all: &mut Triangles) -> bool {
        let Some(meshes) = &self.meshes else { return false };
        let below = self.children.iter_descendants(root).chain([root]);
        let mut is_drawn = false;
        for (mesh, at) in below.filter_map(|entity| self.drawn.get(entity).ok()) {
            let Some(mesh) = meshes.get(&mesh.0) else { continue };
            let shift = DAffine3::from_translation(-frame.origin);
            let place = shift * frame.to_world * at.affine().as_daffine3();
            if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
                continue;
            }
            // Meshes that only the graphics card holds have neither positions nor indices.
            let positions = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION).ok();
            let (Some(positions), Ok(indices)) =
                (positions.and_then(|values| values.as_float3()), mesh.try_indices_option())
            else {
                continue;
            };
            let corners: Vec<DVec3> = positions
                .iter()
                .map(|&p| place.transform_point3(Vec3::from(p).as_dvec3()))
                .collect();
            let indices: Vec<usize> = match indices {
                Some(indices) => indices.iter().collect(),
                None => (0..corners.len()).collect(),
            };
            let triangles = indices.as_chunks::<3>().0.iter();
            let triangles = triangles.filter(|all| all.iter().all(|&i| i < corners.len()));
            all.corners.extend(triangles.map(|triangle| triangle.map(|i| corners[i])));
            all.labels.resize(all.corners.len(), label);
            is_drawn = true;
        }
        is_drawn
    }
}

/// Returns the body of a robot as a box or a cylinder.
fn body(robot: &Robot, pose: Pose) -> Form<'static> {
    let shape = match robot.footprint {
        Footprint::Box => Shape::Box {
            center: pose.position,
            half_size: 0.5 * DVec2::new(robot.length, robot.width),
            heading: pose.heading,
        },
        Footprint::Disc => {
            Shape::Disc { center: pose.position, radius: robot.circumscribed_radius }
        }
    };
    let bottom = CLEARANCE.min(0.5 * robot.height);
    // Heights of robots are at least a centimetre, so there is no error.
    let extent = Extent::new(bottom, robot.height).unwrap_or(WallKind::Wall.extent());
    Form::Prism { shape: Cow::Owned(shape), extent }
}
