//! The ground under a robot: how a [`World`]'s surfaces change its speed and its odometry.

use glam::DVec2;

use crate::geometry::{Rect, Shape};
use crate::grid::{Convex, GridIndex, index_area};
use crate::world::{ClassRaster, Surface, SurfaceKind, World};

/// More than rounding changes the place of an outline, in metres.
const ROUNDING: f64 = 1e-6;

/// A surface is listed in at most this many cells, on average.
const MAX_LISTINGS: usize = 24;

/// The ground at a point. Where surfaces overlap, the worst of each counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Factor on a robot's greatest speed, 0 where it cannot drive.
    pub speed: f64,
    /// Factor on the variances of a robot's odometry.
    pub odometry_noise: f64,
    /// How much too far wheels measure, as a fraction of the distance that was driven.
    pub wheel_bias: f64,
    /// Whether it is water, which a robot must not enter.
    pub water: bool,
}

impl Ground {
    /// A plain floor.
    pub const PLAIN: Ground =
        Ground { speed: 1.0, odometry_noise: 1.0, wheel_bias: 0.0, water: false };

    /// Whether robots cannot or must not enter it.
    pub fn is_barrier(self) -> bool {
        self.water || self.speed <= 0.0
    }

    /// How far wheels roll, in metres, while a robot drives a distance.
    pub fn rolled(self, distance: f64) -> f64 {
        distance * (1.0 + self.wheel_bias)
    }

    /// The ground where this and another overlap: the worst of each.
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
    /// A little more than the bounds of each surface, which are faster to look up than its outline.
    bounds: Vec<Rect>,
    /// Set where a landscape has too many surfaces to be listed.
    raster: Option<ClassRaster>,
}

impl SurfaceIndex {
    /// Indexes the surfaces of a world that are not plain, and its raster if it has no surfaces.
    pub fn new(world: &World) -> Self {
        SurfaceIndex::of(world, |ground| ground != Ground::PLAIN)
    }

    /// Indexes the surfaces of a world with some ground alone, and its raster if it has no surfaces.
    pub(crate) fn of(world: &World, is_listed: impl Fn(Ground) -> bool) -> Self {
        let is_listed = |surface: &&Surface| is_listed(Ground::from(*surface));
        let surfaces: Vec<Surface> = world.surfaces.iter().filter(is_listed).cloned().collect();
        let around = surfaces.iter().map(|surface| surface.shape.bounds()).reduce(Rect::union);
        let (area, len) = (index_area(around, 0.0), surfaces.len());
        let index = GridIndex::new(area, len as f64, len, Some(MAX_LISTINGS), |i, frame, visit| {
            let corners = Shape::from_rect(surfaces[i].shape.bounds()).corners();
            frame.touched_runs(&Convex::Polygon(&corners), visit);
        });
        let raster = if world.surfaces.is_empty() { world.raster.clone() } else { None };
        let bounds = surfaces.iter().map(|s| s.shape.bounds().grown(ROUNDING)).collect();
        SurfaceIndex { index, surfaces, bounds, raster }
    }

    /// Whether the world has water.
    pub fn has_water(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.kind == SurfaceKind::Water)
    }

    /// Whether the ground is plain everywhere.
    pub(crate) fn is_plain(&self) -> bool {
        self.surfaces.is_empty() && self.raster.is_none()
    }

    /// The ground at a point, [`Ground::PLAIN`] where nothing else is known.
    pub fn at(&self, p: DVec2) -> Ground {
        let speed = self.raster.as_ref().and_then(|raster| raster.speed_at(p));
        let plain = Ground { speed: speed.unwrap_or(1.0), ..Ground::PLAIN };
        self.index
            .at(p)
            .iter()
            .filter(|&&i| self.bounds[i as usize].contains(p))
            .map(|&i| &self.surfaces[i as usize])
            .filter(|surface| surface.shape.contains(p))
            .fold(plain, |ground, surface| ground.worst(surface.into()))
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
    fn a_landscape_of_many_pieces_has_its_raster() {
        let spec = LandscapeSpec { rows: 40, cols: 40, ..Default::default() };
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
}
