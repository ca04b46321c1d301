//! Queries in a world with everything that moves: rays, clearances, contacts and smoke.

use glam::DVec2;

use super::smoke::{Laser, Reading, SmokePlace, Stretch};
use super::spec::Body;
use super::{LEG_RADIUS, Leaf, PERSON_RADIUS, ScenarioState};
use crate::geometry::Shape;
use crate::raycast::Hit;
use crate::seed::Stream;
use crate::world::PartId;

/// An upper bound, in metres, of the rounding error of a distance.
const ROUNDING: f64 = 1e-9;

/// The target that a ray or a robot meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A part of the world.
    Part(PartId),
    /// A leaf of the door with this index in the scenario.
    Leaf(u32),
    /// The person with this index in the scenario.
    Person(u32),
}

/// The first target that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingHit {
    /// Distance in metres; 0 for a ray that starts inside the target.
    pub distance: f64,
    /// The target.
    pub target: Target,
}

/// A target near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingContact {
    /// The target.
    pub target: Target,
    /// The target's point that is nearest to the query point; the query point itself if it lies inside the target.
    pub point: DVec2,
    /// Distance from the query point to `point`, in metres.
    pub distance: f64,
}

/// The shape of something that moves, as a laser sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MovingShape {
    /// The leaf of a door.
    Leaf(Leaf),
    /// A person, or a leg of a person.
    Disc {
        /// Centre in metres.
        center: DVec2,
        /// Radius in metres.
        radius: f64,
    },
}

impl MovingShape {
    /// Returns the distance along a ray in the direction of a unit vector, 0 inside the shape; `None` if the ray
    /// misses it.
    pub fn distance_along(&self, from: DVec2, direction: DVec2) -> Option<f64> {
        match *self {
            MovingShape::Leaf(leaf) => leaf.distance_along(from, direction),
            MovingShape::Disc { center, radius } => to_disc(from, direction, (center, radius)),
        }
    }
}

impl ScenarioState {
    /// Returns the first target that a ray in the direction of a unit vector meets within `max_range` metres,
    /// ignoring smoke. Returns `None` if it meets nothing, and for a negative range or NaN. Among targets at the
    /// same distance, a part of the world comes first, then a leaf.
    pub fn cast(&self, from: DVec2, direction: DVec2, max_range: f64) -> Option<MovingHit> {
        let part = self.scene.rays.cast_along(from, direction, max_range);
        let part = part.map(|Hit { distance, part }| (distance, Target::Part(part)));
        let mut best = part.map_or((max_range, None), |(distance, part)| (distance, Some(part)));
        let mut meet = |distance: Option<f64>, target: Target| {
            let is_first =
                |distance: &f64| *distance < best.0 || (*distance <= best.0 && best.1.is_none());
            if let Some(distance) = distance.filter(is_first) {
                best = (distance, Some(target));
            }
        };
        for (target, shape) in self.visible(from, max_range) {
            meet(shape.distance_along(from, direction), target);
        }
        best.1.map(|target| MovingHit { distance: best.0, target })
    }

