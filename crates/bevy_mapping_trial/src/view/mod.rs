//! Draws mapping trials: the growing map, the current scans, the robots and their paths, at the poses that
//! the robots estimate.
//!
//! The world itself is hidden from the first frame, unless [`TrialView::truth`] is set. With [`ShowIn3d`],
//! only three-dimensional cameras see it.
//!
//! ```text
//! Environment          TrialView (what is shown), TrialSights (positions)
//!   trial view
//!     map              a sprite for every 6.4 m of the map
//!     scans            a fan for every robot
//!     paths            ribbons
//!     robot 0          a box with an arrow head; an arrow for minimaps
//!     truth            true poses and paths, for training
//! ```
//!
//! The trials of [`MappingTrial`]s are drawn. The trials of any other component can be drawn as well; see
//! [`WatchTrials`].

mod camera;
mod curtain;
mod drawing;
mod map;
mod minimap;
mod palette;
mod scan;
mod shape;
mod sights;
mod trail;
mod trial_view;

use std::marker::PhantomData;

use bevy::asset::AssetEventSystems;
use bevy::camera::CameraUpdateSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::prelude::*;
use bevy::transform::TransformSystems;
use bevy_envgen::visuals::require_visibility;
use bevy_envgen::{SpawnedOrigin, require_component};
use envgen::glam::DVec2;
use mapping_trial::backend::RobotBackend;
use mapping_trial::trial::Trial;

pub use camera::{FollowRobot, ShowWholeMap};
pub use minimap::{MINIMAP_LAYER, minimap_layers};
pub use palette::TrialPalette;
pub use sights::TrialSights;
pub use trial_view::TrialView;

use curtain::{Changes, Curtain, Shown};
use drawing::{Canvas, Drawing, DrawingRoot};

use crate::trial::{MappingTrial, RapierRobots};

/// A component that lets `Camera3d`s, such as cameras on robots, see the world although it is hidden from
/// `Camera2d`s. It is on the same entity as the [`TrialView`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct ShowIn3d;

/// A component that holds a trial of the [`Environment`](bevy_envgen::Environment) on the same entity.
pub trait WatchTrial: Component {
    /// The robot backend of the trial.
    type RobotBackend: RobotBackend;

    /// Returns the trial, or `None` before it has begun.
    fn watched(&self) -> Option<&Trial<Self::RobotBackend>>;
}

impl WatchTrial for MappingTrial {
    type RobotBackend = RapierRobots;

    fn watched(&self) -> Option<&Trial<RapierRobots>> {
        self.trial()
    }
}

/// An extension of [`App`] for plugins with components that hold trials.
pub trait WatchTrials {
    /// Draws the trials of a component. The component then requires a [`TrialView`], so that no world is
    /// visible before its trial begins.
    fn watch_trials<T: WatchTrial>(&mut self) -> &mut Self;
}

impl WatchTrials for App {
    fn watch_trials<T: WatchTrial>(&mut self) -> &mut Self {
        // Two plugins may register the same component.
        if !self.world().contains_resource::<IsWatched<T>>() {
            self.insert_resource(IsWatched::<T>(PhantomData));
            require_component::<T, TrialView>(self);
            self.add_observer(forget::<T>);
            self.add_systems(PostUpdate, draw::<T>.in_set(TrialViewSystems::Draw));
        }
        self
    }
}

/// A resource that exists if the trials of a component are drawn.
#[derive(Resource)]
struct IsWatched<T: WatchTrial>(PhantomData<fn() -> T>);

/// The system sets that draw trials, in this order, in `PostUpdate`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrialViewSystems {
    /// Hides worlds, or shows them if requested.
    Hide,
    /// Draws what has changed.
    Draw,
    /// Moves cameras.
    Look,
}

/// Draws mapping trials. Add it after [`EnvgenPlugins`](bevy_envgen::EnvgenPlugins).
///
/// Adds the resource [`TrialPalette`] and the systems of [`TrialViewSystems`]. Needs Bevy's plugins for
/// images, meshes, sprites and `ColorMaterial`s, and draws nothing without them. By default it uses the
/// colours that the app already has, if any.
#[derive(Clone, Debug, Default)]
pub struct TrialViewPlugin {
    palette: Option<TrialPalette>,
}

impl TrialViewPlugin {
    /// Inserts `palette` as the colours, replacing those that the app already has.
    pub fn new(palette: TrialPalette) -> Self {
        TrialViewPlugin { palette: Some(palette) }
    }
}

impl Plugin for TrialViewPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<TrialView>()
            .register_type::<ShowIn3d>()
            .register_type::<TrialPalette>()
            .register_type::<TrialSights>()
            .register_type::<FollowRobot>()
            .register_type::<ShowWholeMap>()
            .register_type::<DrawingRoot>()
            .add_observer(show_world)
            .configure_sets(
                PostUpdate,
                (TrialViewSystems::Hide, TrialViewSystems::Draw, TrialViewSystems::Look)
                    .chain()
                    .before(TransformSystems::Propagate)
                    .before(VisibilitySystems::VisibilityPropagate)
                    .before(CameraUpdateSystems)
                    .before(AssetEventSystems),
            )
            .add_systems(
                PostUpdate,
                (
                    (hide_worlds, remove_clones).in_set(TrialViewSystems::Hide),
                    (camera::follow, camera::show_maps).chain().in_set(TrialViewSystems::Look),
                ),
            );
        match &self.palette {
            Some(palette) => app.insert_resource(palette.clone()),
            None => app.init_resource::<TrialPalette>(),
        };
        require_visibility(app);
        app.register_type::<MappingTrial>().watch_trials::<MappingTrial>();
    }
}

