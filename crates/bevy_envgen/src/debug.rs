//! Gizmos over worlds, for debugging.
//!
//! The layers show the true world, including what a player is not meant to see.

use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;
use envgen::World as EnvgenWorld;
use envgen::glam::DVec2;
use envgen::palette::{self, Srgb};
use envgen::scenario::PERSON_RADIUS;

use crate::environment::{GroundTruth, SpawnedOrigin};
use crate::scenario::ScenarioRun;
use crate::visuals::color;

/// The gizmo group of this crate. Bevy's `GizmoConfigStore` sets its line width and visibility.
#[derive(GizmoConfigGroup, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Default, Debug, Clone)]
pub struct EnvgenGizmos;

/// A resource that selects the layers to draw. By default no layer is drawn.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct DebugLayers {
    /// The outlines of all colliders.
    pub colliders: bool,
    /// The graph of rooms: lines between rooms that a doorway connects, whether it is open or closed.
    pub rooms: bool,
    /// The people of scenarios with their planned paths, and the leaves of doors.
    pub scenario: bool,
}

impl DebugLayers {
    /// Selects all layers.
    pub const ALL: DebugLayers = DebugLayers { colliders: true, rooms: true, scenario: true };
}

/// Colours of the layers.
#[cfg(feature = "physics")]
const COLLIDER: Srgb = palette::GREEN;
const ROOM: Srgb = palette::SKY_BLUE;
const OPEN: Srgb = palette::SKY_BLUE;
const CLOSED: Srgb = palette::VERMILION;
const PERSON: Srgb = palette::ORANGE;

/// The radius in metres of the circle at a room, and of the circle at a doorway to a hallway or to the
/// outside.
const NODE: f32 = 0.3;
const WAY_OUT: f32 = 0.12;

/// The system set that draws the layers, in `PostUpdate` after transforms are propagated.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DebugSystems;

/// A resource that exists if Bevy's plugin for gizmos is added.
#[derive(Resource)]
struct Drawable;

/// Draws the layers that [`DebugLayers`] selects, with the gizmo group [`EnvgenGizmos`].
///
/// It draws nothing without Bevy's `GizmoPlugin`, which is one of the default plugins.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvgenDebugPlugin;

impl Plugin for EnvgenDebugPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<DebugLayers>()
            .register_type::<EnvgenGizmos>()
            .init_resource::<DebugLayers>()
            .configure_sets(
                PostUpdate,
                DebugSystems
                    .after(bevy::transform::TransformSystems::Propagate)
                    .run_if(resource_exists::<Drawable>),
            )
            .add_systems(
                PostUpdate,
                (draw_rooms.run_if(on(|on| on.rooms)), draw_scenarios.run_if(on(|on| on.scenario)))
                    .in_set(DebugSystems),
            );
        #[cfg(feature = "physics")]
        app.add_systems(
            PostUpdate,
            draw_colliders.in_set(DebugSystems).run_if(on(|on| on.colliders)),
        );
    }

    fn finish(&self, app: &mut App) {
        if app.is_plugin_added::<GizmoPlugin>() {
            app.init_gizmo_group::<EnvgenGizmos>().insert_resource(Drawable);
        }
    }
}

/// A run condition that is true if a layer is selected.
fn on(layer: fn(&DebugLayers) -> bool) -> impl Fn(Res<DebugLayers>) -> bool + Clone {
    move |layers| layer(&layers)
}

/// A doorway in the graph of rooms.
#[derive(Clone, Debug, PartialEq)]
struct Link {
    doorway: DVec2,
    open: bool,
    /// The centres of the rooms that the doorway connects.
    rooms: [Option<DVec2>; 2],
}

/// Returns the edges of the graph of rooms.
fn links(world: &EnvgenWorld) -> impl Iterator<Item = Link> + '_ {
    let middle = |room: Option<u32>| {
        world.rooms.get(room? as usize).map(|room| room.shape.bounds().center())
    };
    world.doorways.iter().map(move |doorway| Link {
        doorway: doorway.shape.bounds().center(),
        open: doorway.open,
        rooms: doorway.rooms.map(middle),
    })
}

