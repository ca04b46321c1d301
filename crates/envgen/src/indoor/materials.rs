//! Materials: floors on which wheels slip, and walls and objects that a laser hardly sees.
//!
//! Each kind of material has its own random order of the parts that it may take, and takes the first of them up to
//! its share. A larger share therefore adds to the parts of a smaller share, and no kind changes the parts of
//! another kind.

use glam::DVec2;

use super::spec::IndoorSpec;
use crate::geometry::{Rect, Shape, unit_vector};
use crate::seed::Seed;
use crate::world::{Surface, SurfaceKind, Wall, World};

/// Remainders of walls and floors that are shorter than this, in metres, are not cut off.
const SHORTEST: f64 = 0.01;

/// Applies the materials of a spec to a world; does nothing if the spec has no materials.
pub(super) fn apply(spec: &IndoorSpec, seed: Seed, world: &mut World) {
    let floors = floors(world);
    if spec.floor_slip > 1.0 {
        let covered = covered(&floors, spec.floor_slip_share, seed, "indoor/floor_slip");
        world.surfaces.extend(covered.into_iter().map(|floor| Surface {
            odometry_noise: spec.floor_slip,
            ..Surface::new(SurfaceKind::Slippery, Shape::from_rect(floor))
        }));
    }
    if spec.wheel_bias > 0.0 {
        let covered = covered(&floors, spec.wheel_bias_share, seed, "indoor/wheel_bias");
        world.surfaces.extend(covered.into_iter().map(|floor| Surface {
            wheel_bias: spec.wheel_bias,
            ..Surface::new(SurfaceKind::Loose, Shape::from_rect(floor))
        }));
    }
    darken_walls(spec, seed, &mut world.walls);
    let count = (spec.dark_objects * world.obstacles.len() as f64).round() as usize;
    let order = shuffled(world.obstacles.len(), seed, "indoor/dark_objects");
    for i in order.into_iter().take(count) {
        darken(&mut world.obstacles[i].visible_range, spec.dark_range);
    }
}

/// Returns the floors of rooms, hallways and open areas. They overlap only if the design of a room has floors of
/// its own.
pub(super) fn floors(world: &World) -> Vec<Rect> {
    let halls = world.surfaces.iter().filter(|surface| surface.kind.is_hall());
    let halls = halls.map(|surface| surface.shape.bounds());
    world.rooms.iter().map(|room| room.shape.bounds()).chain(halls).collect()
}

/// Returns floors that cover a share of the total area; the last one can be covered in part.
fn covered(floors: &[Rect], share: f64, seed: Seed, stream: &str) -> Vec<Rect> {
    let area = |floor: Rect| floor.size().element_product();
    let mut wanted = share * floors.iter().map(|&floor| area(floor)).sum::<f64>();
    let mut covered = Vec::new();
    for i in shuffled(floors.len(), seed, stream) {
        let floor = floors[i];
        let size = floor.size();
        let along = if size.x >= size.y { DVec2::X } else { DVec2::Y };
        let (length, width) = (size.dot(along), size.dot(DVec2::ONE - along));
        // Rounding leaves no gap at the end of a floor that is wanted whole.
        let taken = if wanted >= area(floor) - SHORTEST * width { length } else { wanted / width };
        if taken < SHORTEST {
            break;
        }
        covered.push(Rect::new(floor.min, floor.min + along * taken + (size - along * length)));
        wanted -= taken * width;
    }
    covered
}

