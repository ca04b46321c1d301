//! The bodies of people and doors in three dimensions.

use std::borrow::Cow;

use glam::DVec2;

use super::view::Target;
use super::{PERSON_RADIUS, ScenarioState};
use crate::geometry::Shape;
use crate::pieces::Form;
use crate::world::{Crown, DOORWAY, Extent, World};

/// Thickness in metres of the body of a door's leaf. For robots and rays, a leaf has no thickness.
pub const LEAF_THICKNESS: f64 = 0.05;

/// Gap above and below the leaf of a door in metres.
const GAP: f64 = 0.005;

/// The least visible length of the rest of a sliding leaf, in metres.
const SHORTEST: f64 = 1e-3;

/// Bottom and top of a person's head, and its radius, in metres.
const HEAD: (f64, f64, f64) = (1.5, 1.75, 0.12);

impl ScenarioState {
    /// Returns the bodies of everything that moves, in its current state, for meshes and cameras: the leaves of all
    /// doors, then the people, each in the order of the scenario. A person is an upright cylinder of radius
    /// [`PERSON_RADIUS`] with a head on it, 1.75 m high. `world` must be the world of the scenario.
    pub fn bodies(&self, world: &World) -> Vec<(Target, Form<'static>)> {
        let mut all = Vec::new();
        for (i, door) in (0..).zip(&self.scene.doors) {
            let opening = world.doorways.get(door.doorway as usize);
            let opening = opening.map_or(DOORWAY, |doorway| doorway.extent());
            let between = Extent::new(opening.bottom() + GAP, opening.top() - GAP);
            let extent = between.unwrap_or(opening);
            for leaf in self.leaves(i as usize) {
                if leaf.hinge.distance(leaf.tip) >= SHORTEST {
                    let shape = Shape::thick_segment(leaf.hinge, leaf.tip, LEAF_THICKNESS, 0.0);
                    all.push((Target::Leaf(i), prism(shape, extent)));
                }
            }
        }
        for (i, person) in (0..).zip(self.people()) {
            all.extend(figure(person.position).map(|form| (Target::Person(i), form)));
        }
        all
    }
}

/// Returns a person's body and head.
fn figure(center: DVec2) -> [Form<'static>; 2] {
    let (bottom, top, radius) = HEAD;
    let body = prism(Shape::Disc { center, radius: PERSON_RADIUS }, Extent::between(0.0, bottom));
    let crown = Crown { extent: Extent::between(bottom, top), radius };
    [body, Form::Crown { center, crown }]
}

fn prism(shape: Shape, extent: Extent) -> Form<'static> {
    Form::Prism { shape: Cow::Owned(shape), extent }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::IndoorSpec;
    use crate::scenario::{Leaf, Scenario, ScenarioSpec};
    use crate::{Blueprint, Seed, Spec};

    #[test]
    fn bodies_are_where_scans_see_them() {
        let world = IndoorSpec::default().generate(Seed(7)).unwrap().to_world();
        let spec = ScenarioSpec { doors: 1.0, people: 5, ..Default::default() };
        let scenario = Scenario::new(&world, &spec, Seed(1)).unwrap();
        let mut state = ScenarioState::new(&world, &scenario).unwrap();
        for _ in 0..20 {
            state.step(1.0, &[]).unwrap();
            let bodies = state.bodies(&world);
            let leaves = bodies.iter().filter(|(target, _)| matches!(target, Target::Leaf(_)));
            let long = |leaf: &Leaf| leaf.hinge.distance(leaf.tip) >= SHORTEST;
            let long: Vec<Leaf> = state.all_leaves().filter(long).collect();
            assert_eq!(leaves.clone().count(), long.len());
            for ((_, form), leaf) in leaves.zip(long) {
                let Form::Prism { shape, extent } = form else { panic!("{form:?}") };
                assert!(shape.contains(0.5 * (leaf.hinge + leaf.tip)) && extent.contains(1.0));
                let area = leaf.hinge.distance(leaf.tip) * LEAF_THICKNESS;
                assert!((shape.area() - area).abs() < 1e-9);
            }
            let people = bodies.iter().filter(|(target, _)| matches!(target, Target::Person(_)));
            assert_eq!(people.count(), 2 * state.people().len());
        }
    }
}
