//! Checks of what moves, at every step.

use envgen::glam::DVec2;
use envgen::scenario::{PERSON_RADIUS, Robot, ScenarioState, Target};

/// What was seen of a scenario.
#[derive(Default)]
pub(crate) struct Watch {
    /// Since when each person has been near a point while walking: the point, and the tick.
    anchors: Vec<(DVec2, u64)>,
    /// Seconds of walking of all people.
    pub(crate) walked: f64,
    /// Of these, seconds of standing.
    pub(crate) waited: f64,
    /// The longest time in seconds that someone walked without coming half a metre far.
    pub(crate) longest: f64,
    /// The greatest overlap of a person with anything in metres, and with what.
    pub(crate) overlap: (f64, String),
}

impl Watch {
    /// Looks at everyone; to be called after every tick.
    pub(crate) fn look(&mut self, state: &ScenarioState, robots: &[Robot]) {
        let people = state.people();
        self.anchors.resize(people.len(), (DVec2::INFINITY, 0));
        for (i, person) in people.iter().enumerate() {
            let p = person.position;
            let mut worst = (0.0, String::new());
            let mut meet = |distance: f64, least: f64, what: &dyn Fn() -> String| {
                if least - distance > worst.0 {
                    worst = (least - distance, what());
                }
            };
            state.contacts(p, PERSON_RADIUS, |contact| match contact.target {
                Target::Person(_) => {}
                target => meet(p.distance(contact.point), PERSON_RADIUS, &|| format!("{target:?}")),
            });
            for (j, other) in people.iter().enumerate().skip(i + 1) {
                meet(p.distance(other.position), 2.0 * PERSON_RADIUS, &|| format!("person {j}"));
            }
            for robot in robots {
                let least = PERSON_RADIUS + robot.radius;
                meet(p.distance(robot.position), least, &|| "a robot".to_owned());
            }
            if worst.0 > self.overlap.0 {
                let (overlap, what) = worst;
                self.overlap = (overlap, format!("person {i} and {what} at tick {}", state.tick()));
            }
            let anchor = &mut self.anchors[i];
            if !person.is_walking() || p.distance(anchor.0) > 0.5 {
                *anchor = (p, state.tick());
            }
            if person.is_walking() {
                self.walked += 0.05;
                self.waited += if person.velocity.length() < 0.05 { 0.05 } else { 0.0 };
            }
            self.longest = self.longest.max((state.tick() - anchor.1) as f64 * 0.05);
        }
    }
}
