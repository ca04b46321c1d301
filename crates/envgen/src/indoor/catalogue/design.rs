//! The design of a room: its size, its difficulty and its contents.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::geometry::{Pose, Rect, Shape, edges, signed_area};
use crate::indoor::grid::Side;
use crate::indoor::room_placement::DESIGN_UNIT;
use crate::world::{MAX_WHEEL_BIAS, Obstacle, Surface, Wall, is_visible_range};

/// The greatest width and height of a room in cells.
pub const MAX_ROOM_SIZE: u32 = 64;

/// The greatest number of parts in a room.
pub const MAX_ROOM_PARTS: usize = 10_000;

/// Contents may extend this far beyond the room's edge, in metres, which allows only for rounding.
const TOLERANCE: f64 = 1e-9;

/// The greatest heading of a part of a room, in radians in either direction. If a quarter turn is added to a far
/// greater heading, it is lost in rounding, and the part lies outside the turned room.
const MAX_HEADING: f64 = 1e3;

/// The greatest number of corners of a polygon. The check whether it is convex compares all pairs.
const MAX_CORNERS: usize = 1000;

/// The design of a room, as a `.room.ron` file contains it.
///
/// Contents are in metres from the room's lower left corner, x right and y up, for cells of [`DESIGN_UNIT`]; a map
/// with another cell size scales them. The centre lines of the walls meet at the corner, so the floor begins half a
/// wall's thickness further inside.
///
/// ```
/// use envgen::geometry::Shape;
/// use envgen::glam::DVec2;
/// use envgen::indoor::{Catalogue, IndoorSpec, RoomDesign};
/// use envgen::world::{Obstacle, ObstacleKind};
/// use envgen::{Seed, Spec};
///
/// // A store room of 2 by 2 cells, 6 m by 6 m, with a crate in its middle.
/// let mut room = RoomDesign::bare("store", 2, 2, 3.0);
/// let center = 0.5 * room.size();
/// let shape = Shape::Box { center, half_size: DVec2::splat(0.4), heading: 0.3 };
/// room.obstacles.push(Obstacle::new(ObstacleKind::Crate, shape));
/// room.validate()?;
/// let spec = IndoorSpec { catalogue: Some(Catalogue::new([room])?), ..Default::default() };
/// assert!(spec.generate(Seed(7))?.rooms().iter().all(|placed| placed.room.name == "store"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoomDesign {
    /// The name, unique in its catalogue.
    pub name: String,
    /// Number of columns that the room takes.
    pub width: u32,
    /// Number of rows that the room takes.
    pub height: u32,
    /// Difficulty on the scale from 0 to 10.
    pub difficulty: f64,
    /// The reason why it has this difficulty.
    #[serde(default)]
    pub reason: String,
    /// Whether the room is lit.
    #[serde(default = "lit")]
    pub lit: bool,
    /// Walls inside the room.
    #[serde(default)]
    pub walls: Vec<Wall>,
    /// Solids other than walls.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
    /// Surfaces that change how a robot drives.
    #[serde(default)]
    pub surfaces: Vec<Surface>,
    /// Poses of victims: people that robots should find.
    #[serde(default)]
    pub victims: Vec<Pose>,
}

fn lit() -> bool {
    true
}

/// The name of a piece of hallway in files of plans.
pub(in crate::indoor) const HALLWAY_NAME: &str = "hallway";

