//! Queries of the ground under a robot: how a [`World`]'s surfaces change its speed and its odometry.

use glam::DVec2;

use crate::geometry::{Rect, Shape};
use crate::grid::{Convex, GridIndex, index_area};
use crate::world::{ClassRaster, Surface, SurfaceKind, World};

/// An upper bound, in metres, of the rounding error of the position of an outline.
const ROUNDING: f64 = 1e-6;

/// The most cells in which a surface is listed, on average.
const MAX_LISTINGS: usize = 24;

/// The properties of the ground at a point. Where surfaces overlap, each property has its worst value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Factor on a robot's greatest speed; 0 where it cannot drive.
    pub speed: f64,
    /// Factor on the variances of a robot's odometry.
    pub odometry_noise: f64,
    /// The fraction by which wheels measure distances too far.
    pub wheel_bias: f64,
    /// Whether the ground is water, which a robot must not enter.
    pub water: bool,
}

impl Ground {
    /// The ground of a plain floor.
    pub const PLAIN: Ground =
        Ground { speed: 1.0, odometry_noise: 1.0, wheel_bias: 0.0, water: false };

    /// Returns whether robots cannot or must not enter the ground.
    pub fn is_barrier(self) -> bool {
        self.water || self.speed <= 0.0
    }

    /// Whether a property is better than that of a plain floor.
    fn is_better(self) -> bool {
        let Ground { speed, odometry_noise, wheel_bias, water: _ } = Ground::PLAIN;
        self.speed > speed || self.odometry_noise < odometry_noise || self.wheel_bias < wheel_bias
    }

    /// Returns how far the wheels roll, in metres, while a robot drives `distance` metres.
    pub fn rolled(self, distance: f64) -> f64 {
        distance * (1.0 + self.wheel_bias)
    }

    /// Returns the ground where this ground and another overlap: the worst value of each property.
    pub fn worst(self, other: Ground) -> Ground {
        Ground {
            speed: self.speed.min(other.speed),
            odometry_noise: self.odometry_noise.max(other.odometry_noise),
            wheel_bias: self.wheel_bias.max(other.wheel_bias),
            water: self.water || other.water,
        }
    }
}

impl From<&Surface> for Ground {
    fn from(surface: &Surface) -> Self {
        let Surface { speed, odometry_noise, wheel_bias, kind, .. } = *surface;
        Ground { speed, odometry_noise, wheel_bias, water: kind == SurfaceKind::Water }
    }
}

/// Returns the raster of a world whose cells are ground; `None` if its classes are among the surfaces.
pub(crate) fn ground_raster(world: &World) -> Option<&ClassRaster> {
    let is_class = |surface: &Surface| matches!(surface.kind, SurfaceKind::Class(_));
    world.raster.as_ref().filter(|_| !world.surfaces.iter().any(is_class))
}

/// A spatial index of a world's surfaces and raster.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
/// use envgen::surface_index::{Ground, SurfaceIndex};
///
/// let world = ForestSpec::default().generate(Seed(7))?.to_world();
/// assert_eq!(SurfaceIndex::new(&world).at(world.bounds.center()), Ground::PLAIN);
/// # Ok::<(), envgen::GenerateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SurfaceIndex {
    index: GridIndex,
    surfaces: Vec<Surface>,
    /// The bounds of each surface, slightly enlarged, which are faster to test than its outline.
    bounds: Vec<Rect>,
    /// The raster of a landscape; absent if its classes are among the surfaces.
    raster: Option<ClassRaster>,
}

impl SurfaceIndex {
    /// Indexes the surfaces of a world that are not plain, and also its raster unless its classes are among the
    /// surfaces.
    pub fn new(world: &World) -> Self {
        // Where a plain surface overlaps one that is better, the ground is plain.
        let are_better = world.surfaces.iter().any(|surface| Ground::from(surface).is_better());
        SurfaceIndex::of(world, |ground| are_better || ground != Ground::PLAIN)
    }

