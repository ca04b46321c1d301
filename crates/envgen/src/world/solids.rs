//! Solids: the parts of a world that stop robots and rays.

use std::borrow::Cow;

use glam::DVec2;

use super::{Extent, PartId, PartKind, World};
use crate::geometry::Shape;

/// A part that stops robots and rays, with its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid<'a> {
    /// The identifier of the part.
    pub id: PartId,
    /// Its shape in world coordinates.
    pub shape: Cow<'a, Shape>,
}

impl World {
    /// Returns everything that stops robots and rays: walls, trees, closed doors and obstacles, in this order,
    /// whatever their heights. Rooms, roads and surfaces are no solids.
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

    /// Returns walls, trees, doorways and obstacles, in this order.
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

    /// Returns the solids that lie at least partly within an extent, such as that of a robot's body, in the order
    /// of [`World::solids`]. Open doorways are included if their lintels lie within it.
    pub fn solids_within(&self, extent: Extent) -> impl Iterator<Item = Solid<'_>> {
        self.solids_where(move |part| part.overlaps(extent))
    }

    /// Returns the solids that a horizontal plane, such as that of a laser, meets at a height in metres above the
    /// floor, in the order of [`World::solids`]. Open doorways are included if the plane meets their lintels. For
    /// NaN there are no solids.
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

    /// Returns the number of parts, and of points and cells of parts. The time to draw or check a world grows with it.
    pub fn part_count(&self) -> usize {
        let points: usize = self.road_strips.iter().map(|strip| strip.centreline.len()).sum();
        let cells = self.raster.as_ref().map_or(0, |raster| raster.cells.len());
        points + cells + self.solids().count() + self.rooms.len() + self.surfaces.len()
    }

    /// Returns the distance in metres from a point to the nearest solid part; infinite in a world without solids.
    /// It takes one step per part.
    pub fn clearance(&self, p: DVec2) -> f64 {
        self.solids().map(|solid| solid.shape.distance(p)).fold(f64::INFINITY, f64::min)
    }
}
