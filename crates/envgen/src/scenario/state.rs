//! The state of a running scenario.

use std::sync::Arc;

use glam::DVec2;

use super::doors::{Bodies, DoorClock, DoorCommand, DoorShape, DoorState, GivenDoorCommand};
use super::neighbourhood::{Neighbourhood, drift};
use super::people::{Crowd, FreeSpace, REACH, Routes, Surroundings, ZONE, find_places};
use super::person::{PERSON_RADIUS, Person, PersonState, max_speed};
use super::plan::shapes;
use super::robot::Robot;
use super::smoke::{SmokeField, SmokeRegions};
use super::tick::TICK;
use super::{Door, Leaf, Scenario, ScenarioSpec};
use crate::clearance_index::ClearanceIndex;
use crate::error::SpecError;
use crate::geometry::Rect;
use crate::grid::{CellBuckets, Convex};
use crate::raycast::Raycaster;
use crate::seed::Seed;
use crate::world::{Digest, World};

/// Tolerance in seconds of the time at which a tick is due, so that the rounding of small steps does not delay it.
const ROUNDING: f64 = 1e-6;

/// The greatest step in seconds.
const MAX_STEP: f64 = 86_400.0;

/// The number of ticks after which smoke spreads.
const SPREAD: u64 = 10;

/// The greatest number of places to which people go.
const MAX_PLACES: usize = 1 << 14;

/// The state of a scenario at a point in time.
///
/// A copy continues on its own. All copies share the indices of the world.
#[derive(Clone, Debug)]
pub struct ScenarioState {
    pub(super) scene: Arc<Scene>,
    tick: u64,
    /// Seconds since the last tick. The rounding of the seconds since the start would grow with time.
    since_tick: f64,
    pub(super) doors: Vec<DoorState>,
    /// The commands of the last tick, and those given since.
    commands: Vec<GivenDoorCommand>,
    pub(super) crowd: Crowd,
    pub(super) smoke: SmokeField,
}

/// The constant data of a scenario.
#[derive(Debug)]
pub(super) struct Scene {
    pub(super) settings: ScenarioSpec,
    seed: Seed,
    bounds: Rect,
    pub(super) doors: Vec<Door>,
    pub(super) shapes: Vec<DoorShape>,
    /// For each doorway, its door.
    door_of: Vec<Option<usize>>,
    people: Vec<Person>,
    max_speed: f64,
    pub(super) rays: Raycaster,
    pub(super) index: Arc<ClearanceIndex>,
    pub(super) smoke: SmokeRegions,
    walk: Option<Walk>,
}

/// The data that people need.
#[derive(Debug)]
struct Walk {
    space: FreeSpace,
    routes: Routes,
    door_zones: CellBuckets<u32>,
    near_doors: CellBuckets<u32>,
}

impl Walk {
    fn new(
        world: &World,
        scenario: &Scenario,
        shapes: &[DoorShape],
        index: &Arc<ClearanceIndex>,
    ) -> Result<Self, SpecError> {
        let space = FreeSpace::new(world, shapes, Arc::clone(index));
        scenario.check_people(&space, shapes)?;
        let people = scenario.people.len();
        let most = (2 * people + 16).min(MAX_PLACES);
        let places = find_places(&space, world, shapes, scenario.seed, (most, most), None);
        let numbers: Vec<u32> = (0..shapes.len() as u32).collect();
        let zones = |margin: f64| {
            CellBuckets::build(&space.frame, &numbers, None, |&i, frame, visit| {
                let door = &shapes[i as usize];
                let reach = door.reach() + PERSON_RADIUS + margin;
                frame.touched_runs(&Convex::Disc(door.middle(), reach), visit);
            })
            .unwrap_or_else(|| unreachable!("there is no limit"))
        };
        let door_zones = zones(ZONE);
        let near_doors = zones(ZONE + drift(max_speed(&scenario.people)));
        let routes = Routes::new(places, &space);
        Ok(Walk { space, routes, door_zones, near_doors })
    }
}

impl ScenarioState {
    /// Creates the state of a scenario at its start in a world.
    ///
    /// # Errors
    /// When the scenario does not fit the world: a door without an open doorway, a person without free space, a
    /// source of smoke without its room, or a number out of range. The error names the item, such as
    /// `people[3].position`.
    pub fn new(world: &World, scenario: &Scenario) -> Result<Self, SpecError> {
        scenario.check(world)?;
        let shapes = shapes(world, &scenario.doors);
        let index = Arc::new(ClearanceIndex::new(world, REACH)?);
        let walk = match scenario.people.is_empty() {
            true => None,
            false => Some(Walk::new(world, scenario, &shapes, &index)?),
        };
        let mut door_of = vec![None; world.doorways.len()];
        for (i, door) in scenario.doors.iter().enumerate() {
            door_of[door.doorway as usize] = Some(i);
        }
        let scene = Scene {
            settings: scenario.settings.clone(),
            seed: scenario.seed,
            bounds: world.bounds,
            doors: scenario.doors.clone(),
            shapes,
            door_of,
            people: scenario.people.clone(),
            max_speed: max_speed(&scenario.people),
            rays: Raycaster::new(world),
            index,
            smoke: SmokeRegions::new(world, &scenario.smoke, scenario.settings.smoke_leak),
            walk,
        };
        Ok(ScenarioState::start(Arc::new(scene)))
    }

