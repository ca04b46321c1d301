//! Heights of parts: the default extents of every kind, and lintels over doorways.

use glam::DVec2;

use super::{
    Doorway, Extent, MIN_HEIGHT, Obstacle, ObstacleKind, PartId, PartKind, RoadStrip, Room,
    Surface, SurfaceKind, Tree, Wall, WallKind, World,
};
use crate::geometry::{Shape, edges};

/// The crown of a tree. It stops neither robots nor rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crown {
    /// Its bottom and top.
    pub extent: Extent,
    /// Its greatest radius in metres.
    pub radius: f64,
}

/// Share of a tree's height below its crown.
const BARE: f64 = 0.4;

/// Radius of a crown as a share of the tree's height.
const CROWN: f64 = 0.25;

impl WallKind {
    /// Returns the default bottom and top of walls of this kind.
    ///
    /// Kerbs are 0.5 m high unless a road's `kerb_height` sets another height, so that lasers see them. Kerbs of
    /// real streets are 0.1 to 0.15 m high.
    pub fn extent(self) -> Extent {
        match self {
            WallKind::Wall | WallKind::EndCap | WallKind::Alcove => WALL,
            WallKind::Partition => Extent::up_to(1.4),
            WallKind::Kerb => KERB,
        }
    }
}

/// The walls of buildings.
pub(crate) const WALL: Extent = Extent::up_to(2.6);

/// The openings of doorways.
pub(crate) const DOORWAY: Extent = Extent::up_to(2.1);

/// The kerbs of roads.
pub(crate) const KERB: Extent = Extent::up_to(0.5);

/// The cells of a landscape that cannot be passed.
pub(crate) const ROCK: Extent = Extent::up_to(1.0);

/// A plain floor, as a slab.
pub(crate) const FLOOR: Extent = Extent::between(-0.1, 0.0);

/// A road, slightly higher than the ground beside it.
const ROAD: Extent = Extent::between(-0.1, 0.01);

impl ObstacleKind {
    /// Returns the default bottom and top of obstacles of this kind.
    pub fn extent(self) -> Extent {
        match self {
            ObstacleKind::Screen => Extent::up_to(0.5),
            ObstacleKind::Rubble | ObstacleKind::Panel => Extent::up_to(0.6),
            ObstacleKind::Desk => Extent::up_to(0.75),
            ObstacleKind::Crate => Extent::up_to(0.8),
            ObstacleKind::Chair => Extent::up_to(0.9),
            ObstacleKind::Counter => Extent::up_to(1.1),
            ObstacleKind::Pipe => Extent::up_to(1.2),
            ObstacleKind::Cabinet => Extent::up_to(1.9),
            ObstacleKind::Boiler | ObstacleKind::Statue => Extent::up_to(2.0),
            ObstacleKind::DoorPost => DOORWAY,
            ObstacleKind::Container => Extent::up_to(2.4),
            ObstacleKind::Stairs => WALL,
            ObstacleKind::Other => ROCK,
        }
    }
}

impl ObstacleKind {
    /// Returns the extent of an obstacle of this kind in a building whose walls have a given height; `None` if it
    /// is the default.
    pub(crate) fn height_beside_walls(self, wall_top: f64) -> Option<Extent> {
        let usual = self.extent();
        match self {
            ObstacleKind::Stairs => Extent::unless_usual(usual, wall_top),
            ObstacleKind::DoorPost => Extent::unless_usual(usual, usual.top().min(wall_top)),
            _ => None,
        }
    }
}

impl SurfaceKind {
    /// Returns the default bottom and top of ground of this kind. Water extends below the floor and slightly above
    /// it; stairs are as high as walls.
    pub fn extent(self) -> Extent {
        match self {
            SurfaceKind::Water => Extent::between(-0.5, 0.01),
            SurfaceKind::Debris | SurfaceKind::Uneven => Extent::up_to(0.05),
            SurfaceKind::Loose => Extent::up_to(0.02),
            SurfaceKind::Stairs => WALL,
            SurfaceKind::Slippery | SurfaceKind::Class(_) => Extent::between(-0.1, 0.005),
            SurfaceKind::Hallway | SurfaceKind::OpenArea => FLOOR,
        }
    }
}

impl Wall {
    /// Returns the bottom and top of the wall.
    pub fn extent(&self) -> Extent {
        self.height.unwrap_or(self.kind.extent())
    }
}