    /// Returns the shapes of what moves within `max_range` metres of a point, as a laser sees them: leaves, then
    /// people. Shapes that are slightly farther away may be among them.
    pub fn visible(
        &self,
        from: DVec2,
        max_range: f64,
    ) -> impl Iterator<Item = (Target, MovingShape)> + '_ {
        let doors = (0..).zip(self.scene.shapes.iter().zip(&self.doors));
        let leaves = doors
            .filter(move |(_, (shape, _))| {
                let reach = shape.reach() + max_range;
                from.distance_squared(shape.middle()) <= reach * reach
            })
            .flat_map(|(door, (shape, state))| {
                state.leaves(shape).map(move |leaf| (Target::Leaf(door), MovingShape::Leaf(leaf)))
            });
        let is_disc = self.scene.settings.body == Body::Disc;
        let reach = max_range + PERSON_RADIUS;
        let people = (0..)
            .zip(&self.crowd.people)
            .filter(move |(_, person)| from.distance_squared(person.position) <= reach * reach)
            .flat_map(move |(i, person)| {
                let discs = match (is_disc, person.legs()) {
                    (true, _) => [Some((person.position, PERSON_RADIUS)), None],
                    (false, [left, right]) => [Some((left, LEG_RADIUS)), Some((right, LEG_RADIUS))],
                };
                let shape = |(center, radius)| MovingShape::Disc { center, radius };
                discs.into_iter().flatten().map(move |disc| (Target::Person(i), shape(disc)))
            });
        leaves.chain(people)
    }

    /// Calls `visit` for everything within `radius` metres of a point. A radius greater than 2 m counts as 2 m. A
    /// part with a long outline may be visited several times. People are discs.
    pub fn contacts(&self, p: DVec2, radius: f64, mut visit: impl FnMut(MovingContact)) {
        let radius = radius.min(self.scene.index.reach());
        self.scene.index.contacts(p, radius, |contact| {
            let (point, distance) = (contact.point, contact.distance);
            visit(MovingContact { target: Target::Part(contact.part), point, distance });
        });
        let mut near = |point: DVec2, target: Target| {
            let distance = p.distance(point);
            if distance <= radius {
                visit(MovingContact { target, point, distance });
            }
        };
        let is_within = |q: DVec2, reach: f64| {
            let reach = reach + radius + ROUNDING;
            p.distance_squared(q) <= reach * reach
        };
        for (door, (shape, state)) in (0..).zip(self.scene.shapes.iter().zip(&self.doors)) {
            if is_within(shape.middle(), shape.reach()) {
                for leaf in state.leaves(shape) {
                    near(leaf.nearest_point(p), Target::Leaf(door));
                }
            }
        }
        for (i, person) in (0..).zip(&self.crowd.people) {
            if is_within(person.position, PERSON_RADIUS) {
                let from = p - person.position;
                near(person.position + from.clamp_length_max(PERSON_RADIUS), Target::Person(i));
            }
        }
    }

    /// Returns the distance in metres from a point to the nearest solid, leaf or person; infinite if none is within
    /// 2 m.
    ///
    /// ```
    /// use envgen::scenario::{Scenario, ScenarioSpec, ScenarioState};
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
    /// let spec = ScenarioSpec { people: 1, ..Default::default() };
    /// let state = ScenarioState::new(&world, &Scenario::new(&world, &spec, Seed(1))?)?;
    /// // Where a person is, the world itself is free.
    /// let position = state.people()[0].position;
    /// assert!(state.clearance(position) == 0.0 && world.clearance(position) > 0.2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clearance(&self, p: DVec2) -> f64 {
        let mut least = f64::INFINITY;
        self.contacts(p, self.scene.index.reach(), |contact| least = least.min(contact.distance));
        least
    }

    /// Returns every place where smoke can be, and its extinction coefficient in 1/m, in an order that does not
    /// change. Where places overlap, the coefficients add up.
    pub fn smoke(&self) -> impl Iterator<Item = (SmokePlace, f64)> + '_ {
        self.has_smoke().then(|| self.scene.smoke.clouds(&self.smoke)).into_iter().flatten()
    }

    /// Returns the shapes of a place of [`ScenarioState::smoke`].
    pub fn smoke_shapes(&self, place: SmokePlace) -> Vec<Shape> {
        self.scene.smoke.shapes(place)
    }

    /// Returns the extinction coefficient of the smoke at a point, in 1/m.
    pub fn extinction(&self, p: DVec2) -> f64 {
        self.scene.smoke.extinction(&self.smoke, p)
    }

    /// Writes the smoke along a ray in the direction of a unit vector, up to `length` metres, into `stretches`.
    /// Sections of different sources may overlap, and then add up.
    pub fn smoke_along(
        &self,
        from: DVec2,
        direction: DVec2,
        length: f64,
        stretches: &mut Vec<Stretch>,
    ) {
        stretches.clear();
        if !self.scene.smoke.is_empty() {
            let ray = (from, direction, length);
            self.scene.smoke.stretches(&self.smoke, ray, |stretch| stretches.push(stretch));
        }
    }

    /// Returns the reading of a laser beam, and what it would have met without smoke. `stream` is the beam's own
    /// random stream, for example one of the robot's seed, the scan and the beam; it is used only for phantom
    /// echoes.
    pub fn beam(
        &self,
        laser: &Laser,
        (from, direction): (DVec2, DVec2),
        max_range: f64,
        stream: &mut Stream,
    ) -> (Reading, Option<MovingHit>) {
        let hit = self.cast(from, direction, max_range);
        let end = hit.map_or(max_range, |hit| hit.distance);
        let mut stretches = Vec::new();
        self.smoke_along(from, direction, end, &mut stretches);
        let distance = hit.map(|hit| hit.distance);
        let failed = self.scene.settings.failed_beams;
        (laser.read(distance, max_range, &stretches, failed, stream), hit)
    }
}

/// Returns the distance along a ray to a disc, 0 inside; `None` if the ray misses it.
fn to_disc(from: DVec2, direction: DVec2, (center, radius): (DVec2, f64)) -> Option<f64> {
    let to = center - from;
    let (middle, off) = (to.dot(direction), to.perp_dot(direction));
    let half2 = radius * radius - off * off;
    if half2 < 0.0 {
        return None;
    }
    let half = half2.sqrt();
    (middle + half >= 0.0).then(|| (middle - half).max(0.0))
}
