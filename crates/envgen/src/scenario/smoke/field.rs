//! The density of smoke in every region, and its spread.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::chord::{Stretch, chords};
use super::source::{SmokePlace, SmokeRegion, SmokeSource};
use crate::geometry::{Rect, Shape};
use crate::scenario::spec::SmokeKind;
use crate::world::World;

/// The extinction coefficient, in 1/m, below which smoke is ignored.
const THINNEST: f64 = 1e-9;

/// The greatest share of a compartment's air that is exchanged in one step of the integration.
const MOST_EXCHANGED: f64 = 0.1;

/// The greatest number of steps of the integration per step of the simulation.
const MAX_STEPS: f64 = 200.0;

/// The constant properties of the smoke of a world.
#[derive(Clone, Debug)]
pub(crate) struct SmokeRegions {
    sources: Vec<SmokeSource>,
    /// The floors of the compartments: those of the rooms, and as the last one all hallways and open areas.
    floors: Vec<Vec<(Rect, Shape)>>,
    /// The areas of the compartments in square metres. An infinite one absorbs all smoke.
    areas: Vec<f64>,
    /// The doorways between different compartments: the two compartments, the index of the doorway, and its width
    /// in metres.
    links: Vec<([usize; 2], usize, f64)>,
    /// Speed of the air through an open doorway in m/s.
    leak: f64,
    /// The greatest share of a compartment's air that leaves in a second while all doors are open.
    exchange: f64,
}

/// The current density of smoke.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SmokeField {
    /// The mean extinction coefficients of the compartments in 1/m.
    rooms: Vec<f64>,
    /// The extinction coefficient of each source that does not leak; 0 for the others. The name is part of digests.
    discs: Vec<f64>,
}

/// What the sources of a compartment emit, as sums of extinction coefficients in 1/m.
#[derive(Clone, Copy, Default)]
struct Emission {
    /// Of the sources that do not grow.
    constant: f64,
    /// Of those that grow, in the end.
    growing: f64,
    /// What those that grow lack of it by their own laws.
    lacked: f64,
}

impl SmokeRegions {
    pub(crate) fn new(world: &World, sources: &[SmokeSource], leak: f64) -> Self {
        let bounded = |shape: &Shape| (shape.bounds(), shape.clone());
        let mut floors: Vec<Vec<_>> =
            world.rooms.iter().map(|room| vec![bounded(&room.shape)]).collect();
        let halls = world.surfaces.iter().filter(|surface| surface.kind.is_hall());
        floors.push(halls.map(|surface| bounded(&surface.shape)).collect());
        let area = |shapes: &Vec<(Rect, Shape)>| {
            let area: f64 = shapes.iter().map(|(_, shape)| shape.area()).sum();
            if area > 0.0 { area } else { f64::INFINITY }
        };
        let areas: Vec<f64> = floors.iter().map(area).collect();
        let outside = world.rooms.len();
        let place = |room: Option<u32>| room.map_or(outside, |room| room as usize);
        let links = world.doorways.iter().enumerate().filter(|(_, doorway)| doorway.open);
        let links: Vec<_> = links
            .map(|(i, doorway)| {
                let (from, to, _) = doorway.shape.long_axis();
                (doorway.rooms.map(place), i, from.distance(to))
            })
            .filter(|([a, b], ..)| a != b)
            .collect();
        let mut flows = vec![0.0; areas.len()];
        for &(ends, _, width) in &links {
            ends.into_iter().for_each(|end| flows[end] += leak * width);
        }
        let exchange = flows.iter().zip(&areas).map(|(flow, area)| flow / area).fold(0.0, f64::max);
        SmokeRegions { sources: sources.to_vec(), floors, areas, links, leak, exchange }
    }

    /// Whether there is no smoke at any time.
    pub(crate) fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// Returns the field at the start, without smoke that grows.
    pub(crate) fn start(&self) -> SmokeField {
        let mut field =
            SmokeField { rooms: vec![0.0; self.areas.len()], discs: vec![0.0; self.sources.len()] };
        self.grow(&mut field, 0.0, 0.0);
        field
    }

    /// Spreads the smoke by `dt` seconds, up to a time since the start. `openness` returns that of a doorway by its
    /// index, from 0 to 1.
    ///
    /// The concentrations follow `dC_i/dt = q_i/V_i + sum_j k A_ij (C_j - C_i)/V_i` on the graph of rooms, with
    /// areas for volumes, since all rooms have the same height. Each term is integrated exactly on its own
    /// (operator splitting), so that every step is stable and the exchange preserves the amount of smoke. Where much
    /// air is exchanged, the steps are shorter.
    pub(crate) fn spread(
        &self,
        field: &mut SmokeField,
        (time, dt): (f64, f64),
        openness: impl Fn(usize) -> f64,
    ) {
        let steps = (self.exchange * dt / MOST_EXCHANGED).ceil().clamp(1.0, MAX_STEPS);
        let step = dt / steps;
        for left in (0..steps as u32).rev() {
            self.exchange(field, step, &openness);
            self.grow(field, time - step * f64::from(left), step);
        }
    }