/// The reasons why a room is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RoomError {
    /// The name is empty.
    #[error("a room has no name")]
    Unnamed,
    /// The name is that of hallways in files, or contains characters that files cannot hold.
    #[error(
        "a room cannot be named {name:?}: it must be other than `{HALLWAY_NAME}`, without control characters"
    )]
    Name {
        /// The name.
        name: String,
    },
    /// Width or height is out of range.
    #[error(
        "width and height of room `{name}` must be 1 to {MAX_ROOM_SIZE} cells, got {width} by {height}"
    )]
    Size {
        /// The room's name.
        name: String,
        /// The room's number of columns.
        width: u32,
        /// The room's number of rows.
        height: u32,
    },
    /// The difficulty is out of range or not a number.
    #[error("`difficulty` of room `{name}` must be a number from 0 to 10, got {difficulty}")]
    Difficulty {
        /// The room's name.
        name: String,
        /// The room's difficulty.
        difficulty: f64,
    },
    /// A part of the room has a size that is not positive, a number that is not finite, or a polygon that is not
    /// convex and counter-clockwise.
    #[error("room `{name}`: {part} is not {wanted}")]
    Part {
        /// The room's name.
        name: String,
        /// The part, such as `obstacle 3`.
        part: String,
        /// What the part must be.
        wanted: &'static str,
    },
    /// A part lies outside the room.
    #[error("room `{name}`: {part} reaches outside the room of {width} by {height} m")]
    Outside {
        /// The room's name.
        name: String,
        /// The part, such as `obstacle 3`.
        part: String,
        /// The room's width in metres.
        width: f64,
        /// The room's height in metres.
        height: f64,
    },
    /// There are too many parts in the room.
    #[error("room `{name}` must hold at most {MAX_ROOM_PARTS} parts, got {count}")]
    TooMany {
        /// The room's name.
        name: String,
        /// Number of parts in the room.
        count: usize,
    },
}

impl RoomDesign {
    /// Creates a room without contents.
    pub fn bare(name: &str, width: u32, height: u32, difficulty: f64) -> Self {
        RoomDesign {
            name: name.to_owned(),
            width,
            height,
            difficulty,
            reason: String::new(),
            lit: true,
            walls: Vec::new(),
            obstacles: Vec::new(),
            surfaces: Vec::new(),
            victims: Vec::new(),
        }
    }

    /// Returns the room without its walls, obstacles and surfaces.
    pub fn emptied(&self) -> Self {
        RoomDesign {
            walls: Vec::new(),
            obstacles: Vec::new(),
            surfaces: Vec::new(),
            ..self.clone()
        }
    }

    /// Returns the number of cells along a side.
    pub fn side_length(&self, side: Side) -> u32 {
        match side {
            Side::North | Side::South => self.width,
            Side::East | Side::West => self.height,
        }
    }

    /// Returns the width and height in metres, measured between the centre lines of the walls.
    pub fn size(&self) -> DVec2 {
        DVec2::new(f64::from(self.width), f64::from(self.height)) * DESIGN_UNIT
    }

    /// Returns everything on which a robot cannot drive: walls, obstacles, water, and surfaces of speed 0.
    pub fn barriers(&self) -> impl Iterator<Item = &Shape> {
        let walls = self.walls.iter().map(|wall| &wall.shape);
        let obstacles = self.obstacles.iter().map(|obstacle| &obstacle.shape);
        let surfaces = self.surfaces.iter().filter(|s| s.is_barrier()).map(|s| &s.shape);
        walls.chain(obstacles).chain(surfaces)
    }

