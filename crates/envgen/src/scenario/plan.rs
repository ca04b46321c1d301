//! Scenarios: the doors, people and smoke of a world.

use ron::ser::PrettyConfig;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::doors::{DoorShape, place_doors};
use super::people::{FreeSpace, place_people};
use super::smoke::place_smoke;
use super::spec::MAX_SMOKE_SOURCES;
use super::{Door, MAX_PEOPLE, PERSON_RADIUS, Person, ScenarioSpec};
use crate::error::SpecError;
use crate::scenario::smoke::SmokeSource;
use crate::seed::Seed;
use crate::world::World;

/// The moving elements of a world, and their properties.
///
/// Its lists may be edited; [`ScenarioState::new`](super::ScenarioState::new) checks them against the world.
///
/// ```
/// use envgen::scenario::{Scenario, ScenarioSpec, ScenarioState};
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
///
/// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
/// let spec = ScenarioSpec { people: 3, ..Default::default() };
/// let mut scenario = Scenario::new(&world, &spec, Seed(1))?;
/// // One of the three people runs, and another is left out.
/// scenario.people[0].speed = 2.5;
/// scenario.people.pop();
/// assert_eq!(ScenarioState::new(&world, &scenario)?.people().len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// The seed from which everything random follows.
    pub seed: Seed,
    /// The settings with which the scenario was drawn. Those of single doors, people and sources are in their lists.
    pub settings: ScenarioSpec,
    /// The doors.
    pub doors: Vec<Door>,
    /// The people.
    pub people: Vec<Person>,
    /// The sources of smoke.
    pub smoke: Vec<SmokeSource>,
}

/// The reasons why a scenario could not be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ScenarioFileError {
    /// The text is not the RON of a scenario.
    #[error("not the RON of a scenario, at {0}")]
    Ron(Box<ron::error::SpannedError>),
    /// The scenario cannot be written as RON.
    #[error("the scenario cannot be written as RON: {0}")]
    WriteRon(Box<ron::Error>),
    /// A setting is not allowed.
    #[error(transparent)]
    Setting(#[from] SpecError),
}

impl Scenario {
    /// Draws the scenario of a spec in a world.
    ///
    /// # Errors
    /// When a setting is out of range, and when the world has no open doorway for doors, or not enough free space
    /// for the people or the smoke.
    pub fn new(world: &World, spec: &ScenarioSpec, seed: Seed) -> Result<Self, SpecError> {
        spec.validate()?;
        let doors = place_doors(world, spec, seed)?;
        let shapes = shapes(world, &doors);
        let people = place_people(world, &shapes, spec, seed)?;
        let smoke = place_smoke(world, spec, seed)?;
        Ok(Scenario { seed, settings: spec.clone(), doors, people, smoke })
    }

    /// Returns the scenario as RON.
    ///
    /// # Errors
    /// When a number cannot be written.
    pub fn to_ron(&self) -> Result<String, ScenarioFileError> {
        let layout = PrettyConfig::new().depth_limit(2).indentor("  ").new_line("\n");
        let text = ron::ser::to_string_pretty(self, layout);
        text.map(|text| text + "\n").map_err(|error| ScenarioFileError::WriteRon(Box::new(error)))
    }

    /// Reads a scenario from RON. Fields that are absent have the usual values.
    ///
    /// ```
    /// use envgen::scenario::{DoorControl, Scenario};
    ///
    /// let text = "(doors: [(doorway: 2, kind: hinged)], people: [(position: (4.0, 7.5))])";
    /// let scenario = Scenario::from_ron(text)?;
    /// assert_eq!((scenario.doors[0].control, scenario.doors[0].open), (DoorControl::Timed, 20.0));
    /// assert_eq!(scenario.people[0].speed, 1.34);
    /// # Ok::<(), envgen::scenario::ScenarioFileError>(())
    /// ```
    ///
    /// # Errors
    /// When the text is not the RON of a scenario, or when a setting is out of range.
    pub fn from_ron(text: &str) -> Result<Self, ScenarioFileError> {
        let scenario: Scenario = ron::Options::default()
            .with_recursion_limit(128)
            .from_str(text)
            .map_err(|error| ScenarioFileError::Ron(Box::new(error)))?;
        scenario.settings.validate()?;
        Ok(scenario)
    }