    /// Exchanges air through open doorways.
    fn exchange(&self, field: &mut SmokeField, dt: f64, openness: impl Fn(usize) -> f64) {
        for &([a, b], doorway, width) in &self.links {
            let flow = self.leak * width * openness(doorway);
            let (from, to) = (field.rooms[a], field.rooms[b]);
            if flow == 0.0 || from == to {
                continue;
            }
            let (inverse_a, inverse_b) = (1.0 / self.areas[a], 1.0 / self.areas[b]);
            let moved = (to - from) * -libm::expm1(-flow * (inverse_a + inverse_b) * dt)
                / (inverse_a + inverse_b);
            if moved.is_finite() {
                field.rooms[a] += moved * inverse_a;
                field.rooms[b] -= moved * inverse_b;
            }
        }
    }

    /// Lets the smoke of the sources grow for `dt` seconds, up to a time since the start. In an infinite
    /// compartment, smoke is lost at once.
    ///
    /// The smoke of several sources in a compartment adds up: while no air is exchanged, it is the sum of
    /// `alpha (1 - exp(-t/T))`. What is lost is replaced at once up to the sum of the constant sources, and above it by
    /// those that grow, in proportion to `alpha` and at their own rates.
    fn grow(&self, field: &mut SmokeField, time: f64, dt: f64) {
        let share = |growth: f64, dt: f64| {
            if growth > 0.0 { -libm::expm1(-dt / growth) } else { 1.0 }
        };
        for (source, own) in self.sources.iter().zip(&mut field.discs) {
            if !source.leaks() {
                *own = source.extinction * share(source.growth, time);
            }
        }
        // What a source lacked by its own law at the beginning of the step.
        let lacked =
            |source: &SmokeSource| source.extinction * libm::exp(-(time - dt) / source.growth);
        let mut sums = vec![Emission::default(); field.rooms.len()];
        let leaking = || self.sources.iter().filter(|source| source.leaks());
        for source in leaking() {
            let Some(sum) = self.compartment(source).and_then(|i| sums.get_mut(i)) else {
                continue;
            };
            if source.growth > 0.0 {
                sum.growing += source.extinction;
                sum.lacked += lacked(source);
            } else {
                sum.constant += source.extinction;
            }
        }
        for (density, sum) in field.rooms.iter_mut().zip(&sums) {
            *density = density.max(sum.constant);
        }
        let mut growths = vec![0.0; field.rooms.len()];
        for source in leaking().filter(|source| source.growth > 0.0) {
            let Some(i) = self.compartment(source) else { continue };
            let (Some(density), Some(sum)) = (field.rooms.get(i), sums.get(i)) else { continue };
            let lost = sum.constant + sum.growing - density - sum.lacked;
            growths[i] += (lacked(source) + lost * (source.extinction / sum.growing))
                * share(source.growth, dt);
        }
        for ((density, growth), sum) in field.rooms.iter_mut().zip(growths).zip(&sums) {
            let most = sum.constant + sum.growing;
            if most > *density {
                *density = (*density + growth.max(0.0)).min(most);
            }
        }
    }

    /// Returns the index of the compartment that a source fills; `None` for discs and boxes.
    fn compartment(&self, source: &SmokeSource) -> Option<usize> {
        match source.region {
            SmokeRegion::Room(room) => Some(room as usize),
            SmokeRegion::Halls => Some(self.floors.len() - 1),
            SmokeRegion::Disc { .. } | SmokeRegion::Box { .. } => None,
        }
    }

    /// Returns the extinction coefficient of each compartment, also by sources that do not leak.
    fn densities(&self, field: &SmokeField) -> Vec<f64> {
        let mut densities = field.rooms.clone();
        for (source, own) in self.sources.iter().zip(&field.discs) {
            if let Some(density) = self.compartment(source).and_then(|i| densities.get_mut(i)) {
                *density += own;
            }
        }
        densities
    }

