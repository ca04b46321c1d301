//! Runs scenarios: starts those that are requested, and spawns their entities.

use std::sync::Arc;

use bevy::ecs::query::QueryItem;
use bevy::prelude::*;
use envgen::SpecError;
use envgen::glam::DVec2;
use envgen::scenario::{DoorCommand, Robot, Scenario, ScenarioState, TICKS_PER_SECOND};

use super::part::{Door, Person, Smoke};
use super::pose::{leaf_poses, person_pose};
use super::request::{
    EnvironmentScenario, RestartScenario, ScenarioError, ScenarioFailed, ScenarioFailure,
    ScenarioStarted,
};
use crate::environment::{EndlessTruth, GroundTruth};
use crate::job::spawned_origin;
use crate::part::PartOf;
use crate::place::{check_transform, global_transform};
use crate::shape::LocalFrame;

/// The fraction of a tick below which everything is at its position of the last tick. Rounding adds less in
/// steps of whole ticks.
const WHOLE: f64 = 1e-3;

/// A component with the running scenario of an environment, on the entity of the environment. It is not
/// reflected, so scenes do not hold it: the scenario begins again.
#[derive(Component, Debug)]
#[component(clone_behavior = Ignore)]
pub struct ScenarioRun {
    number: u64,
    scenario: Arc<Scenario>,
    /// The point of the world that is at the origin of the environment.
    pub(super) origin: DVec2,
    /// The global transform of the environment in the current step, which Bevy may not have propagated yet.
    pub(super) frame: GlobalTransform,
    pub(super) state: ScenarioState,
    /// The expected state after the next tick, if nothing in the app changes it. It is known only while the
    /// steps of the schedule are not whole ticks.
    ahead: Option<ScenarioState>,
    /// The state between two ticks.
    between: Option<ScenarioState>,
    pub(super) switches: Switches,
    pub(super) people: Vec<Entity>,
    pub(super) doors: Vec<DoorEntity>,
    pub(super) smoke: Vec<Entity>,
}

/// A resource with the number of runs of scenarios that have begun. Bevy's ticks do not identify runs, since it
/// changes old ones.
#[derive(Resource, Default)]
struct BegunRuns(u64);

/// What a scenario keeps when it is restarted on request.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Switches {
    is_paused: bool,
    pub(super) ignores_commands: bool,
}

/// The entities of a door.
#[derive(Debug)]
pub(super) struct DoorEntity {
    pub(super) door: Entity,
    /// The pose in the frame of the environment.
    pub(super) at: Transform,
    pub(super) leaves: Vec<Entity>,
}

impl ScenarioRun {
    /// Returns the scenario that was requested.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Returns the state after the last tick of 1/20 s, in the frame of the world.
    pub fn state(&self) -> &ScenarioState {
        &self.state
    }

    /// Returns the current state in the frame of the world, for rays, clearances, contacts and smoke. Between
    /// two ticks, people and leaves (both here and as entities) move evenly to where the next tick is
    /// expected to place them. Changes that an agent or a command causes in that tick become visible only
    /// after it.
    pub fn now(&self) -> &ScenarioState {
        self.between.as_ref().unwrap_or(&self.state)
    }

    /// Advances the scenario by `dt` seconds among robots, and returns whether there was a tick.
    pub(super) fn advance(&mut self, dt: f64, robots: &[Robot]) -> Result<bool, SpecError> {
        let before = self.state.tick();
        self.state.step(dt, robots)?;
        let has_ticked = self.state.tick() != before;
        if has_ticked {
            self.ahead = None;
        }
        let ticks = TICKS_PER_SECOND as f64;
        let share = self.state.time() * ticks - self.state.tick() as f64;
        self.between = None;
        if share > WHOLE {
            let ahead = match self.ahead.take() {
                Some(ahead) => ahead,
                None => {
                    let mut ahead = self.state.clone();
                    ahead.step(1.0 / ticks, robots)?;
                    ahead
                }
            };
            self.between = Some(self.state.interpolated(&ahead, share));
            self.ahead = Some(ahead);
        }
        Ok(has_ticked)
    }

    /// Returns the number of this run among those that have begun in the app. A scenario that begins again has
    /// another number.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Returns the entities of the people, in the order of the scenario. An app may have despawned some of them;
    /// the scenario continues with these people.
    pub fn people(&self) -> &[Entity] {
        &self.people
    }