/// Draws lines between rooms that doorways connect.
fn draw_rooms(
    worlds: Query<(&SpawnedOrigin, &GroundTruth, &GlobalTransform)>,
    mut gizmos: Gizmos<EnvgenGizmos>,
) {
    for (origin, truth, frame) in &worlds {
        let place = |p: DVec2| origin.point_in_app(frame, p);
        for room in &truth.rooms {
            gizmos.circle_2d(place(room.shape.bounds().center()), NODE, color(ROOM));
        }
        for link in links(truth) {
            let ink = color(if link.open { OPEN } else { CLOSED });
            let doorway = place(link.doorway);
            for room in link.rooms {
                match room {
                    Some(room) => gizmos.line_2d(place(room), doorway, ink),
                    None => {
                        gizmos.circle_2d(doorway, WAY_OUT, ink);
                    }
                }
            }
        }
    }
}

/// Draws people, their paths, and the leaves of doors.
fn draw_scenarios(
    runs: Query<(&ScenarioRun, &SpawnedOrigin, &GlobalTransform)>,
    mut gizmos: Gizmos<EnvgenGizmos>,
) {
    for (run, origin, frame) in &runs {
        let place = |p: DVec2| origin.point_in_app(frame, p);
        for person in run.now().people() {
            let at = place(person.position);
            gizmos.circle_2d(
                at,
                place(person.position + DVec2::X * PERSON_RADIUS).distance(at),
                color(PERSON),
            );
            let ahead = std::iter::once(&person.position).chain(person.path().iter().rev());
            gizmos.linestrip_2d(ahead.map(|&p| place(p)), color(PERSON));
        }
        for leaf in run.now().all_leaves() {
            gizmos.line_2d(place(leaf.hinge), place(leaf.tip), color(CLOSED));
        }
    }
}

/// Draws the outlines of all colliders.
#[cfg(feature = "physics")]
fn draw_colliders(
    colliders: Query<(&bevy_rapier2d::geometry::Collider, &GlobalTransform)>,
    mut gizmos: Gizmos<EnvgenGizmos>,
) {
    for (collider, frame) in &colliders {
        // The shape includes the scale.
        let (_, rotation, translation) = frame.to_scale_rotation_translation();
        let place = |p: Vec2| (translation + rotation * p.extend(0.0)).truncate();
        outline(&*collider.raw, &mut |from, to| {
            gizmos.line_2d(place(from), place(to), color(COLLIDER));
        });
    }
}

/// The number of corners with which a circle is drawn.
#[cfg(feature = "physics")]
const CIRCLE: u32 = 24;

/// Calls `edge` with every edge of a shape, in the frame of the shape. Shapes that neither this crate nor
/// robots use are drawn as their bounding boxes.
#[cfg(feature = "physics")]
fn outline(shape: &dyn bevy_rapier2d::parry::shape::Shape, edge: &mut dyn FnMut(Vec2, Vec2)) {
    use bevy_rapier2d::parry::shape::TypedShape;

    let mut ring = |corners: &[Vec2]| {
        for (i, &corner) in corners.iter().enumerate() {
            edge(corner, corners[(i + 1) % corners.len()]);
        }
    };
    match shape.as_typed_shape() {
        TypedShape::Ball(ball) => ring(&ball.to_polyline(CIRCLE)),
        TypedShape::Cuboid(cuboid) => ring(&cuboid.to_polyline()),
        TypedShape::Capsule(capsule) => ring(&capsule.to_polyline(CIRCLE)),
        TypedShape::Segment(segment) => edge(segment.a, segment.b),
        TypedShape::Triangle(triangle) => ring(&[triangle.a, triangle.b, triangle.c]),
        TypedShape::ConvexPolygon(polygon) => ring(polygon.points()),
        TypedShape::Polyline(line) => line.segments().for_each(|s| edge(s.a, s.b)),
        TypedShape::Compound(compound) => {
            for (pose, piece) in compound.shapes() {
                outline(&**piece, &mut |from, to| edge(*pose * from, *pose * to));
            }
        }
        _ => {
            let around = shape.compute_local_aabb();
            let (low, high) = (around.mins, around.maxs);
            // A half-plane is unbounded.
            if low.is_finite() && high.is_finite() && (high - low).max_element() < 1e6 {
                ring(&[low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)]);
            }
        }
    }
}