/// A drawn trial, with what is shown of its world.
type Veiled =
    (Entity, &'static TrialView, Has<ShowIn3d>, &'static Children, Option<&'static Shown>);

/// Hides the worlds whose trials are drawn: all their parts if what is shown has changed, and otherwise what else
/// has changed.
fn hide_worlds(
    views: Query<Veiled>,
    mut changes: Changes<'_, '_>,
    mut curtain: Curtain<'_, '_>,
    mut commands: Commands,
) {
    let wanted = |view: &TrialView, in_3d| Shown { from_above: view.truth, in_3d };
    for (entity, view, in_3d, children, shown) in &views {
        let wanted = wanted(view, in_3d);
        if shown != Some(&wanted) {
            curtain.set(children, wanted);
            commands.entity(entity).try_insert(wanted);
        }
    }
    for changed in changes.take() {
        if let Some((child, root)) = changes.root_of(changed, |parent| views.contains(parent))
            && let Ok((_, view, in_3d, _, shown)) = views.get(root)
            && shown == Some(&wanted(view, in_3d))
        {
            curtain.set_below(child, changed, wanted(view, in_3d));
        }
    }
}

/// Despawns the drawings that were spawned from a scene, or cloned, together with their environment.
fn remove_clones(
    added: Query<(Entity, &ChildOf), Added<DrawingRoot>>,
    drawings: Query<&Drawing>,
    mut commands: Commands,
) {
    for (root, below) in &added {
        if !drawings.get(below.parent()).is_ok_and(|drawing| drawing.root == root) {
            commands.entity(root).try_despawn();
        }
    }
}

/// Shows a world whose trial is no longer drawn, and removes the drawing.
fn show_world(
    removed: On<Remove, TrialView>,
    children: Query<&Children>,
    mut curtain: Curtain<'_, '_>,
    drawings: Query<&Drawing>,
    mut commands: Commands,
) {
    if let Ok(children) = children.get(removed.entity) {
        curtain.set(children, Shown { from_above: true, in_3d: true });
    }
    commands.entity(removed.entity).try_remove::<Shown>();
    if let Ok(drawing) = drawings.get(removed.entity) {
        // If the environment is despawned, so is everything below it.
        commands.entity(drawing.root).try_despawn();
        commands.entity(removed.entity).try_remove::<(Drawing, TrialSights)>();
    }
}

/// Stops drawing a trial that was removed.
fn forget<T: WatchTrial>(removed: On<Remove, T>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<TrialView>();
}

/// A trial and its drawing.
type Watched<'a, T> =
    (Entity, &'a SpawnedOrigin, &'a T, &'a TrialView, &'a mut TrialSights, Option<&'a mut Drawing>);

/// Draws what has changed in the trials.
fn draw<T: WatchTrial>(
    mut trials: Query<Watched<'_, T>>,
    palette: Res<TrialPalette>,
    mut canvas: Canvas,
) {
    for (entity, origin, holder, view, mut sights, drawing) in &mut trials {
        let Some(trial) = holder.watched() else {
            if let Some(drawing) = drawing {
                canvas.commands.entity(drawing.root).try_despawn();
                canvas.commands.entity(entity).try_remove::<Drawing>();
                sights.set_if_neq(TrialSights::default());
            }
            continue;
        };
        look_around(trial, origin.0, &mut sights);
        if let Some(mut drawing) = drawing {
            if drawing.is_of(trial) && drawing.is_whole(&canvas) {
                drawing.renew(trial, view, origin.0, &palette, &mut canvas);
                continue;
            }
            canvas.commands.entity(drawing.root).try_despawn();
        }
        if let Some(mut drawing) = Drawing::begin(entity, trial, &palette, &mut canvas) {
            drawing.renew(trial, view, origin.0, &palette, &mut canvas);
            canvas.commands.entity(entity).try_insert(drawing);
        }
    }
}

/// Updates the estimated positions of the robots and the bounds of their map.
fn look_around<B: RobotBackend>(
    trial: &Trial<B>,
    origin: DVec2,
    sights: &mut Mut<'_, TrialSights>,
) {
    let slam = trial.autonomy().slam();
    let local = |p: DVec2| (p - origin).as_vec2();
    let map = slam.map().bounds();
    let map = map.map(|area| Rect::from_corners(local(area.min), local(area.max)));
    let robots = (0..trial.robots()).map(|robot| local(slam.estimate(robot).pose.position));
    if sights.map != map || !sights.robots.iter().copied().eq(robots.clone()) {
        sights.map = map;
        sights.robots.clear();
        sights.robots.extend(robots);
    }
}