    /// Returns the entities of the doors, in the order of the scenario.
    pub fn doors(&self) -> impl Iterator<Item = Entity> + '_ {
        self.doors.iter().map(|door| door.door)
    }

    /// Returns the entities of the places of smoke, in the order of [`ScenarioState::smoke`].
    pub fn smoke(&self) -> &[Entity] {
        &self.smoke
    }

    /// Opens, closes or slams the door with a given index in the scenario at once, while [`Door`] does so in
    /// the next step. It does nothing while commands are ignored, as in a replay.
    ///
    /// # Errors
    /// Returns an error if there is no such door.
    pub fn command_door(&mut self, door: usize, command: DoorCommand) -> Result<(), SpecError> {
        if self.switches.ignores_commands && door < self.doors.len() {
            return Ok(());
        }
        self.replay_door(door, command)
    }

    /// Gives a door a command from a log, even while commands of the app are ignored.
    ///
    /// # Errors
    /// Returns an error if there is no such door.
    pub fn replay_door(&mut self, door: usize, command: DoorCommand) -> Result<(), SpecError> {
        self.ahead = None;
        self.state.command_door(door, command)
    }

    /// Sets whether commands to [`Door`] components and [`ScenarioRun::command_door`] are ignored. This
    /// persists after a [`RestartScenario`]. It is true in a replay, whose log has the commands.
    pub fn set_ignores_commands(&mut self, ignores: bool) {
        self.switches.ignores_commands = ignores;
    }

    /// Returns whether commands to doors are ignored.
    pub fn ignores_commands(&self) -> bool {
        self.switches.ignores_commands
    }

    /// Returns whether the scenario is paused.
    pub fn is_paused(&self) -> bool {
        self.switches.is_paused
    }

    /// Pauses or resumes the scenario. A `MappingTrial` of `bevy_mapping_trial` that runs in the environment
    /// resumes it.
    pub fn set_paused(&mut self, is_paused: bool) {
        self.switches.is_paused = is_paused;
    }
}

/// A component with the last request, whether it began or failed.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
pub(super) struct LastRequest(EnvironmentScenario);

/// Environments that request a scenario, with their worlds.
type Asked = (
    Entity,
    &'static EnvironmentScenario,
    Option<&'static LastRequest>,
    Option<Ref<'static, GroundTruth>>,
    Option<Ref<'static, EndlessTruth>>,
);

/// A filter for environments whose request or world has changed.
type Renewed = (
    With<EnvironmentScenario>,
    Or<(Changed<EnvironmentScenario>, Changed<GroundTruth>, Added<EndlessTruth>)>,
);

/// Starts the requested scenarios whose worlds are spawned.
pub(super) fn start(world: &mut World, renewed: &mut QueryState<Asked, Renewed>) {
    // A request that is written with the same value changes nothing.
    let has_changed = |(_, request, last, truth, endless): &QueryItem<'_, '_, Asked>| {
        let is_same = last.is_some_and(|last| last.0 == **request);
        let has_other_world = truth.as_ref().is_some_and(Ref::is_changed)
            || endless.as_ref().is_some_and(Ref::is_changed);
        (truth.is_some() || endless.is_some()) && (has_other_world || !is_same)
    };
    let renewed: Vec<Entity> =
        renewed.iter(world).filter(has_changed).map(|(entity, ..)| entity).collect();
    for entity in renewed {
        // An environment with an invalid transform has no world.
        if check_transform(&global_transform(world, entity)).is_ok() {
            begin(world, entity, Switches::default());
        }
    }
}

/// Restarts a scenario on request.
pub(super) fn restart(
    asked: On<RestartScenario>,
    runs: Query<&ScenarioRun>,
    mut commands: Commands,
) {
    let entity = asked.entity;
    let Ok(run) = runs.get(entity) else {
        log::warn!("{entity} has no scenario that could begin again");
        return;
    };
    let switches = run.switches;
    commands.queue(move |world: &mut World| begin(world, entity, switches));
}

/// Removes a scenario when its request is removed.
pub(super) fn withdraw(removed: On<Remove, EnvironmentScenario>, mut commands: Commands) {
    let entity = removed.entity;
    commands.queue(move |world: &mut World| {
        // Inserting another request must not remove anything here.
        if world.get_entity(entity).is_ok_and(|root| !root.contains::<EnvironmentScenario>()) {
            remove(world, entity);
        }
    });
}

