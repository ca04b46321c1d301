//! People: where they go, how they avoid each other, and how they react to a robot.

use std::f64::consts::PI;
use std::sync::Arc;

mod crowd;
mod door_passage;
mod free_path;
mod free_space;
mod goals;
mod held_up;
mod orca;
mod places;
mod quiet;
mod routes;
mod sights;
mod surroundings;

pub(super) use crowd::Crowd;
pub(super) use free_space::{FreeSpace, REACH};
pub(super) use places::find_places;
pub(super) use routes::Routes;
pub(super) use surroundings::{Surroundings, ZONE};

use crate::clearance_index::ClearanceIndex;
use crate::distribution::standard_normal;
use crate::error::SpecError;
use crate::placement::pose_of_most_clearance;
use crate::scenario::doors::DoorShape;
use crate::scenario::person::{MAX_SPEED, PERSON_RADIUS, Person, Reaction};
use crate::scenario::spec::{Reactions, ScenarioSpec};
use crate::seed::Seed;
use crate::world::World;

/// Draws the people of a world.
pub(super) fn place_people(
    world: &World,
    doors: &[DoorShape],
    spec: &ScenarioSpec,
    seed: Seed,
) -> Result<Vec<Person>, SpecError> {
    let needed = spec.people as usize;
    if needed == 0 {
        return Ok(Vec::new());
    }
    let index = Arc::new(ClearanceIndex::new(world, REACH)?);
    let space = FreeSpace::new(world, doors, index);
    // Without a start, robots of this project's programs start where there is most room.
    let in_the_open = || pose_of_most_clearance(world).ok().flatten();
    let start = world.start.or_else(in_the_open).map(|start| start.position);
    let places = find_places(&space, world, doors, seed, (needed, needed), start);
    if places.len() < needed {
        return Err(FreeSpace::too_many(needed, places.len()));
    }
    let person = |(i, &position)| {
        let mut stream = seed.stream("scenario/people", i);
        let factor = (1.0 + 0.2 * standard_normal(&mut stream)).clamp(0.5, 1.5);
        Person {
            position,
            heading: stream.between(-PI, PI),
            speed: (spec.walking_speed * factor).min(MAX_SPEED),
            reaction: spec.reaction.reaction(stream.below(5)),
        }
    };
    Ok((0_u64..).zip(&places).map(person).collect())
}

impl Reactions {
    /// Returns the reaction of a person for a drawn number from 0 to 4.
    fn reaction(self, draw: u64) -> Reaction {
        const ALL: [Reaction; 5] = [
            Reaction::Regular,
            Reaction::Surprised,
            Reaction::Curious,
            Reaction::Scared,
            Reaction::Impassive,
        ];
        match self {
            Reactions::Regular => Reaction::Regular,
            Reactions::Surprised => Reaction::Surprised,
            Reactions::Curious => Reaction::Curious,
            Reactions::Scared => Reaction::Scared,
            Reactions::Impassive => Reaction::Impassive,
            Reactions::Mixed => ALL[draw as usize % ALL.len()],
        }
    }
}

impl Person {
    /// Checks the person against the world, other people and doors.
    ///
    /// # Errors
    /// When the person is not in free space, and when the speed is out of range.
    pub(super) fn check(&self, space: &FreeSpace) -> Result<(), SpecError> {
        if !(0.05..=MAX_SPEED).contains(&self.speed) {
            let allowed = format!("a number from 0.05 to {MAX_SPEED}");
            return Err(SpecError::new("speed", self.speed, allowed));
        }
        if !self.heading.is_finite() {
            return Err(SpecError::new("heading", self.heading, "a finite number"));
        }
        // Beyond the world, and at NaN, nothing is known of solids.
        let is_inside = space.frame.index_at(self.position).is_some();
        if !is_inside || !space.fits(self.position) {
            let allowed = format!("a point with {PERSON_RADIUS} m of free space around it");
            return Err(SpecError::new("position", self.position, allowed));
        }
        Ok(())
    }
}
