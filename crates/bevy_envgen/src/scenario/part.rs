//! The entities of a scenario.

use bevy::prelude::*;
use envgen::scenario::DoorCommand;

/// A person of a scenario, a child of its environment. It is moved by the scenario: changes of its [`Transform`]
/// are overwritten.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Person {
    /// The index in [`Scenario::people`](envgen::scenario::Scenario::people).
    pub index: u32,
    /// Velocity in m/s, in the environment's frame.
    pub velocity: Vec2,
    /// Whether the person reacts to an agent.
    pub reacts: bool,
}

/// A door of a scenario, a child of its environment. Its leaves are its children, with [`DoorLeaf`].
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
    /// Starts to open it in the next step; takes at most 1 s.
    pub fn open(&mut self) {
        self.command = Some(DoorCommand::Open);
    }

    /// Starts to close it in the next step; takes at most 1 s. It opens again if an agent or a person is in front of
    /// its leaves.
    pub fn close(&mut self) {
        self.command = Some(DoorCommand::Close);
    }

    /// Starts to slam it shut in the next step; takes at most 0.15 s.
    pub fn slam(&mut self) {
        self.command = Some(DoorCommand::Slam);
    }

    /// The index in [`Scenario::doors`](envgen::scenario::Scenario::doors).
    pub fn index(&self) -> u32 {
        self.index
    }

    /// The index of its doorway in [`World::doorways`](envgen::World::doorways).
    pub fn doorway(&self) -> u32 {
        self.doorway
    }

    /// How far it is open: 0 is closed, 1 is open.
    pub fn openness(&self) -> f64 {
        self.openness
    }

    /// Whether it is open or opening.
    pub fn opens(&self) -> bool {
        self.opens
    }

    /// How often an agent or a person stopped it while it closed.
    pub fn stopped(&self) -> u64 {
        self.stopped
    }
}

/// A leaf of a [`Door`], a child of it: a line along +x of its [`Transform`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct DoorLeaf {
    /// Length in metres: of a sliding leaf what is outside of the wall, 0 where nothing is left.
    pub length: f32,
}

/// A place where smoke can be, a child of its environment. Where places overlap, their extinctions add up.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Smoke {
    /// The index in [`ScenarioState::smoke`](envgen::scenario::ScenarioState::smoke).
    pub index: u32,
    /// The extinction coefficient in 1/m.
    pub extinction: f64,
}

/// What a door did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DoorChange {
    /// It is fully open.
    Opened,
    /// It is closed.
    Closed,
    /// It met an agent or a person while it closed, and opens again.
    Blocked,
}

/// Triggered on a [`Door`], and written as a message, when it has fully opened or closed, or was blocked.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct DoorChanged {
    /// The door.
    pub entity: Entity,
    /// What it did.
    pub change: DoorChange,
}

/// Triggered on a [`Person`], and written as a message, when a reaction to an agent begins or ends.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct PersonReacted {
    /// The person.
    pub entity: Entity,
    /// Whether it begins.
    pub begins: bool,
}