    /// Returns a note for the user if nothing moves although the settings ask for something, as in a file whose lists
    /// were left out.
    ///
    /// ```
    /// use envgen::scenario::Scenario;
    ///
    /// let scenario = Scenario::from_ron("(settings: (people: 4))")?;
    /// assert!(scenario.note().is_some_and(|note| note.starts_with("nothing moves")));
    /// assert_eq!(Scenario::default().note(), None);
    /// # Ok::<(), envgen::scenario::ScenarioFileError>(())
    /// ```
    pub fn note(&self) -> Option<&'static str> {
        let Scenario { settings, doors, people, smoke, .. } = self;
        let is_empty = doors.is_empty() && people.is_empty() && smoke.is_empty();
        (is_empty && !settings.is_still()).then_some(
            "nothing moves, since the lists `doors`, `people` and `smoke` are empty; `settings` alone draw nothing",
        )
    }

    /// Checks the doors, the smoke and the number of people against a world.
    pub(super) fn check(&self, world: &World) -> Result<(), SpecError> {
        self.settings.validate()?;
        let mut doors = vec![None; world.doorways.len()];
        for (i, door) in self.doors.iter().enumerate() {
            let part = format!("doors[{i}]");
            door.check(world).map_err(|error| error.within(&part))?;
            if let Some(other) = doors[door.doorway as usize].replace(i) {
                let allowed = format!("a doorway without a door: doors[{other}] is in it");
                return Err(SpecError::new("doorway", door.doorway, allowed).within(&part));
            }
        }
        if self.smoke.len() > MAX_SMOKE_SOURCES as usize {
            return Err(ScenarioSpec::setting("smoke_sources").error(self.smoke.len()));
        }
        for (i, source) in self.smoke.iter().enumerate() {
            source.check(world).map_err(|error| error.within(&format!("smoke[{i}]")))?;
        }
        if self.people.len() > MAX_PEOPLE as usize {
            return Err(ScenarioSpec::setting("people").error(self.people.len()));
        }
        Ok(())
    }

    /// Checks the people against the free space, the doors and each other.
    pub(super) fn check_people(
        &self,
        space: &FreeSpace,
        doors: &[DoorShape],
    ) -> Result<(), SpecError> {
        for (i, person) in self.people.iter().enumerate() {
            let part = || format!("people[{i}]");
            person.check(space).map_err(|error| error.within(&part()))?;
            let p = person.position;
            let is_in = |door: &DoorShape| door.swing_distance(p) < PERSON_RADIUS;
            let least = 4.0 * PERSON_RADIUS * PERSON_RADIUS;
            let is_met = |other: &Person| other.position.distance_squared(p) < least;
            let allowed = if let Some(door) = doors.iter().position(is_in) {
                format!("a point out of reach of the leaves: doors[{door}] comes there")
            } else if let Some(other) = self.people[..i].iter().position(is_met) {
                format!(
                    "a point {} m from other people: people[{other}] is nearer",
                    2.0 * PERSON_RADIUS
                )
            } else {
                continue;
            };
            return Err(SpecError::new("position", p, allowed).within(&part()));
        }
        Ok(())
    }
}

/// Returns the shapes of doors that were checked.
pub(super) fn shapes(world: &World, doors: &[Door]) -> Vec<DoorShape> {
    let doorway = |door: &Door| world.doorways.get(door.doorway as usize);
    doors.iter().filter_map(|door| Some(DoorShape::new(door, doorway(door)?))).collect()
}
