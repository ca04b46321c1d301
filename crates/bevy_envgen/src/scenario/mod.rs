//! Doors, people and smoke in environments: the scenarios of [`envgen::scenario`] as entities.
//!
//! Add an [`EnvironmentScenario`] to the entity of an [`Environment`](crate::Environment), when it is spawned
//! or later. Doors, people and smoke are spawned as its children. They are updated in ticks of 1/20 s of the
//! schedule's time, which gives the same result at every frame rate. Between ticks people and leaves move
//! evenly. Doors open for entities with a [`ScenarioAgent`], and people avoid these entities.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_envgen::prelude::*;
//! use bevy_envgen::scenario::{Person, ScenarioRun};
//!
//! let mut app = bevy_envgen::testing::test_app();
//! let moving = ScenarioSpec { doors: 0.5, people: 4, ..default() };
//! let scenario = EnvironmentScenario::new(moving, 1);
//! let root = app.world_mut().spawn((Environment::new(IndoorSpec::default(), 4), scenario)).id();
//! bevy_envgen::testing::wait_until_ready(&mut app, root)?;
//! let mut people = app.world_mut().query::<(&Person, &Transform)>();
//! assert_eq!(people.iter(app.world()).count(), 4);
//! let state = app.world().get::<ScenarioRun>(root).unwrap().state();
//! assert_eq!(state.people().len(), 4);
//! # Ok::<(), bevy_envgen::EnvironmentError>(())
//! ```
//!
//! # What is spawned
//!
//! ```text
//! Environment       EnvironmentScenario, ScenarioRun (its exact state), ScenarioFailure
//!   Person          PartOf, Transform (position, and the direction of looking along +x)
//!   Door            PartOf, Transform (the middle of its doorway)
//!     DoorLeaf      Transform (the hinge, and the leaf along +x)
//!   Smoke           PartOf
//! ```
//!
//! With the feature `physics` people and leaves are kinematic bodies. Their bodies are one step behind, since
//! rapier moves them together with all other bodies. A leaf stops at an agent, and pushes other bodies.

mod agent;
#[cfg(feature = "physics")]
mod leaf_collider;
mod part;
mod pose;
mod request;
mod run;
mod step;

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

pub use agent::ScenarioAgent;
pub use envgen::scenario::{
    DoorCommand, DoorControl, DoorKind, DoorKinds, Reactions, Scenario, ScenarioSpec, ScenarioState,
};
#[cfg(feature = "physics")]
pub(crate) use leaf_collider::leaf_collider;
pub use part::{Door, DoorChange, DoorChanged, DoorLeaf, Person, PersonReacted, Smoke};
pub use request::{
    EnvironmentScenario, RestartScenario, ScenarioError, ScenarioFailed, ScenarioFailure,
    ScenarioSource, ScenarioStarted, SourceScenario, SourceScenarioSpec,
};
pub use run::ScenarioRun;
pub(crate) use run::remove;

use crate::systems::{EnvgenSchedules, EnvgenSystems};

/// The system set that moves doors, people and smoke. It is after rapier's `PhysicsSet::Writeback`, so that
/// they react to the current positions of bodies, and before Bevy propagates transforms.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ScenarioSystems;

/// Runs the scenarios that [`EnvironmentScenario`] components request.
#[derive(Clone, Copy, Debug)]
pub struct EnvgenScenarioPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl EnvgenScenarioPlugin {
    /// Creates the plugin with the systems that move everything in `schedule` instead of `FixedUpdate`. If
    /// the app has rapier, it must be rapier's schedule.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        EnvgenScenarioPlugin { schedule: schedule.intern() }
    }
}

impl Default for EnvgenScenarioPlugin {
    fn default() -> Self {
        EnvgenScenarioPlugin::new(FixedUpdate)
    }
}

impl Plugin for EnvgenScenarioPlugin {
    fn build(&self, app: &mut App) {
        let main = EnvgenSchedules::of(app).main;
        app.register_type::<Door>()
            .register_type::<DoorLeaf>()
            .register_type::<EnvironmentScenario>()
            .register_type::<Person>()
            .register_type::<ScenarioAgent>()
            .register_type::<Smoke>()
            .add_message::<DoorChanged>()
            .add_message::<PersonReacted>()
            .add_message::<ScenarioFailed>()
            .add_message::<ScenarioStarted>()
            .add_observer(run::restart)
            .add_observer(run::withdraw)
            .add_systems(
                main,
                run::start.after(EnvgenSystems::Stream).before(EnvgenSystems::Notify),
            )
            .configure_sets(
                self.schedule,
                ScenarioSystems.after(EnvgenSystems::Notify).before(TransformSystems::Propagate),
            )
            .add_systems(
                self.schedule,
                (agent::locate, step::step, step::place, step::place_leaves)
                    .chain()
                    .in_set(ScenarioSystems),
            );
        #[cfg(feature = "physics")]
        app.configure_sets(
            self.schedule,
            ScenarioSystems.after(bevy_rapier2d::prelude::PhysicsSet::Writeback),
        )
        .add_systems(
            self.schedule,
            leaf_collider::fit_leaves.in_set(ScenarioSystems).after(step::place_leaves),
        );
    }
}