impl Obstacle {
    /// Returns the bottom and top of the obstacle.
    pub fn extent(&self) -> Extent {
        self.height.unwrap_or(self.kind.extent())
    }
}

impl Surface {
    /// Returns the bottom and top of the ground.
    pub fn extent(&self) -> Extent {
        self.height.unwrap_or(self.kind.extent())
    }
}

impl Room {
    /// Returns the heights of the room's floor and ceiling.
    pub fn extent(&self) -> Extent {
        self.height.unwrap_or(WALL)
    }
}

impl Doorway {
    /// Returns the bottom and top of the opening, and of the door that closes it.
    pub fn extent(&self) -> Extent {
        self.height.unwrap_or(DOORWAY)
    }
}

impl RoadStrip {
    /// Returns the bottom and top of the road.
    pub fn extent(&self) -> Extent {
        ROAD
    }
}

impl Tree {
    /// Returns the bottom and top of the tree. Unless the tree states its own, its height is 2.5 m plus ten times
    /// the radius, at most 40 m.
    pub fn extent(&self) -> Extent {
        self.height.unwrap_or(Extent::up_to((2.5 + 10.0 * self.radius).min(40.0)))
    }

    /// Returns the bottom and top of the visible part of the trunk, which ends in the middle of the crown.
    pub fn trunk(&self) -> Extent {
        let crown = self.crown().extent;
        Extent::between(self.extent().bottom(), 0.5 * (crown.bottom() + crown.top()))
    }

    /// Returns the crown of the tree.
    pub fn crown(&self) -> Crown {
        let whole = self.extent();
        let bottom = whole.bottom() + BARE * whole.height();
        let radius = (CROWN * whole.height()).max(1.5 * self.radius);
        Crown { extent: Extent::between(bottom, whole.top()), radius }
    }
}

impl World {
    /// Returns the bottom and top of a part; `None` for marks and for parts that do not exist. For a doorway these
    /// are the bottom and top of its opening; there can be a [lintel](World::lintels) over it.
    pub fn extent(&self, part: PartId) -> Option<Extent> {
        let index = part.index as usize;
        Some(match part.kind {
            PartKind::Wall => self.walls.get(index)?.extent(),
            PartKind::Tree => self.trees.get(index)?.extent(),
            PartKind::RoadStrip => self.road_strips.get(index)?.extent(),
            PartKind::Room => self.rooms.get(index)?.extent(),
            PartKind::Doorway => self.doorways.get(index)?.extent(),
            PartKind::Obstacle => self.obstacles.get(index)?.extent(),
            PartKind::Surface => self.surfaces.get(index)?.extent(),
            PartKind::Start | PartKind::Goal | PartKind::Victim | PartKind::Ground => return None,
        })
    }

    /// Returns the top of the highest wall in metres, on which the ceilings over hallways and open areas rest; 2.6
    /// in a world without walls. Partitions and kerbs do not count.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    ///
    /// let spec = HallwaySpec { wall_height: 3.0, ..Default::default() };
    /// assert_eq!(spec.generate(Seed(7))?.to_world().wall_top(), 3.0);
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn wall_top(&self) -> f64 {
        let walls = self.walls.iter().filter(|wall| wall.kind == WallKind::Wall);
        walls.map(|wall| wall.extent().top()).reduce(f64::max).unwrap_or(WALL.top())
    }