    /// Calls `visit` with every section of a ray in smoke. Sections of different regions may overlap; their
    /// extinction coefficients then add up.
    pub(crate) fn stretches(
        &self,
        field: &SmokeField,
        (from, direction, length): (DVec2, DVec2, f64),
        mut visit: impl FnMut(Stretch),
    ) {
        let to = from + direction * length;
        let around = Rect::new(from.min(to), from.max(to));
        for (shapes, &extinction) in self.floors.iter().zip(&field.rooms) {
            if extinction < THINNEST {
                continue;
            }
            for (_, shape) in shapes.iter().filter(|(bounds, _)| bounds.overlaps(around)) {
                chords(shape, from, direction, length, |from, to| {
                    visit(Stretch { from, to, extinction, is_particle: false });
                });
            }
        }
        for (source, &extinction) in self.sources.iter().zip(&field.discs) {
            if extinction < THINNEST {
                continue;
            }
            let is_particle = source.kind == SmokeKind::Particle;
            let mut visit_shape = |shape: &Shape| {
                chords(shape, from, direction, length, |from, to| {
                    visit(Stretch { from, to, extinction, is_particle });
                });
            };
            let floor = self.compartment(source).and_then(|i| self.floors.get(i));
            let floor = floor.into_iter().flatten();
            floor
                .filter(|(bounds, _)| bounds.overlaps(around))
                .for_each(|(_, shape)| visit_shape(shape));
            source.region.shape().iter().for_each(visit_shape);
        }
    }

    /// Returns every place with smoke of one density, and its extinction coefficient in 1/m.
    pub(crate) fn clouds(&self, field: &SmokeField) -> impl Iterator<Item = (SmokePlace, f64)> {
        let rooms = self.floors.len().saturating_sub(1);
        let place = move |i| if i < rooms { SmokePlace::Room(i as u32) } else { SmokePlace::Halls };
        let compartments = self.densities(field).into_iter().enumerate();
        let compartments = compartments.map(move |(i, c)| (place(i), c));
        let sources = (0..).zip(self.sources.iter().zip(&field.discs));
        let sources = sources
            .map(|(i, (source, &extinction))| (source.region.place(i), extinction))
            .filter(|(place, _)| matches!(place, SmokePlace::Source(_)));
        compartments.chain(sources)
    }

    /// Returns the shapes of a place, which may overlap; no shapes for a place that does not exist.
    pub(crate) fn shapes(&self, place: SmokePlace) -> Vec<Shape> {
        let of_floor = |floor: Option<&Vec<(Rect, Shape)>>| {
            floor.into_iter().flatten().map(|(_, shape)| shape.clone()).collect()
        };
        let rooms = self.floors.len().saturating_sub(1);
        match place {
            SmokePlace::Room(room) => of_floor(self.floors[..rooms].get(room as usize)),
            SmokePlace::Halls => of_floor(self.floors.last()),
            SmokePlace::Source(source) => {
                let source = self.sources.get(source as usize);
                source.and_then(|source| source.region.shape()).into_iter().collect()
            }
        }
    }

