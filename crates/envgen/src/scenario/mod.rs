//! Moving elements of a [`World`](crate::World): doors, people and smoke.
//!
//! A [`ScenarioSpec`] and a seed give a [`Scenario`], which lists the doors, people and sources of smoke of a
//! world. It can be edited, and is stored as a RON file. A [`ScenarioState`] runs it in steps of 1/20 s, with the
//! same result on every platform, however often it is queried. It needs no simulator: its only input are the true
//! poses of the robots, and its output are rays, clearances and contacts with everything.
//!
//! ```
//! use envgen::scenario::{Scenario, ScenarioSpec, ScenarioState, Target};
//! use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
//!
//! let world = IndoorSpec::default().generate(Seed(7))?.to_world();
//! let spec = ScenarioSpec { doors: 0.5, people: 4, smoke: 0.2, ..Default::default() };
//! let scenario = Scenario::new(&world, &spec, Seed(1))?;
//! let mut state = ScenarioState::new(&world, &scenario)?;
//! // A minute without a robot.
//! state.step(60.0, &[])?;
//! let person = &state.people()[0];
//! let hit = state.cast(person.position - person.facing, person.facing, 8.0);
//! assert!(hit.is_some_and(|hit| hit.distance <= 0.75 + 1e-9));
//! assert_eq!(Scenario::from_ron(&scenario.to_ron()?)?, scenario);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//!
//! - Doors are in open doorways. A doorway that is closed in the world remains closed. The leaf of a door has no
//!   thickness.
//! - People are discs of radius [`PERSON_RADIUS`] for everything except a laser. They walk where such a disc fits,
//!   on a grid of 0.2 m that is coarser in worlds of more than 41,000 square metres.
//! - Smoke has one density in each room, and one in all hallways and open areas together.

mod access;
mod bodies;
mod door_graph;
mod doors;
mod interpolation;
mod neighbourhood;
mod people;
mod person;
mod plan;
mod robot;
mod rooms;
pub mod smoke;
mod spec;
mod state;
mod tick;
mod view;

pub use access::BehindDoor;
pub use bodies::LEAF_THICKNESS;
pub use doors::{Door, DoorCommand, DoorKind, DoorState, GivenDoorCommand, Leaf};
pub use person::{LEG_RADIUS, PERSON_RADIUS, Person, PersonState, Reaction};
pub use plan::{Scenario, ScenarioFileError};
pub use robot::Robot;
pub use spec::{
    Body, DoorControl, DoorKinds, FailedBeams, MAX_PEOPLE, Reactions, ScenarioSpec, SmokeKind,
    SmokeProfile,
};
pub use state::ScenarioState;
pub use tick::TICKS_PER_SECOND;
pub use view::{MovingContact, MovingHit, MovingShape, Target};
