//! The parts and poses of a world that can be edited, and queries for those at a point.

use std::borrow::Cow;
use std::fmt;

use glam::DVec2;

use crate::geometry::{Pose, Shape};
use crate::world::{PartId, PartKind, SurfaceKind, World};

/// Radius of the outline of the start, the goal or a victim, in metres.
const MARK: f64 = 0.3;

/// A part of a world, or one of its poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorldTarget {
    /// A part.
    Part(PartId),
    /// A victim, by the index in [`World::victims`].
    Victim(u32),
    /// The start pose.
    Start,
    /// The goal pose.
    Goal,
}

impl fmt::Display for WorldTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WorldTarget::Part(part) => part.fmt(f),
            WorldTarget::Victim(index) => write!(f, "victim {index}"),
            WorldTarget::Start => f.write_str("start"),
            WorldTarget::Goal => f.write_str("goal"),
        }
    }
}

/// Returns the outline of a pose.
pub(super) fn mark(pose: &Pose) -> Shape {
    Shape::Disc { center: pose.position, radius: MARK }
}

impl World {
    /// Returns the target at a point in metres, or within a distance of `reach` from it: a pose; otherwise the
    /// nearest solid part or doorway, the smallest of equally near ones; otherwise a surface that is not a plain
    /// floor; otherwise a room. It takes one step per part.
    ///
    /// ```
    /// use envgen::edit::WorldTarget;
    /// use envgen::world::PartKind;
    /// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
    ///
    /// let world = ForestSpec::default().generate(Seed(7))?.to_world();
    /// let start = world.start.expect("a forest with a free place").position;
    /// assert_eq!(world.target_at(start, 0.0), Some(WorldTarget::Start));
    /// let tree = world.target_at(world.trees[3].center, 0.0).expect("a tree");
    /// assert!(matches!(tree, WorldTarget::Part(part) if part.kind == PartKind::Tree));
    /// # Ok::<(), envgen::forest::ForestError>(())
    /// ```
    pub fn target_at(&self, p: DVec2, reach: f64) -> Option<WorldTarget> {
        if !p.is_finite() {
            return None;
        }
        let part = |kind, index: usize| WorldTarget::Part(PartId { kind, index: index as u32 });
        let is_laid = |kind| {
            !matches!(kind, SurfaceKind::Hallway | SurfaceKind::OpenArea | SurfaceKind::Class(_))
        };
        let victims = (0..self.victims.len() as u32).map(WorldTarget::Victim);
        let poses = [WorldTarget::Start, WorldTarget::Goal].into_iter().chain(victims);
        let poses = poses.filter_map(|target| Some((target, Cow::Owned(self.outline(target)?))));
        let uprights = self.uprights().map(|solid| (WorldTarget::Part(solid.id), solid.shape));
        let surfaces = self.surfaces.iter().enumerate().filter(|(_, s)| is_laid(s.kind));
        let surfaces = surfaces.map(|(i, s)| (part(PartKind::Surface, i), Cow::Borrowed(&s.shape)));
        let rooms = self.rooms.iter().enumerate();
        let rooms = rooms.map(|(i, room)| (part(PartKind::Room, i), Cow::Borrowed(&room.shape)));
        nearest(p, reach, poses)
            .or_else(|| nearest(p, reach, uprights))
            .or_else(|| nearest(p, reach, surfaces))
            .or_else(|| nearest(p, reach, rooms))
    }

    /// Returns the outline of a part in metres, or a disc around a pose; `None` if the target does not exist, and
    /// for roads.
    pub fn outline(&self, target: WorldTarget) -> Option<Shape> {
        let id = match target {
            WorldTarget::Start => return self.start.as_ref().map(mark),
            WorldTarget::Goal => return self.goal.as_ref().map(mark),
            WorldTarget::Victim(index) => return self.victims.get(index as usize).map(mark),
            WorldTarget::Part(id) => id,
        };
        let index = id.index as usize;
        match id.kind {
            PartKind::Wall => Some(self.walls.get(index)?.shape.clone()),
            PartKind::Tree => {
                let tree = self.trees.get(index)?;
                Some(Shape::Disc { center: tree.center, radius: tree.radius })
            }
            PartKind::Room => Some(self.rooms.get(index)?.shape.clone()),
            PartKind::Doorway => Some(self.doorways.get(index)?.shape.clone()),
            PartKind::Obstacle => Some(self.obstacles.get(index)?.shape.clone()),
            PartKind::Surface => Some(self.surfaces.get(index)?.shape.clone()),
            PartKind::RoadStrip | PartKind::Ground => None,
            PartKind::Start | PartKind::Goal | PartKind::Victim => None,
        }
    }
}

/// Returns the nearest shape within a distance of `reach` from a point; among those at the same distance, the smallest.
fn nearest<'a>(
    p: DVec2,
    reach: f64,
    shapes: impl Iterator<Item = (WorldTarget, Cow<'a, Shape>)>,
) -> Option<WorldTarget> {
    let near = shapes.filter_map(|(target, shape)| {
        let distance = shape.distance(p);
        (distance <= reach).then(|| (distance, shape.area(), target))
    });
    let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    nearest.map(|(_, _, target)| target)
}