    /// Checks sizes and numbers, and that all parts lie in the room.
    ///
    /// # Errors
    /// Returns the first rule that the room breaks.
    pub fn validate(&self) -> Result<(), RoomError> {
        let name = || self.name.clone();
        if self.name.trim().is_empty() {
            return Err(RoomError::Unnamed);
        }
        if self.name == HALLWAY_NAME || self.name.chars().any(char::is_control) {
            return Err(RoomError::Name { name: self.name.clone() });
        }
        if ![self.width, self.height].iter().all(|size| (1..=MAX_ROOM_SIZE).contains(size)) {
            return Err(RoomError::Size { name: name(), width: self.width, height: self.height });
        }
        if !(0.0..=10.0).contains(&self.difficulty) {
            return Err(RoomError::Difficulty { name: name(), difficulty: self.difficulty });
        }
        let count =
            self.walls.len() + self.obstacles.len() + self.surfaces.len() + self.victims.len();
        if count > MAX_ROOM_PARTS {
            return Err(RoomError::TooMany { name: name(), count });
        }
        let walls = self.walls.iter().enumerate().map(|(i, w)| ("wall", i, &w.shape));
        let obstacles = self.obstacles.iter().enumerate().map(|(i, o)| ("obstacle", i, &o.shape));
        let surfaces = self.surfaces.iter().enumerate().map(|(i, s)| ("surface", i, &s.shape));
        let wall_ranges = self.walls.iter().enumerate().map(|(i, w)| ("wall", i, w.visible_range));
        let ranges =
            self.obstacles.iter().enumerate().map(|(i, o)| ("obstacle", i, o.visible_range));
        for (list, i, range) in wall_ranges.chain(ranges) {
            if !is_visible_range(range) {
                let wanted = "of a `visible_range` of a positive number of metres";
                return Err(RoomError::Part { name: name(), part: format!("{list} {i}"), wanted });
            }
        }
        for (list, i, shape) in walls.chain(obstacles).chain(surfaces) {
            self.check_shape(shape, || format!("{list} {i}"))?;
        }
        for (i, surface) in self.surfaces.iter().enumerate() {
            if !(0.0..=MAX_WHEEL_BIAS).contains(&surface.wheel_bias) {
                let wanted = "of a `wheel_bias` from 0 to 1";
                return Err(RoomError::Part { name: name(), part: format!("surface {i}"), wanted });
            }
            let allowed = |factor: f64| factor.is_finite() && factor >= 0.0;
            if !(allowed(surface.speed) && allowed(surface.odometry_noise)) {
                let wanted = "of finite factors that are not negative";
                return Err(RoomError::Part { name: name(), part: format!("surface {i}"), wanted });
            }
        }
        for (i, victim) in self.victims.iter().enumerate() {
            let part = || format!("victim {i}");
            if !(victim.position.is_finite() && victim.heading.abs() <= MAX_HEADING) {
                let wanted = "at a finite position, with a heading of at most 1000 rad";
                return Err(RoomError::Part { name: name(), part: part(), wanted });
            }
            self.check_inside(Rect::new(victim.position, victim.position), part)?;
        }
        Ok(())
    }

    fn check_shape(&self, shape: &Shape, part: impl Fn() -> String) -> Result<(), RoomError> {
        let (sound, wanted) = match shape {
            Shape::Segment { .. } => (false, "a disc, a box or a polygon"),
            Shape::Disc { center, radius } => (
                center.is_finite() && radius.is_finite() && *radius > 0.0,
                "a disc of finite middle and positive radius",
            ),
            Shape::Box { center, half_size, heading } => (
                center.is_finite()
                    && half_size.is_finite()
                    && heading.abs() <= MAX_HEADING
                    && half_size.cmpgt(DVec2::ZERO).all(),
                "a box of finite middle, positive size and a heading of at most 1000 rad",
            ),
            Shape::Polygon { vertices } => (
                is_convex(vertices),
                "a convex polygon of three to 1000 corners, counter-clockwise",
            ),
        };
        if !sound {
            return Err(RoomError::Part { name: self.name.clone(), part: part(), wanted });
        }
        self.check_inside(shape.bounds(), part)
    }

    fn check_inside(&self, bounds: Rect, part: impl Fn() -> String) -> Result<(), RoomError> {
        let size = self.size();
        if Rect::new(DVec2::ZERO, size).grown(TOLERANCE).contains_rect(bounds) {
            return Ok(());
        }
        let (width, height) = (size.x, size.y);
        Err(RoomError::Outside { name: self.name.clone(), part: part(), width, height })
    }
}