    /// Indexes only the surfaces of a world whose ground `is_listed`, and also its raster unless its classes are
    /// among all surfaces.
    pub(crate) fn of(world: &World, is_listed: impl Fn(Ground) -> bool) -> Self {
        let is_listed = |surface: &&Surface| is_listed(Ground::from(*surface));
        let surfaces: Vec<Surface> = world.surfaces.iter().filter(is_listed).cloned().collect();
        let around = surfaces.iter().map(|surface| surface.shape.bounds()).reduce(Rect::union);
        let (area, len) = (index_area(around, 0.0), surfaces.len());
        let index = GridIndex::new(area, len as f64, len, Some(MAX_LISTINGS), |i, frame, visit| {
            let corners = Shape::from_rect(surfaces[i].shape.bounds()).corners();
            frame.touched_runs(&Convex::Polygon(&corners), visit);
        });
        let raster = ground_raster(world).cloned();
        let bounds = surfaces.iter().map(|s| s.shape.bounds().grown(ROUNDING)).collect();
        SurfaceIndex { index, surfaces, bounds, raster }
    }

    /// Returns whether a straight line touches a barrier, and how many surfaces and cells were examined.
    pub(crate) fn barrier_along(&self, a: DVec2, b: DVec2) -> (bool, usize) {
        let (line, mut meets, mut cost) = ([a, b], false, 0);
        self.index.frame.touched_runs(&Convex::Polygon(&line), |row, from, to| {
            for col in from..=to {
                for &i in self.index.of(self.index.frame.index(col, row)) {
                    let surface = &self.surfaces[i as usize];
                    cost += 1;
                    meets |= Ground::from(surface).is_barrier()
                        && surface.shape.distance_from_segment(a, b) == 0.0;
                }
            }
        });
        if let Some(raster) = &self.raster {
            let frame = raster.frame();
            frame.touched_runs(&Convex::Polygon(&line), |row, from, to| {
                cost += to - from + 1;
                let start = frame.index(0, frame.rows - 1 - row);
                let classes = &raster.cells[start + from..=start + to];
                meets |= classes.iter().any(|&class| raster.speed_of(class) <= 0.0);
            });
        }
        (meets, cost)
    }