/// Despawns all entities of the scenario of an environment. This includes those that were spawned from a
/// scene, or cloned, together with the environment.
pub(crate) fn remove(world: &mut World, environment: Entity) {
    let children = world.get::<Children>(environment).into_iter().flatten().copied();
    let children: Vec<Entity> = children.collect();
    // In reverse order: rapier reuses the freed indices last in, first out, so that bodies that are spawned
    // again get the same order, on which the last bits of results depend.
    for child in children.into_iter().rev() {
        let is_ours = |child: &EntityRef<'_>| {
            child.contains::<Person>() || child.contains::<Door>() || child.contains::<Smoke>()
        };
        if world.get_entity(child).is_ok_and(|child| is_ours(&child)) {
            world.despawn(child);
        }
    }
    if let Ok(mut root) = world.get_entity_mut(environment) {
        root.remove::<(ScenarioRun, ScenarioFailure, LastRequest)>();
    }
}

/// Starts the requested scenario of an environment, in place of the current one.
fn begin(world: &mut World, entity: Entity, switches: Switches) {
    let Ok(root) = world.get_entity(entity) else { return };
    let Some(request) = root.get::<EnvironmentScenario>() else { return };
    let last = LastRequest(request.clone());
    let origin = spawned_origin(world, entity);
    let known = root.get::<ScenarioRun>().map(|run| Arc::clone(&run.scenario));
    let made = match root.get::<GroundTruth>() {
        Some(truth) => request.of(truth).map_err(ScenarioError::from).and_then(|scenario| {
            let state = ScenarioState::new(truth, &scenario)?;
            Ok((
                known.filter(|known| **known == scenario).unwrap_or_else(|| scenario.into()),
                state,
            ))
        }),
        None => Err(ScenarioError::Endless),
    };
    remove(world, entity);
    match made {
        Ok((scenario, state)) => {
            let run = spawn(world, (entity, origin), scenario, state);
            let mut begun = world.get_resource_or_init::<BegunRuns>();
            begun.0 += 1;
            let number = begun.0;
            if let Ok(mut root) = world.get_entity_mut(entity) {
                root.insert((ScenarioRun { number, switches, ..run }, last));
            }
            world.write_message(ScenarioStarted { entity });
            world.trigger(ScenarioStarted { entity });
        }
        Err(error) => {
            log::warn!("scenario of environment {entity}: {error}");
            if let Ok(mut root) = world.get_entity_mut(entity) {
                root.insert((ScenarioFailure(error.clone()), last));
            }
            world.write_message(ScenarioFailed { entity, error: error.clone() });
            world.trigger(ScenarioFailed { entity, error });
        }
    }
    world.flush();
}

/// Spawns the entities of a scenario.
fn spawn(
    world: &mut World,
    (environment, origin): (Entity, DVec2),
    scenario: Arc<Scenario>,
    state: ScenarioState,
) -> ScenarioRun {
    let frame = LocalFrame::new(origin);
    let global = global_transform(world, environment);
    let belongs = (ChildOf(environment), PartOf(environment));
    let people = (0..).zip(state.people()).map(|(index, person)| {
        let at = person_pose(frame, person);
        let part = Person { index, velocity: Vec2::ZERO, reacts: false };
        let name = Name::new(format!("person {index}"));
        world.spawn((part, name, at, global.mul_transform(at), belongs.clone())).id()
    });
    let people = people.collect();
    let doors = (0..).zip(scenario.doors.iter().zip(state.doors())).map(|(index, (door, now))| {
        let at = frame.pose(state.doorway_middle(index as usize), 0.0);
        let part = Door {
            index,
            doorway: door.doorway,
            openness: now.openness,
            opens: now.opens,
            stopped: now.stopped,
            command: None,
        };
        let name = Name::new(format!("door {index}"));
        let above = global.mul_transform(at);
        let entity = world.spawn((part, name, at, above, belongs.clone())).id();
        let leaves = leaf_poses(frame, &at, &state, index as usize).map(|(leaf, at)| {
            let place = (at, above.mul_transform(at), ChildOf(entity), PartOf(environment));
            world.spawn((leaf, Name::new("leaf"), place)).id()
        });
        DoorEntity { door: entity, at, leaves: leaves.collect() }
    });
    let doors = doors.collect();
    let smoke = (0..).zip(state.smoke()).map(|(index, (_, extinction))| {
        let at = Transform::IDENTITY;
        let name = Name::new(format!("smoke {index}"));
        let part = Smoke { index, extinction };
        world.spawn((part, name, at, global.mul_transform(at), belongs.clone())).id()
    });
    let smoke = smoke.collect();
    ScenarioRun {
        number: 0,
        scenario,
        origin,
        frame: global,
        state,
        ahead: None,
        between: None,
        switches: Switches::default(),
        people,
        doors,
        smoke,
    }
}