fn is_convex(vertices: &[DVec2]) -> bool {
    (3..=MAX_CORNERS).contains(&vertices.len())
        && vertices.iter().all(|v| v.is_finite())
        && signed_area(vertices) > 0.0
        && edges(vertices).all(|(a, b)| a != b)
        // A star turns left everywhere too, but has corners to the right of its sides.
        && edges(vertices).all(|(a, b)| vertices.iter().all(|&v| (b - a).perp_dot(v - a) >= -1e-9))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{ObstacleKind, SurfaceKind};

    fn with(shape: Shape) -> RoomDesign {
        let mut room = RoomDesign::bare("test", 1, 2, 5.0);
        room.obstacles.push(Obstacle::new(ObstacleKind::Other, shape));
        room
    }

    fn at(x: f64, y: f64, half: f64) -> Shape {
        let half_size = DVec2::splat(half);
        Shape::Box { center: DVec2::new(x, y), half_size, heading: 0.0 }
    }

    #[test]
    fn sound_rooms_pass() {
        assert_eq!(with(at(1.5, 5.5, 0.5)).validate(), Ok(()));
        let vertices = vec![DVec2::ZERO, DVec2::X, DVec2::ONE];
        assert_eq!(with(Shape::Polygon { vertices }).validate(), Ok(()));
    }

    #[test]
    fn unsound_rooms_say_what_is_wrong() {
        let error = |room: RoomDesign| room.validate().unwrap_err().to_string();
        assert!(error(with(at(2.6, 1.0, 0.5))).contains("obstacle 0 reaches outside"));
        assert!(error(with(at(1.0, 1.0, -0.5))).contains("obstacle 0 is not a box"));
        assert!(error(with(at(f64::NAN, 1.0, 0.5))).contains("finite"));
        let radius = f64::INFINITY;
        assert!(error(with(Shape::Disc { center: DVec2::ONE, radius })).contains("disc"));
        let closed = vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::ZERO];
        assert!(error(with(Shape::Polygon { vertices: closed })).contains("convex"));
        let clockwise = vec![DVec2::ZERO, DVec2::ONE, DVec2::X];
        assert!(error(with(Shape::Polygon { vertices: clockwise })).contains("convex"));
        let star: Vec<_> = [0, 2, 4, 1, 3]
            .iter()
            .map(|&i| {
                let angle = std::f64::consts::TAU * f64::from(i) / 5.0;
                DVec2::ONE + crate::geometry::unit_vector(angle)
            })
            .collect();
        assert!(error(with(Shape::Polygon { vertices: star })).contains("convex"));
        for (width, height) in [(0, 1), (1, 0), (65, 1), (1, u32::MAX)] {
            assert!(error(RoomDesign::bare("a", width, height, 1.0)).contains("by"));
        }
        for difficulty in [f64::NAN, -1.0, 10.5] {
            assert!(error(RoomDesign::bare("a", 1, 1, difficulty)).contains("difficulty"));
        }
        assert_eq!(RoomDesign::bare(" ", 1, 1, 1.0).validate(), Err(RoomError::Unnamed));
        for name in ["hallway", "a\u{1}b", "a\u{7f}"] {
            assert!(error(RoomDesign::bare(name, 1, 1, 1.0)).contains("cannot be named"));
        }
        let mut room = RoomDesign::bare("a", 1, 1, 1.0);
        room.victims.push(Pose::new(4.0, 1.0, 0.0));
        assert!(error(room).contains("victim 0"));
        let mut room = RoomDesign::bare("a", 1, 1, 1.0);
        let (shape, speed) = (at(1.0, 1.0, 0.5), f64::NAN);
        room.surfaces.push(Surface { speed, ..Surface::new(SurfaceKind::Water, shape) });
        assert!(error(room).contains("surface 0"));
        let mut room = RoomDesign::bare("a", 1, 1, 1.0);
        let loose = Surface::new(SurfaceKind::Loose, at(1.0, 1.0, 0.5));
        room.surfaces.push(Surface { wheel_bias: 1.5, ..loose });
        assert!(error(room).contains("`wheel_bias`"));
        let mut room = RoomDesign::bare("a", 1, 1, 1.0);
        let dark = Obstacle::new(ObstacleKind::Other, at(1.0, 1.0, 0.5));
        room.obstacles.push(Obstacle { visible_range: Some(0.0), ..dark });
        assert!(error(room).contains("`visible_range`"));
    }
}