    /// Returns the extinction coefficient at a point in 1/m.
    pub(crate) fn extinction(&self, field: &SmokeField, p: DVec2) -> f64 {
        let rooms = self.floors.iter().zip(self.densities(field)).filter(|(shapes, _)| {
            shapes.iter().any(|(bounds, shape)| bounds.contains(p) && shape.contains(p))
        });
        let sources = self.sources.iter().zip(&field.discs);
        let sources = sources.filter(|(source, _)| source.region.contains(p));
        rooms.map(|(_, extinction)| extinction).sum::<f64>()
            + sources.map(|(_, extinction)| extinction).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Provenance;
    use crate::world::{Doorway, Room};

    /// Two rooms of 4 x 3 m and 2 x 3 m with a doorway of 1 m between them.
    fn two_rooms() -> World {
        let v = DVec2::new;
        let bounds = Rect::new(v(0.0, 0.0), v(6.0, 3.0));
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        for (left, right) in [(0.0, 4.0), (4.0, 6.0)] {
            world.rooms.push(Room {
                name: "room".to_owned(),
                shape: Shape::from_rect(Rect::new(v(left, 0.0), v(right, 3.0))),
                difficulty: None,
                lit: true,
                contents: Default::default(),
                height: None,
            });
        }
        let shape = Shape::from_rect(Rect::new(v(3.95, 1.0), v(4.05, 2.0)));
        world.doorways.push(Doorway::new(shape, true, [Some(0), Some(1)]));
        world
    }

    fn source(growth: f64) -> SmokeSource {
        let region = SmokeRegion::Room(0);
        SmokeSource { region, extinction: 2.0, growth, kind: SmokeKind::Regional }
    }

    #[test]
    fn smoke_grows_by_its_law_in_a_closed_room() {
        let regions = SmokeRegions::new(&two_rooms(), &[source(30.0)], 0.1);
        let mut field = regions.start();
        for step in 1..=200 {
            let time = 0.5 * f64::from(step);
            regions.spread(&mut field, (time, 0.5), |_| 0.0);
            let expected = 2.0 * -libm::expm1(-time / 30.0);
            assert!((field.rooms[0] - expected).abs() < 1e-12);
            assert_eq!(field.rooms[1], 0.0);
        }
    }

    #[test]
    fn two_rooms_even_out_as_their_equation_says() {
        let regions = SmokeRegions::new(&two_rooms(), &[], 0.1);
        let mut field = regions.start();
        field.rooms[0] = 3.0;
        let rate = 0.1 * (1.0 / 12.0 + 1.0 / 6.0);
        for step in 1..=100 {
            regions.spread(&mut field, (0.0, 0.5), |_| 1.0);
            let difference = 3.0 * libm::exp(-rate * 0.5 * f64::from(step));
            assert!((field.rooms[0] - field.rooms[1] - difference).abs() < 1e-12);
            let amount = 12.0 * field.rooms[0] + 6.0 * field.rooms[1];
            assert!((amount - 36.0).abs() < 1e-9, "{amount}");
        }
    }

    #[test]
    fn the_smoke_of_several_sources_in_a_room_adds_up() {
        let sources = [(2.0, 30.0), (1.0, 0.0), (0.5, 90.0), (0.7, 30.0)]
            .map(|(extinction, growth)| SmokeSource { extinction, ..source(growth) });
        let regions = SmokeRegions::new(&two_rooms(), &sources, 0.1);
        let mut field = regions.start();
        assert_eq!(field.rooms, [1.0, 0.0, 0.0]);
        for step in 1..=400 {
            let time = 0.5 * f64::from(step);
            regions.spread(&mut field, (time, 0.5), |_| 0.0);
            let grown = |source: &SmokeSource| match source.growth {
                growth if growth > 0.0 => source.extinction * -libm::expm1(-time / growth),
                _ => source.extinction,
            };
            let expected: f64 = sources.iter().map(grown).sum();
            assert!((field.rooms[0] - expected).abs() < 1e-9, "{time}");
        }
        // What leaks is replaced.
        for step in 401..=4000 {
            regions.spread(&mut field, (0.5 * f64::from(step), 0.5), |_| 1.0);
        }
        assert!(field.rooms.iter().take(2).all(|room| (room - 4.2).abs() < 0.01), "{field:?}");
    }

    #[test]
    fn a_growing_source_beside_a_constant_one_makes_no_room_thinner() {
        let sources = [(0.5, 0.0), (5.0, 600.0)]
            .map(|(extinction, growth)| SmokeSource { extinction, ..source(growth) });
        let regions = SmokeRegions::new(&two_rooms(), &sources, 1.0);
        let end = |dt: f64| {
            let mut field = regions.start();
            for step in 1..=(30.0 / dt) as u32 {
                regions.spread(&mut field, (dt * f64::from(step), dt), |_| 1.0);
                assert!(field.rooms[0] >= 0.5, "{field:?}");
            }
            field.rooms[0]
        };
        assert!((end(0.5) - end(0.005)).abs() < 0.02, "{} {}", end(0.5), end(0.005));
    }

    #[test]
    fn a_constant_source_keeps_its_room_as_dense_whatever_leaks() {
        for leak in [0.1, 1.0, 10.0] {
            let regions = SmokeRegions::new(&two_rooms(), &[source(0.0)], leak);
            let mut field = regions.start();
            let rate = leak / 6.0;
            for step in 1..=60 {
                let time = 0.5 * f64::from(step);
                regions.spread(&mut field, (time, 0.5), |_| 1.0);
                let expected = 2.0 * -libm::expm1(-rate * time);
                assert_eq!(field.rooms[0], 2.0);
                assert!((field.rooms[1] - expected).abs() < 0.03, "{leak}: {field:?} {expected}");
            }
        }
    }

    #[test]
    fn half_steps_change_little() {
        // With a source and a link the splitting is of first order: half the step, half the error.
        let regions = SmokeRegions::new(&two_rooms(), &[source(30.0)], 0.1);
        let end = |dt: f64| {
            let mut field = regions.start();
            let steps = (60.0 / dt) as u32;
            (1..=steps).for_each(|i| {
                regions.spread(&mut field, (dt * f64::from(i), dt), |_| 1.0);
            });
            field.rooms[0]
        };
        let fine = end(1e-3);
        assert!((end(0.5) - fine).abs() < 0.005 * fine, "{} {fine}", end(0.5));
    }

    #[test]
    fn a_ray_through_both_rooms_adds_up_their_smoke() {
        let world = two_rooms();
        let regions = SmokeRegions::new(&world, &[source(0.0)], 0.0);
        let mut field = regions.start();
        field.rooms[1] = 0.5;
        let mut depth = 0.0;
        let ray = (DVec2::new(1.0, 1.5), DVec2::X, 4.5);
        regions.stretches(&field, ray, |s| depth += s.extinction * (s.to - s.from));
        assert!((depth - (3.0 * 2.0 + 1.5 * 0.5)).abs() < 1e-12, "{depth}");
        assert_eq!(regions.extinction(&field, DVec2::new(5.0, 1.0)), 0.5);
    }
}
