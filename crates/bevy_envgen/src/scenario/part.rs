//! The components of the entities of a scenario.

use bevy::prelude::*;
use envgen::scenario::DoorCommand;

/// A component of a person of a scenario, on a child of the environment. The scenario moves the person, and
/// overwrites changes of the [`Transform`].
///
/// Despawning the entity removes only its meshes and its collider. The scenario continues with the person, whom
/// other people, doors and lasers still notice.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Person {
    /// The index in [`Scenario::people`](envgen::scenario::Scenario::people).
    pub index: u32,
    /// The velocity in m/s, in the frame of the environment.
    pub velocity: Vec2,
    /// Whether the person is reacting to an agent.
    pub reacts: bool,
}

/// A component of a door of a scenario, on a child of the environment. The leaves of the door are its
/// children, with the component [`DoorLeaf`].
///
/// Despawning the entity removes only the meshes and the colliders of its leaves. The scenario continues with the
/// door, which people and lasers still notice.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_envgen::prelude::*;
///
/// fn close_all(mut doors: Query<&mut Door>) {
///     for mut door in &mut doors {
///         door.close();
///     }
/// }
/// # let mut app = bevy_envgen::testing::test_app();
/// # let doors = ScenarioSpec { doors: 1.0, door_control: DoorControl::Commanded, ..default() };
/// # let environment = Environment::new(IndoorSpec::default(), 4);
/// # app.world_mut().spawn((environment, EnvironmentScenario::new(doors, 1)));
/// # app.update();
/// # bevy::ecs::system::RunSystemOnce::run_system_once(app.world_mut(), close_all).unwrap();
/// # bevy_envgen::testing::step(&mut app, 70);
/// # let mut doors = app.world_mut().query::<&Door>();
/// # assert!(doors.iter(app.world()).count() > 5);
/// # assert!(doors.iter(app.world()).all(|door| door.openness() == 0.0));
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Door {
    pub(super) index: u32,
    pub(super) doorway: u32,
    pub(super) openness: f64,
    pub(super) opens: bool,
    pub(super) stopped: u64,
    #[reflect(ignore)]
    pub(super) command: Option<DoorCommand>,
}

impl Door {
    /// Starts to open the door in the next step. This takes at most 1 s.
    pub fn open(&mut self) {
        self.command = Some(DoorCommand::Open);
    }

    /// Starts to close the door in the next step. This takes at most 1 s. The door opens again if an agent or
    /// a person is in front of its leaves.
    pub fn close(&mut self) {
        self.command = Some(DoorCommand::Close);
    }

    /// Starts to slam the door shut in the next step. This takes at most 0.15 s.
    pub fn slam(&mut self) {
        self.command = Some(DoorCommand::Slam);
    }

    /// Returns the index of the door in [`Scenario::doors`](envgen::scenario::Scenario::doors).
    pub fn index(&self) -> u32 {
        self.index
    }

    /// Returns the index of its doorway in [`World::doorways`](envgen::World::doorways).
    pub fn doorway(&self) -> u32 {
        self.doorway
    }

    /// Returns how far the door is open, from 0 (closed) to 1 (fully open).
    pub fn openness(&self) -> f64 {
        self.openness
    }

    /// Returns whether the door is open or opening.
    pub fn opens(&self) -> bool {
        self.opens
    }

    /// Returns how often an agent or a person has stopped the door while it was closing.
    pub fn stopped(&self) -> u64 {
        self.stopped
    }
}

/// A component of a leaf of a [`Door`], on a child of the door. The leaf is a line along +x of its
/// [`Transform`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct DoorLeaf {
    /// The length in metres. For a sliding leaf it is the length outside of the wall, which is 0 if the leaf
    /// is completely inside.
    pub length: f32,
}

/// A component of a place where smoke can be, on a child of the environment. Where places overlap, their
/// extinction coefficients add up.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Smoke {
    /// The index in [`ScenarioState::smoke`](envgen::scenario::ScenarioState::smoke).
    pub index: u32,
    /// The extinction coefficient in 1/m.
    pub extinction: f64,
}

/// A change of a door.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DoorChange {
    /// The door is fully open.
    Opened,
    /// The door is closed.
    Closed,
    /// The door met an agent or a person while it was closing, and opens again.
    Blocked,
}

/// An event that is triggered on a [`Door`], and written as a message, when the door has fully opened or
/// closed, or was blocked.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct DoorChanged {
    /// The door.
    pub entity: Entity,
    /// The change.
    pub change: DoorChange,
}

/// An event that is triggered on a [`Person`], and written as a message, when a reaction to an agent begins
/// or ends.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct PersonReacted {
    /// The person.
    pub entity: Entity,
    /// Whether the reaction begins, or else ends.
    pub begins: bool,
}