/// Darkens a share of the walls' length. The last wall is cut where its dark part ends.
fn darken_walls(spec: &IndoorSpec, seed: Seed, walls: &mut Vec<Wall>) {
    if spec.dark_walls == 0.0 {
        return;
    }
    let long: Vec<f64> = walls.iter().map(|wall| wall.length()).collect();
    let mut wanted = spec.dark_walls * long.iter().sum::<f64>();
    for i in shuffled(walls.len(), seed, "indoor/dark_walls") {
        if wanted < SHORTEST {
            break;
        }
        if wanted < long[i] - SHORTEST {
            match cut(&walls[i].shape, wanted) {
                Some([dark, rest]) => {
                    walls.push(Wall { shape: rest, ..walls[i] });
                    walls[i].shape = dark;
                }
                // Walls of other shapes are dark as a whole or not at all.
                None if wanted < 0.5 * long[i] => break,
                None => {}
            }
        }
        darken(&mut walls[i].visible_range, spec.dark_range);
        wanted -= long[i];
    }
}

/// Sets a visible range, unless the part is darker by design.
fn darken(visible_range: &mut Option<f64>, range: f64) {
    *visible_range = Some(visible_range.map_or(range, |designed| designed.min(range)));
}

/// Cuts a box into two, of which the first has a length of `at` metres.
fn cut(shape: &Shape, at: f64) -> Option<[Shape; 2]> {
    let Shape::Box { center, half_size, heading } = *shape else { return None };
    let along = if half_size.x >= half_size.y { DVec2::X } else { DVec2::Y };
    let axis = unit_vector(heading).rotate(along);
    let half = half_size.dot(along);
    let piece = |from: f64, to: f64| Shape::Box {
        center: center + axis * (0.5 * (from + to) - half),
        half_size: half_size * (DVec2::ONE - along) + along * (0.5 * (to - from)),
        heading,
    };
    Some([piece(0.0, at), piece(at, 2.0 * half)])
}