    /// Returns the bottom and top of the lintel over each doorway: from the top of its opening to the top of the
    /// highest wall that it touches. `None` where the doorway touches no wall, or none that is at least
    /// [`MIN_HEIGHT`] higher than the opening.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let world = IndoorSpec::default().generate(Seed(7))?.to_world();
    /// let lintels = world.lintels();
    /// assert_eq!(lintels.len(), world.doorways.len());
    /// let lintel = lintels[0].expect("doorways of buildings are lower than the walls");
    /// assert_eq!(lintel.bottom(), world.doorways[0].extent().top());
    /// assert_eq!(lintel.top(), world.wall_top());
    /// # Ok::<(), envgen::indoor::IndoorError>(())
    /// ```
    pub fn lintels(&self) -> Vec<Option<Extent>> {
        let mut doors: Vec<_> = (0..self.doorways.len())
            .map(|i| (self.doorways[i].shape.bounds().grown(TOUCHING), i))
            .collect();
        let walls = self.walls.iter().enumerate();
        let mut walls: Vec<_> =
            walls.map(|(i, wall)| (wall.shape.bounds(), wall.extent().top(), i)).collect();
        doors.sort_by(|a, b| a.0.min.x.total_cmp(&b.0.min.x).then(a.1.cmp(&b.1)));
        walls.sort_by(|a, b| a.0.min.x.total_cmp(&b.0.min.x));
        let mut lintels = vec![None; doors.len()];
        // The walls that a line from bottom to top crosses as it moves to the right.
        let mut crossed: Vec<usize> = Vec::new();
        let mut next = 0;
        for (door, i) in doors {
            while next < walls.len() && walls[next].0.min.x <= door.max.x {
                crossed.push(next);
                next += 1;
            }
            crossed.retain(|&wall| walls[wall].0.max.x >= door.min.x);
            let beside = crossed.iter().map(|&wall| &walls[wall]);
            let near = beside.filter(|(bounds, ..)| bounds.overlaps(door));
            let shape = &self.doorways[i].shape;
            let touching = near.filter(|(.., wall)| touch(shape, &self.walls[*wall].shape));
            let top = touching.map(|(_, top, _)| *top).fold(f64::NEG_INFINITY, f64::max);
            let bottom = self.doorways[i].extent().top();
            lintels[i] = (top - bottom >= MIN_HEIGHT).then(|| Extent::between(bottom, top));
        }
        lintels
    }
}

/// The greatest distance, in metres, between a doorway and a wall that touch.
const TOUCHING: f64 = 1e-3;

/// For polygons with more pairs of sides than this, only the bounds are compared.
const MOST_PAIRS: usize = 1 << 16;

