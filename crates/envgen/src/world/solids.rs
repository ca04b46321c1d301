//! What stops a robot and a ray.

use std::borrow::Cow;

use glam::DVec2;

use super::{Extent, PartId, PartKind, World};
use crate::geometry::Shape;

/// A part that stops a robot and a ray, with its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid<'a> {
    /// Which part it is.
    pub id: PartId,
    /// Its shape in world coordinates.
    pub shape: Cow<'a, Shape>,
}

impl World {
    /// Everything that stops a robot and a ray: walls, trees, closed doors and obstacles, in this
    /// order, whatever their heights. Rooms, roads and surfaces do not.
    ///
    /// ```
    /// use envgen::world::{Surface, SurfaceKind};
    /// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec, geometry::Shape};
    ///
    /// let mut world = ForestSpec::default().generate(Seed(7))?.to_world();
    /// // Water stops no ray, and is no solid.
    /// world.surfaces.push(Surface::new(SurfaceKind::Water, Shape::from_rect(world.bounds)));
    /// assert_eq!(world.solids().count(), world.trees.len());
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn solids(&self) -> impl Iterator<Item = Solid<'_>> {
        let is_open = |id: PartId| self.doorways[id.index as usize].open;
        self.uprights().filter(move |part| part.id.kind != PartKind::Doorway || !is_open(part.id))
    }

    /// Walls, trees, doorways and obstacles, in this order.
    pub(crate) fn uprights(&self) -> impl Iterator<Item = Solid<'_>> {
        let solid =
            |kind, index: usize, shape| Solid { id: PartId { kind, index: index as u32 }, shape };
        let walls = self.walls.iter().enumerate();
        let trees = self.trees.iter().enumerate();
        let doorways = self.doorways.iter().enumerate();
        let obstacles = self.obstacles.iter().enumerate();
        walls
            .map(move |(i, wall)| solid(PartKind::Wall, i, Cow::Borrowed(&wall.shape)))
            .chain(trees.map(move |(i, tree)| {
                let shape = Shape::Disc { center: tree.center, radius: tree.radius };
                solid(PartKind::Tree, i, Cow::Owned(shape))
            }))
            .chain(doorways.map(move |(i, doorway)| {
                solid(PartKind::Doorway, i, Cow::Borrowed(&doorway.shape))
            }))
            .chain(obstacles.map(move |(i, obstacle)| {
                solid(PartKind::Obstacle, i, Cow::Borrowed(&obstacle.shape))
            }))
    }

    /// The solids that are partly within an extent, such as that of a robot's body: in the order of
    /// [`World::solids`], with the open doorways whose lintels are.
    pub fn solids_within(&self, extent: Extent) -> impl Iterator<Item = Solid<'_>> {
        self.solids_where(move |part| part.overlaps(extent))
    }

    /// The solids that a level plane meets, such as a laser's, at a height in metres above the floor: in the
    /// order of [`World::solids`], with the open doorways whose lintels it meets. None for NaN.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    ///
    /// let spec = HallwaySpec { wall_height: 1.0, ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// assert_eq!(world.solids_at(0.5).count(), world.walls.len());
    /// // A laser at 1.5 m looks over the walls.
    /// assert_eq!(world.solids_at(1.5).count(), 0);
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn solids_at(&self, height: f64) -> impl Iterator<Item = Solid<'_>> {
        self.solids_where(move |part| part.contains(height))
    }

    fn solids_where(&self, is_met: impl Fn(Extent) -> bool) -> impl Iterator<Item = Solid<'_>> {
        let lintels = self.lintels();
        self.uprights().filter(move |part| {
            let is_part_met = || self.extent(part.id).is_some_and(&is_met);
            if part.id.kind != PartKind::Doorway {
                return is_part_met();
            }
            let index = part.id.index as usize;
            let is_closed = !self.doorways[index].open;
            (is_closed && is_part_met()) || lintels[index].is_some_and(&is_met)
        })
    }

    /// How many parts there are, and points and cells of parts: what the time to draw or check a world grows with.
    pub fn part_count(&self) -> usize {
        let points: usize = self.road_strips.iter().map(|strip| strip.centreline.len()).sum();
        let cells = self.raster.as_ref().map_or(0, |raster| raster.cells.len());
        points + cells + self.solids().count() + self.rooms.len() + self.surfaces.len()
    }

    /// Distance in metres from a point to the nearest solid part, infinite in a world without any.
    /// Costs one step per part.
    pub fn clearance(&self, p: DVec2) -> f64 {
        self.solids().map(|solid| solid.shape.distance(p)).fold(f64::INFINITY, f64::min)
    }
}