    fn start(scene: Arc<Scene>) -> Self {
        let doors = scene.doors.iter();
        let doors: Vec<DoorState> =
            doors.map(|door| DoorState::new(door, &scene.clock(door, 0))).collect();
        let near = Neighbourhood::new(scene.bounds, scene.people.len(), scene.max_speed);
        let places = scene.walk.as_ref().map_or(0, |walk| walk.routes.places.len());
        let crowd = Crowd::new(&scene.people, places, (&scene.settings, scene.seed), near, &doors);
        let smoke = scene.smoke.start();
        ScenarioState { scene, tick: 0, since_tick: 0.0, doors, commands: Vec::new(), crowd, smoke }
    }

    /// Returns the same scenario at its start.
    ///
    /// ```
    /// use envgen::scenario::{Scenario, ScenarioSpec, ScenarioState};
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
    /// let spec = ScenarioSpec { doors: 1.0, ..Default::default() };
    /// let mut state = ScenarioState::new(&world, &Scenario::new(&world, &spec, Seed(1))?)?;
    /// let first = state.digest();
    /// state.step(30.0, &[])?;
    /// assert_ne!(state.digest(), first);
    /// assert_eq!(state.restarted().digest(), first);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn restarted(&self) -> Self {
        ScenarioState::start(Arc::clone(&self.scene))
    }

    /// Continues by `dt` seconds, from 0 to a day, with robots at their true positions. Everything moves in whole
    /// ticks: several short steps give the same result as a long one, to the bit, if the robots are the same.
    ///
    /// ```
    /// use envgen::scenario::{Robot, Scenario, ScenarioSpec, ScenarioState};
    /// use envgen::{Blueprint, Seed, Spec, glam::DVec2, indoor::IndoorSpec};
    ///
    /// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
    /// let spec = ScenarioSpec { people: 4, ..Default::default() };
    /// let mut state = ScenarioState::new(&world, &Scenario::new(&world, &spec, Seed(1))?)?;
    /// let mut other = state.clone();
    /// let position = world.start.expect("a start").position;
    /// let robot = Robot { position, velocity: DVec2::ZERO, radius: 0.36 };
    /// state.step(2.0, &[robot])?;
    /// assert_eq!(state.tick(), 40);
    /// // Many short steps are as a long one.
    /// for _ in 0..80 {
    ///     other.step(0.025, &[robot])?;
    /// }
    /// assert_eq!(other.digest(), state.digest());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When `dt` is out of range, or when a number of a robot is not finite or its radius is negative. Then nothing
    /// moves.
    pub fn step(&mut self, dt: f64, robots: &[Robot]) -> Result<(), SpecError> {
        if !(0.0..=MAX_STEP).contains(&dt) {
            return Err(SpecError::new("dt", dt, format!("a number from 0 to {MAX_STEP}")));
        }
        for (i, robot) in robots.iter().enumerate() {
            robot.check().map_err(|error| error.within(&format!("robots[{i}]")))?;
        }
        let (before, elapsed) = (self.tick, self.since_tick + dt);
        while (self.tick - before + 1) as f64 * TICK <= elapsed + ROUNDING {
            let last = self.tick;
            self.commands.retain(|given| given.tick == last);
            self.tick += 1;
            self.advance(robots);
        }
        self.since_tick = elapsed - (self.tick - before) as f64 * TICK;
        Ok(())
    }

    fn advance(&mut self, robots: &[Robot]) {
        let scene = &*self.scene;
        let bodies = Bodies { people: &self.crowd.people, near: &self.crowd.near, robots };
        for ((door, shape), state) in scene.doors.iter().zip(&scene.shapes).zip(&mut self.doors) {
            state.step(door, shape, &scene.clock(door, self.tick), &bodies);
        }
        if let Some(around) = scene.surroundings(&self.doors, robots, self.tick) {
            self.crowd.step(&around);
        }
        if !scene.smoke.is_empty() && self.tick.is_multiple_of(SPREAD) {
            let doors = &self.doors;
            let openness =
                |doorway: usize| scene.door_of[doorway].map_or(1.0, |door| doors[door].openness);
            let time = (self.tick as f64 * TICK, SPREAD as f64 * TICK);
            scene.smoke.spread(&mut self.smoke, time, openness);
        }
    }

    /// Returns the settings of the scenario.
    pub fn settings(&self) -> &ScenarioSpec {
        &self.scene.settings
    }

    /// Returns whether there is any smoke.
    pub fn has_smoke(&self) -> bool {
        !self.scene.smoke.is_empty()
    }

    /// Returns the seconds since the start, which is the sum of all steps.
    pub fn time(&self) -> f64 {
        self.tick as f64 * TICK + self.since_tick
    }

    /// Returns the number of ticks since the start, of which there are
    /// [`TICKS_PER_SECOND`](super::TICKS_PER_SECOND) per second.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Returns the states of the doors, in the order of the scenario.
    pub fn doors(&self) -> &[DoorState] {
        &self.doors
    }

    /// Opens, closes or slams a door. The motion begins with the next tick, and stops at bodies as always. Logs of
    /// trials contain the commands that [`ScenarioState::door_commands`] lists.
    ///
    /// ```
    /// use envgen::scenario::{DoorCommand, DoorControl, Scenario, ScenarioSpec, ScenarioState};
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
    /// let spec = ScenarioSpec {
    ///     doors: 1.0,
    ///     door_control: DoorControl::Commanded,
    ///     ..Default::default()
    /// };
    /// let mut state = ScenarioState::new(&world, &Scenario::new(&world, &spec, Seed(1))?)?;
    /// state.command_door(0, DoorCommand::Close)?;
    /// state.step(0.5, &[])?;
    /// assert!((state.doors()[0].openness - 0.5).abs() < 1e-9);
    /// // The command was given before an earlier tick than the last one.
    /// assert_eq!(state.door_commands(), []);
    /// assert!(state.command_door(1000, DoorCommand::Open).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the door does not exist.
    pub fn command_door(&mut self, door: usize, command: DoorCommand) -> Result<(), SpecError> {
        match self.doors.get_mut(door) {
            Some(state) => {
                let before = *state;
                state.obey(command, &self.scene.doors[door], self.tick);
                if *state != before {
                    self.commands.push(GivenDoorCommand { tick: self.tick, door, command });
                }
                Ok(())
            }
            None => {
                let doors = self.doors.len();
                let allowed = format!("the index of one of the scenario's {doors} doors");
                Err(SpecError::new("door", door, allowed))
            }
        }
    }

    /// Returns the commands that doors carried out from the last tick on, and those given since, in the order in
    /// which they were given. Commands that change nothing, such as closing a door that is closing, are left out.
    pub fn door_commands(&self) -> &[GivenDoorCommand] {
        &self.commands
    }

    /// Returns the leaves of a door; no leaves for a door that does not exist.
    pub fn leaves(&self, door: usize) -> impl Iterator<Item = Leaf> + use<> {
        let shape = self.scene.shapes.get(door).zip(self.doors.get(door));
        shape.map(|(shape, state)| state.leaves(shape)).into_iter().flatten()
    }

    /// Returns the leaves of a door as they would be at an openness from 0 (closed) to 1 (open); no leaves for a
    /// door that does not exist.
    pub fn leaves_at(&self, door: usize, openness: f64) -> impl Iterator<Item = Leaf> + use<> {
        let openness = openness.clamp(0.0, 1.0);
        self.scene.shapes.get(door).map(|shape| shape.leaves(openness)).into_iter().flatten()
    }

    /// Returns the middle of the doorway of a door; the origin for a door that does not exist.
    pub fn doorway_middle(&self, door: usize) -> DVec2 {
        self.scene.shapes.get(door).map_or(DVec2::ZERO, DoorShape::middle)
    }

    /// Returns the leaves of all doors.
    pub fn all_leaves(&self) -> impl Iterator<Item = Leaf> + '_ {
        (0..self.doors.len()).flat_map(|door| self.leaves(door))
    }

    /// Returns the states of the people, in the order of the scenario.
    pub fn people(&self) -> &[PersonState] {
        &self.crowd.people
    }

    /// Returns a digest of everything that moves. If two digests are equal, everything is at the same position, to
    /// the bit.
    pub fn digest(&self) -> Digest {
        Digest::of(&(self.tick, &self.doors, &self.crowd.people, &self.smoke))
    }
}

impl Scene {
    fn clock(&self, door: &Door, tick: u64) -> DoorClock {
        DoorClock { seed: self.seed, doorway: u64::from(door.doorway), tick }
    }

    /// Returns the surroundings of people; `None` without people.
    pub(super) fn surroundings<'a>(
        &'a self,
        doors: &'a [DoorState],
        robots: &'a [Robot],
        tick: u64,
    ) -> Option<Surroundings<'a>> {
        let Walk { space, routes, door_zones, near_doors } = self.walk.as_ref()?;
        Some(Surroundings {
            space,
            routes,
            rays: &self.rays,
            shapes: &self.shapes,
            door_zones,
            near_doors,
            people: &self.people,
            spec: &self.settings,
            seed: self.seed,
            doors,
            robots,
            tick,
            max_speed: self.max_speed,
        })
    }
}