/// Whether a doorway and a wall touch. Their bounds are known to be within [`TOUCHING`] of each other.
fn touch(doorway: &Shape, wall: &Shape) -> bool {
    let sides =
        |shape: &Shape| if let Shape::Polygon { vertices } = shape { vertices.len() } else { 4 };
    if sides(doorway).saturating_mul(sides(wall)) > MOST_PAIRS {
        return true;
    }
    let is_beside = |a: DVec2, b: DVec2| wall.distance_from_segment(a, b) <= TOUCHING;
    match doorway {
        Shape::Segment { a, b } => is_beside(*a, *b),
        Shape::Disc { center, radius } => wall.distance(*center) <= radius + TOUCHING,
        Shape::Box { .. } | Shape::Polygon { .. } => {
            let corners = doorway.corners();
            edges(&corners).any(|(a, b)| is_beside(a, b))
                || doorway.distance(wall.bounds().center()) == 0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::Rect;
    use crate::{Provenance, Seed, WorldKind};

    fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Shape {
        Shape::from_rect(Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1)))
    }

    fn world() -> World {
        let bounds = Rect::new(DVec2::ZERO, DVec2::new(10.0, 10.0));
        World::new(Provenance::other("test", serde_json::Value::Null), bounds)
    }

    #[test]
    fn every_laser_of_the_project_sees_what_is_solid() {
        // Robots of `assets/robots` have theirs from 0.13 to 0.45 m above the floor.
        let kinds = ["wall", "end_cap", "alcove", "partition", "kerb"];
        let walls = kinds.map(|kind| {
            serde_json::from_value::<WallKind>(kind.into()).expect("a kind of wall").extent()
        });
        let kinds = [
            "door_post",
            "crate",
            "desk",
            "chair",
            "screen",
            "cabinet",
            "counter",
            "container",
            "boiler",
            "pipe",
            "statue",
            "panel",
            "rubble",
            "stairs",
            "other",
        ];
        let obstacles = kinds.map(|kind| {
            serde_json::from_value::<ObstacleKind>(kind.into())
                .expect("a kind of obstacle")
                .extent()
        });
        for extent in walls.into_iter().chain(obstacles).chain([DOORWAY]) {
            assert!(extent.bottom() == 0.0 && extent.top() >= 0.5, "{extent:?}");
        }
    }

    #[test]
    fn parts_without_a_height_are_written_as_before() {
        let mut world = world();
        world.obstacles.push(Obstacle::new(ObstacleKind::Desk, rect(1.0, 1.0, 2.0, 2.0)));
        world.trees.push(Tree::new(DVec2::new(5.0, 5.0), 0.5));
        let before = world.digest();
        let mut file = Vec::new();
        world.write_json(&mut file).unwrap();
        assert!(!String::from_utf8(file).unwrap().contains("height\":"));
        let height = Extent::new(0.7, 0.75).unwrap();
        world.obstacles[0].height = Some(height);
        assert_ne!(world.digest(), before);
        let mut file = Vec::new();
        world.write_json(&mut file).unwrap();
        let read = crate::import::read_json(&mut file.as_slice()).unwrap();
        assert_eq!(read, world);
        let id = PartId { kind: PartKind::Obstacle, index: 0 };
        assert_eq!(read.extent(id), Some(height));
        assert_eq!(read.extent(PartId { index: 1, ..id }), None);
    }

    #[test]
    fn trees_are_trunk_and_crown() {
        for radius in [0.01, 0.25, 1.0, 5.0] {
            let tree = Tree::new(DVec2::ZERO, radius);
            let (whole, crown) = (tree.extent(), tree.crown());
            assert!(whole.top() <= 40.0 && crown.extent.top() == whole.top());
            assert!(crown.extent.bottom() > 0.4 * whole.top() - 1e-12 && crown.radius > radius);
            assert!(tree.trunk().top() > crown.extent.bottom());
        }
    }

    #[test]
    fn lintels_end_at_the_highest_wall_beside() {
        let mut world = world();
        let tall = Some(Extent::new(0.0, 3.0).unwrap());
        let wall = |x0, x1| Wall::new(WallKind::Wall, rect(x0, 4.9, x1, 5.1));
        world.walls =
            vec![wall(0.0, 1.0), Wall { height: tall, ..wall(2.0, 5.0) }, wall(9.0, 10.0)];
        let door = |x0, x1, height| Doorway {
            height,
            ..Doorway::new(rect(x0, 4.9, x1, 5.1), true, [None, None])
        };
        let low = Some(Extent::new(0.0, 1.0).unwrap());
        world.doorways = vec![door(1.0, 2.0, None), door(8.0, 9.0, low), door(6.0, 7.0, None)];
        world.doorways.push(door(5.0, 5.5, tall));
        let lintel = |bottom, top| Some(Extent::new(bottom, top).unwrap());
        assert_eq!(world.lintels(), [lintel(2.1, 3.0), lintel(1.0, 2.6), None, None]);
    }

    proptest! {
        #[test]
        fn extents_have_a_bottom_and_a_top(seed: u64, kind in 0..WorldKind::ALL.len()) {
            let kind = WorldKind::ALL[kind];
            let Ok(blueprint) = kind.default_spec().generate(Seed(seed)) else {
                return Ok(());
            };
            let world = blueprint.to_world();
            let lintels = world.lintels();
            for solid in world.solids() {
                let extent = world.extent(solid.id).expect("a part of the world");
                prop_assert!(extent.bottom() < extent.top());
            }
            if kind == WorldKind::Indoor {
                // Every doorway is in a wall.
                let over = Some(Extent::new(2.1, 2.6).unwrap());
                prop_assert!(lintels.iter().all(|lintel| *lintel == over));
            }
        }
    }

    #[test]
    fn a_doorway_has_no_lintel_from_a_wall_whose_bounds_alone_are_near() {
        let mut world = world();
        let (from, to) = (DVec2::new(0.0, 0.0), DVec2::new(10.0, 10.0));
        let wall = Wall::new(WallKind::Wall, Shape::thick_segment(from, to, 0.1, 0.0));
        world.walls = vec![Wall { height: Some(Extent::up_to(5.0)), ..wall }];
        world.doorways = vec![Doorway::new(rect(8.0, 2.0, 9.0, 2.1), true, [None, None])];
        assert_eq!(world.lintels(), [None]);
        world.doorways = vec![Doorway::new(rect(5.0, 4.5, 6.0, 4.6), true, [None, None])];
        assert_eq!(world.lintels(), [None]);
        let beside = Shape::thick_segment(to, to + DVec2::ONE, 0.1, 0.0);
        world.doorways = vec![Doorway::new(beside, true, [None, None])];
        assert_eq!(world.lintels()[0].map(Extent::top), Some(5.0));
    }
}