    /// Returns whether the world has water.
    pub fn has_water(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.kind == SurfaceKind::Water)
    }

    /// Whether the ground is plain everywhere.
    pub(crate) fn is_plain(&self) -> bool {
        self.surfaces.is_empty() && self.raster.is_none()
    }

    /// Returns the ground at a point; [`Ground::PLAIN`] if the world has no other ground there.
    pub fn at(&self, p: DVec2) -> Ground {
        let speed = self.raster.as_ref().and_then(|raster| raster.speed_at(p));
        let cell = speed.map(|speed| Ground { speed, ..Ground::PLAIN });
        self.index
            .at(p)
            .iter()
            .filter(|&&i| self.bounds[i as usize].contains(p))
            .map(|&i| &self.surfaces[i as usize])
            .filter(|surface| surface.shape.contains(p))
            .map(Ground::from)
            .chain(cell)
            .reduce(Ground::worst)
            .unwrap_or(Ground::PLAIN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::IndoorSpec;
    use crate::landscape::LandscapeSpec;
    use crate::{Blueprint, Seed, Spec};

    /// The slow, obvious method.
    fn slow(world: &World, p: DVec2) -> Ground {
        let mut ground = Ground::PLAIN;
        for surface in world.surfaces.iter().filter(|surface| surface.shape.contains(p)) {
            ground.speed = ground.speed.min(surface.speed);
            ground.odometry_noise = ground.odometry_noise.max(surface.odometry_noise);
            ground.wheel_bias = ground.wheel_bias.max(surface.wheel_bias);
            ground.water |= surface.kind == SurfaceKind::Water;
        }
        ground
    }

    fn points(world: &World, n: usize) -> impl Iterator<Item = DVec2> + '_ {
        let mut draws = Seed(5).stream("test", 0);
        let size = world.bounds.size();
        (0..n).map(move |_| {
            world.bounds.min + size * (DVec2::new(draws.unit(), draws.unit()) * 1.2 - 0.1)
        })
    }

    #[test]
    fn the_index_finds_every_surface() {
        let mut water = 0;
        let mut uneven = 0;
        for seed in 0..10 {
            let spec = IndoorSpec { difficulty: 9.0, ..Default::default() };
            let world = spec.generate(Seed(seed)).expect("a map").to_world();
            let grounds = SurfaceIndex::new(&world);
            let is_water = |surface: &Surface| surface.kind == SurfaceKind::Water;
            assert_eq!(grounds.has_water(), world.surfaces.iter().any(is_water));
            for p in points(&world, 2000) {
                let ground = grounds.at(p);
                assert_eq!(ground, slow(&world, p));
                water += u32::from(ground.water);
                uneven += u32::from(ground.odometry_noise > 1.0);
            }
        }
        assert!(water > 0 && uneven > 0, "the maps have {water} wet and {uneven} uneven points");
    }

    #[test]
    fn ground_may_be_better_than_plain() {
        let mut world = IndoorSpec::default().generate(Seed(1)).expect("a map").to_world();
        world.surfaces.clear();
        let side = |side: f64| Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::splat(side)));
        let good = Surface::new(SurfaceKind::Class(1), side(2.0));
        world.surfaces.push(Surface { speed: 3.0, odometry_noise: 0.5, ..good });
        let ground = |world: &World, x| {
            let ground = SurfaceIndex::new(world).at(DVec2::splat(x));
            (ground.speed, ground.odometry_noise)
        };
        assert_eq!((ground(&world, 1.0), ground(&world, 3.0)), ((3.0, 0.5), (1.0, 1.0)));
        // The worst counts where surfaces overlap, also if it is plain.
        world.surfaces.push(Surface::new(SurfaceKind::Class(2), side(1.0)));
        assert_eq!((ground(&world, 0.5), ground(&world, 1.5)), ((1.0, 1.0), (3.0, 0.5)));
    }

    #[test]
    fn a_landscape_of_many_pieces_has_its_raster() {
        let speeds = vec![1.0, 3.0, 0.5];
        let spec = LandscapeSpec {
            rows: 40,
            cols: 40,
            classes: 3,
            entropy: 1.0,
            speeds,
            ..Default::default()
        };
        let mut world = spec.generate(Seed(1)).expect("a landscape").to_world();
        let listed = SurfaceIndex::new(&world);
        world.surfaces.clear();
        let raster = SurfaceIndex::new(&world);
        let cell = world.raster.as_ref().expect("a raster").cell;
        let border = |p: DVec2| ((p / cell) - (p / cell).round()).abs().min_element() < 1e-6;
        for p in points(&world, 500).filter(|&p| !border(p)) {
            assert_eq!(raster.at(p).speed, listed.at(p).speed, "{p}");
        }
        assert_eq!(raster.at(DVec2::NAN), Ground::PLAIN);
    }

    #[test]
    fn an_added_surface_leaves_the_speeds_of_the_raster() {
        let spec = LandscapeSpec { rows: 40, cols: 40, ..Default::default() };
        let mut world = spec.generate(Seed(1)).expect("a landscape").to_world();
        world.surfaces.clear();
        let before = SurfaceIndex::new(&world);
        let corner = world.bounds.min;
        let patch = Shape::from_rect(Rect::new(corner, corner + 0.2));
        world.surfaces.push(Surface::new(SurfaceKind::Slippery, patch));
        let after = SurfaceIndex::new(&world);
        for p in points(&world, 500) {
            assert_eq!(after.at(p).speed, before.at(p).speed, "{p}");
        }
    }

    #[test]
    fn a_line_meets_the_barriers_that_its_points_meet() {
        let spec = IndoorSpec { difficulty: 9.0, ..Default::default() };
        let world = spec.generate(Seed(3)).expect("a map").to_world();
        let grounds = SurfaceIndex::of(&world, Ground::is_barrier);
        let points: Vec<DVec2> = points(&world, 400).collect();
        let mut barriers = 0;
        for pair in points.windows(2) {
            let to = pair[0] + (pair[1] - pair[0]).clamp_length_max(3.0);
            let (meets, _) = grounds.barrier_along(pair[0], to);
            let is_wet = |k| grounds.at(pair[0].lerp(to, f64::from(k) / 500.0)).is_barrier();
            if (0..=500).any(is_wet) {
                assert!(meets, "{} to {to}", pair[0]);
                barriers += 1;
            }
            let distance = world.surfaces.iter().filter(|s| Ground::from(*s).is_barrier());
            let distance = distance.map(|s| s.shape.distance_from_segment(pair[0], to));
            assert_eq!(meets, distance.fold(f64::INFINITY, f64::min) == 0.0);
        }
        assert!(barriers > 0);
    }
}
