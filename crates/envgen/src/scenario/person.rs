//! People, and their reactions to robots.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::geometry::unit_vector;
use crate::scenario::spec::ScenarioSpec;

/// Radius in metres of the disc that a person occupies.
pub const PERSON_RADIUS: f64 = 0.25;

/// Radius in metres of a leg, as a laser sees it.
pub const LEG_RADIUS: f64 = 0.07;

/// The greatest speed of a person in m/s.
pub(super) const MAX_SPEED: f64 = 3.0;

/// A person of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Person {
    /// The initial position, in metres.
    pub position: DVec2,
    /// The initial direction in which the person looks, in radians.
    #[serde(default)]
    pub heading: f64,
    /// Walking speed in m/s.
    #[serde(default = "usual_speed")]
    pub speed: f64,
    /// The person's reaction to a robot.
    #[serde(default = "usual_reaction")]
    pub reaction: Reaction,
}

fn usual_speed() -> f64 {
    ScenarioSpec::default().walking_speed
}

fn usual_reaction() -> Reaction {
    Reaction::Regular
}

/// The reaction of a person to a robot that is near and in sight. The numbers are those of `HuNavSim`
/// (Pérez-Higueras et al., <https://arxiv.org/abs/2305.01303>).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reaction {
    /// The person treats the robot like another person, and expects it to avoid collisions as well.
    Regular,
    /// The person stops and looks at a robot within 4 m for 30 s.
    Surprised,
    /// The person approaches a robot within 10 m up to 1.5 m, for 30 s, and slows down when nearer.
    Curious,
    /// The person moves away from a robot within 3 m at 0.6 m/s, for 40 s.
    Scared,
    /// The person treats the robot as an obstacle, and does not expect it to avoid collisions.
    Impassive,
}

impl Reaction {
    /// Returns the distance of a robot in metres at which a person reacts, and the duration of the reaction in seconds.
    pub(super) fn trigger(self) -> Option<(f64, f64)> {
        match self {
            Reaction::Regular | Reaction::Impassive => None,
            Reaction::Surprised => Some((4.0, 30.0)),
            Reaction::Curious => Some((10.0, 30.0)),
            Reaction::Scared => Some((3.0, 40.0)),
        }
    }

    /// Returns the velocity of a person who reacts to a robot, given the vector to it.
    pub(super) fn velocity(self, to_robot: DVec2) -> DVec2 {
        const STOP: f64 = 1.5;
        let distance = to_robot.length();
        let direction = to_robot.normalize_or_zero();
        match self {
            Reaction::Curious if distance > STOP => {
                direction * (MAX_CURIOUS * distance.min(10.0) / 10.0)
            }
            Reaction::Scared => direction * -SCARED_SPEED,
            _ => DVec2::ZERO,
        }
    }

    /// Returns the greatest speed in m/s of a person who reacts to a robot.
    pub(super) fn max_speed(self) -> f64 {
        match self {
            Reaction::Curious => MAX_CURIOUS,
            Reaction::Scared => SCARED_SPEED,
            _ => 0.0,
        }
    }
}

/// Half the distance between the centres of a person's legs, in metres.
const LEG_OFFSET: f64 = 0.15;

/// The greatest speed of a curious person, and the speed of a scared one, in m/s.
const MAX_CURIOUS: f64 = 1.8;
const SCARED_SPEED: f64 = 0.6;

/// The state of a person: position, velocity and activity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PersonState {
    /// Position in metres.
    pub position: DVec2,
    /// Velocity in m/s.
    pub velocity: DVec2,
    /// Unit vector in the direction in which the person looks.
    pub facing: DVec2,
    pub(super) task: Task,
    /// The corners of the path, with the last one first.
    pub(super) path: Vec<DVec2>,
    /// The place to which the path leads, or at which the person is.
    pub(super) place: Option<u32>,
    /// Number of goals that were drawn.
    pub(super) draws: u64,
    /// Whether the line to the next corner is known to be clear of solids.
    pub(super) on_path: bool,
    /// Number of steps with the current velocity until the next corner.
    pub(super) steps_left: u32,
    /// Position and tick at which the person last made progress.
    pub(super) moved: (DVec2, u64),
    /// The point to which the person steps aside for the leaf of a door that is about to open.
    pub(super) aside: Option<DVec2>,
    /// The position at which others held the person up, and how often.
    pub(super) held_up: (DVec2, u32),
    /// Whether the person no longer reacts, which is set after a reaction until the robot is away.
    pub(super) is_used_to_robot: bool,
}

/// The activity of a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Task {
    /// The person works or waits until a tick.
    Stand { until: u64 },
    /// The person walks along the path.
    Walk,
    /// The person reacts to a robot until a tick.
    React { until: u64 },
}

impl PersonState {
    pub(super) fn new(person: &Person, until: u64) -> Self {
        PersonState {
            position: person.position,
            velocity: DVec2::ZERO,
            facing: unit_vector(person.heading),
            task: Task::Stand { until },
            path: Vec::new(),
            place: None,
            draws: 0,
            on_path: false,
            steps_left: 0,
            moved: (person.position, 0),
            aside: None,
            held_up: (person.position, 0),
            is_used_to_robot: false,
        }
    }

    /// Returns whether the person is walking to a place.
    pub fn is_walking(&self) -> bool {
        self.task == Task::Walk
    }

    /// Returns whether the person reacts to a robot.
    pub fn is_reacting(&self) -> bool {
        matches!(self.task, Task::React { .. })
    }

    /// Returns the remaining corners of the path in metres, with the last one first; empty for a person who does
    /// not walk.
    pub fn path(&self) -> &[DVec2] {
        &self.path
    }

    /// Returns the centres of the legs, in metres. They are beside each other, across the direction in which the
    /// person looks.
    pub fn legs(&self) -> [DVec2; 2] {
        let aside = self.facing.perp() * LEG_OFFSET;
        [self.position + aside, self.position - aside]
    }
}

/// Returns the greatest speed that any of these people can have, in m/s.
pub(crate) fn max_speed(people: &[Person]) -> f64 {
    let speed = |person: &Person| person.speed.max(person.reaction.max_speed());
    people.iter().map(speed).fold(0.0, f64::max)
}