/// Returns the numbers from 0 to `len` in random order.
pub(super) fn shuffled(len: usize, seed: Seed, stream: &str) -> Vec<usize> {
    // Each part has a draw of its own, so that further parts do not change the order of others.
    let draw = |i: usize| (seed.stream(stream, i as u64).unit(), i);
    let mut order: Vec<(f64, usize)> = (0..len).map(draw).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    order.into_iter().map(|(_, i)| i).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Spec;
    use crate::indoor::IndoorSpec;
    use crate::indoor::tests::small_world as world;

    fn of_kind(world: &World, kind: SurfaceKind) -> Vec<Surface> {
        world.surfaces.iter().filter(|surface| surface.kind == kind).cloned().collect()
    }

    fn dark_walls(world: &World) -> Vec<&Wall> {
        world.walls.iter().filter(|wall| wall.visible_range.is_some()).collect()
    }

    fn total(world: &World) -> f64 {
        world.walls.iter().map(|wall| wall.length()).sum()
    }

    #[test]
    fn without_materials_specs_and_worlds_are_as_ever() {
        let text = serde_json::to_string(&IndoorSpec::default()).expect("JSON");
        for name in ["floor_slip", "wheel_bias", "dark_"] {
            assert!(!text.contains(name), "{name}: {text}");
        }
        let plain = world(&IndoorSpec::default(), 3);
        let off = IndoorSpec {
            floor_slip_share: 0.5,
            wheel_bias_share: 0.5,
            dark_range: 2.0,
            ..Default::default()
        };
        assert_eq!(world(&off, 3).digest(), plain.digest());
        let none = IndoorSpec {
            floor_slip: 9.0,
            floor_slip_share: 0.0,
            wheel_bias: 0.2,
            wheel_bias_share: 0.0,
            ..Default::default()
        };
        assert_eq!(world(&none, 3).digest(), plain.digest());
    }

    #[test]
    fn limits_are_stated() {
        let error = |spec: IndoorSpec| spec.generate(Seed(0)).unwrap_err().to_string();
        let slip = IndoorSpec { floor_slip: 0.5, ..Default::default() };
        assert_eq!(error(slip), "`floor_slip` must be a number from 1 to 25, got 0.5");
        let bias = IndoorSpec { wheel_bias: 0.5, ..Default::default() };
        assert_eq!(error(bias), "`wheel_bias` must be a number from 0 to 0.35, got 0.5");
        let dark = IndoorSpec { dark_walls: f64::NAN, ..Default::default() };
        assert_eq!(error(dark), "`dark_walls` must be a number from 0 to 1, got NaN");
        let near = IndoorSpec { dark_range: 0.0, ..Default::default() };
        assert_eq!(error(near), "`dark_range` must be a number from 1 to 10, got 0");
    }

    #[test]
    fn no_material_moves_another_or_the_geometry() {
        let all = IndoorSpec {
            floor_slip: 8.0,
            floor_slip_share: 0.4,
            wheel_bias: 0.2,
            wheel_bias_share: 0.3,
            dark_walls: 0.6,
            dark_objects: 0.5,
            dark_range: 2.0,
            ..Default::default()
        };
        for seed in 0..8 {
            let (plain, rich) = (world(&IndoorSpec::default(), seed), world(&all, seed));
            rich.check().expect("a sound world");
            assert_eq!((rich.start, rich.goal), (plain.start, plain.goal));
            assert_eq!(rich.certificate, plain.certificate);
            let slip = world(
                &IndoorSpec { floor_slip: 8.0, floor_slip_share: 0.4, ..<_>::default() },
                seed,
            );
            let kind = SurfaceKind::Slippery;
            assert_eq!(of_kind(&rich, kind), of_kind(&slip, kind));
            let dark =
                world(&IndoorSpec { dark_walls: 0.6, dark_range: 2.0, ..<_>::default() }, seed);
            assert_eq!(dark.walls, rich.walls);
            // Cut walls are where they were.
            let mut draws = Seed(seed).stream("test", 0);
            for _ in 0..200 {
                let at = DVec2::new(draws.unit(), draws.unit()) * plain.bounds.size();
                assert!((rich.clearance(at) - plain.clearance(at)).abs() < 1e-9, "{at}");
            }
        }
    }

    #[test]
    fn objects_are_dark_by_number() {
        let mut some = 0;
        for seed in 0..6 {
            let spec = IndoorSpec { dark_objects: 0.5, difficulty: 8.0, ..Default::default() };
            let world = world(&spec, seed);
            let dark = world.obstacles.iter().filter(|o| o.visible_range == Some(3.0)).count();
            assert_eq!(dark, (0.5 * world.obstacles.len() as f64).round() as usize);
            some += dark;
        }
        assert!(some > 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn shares_are_kept_and_larger_ones_add(
            seed in 0..1000_u64, a in 0.0..=1.0_f64, b in 0.0..=1.0_f64,
        ) {
            let (less, more) = (a.min(b), a.max(b));
            let at = |share: f64| {
                world(&IndoorSpec {
                    wheel_bias: 0.1,
                    wheel_bias_share: share,
                    dark_walls: share,
                    ..Default::default()
                }, seed)
            };
            let (small, large) = (at(less), at(more));
            let floor: f64 = floors(&small).iter().map(|f| f.size().element_product()).sum();
            for (world, share) in [(&small, less), (&large, more)] {
                prop_assert!(world.check().is_ok());
                let loose = of_kind(world, SurfaceKind::Loose);
                let covered: f64 = loose.iter().map(|surface| surface.shape.area()).sum();
                prop_assert!((covered - share * floor).abs() < 0.1, "{covered} of {floor}");
                let dark: f64 = dark_walls(world).iter().map(|wall| wall.length()).sum();
                // Walls of rooms that cannot be cut are rounded.
                prop_assert!((dark - share * total(world)).abs() < 2.0, "{dark}");
            }
            let covers = |world: &World, p: DVec2| {
                of_kind(world, SurfaceKind::Loose).iter().any(|s| s.shape.contains(p))
            };
            for surface in of_kind(&small, SurfaceKind::Loose) {
                prop_assert!(covers(&large, surface.shape.bounds().center()));
            }
            for wall in dark_walls(&small) {
                let middle = wall.shape.bounds().center();
                prop_assert!(dark_walls(&large).iter().any(|w| w.shape.distance(middle) < 1e-9));
            }
        }
    }
}
