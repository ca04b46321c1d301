//! Gizmos over trials, for debugging: beams, frontiers and plans, at the estimated poses.

use std::collections::BTreeMap;

use bevy::prelude::*;
use bevy_envgen::SpawnedOrigin;
use bevy_envgen::debug::{DebugSystems, EnvgenDebugPlugin, EnvgenGizmos};
use bevy_envgen::visuals::color;
use envgen::geometry::unit_vector;
use envgen::glam::DVec2;
use envgen::palette::{self, Srgb};
use mapping_trial::backend::RobotBackend;
use mapping_trial::map::OccupancyMap;
use mapping_trial::policy::costmap::Costmap;
use mapping_trial::policy::frontier::Frontiers;
use mapping_trial::robot::Robot;
use mapping_trial::trial::Trial;

use crate::trial::MappingTrial;
use crate::view::WatchTrial;

/// A resource that selects the layers to draw over trials. By default no layer is drawn.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct TrialDebugLayers {
    /// The beams of the last scan of each robot, from its estimated pose.
    pub rays: bool,
    /// The frontiers of the map of the robots, in the clusters that are worth visiting.
    pub frontiers: bool,
    /// The paths that exploration policies follow.
    pub plan: bool,
}

impl TrialDebugLayers {
    /// Selects all layers.
    pub const ALL: TrialDebugLayers = TrialDebugLayers { rays: true, frontiers: true, plan: true };
}

/// Colours of the layers.
const BEAM: Srgb = palette::VERMILION;
const PLAN: Srgb = palette::PURPLE;

/// The radius in metres of the mark of a goal.
const GOAL: f32 = 0.2;

/// Half the side in metres of the mark of a frontier cell.
const CELL: f64 = 0.02;

/// The difference in degrees between the hues of successive clusters, so that neighbours in the list differ
/// clearly.
const HUE_STEP: f32 = 137.5;

/// Draws the layers that [`TrialDebugLayers`] selects over [`MappingTrial`]s, in [`DebugSystems`] with the
/// gizmo group [`EnvgenGizmos`]. Adds [`EnvgenDebugPlugin`], unless it is already added.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrialDebugPlugin;

impl Plugin for TrialDebugPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<EnvgenDebugPlugin>() {
            app.add_plugins(EnvgenDebugPlugin);
        }
        app.register_type::<TrialDebugLayers>()
            .init_resource::<TrialDebugLayers>()
            .debug_trials::<MappingTrial>();
    }
}

/// An extension of [`App`] for plugins with components that hold trials.
pub trait DebugTrials {
    /// Adds the systems that draw the layers for the trials of a component. Needs [`TrialDebugPlugin`].
    fn debug_trials<T: WatchTrial>(&mut self) -> &mut Self;
}

impl DebugTrials for App {
    fn debug_trials<T: WatchTrial>(&mut self) -> &mut Self {
        self.add_systems(
            PostUpdate,
            (
                draw_rays::<T>.run_if(|layers: Res<TrialDebugLayers>| layers.rays),
                draw_frontiers::<T>,
                draw_plans::<T>.run_if(|layers: Res<TrialDebugLayers>| layers.plan),
            )
                .in_set(DebugSystems),
        )
    }
}

type Trials<'w, 's, T> =
    Query<'w, 's, (Entity, &'static SpawnedOrigin, &'static GlobalTransform, &'static T)>;

/// Draws the beams of the last scan of each robot.
fn draw_rays<T: WatchTrial>(trials: Trials<'_, '_, T>, mut gizmos: Gizmos<EnvgenGizmos>) {
    for (_, origin, frame, holder) in &trials {
        let Some(trial) = holder.watched() else { continue };
        let place = |p: DVec2| origin.point_in_app(frame, p);
        beams(trial, |from, to| {
            gizmos.line_2d(place(from), place(to), color(BEAM).with_alpha(0.35))
        });
    }
}

/// Calls `beam` with both ends of every beam that has an echo, in the frame of the world.
fn beams<B: RobotBackend>(trial: &Trial<B>, mut beam: impl FnMut(DVec2, DVec2)) {
    let (autonomy, settings) = (trial.autonomy(), trial.settings());
    for robot in 0..trial.robots() {
        let laser = settings.body.laser_pose(autonomy.slam().estimate(robot).pose);
        for (i, &range) in autonomy.scan(robot).ranges.iter().enumerate() {
            if range.is_finite() {
                let ray = unit_vector(laser.heading + settings.laser.angle(i)) * range;
                beam(laser.position, laser.position + ray);
            }
        }
    }
}

/// The frontiers of a map, updated only when the map has changed.
struct Edge {
    /// The revision of the map.
    revision: Option<u64>,
    costmap: Costmap,
    frontiers: Frontiers,
}

impl Edge {
    fn new(robot: &Robot) -> Self {
        Edge { revision: None, costmap: Costmap::new(robot), frontiers: Frontiers::new() }
    }

    fn renew(&mut self, map: &OccupancyMap, robot: &Robot) {
        if self.revision.is_some_and(|revision| revision > map.revision()) {
            // A lower revision means that another trial has begun.
            *self = Edge::new(robot);
        }
        if self.revision != Some(map.revision()) {
            self.revision = Some(map.revision());
            self.costmap.refresh(map);
            self.frontiers.gather(&mut self.costmap, |_, _| false);
        }
    }

    /// Calls `cell` with the index of the cluster and the centre of every cell.
    fn cells(&self, mut cell: impl FnMut(usize, DVec2)) {
        for cluster in 0..self.frontiers.len() {
            for index in self.frontiers.cells(cluster) {
                cell(cluster, index.centre());
            }
        }
    }
}

/// Draws the frontiers of the map of the robots, each cluster in its own colour.
fn draw_frontiers<T: WatchTrial>(
    trials: Trials<'_, '_, T>,
    layers: Res<TrialDebugLayers>,
    mut edges: Local<BTreeMap<Entity, Edge>>,
    mut gizmos: Gizmos<EnvgenGizmos>,
) {
    if !layers.frontiers {
        // When the layer is shown again, the trial may have another map.
        edges.clear();
        return;
    }
    edges.retain(|&entity, _| trials.contains(entity));
    for (entity, origin, frame, holder) in &trials {
        let Some(trial) = holder.watched() else { continue };
        let robot = &trial.settings().body;
        let edge = edges.entry(entity).or_insert_with(|| Edge::new(robot));
        edge.renew(trial.autonomy().slam().map(), robot);
        let place = |p: DVec2| origin.point_in_app(frame, p);
        edge.cells(|cluster, p| {
            let color = Color::hsl((cluster as f32 * HUE_STEP) % 360.0, 0.9, 0.45);
            for side in [DVec2::new(CELL, CELL), DVec2::new(CELL, -CELL)] {
                gizmos.line_2d(place(p - side), place(p + side), color);
            }
        });
    }
}

/// Draws the paths that exploration policies follow, and their goals.
fn draw_plans<T: WatchTrial>(trials: Trials<'_, '_, T>, mut gizmos: Gizmos<EnvgenGizmos>) {
    for (_, origin, frame, holder) in &trials {
        let Some(trial) = holder.watched() else { continue };
        let place = |p: DVec2| origin.point_in_app(frame, p);
        let Some(policy) = trial.autonomy().policy() else { continue };
        for robot in 0..trial.robots() {
            let path = policy.path(robot);
            gizmos.linestrip_2d(path.iter().map(|&p| place(p)), color(PLAN));
            if let Some(&goal) = path.last() {
                gizmos.circle_2d(place(goal), GOAL, color(PLAN));
            }
        }
    }
}
