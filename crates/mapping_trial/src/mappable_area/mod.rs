//! The mappable area of a world: the ground that a robot can reach, and the walls that it can see from
//! there.

mod frame;
mod ground;
mod reach;
mod walls;

use envgen::SpecError;
use envgen::geometry::Rect;
use envgen::world::{Violation, World};
use glam::DVec2;
use thiserror::Error;

pub use self::frame::{SCORE_CELL, ScoreFrame};
use self::ground::{DiscGround, open_cells};
use self::reach::Reach;
pub use self::walls::WallPoint;
use crate::map::{CLAMP, CellIndex, OccupancyMap};
use crate::robot::Robot;

/// Greatest number of cells of [`SCORE_CELL`] of a world with its border: 579 x 579 m.
pub const MAX_CELLS: u64 = 1 << 25;

/// Width in metres of the border of cells around the world's bounds. It is larger than the distances at
/// which walls are compared.
const BORDER: f64 = 1.3;

/// The greatest coordinate of a world and its border in metres.
const FARTHEST: f64 = 1e7;

/// Margin in metres that is added to a robot's circumscribed radius for planning and for the area that
/// it could have covered: the Pioneer's 0.355 m become 0.36 m.
pub const MARGIN: f64 = 0.005;

/// The circumscribed radii that a trial can be scored for, in metres.
const RADII: std::ops::RangeInclusive<f64> = 0.15..=2.0;

/// Distance in metres beyond the robot's radius up to which distances to solids are known.
const REACH: f64 = 0.6;

/// Depth in metres inside a wall at which the wall's surface is drawn.
const INTO_WALL: f64 = 1e-3;

/// An error for which a world has no mappable area.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MappableAreaError {
    /// The world breaks an invariant.
    #[error("the world is broken: {0}")]
    World(#[from] Violation),
    /// The world is too large.
    #[error(
        "`bounds` are {width} m x {height} m, expected at most {MAX_CELLS} cells of 0.1 m, which are 576 m \
         x 576 m with a border, no farther than {FARTHEST} m from the origin"
    )]
    Size {
        /// Width in metres.
        width: f64,
        /// Height in metres.
        height: f64,
    },
    /// The robot's radius is outside of the range that can be scored.
    #[error("`circumscribed_radius` must be from {min} to {max} m, got {0} m", min = RADII.start(), max = RADII.end())]
    Radius(f64),
    /// The robot's height is not valid.
    #[error(transparent)]
    Height(#[from] SpecError),
    /// The world has no start.
    #[error("`start` must be set: a trial starts there")]
    NoStart,
    /// The robot does not fit at the start.
    #[error(
        "`start` must be on ground to drive on with {radius} m of free ground all around, \
         got ({x}, {y}) m"
    )]
    Start {
        /// Its x in metres.
        x: f64,
        /// Its y in metres.
        y: f64,
        /// The robot's radius in metres.
        radius: f64,
    },
}

/// The mappable area of a world, computed once for any number of trials in it.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::robot::Robot;
/// use mapping_trial::mappable_area::MappableArea;
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let area = MappableArea::new(&world, &Robot::default())?;
/// assert!(area.free_area() > 5.0 && !area.walls().is_empty());
/// assert!(area.is_clear(area.start()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MappableArea {
    frame: ScoreFrame,
    ground: DiscGround,
    /// Where the robot starts.
    start: DVec2,
    robot: Robot,
    free: Vec<bool>,
    free_cells: usize,
    walls: Vec<WallPoint>,
    wall_distance: Vec<u16>,
}

impl MappableArea {
    /// Computes the mappable area from the world's start.
    ///
    /// # Errors
    ///
    /// If the world has no start; otherwise as [`MappableArea::from_start`].
    pub fn new(world: &World, robot: &Robot) -> Result<Self, MappableAreaError> {
        let start = world.start.ok_or(MappableAreaError::NoStart)?;
        MappableArea::from_start(world, robot, start.position)
    }

    /// Computes the mappable area from a start, which may be the world's or another one.
    ///
    /// The robot is a disc of its circumscribed radius and height. It stays off solid parts and inside
    /// the world's bounds, and its centre stays off water and surfaces of speed 0. Its laser sees the
    /// walls and solids at its own height.
    ///
    /// # Errors
    ///
    /// If the world is broken or too large, if the robot does not fit at the start, or if it is smaller
    /// or larger than can be scored.
    pub fn from_start(
        world: &World,
        robot: &Robot,
        start: DVec2,
    ) -> Result<Self, MappableAreaError> {
        Self::check_robot(robot)?;
        let radius = robot.circumscribed_radius;
        world.check()?;
        let (around, too_large) = (Self::check_size(world)?, too_large(world));
        let frame = ScoreFrame::around(around);

        let footprint = radius + MARGIN;
        let ground =
            DiscGround::new(world, frame, footprint + REACH, robot.extent()?).ok_or(too_large)?;
        let reach = Reach::from_start(&ground, footprint, start);
        let land: Vec<bool> =
            (0..frame.len()).map(|cell| ground.is_open(cell) && ground.is_dry_cell(cell)).collect();
        let free = reach.covered(&land, footprint);
        let free_cells = free.iter().filter(|free| **free).count();
        if free_cells == 0 || ground.room(start, radius) < 0.0 {
            return Err(MappableAreaError::Start { x: start.x, y: start.y, radius: footprint });
        }
        // A laser may see over solids that stop the robot.
        let laser = robot.laser_mount.height;
        let seen = open_cells(world, frame, world.solids_at(laser))
            .ok_or_else(|| self::too_large(world))?;
        let walls = walls::seen(world, laser, frame, &free, &joined(frame, &free, &seen));
        let mut truth = MappableArea {
            frame,
            ground,
            start,
            robot: robot.clone(),
            free_cells,
            free,
            walls,
            wall_distance: Vec::new(),
        };
        let mut walls = vec![false; frame.len()];
        for point in &truth.walls {
            if let Some(cell) = frame.cell_at(into_wall(*point)) {
                walls[cell] = true;
            }
        }
        truth.wall_distance = envgen::distance::squared_distances(frame.cols, &walls);
        Ok(truth)
    }

    /// Returns the position where the robot starts.
    pub fn start(&self) -> DVec2 {
        self.start
    }

    /// Returns the robot that maps.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Checks, before a trial, that a world is small enough to be scored. Returns the area of the grid
    /// of scores.
    ///
    /// # Errors
    ///
    /// If the world is too large, or too far from the origin.
    pub fn check_size(world: &World) -> Result<Rect, MappableAreaError> {
        let around = world.bounds.grown(BORDER);
        let size = around.size();
        let cells = (size.x / SCORE_CELL + 2.0) * (size.y / SCORE_CELL + 2.0);
        // Far from the origin, cells of 0.1 m cannot be distinguished.
        let far = around.min.abs().max(around.max.abs()).max_element();
        let small = cells <= MAX_CELLS as f64 && far <= FARTHEST;
        if small { Ok(around) } else { Err(too_large(world)) }
    }

    /// Checks, before a trial, that a robot has a size that can be scored: a circumscribed radius from
    /// 0.15 to 2 m.
    ///
    /// # Errors
    ///
    /// If the robot is smaller or larger.
    pub fn check_robot(robot: &Robot) -> Result<(), MappableAreaError> {
        let radius = robot.circumscribed_radius;
        if RADII.contains(&radius) { Ok(()) } else { Err(MappableAreaError::Radius(radius)) }
    }

    /// Returns the grid of the mappable area.
    pub fn frame(&self) -> ScoreFrame {
        self.frame
    }

    /// Returns for each cell of the grid whether it belongs to F: ground that no solid enters and that
    /// the robot's disc can cover.
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// Returns the area of F in square metres.
    pub fn free_area(&self) -> f64 {
        self.free_cells as f64 * (SCORE_CELL * SCORE_CELL)
    }

    /// Returns the walls that can be seen from F, as points about 5 cm apart.
    pub fn walls(&self) -> &[WallPoint] {
        &self.walls
    }

    /// Returns whether the robot's centre can be at a point: its disc of its circumscribed radius
    /// touches nothing solid, and it can drive on the ground.
    pub fn is_clear(&self, p: DVec2) -> bool {
        self.room(p) >= 0.0
    }

    /// Returns the map of a robot without any error: F is free, and the walls that can be seen are
    /// occupied.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    /// use mapping_trial::map::{Cell, CellIndex};
    /// use mapping_trial::{robot::Robot, mappable_area::MappableArea};
    ///
    /// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
    /// let area = MappableArea::new(&world, &Robot::default())?;
    /// let map = area.perfect_map();
    /// assert_eq!(map.cell(CellIndex::of(area.start())), Cell::Free);
    /// let wall = area.walls()[0];
    /// let inside = wall.position - 0.01 * wall.normal;
    /// assert_eq!(map.cell(CellIndex::of(inside)), Cell::Occupied);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn perfect_map(&self) -> OccupancyMap {
        let mut map = OccupancyMap::new();
        for cell in (0..self.frame.len()).filter(|&cell| self.free[cell]) {
            let (col, row) = self.frame.place(cell);
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                map.add(CellIndex { col: 2 * col + x, row: 2 * row + y }, -CLAMP);
            }
        }
        for point in &self.walls {
            let cell = CellIndex::of(into_wall(*point));
            map.add(cell, CLAMP);
            map.add(cell, CLAMP);
        }
        map.touch(self.frame.area());
        map
    }

    /// Distance in metres of the robot's disc from the nearest solid part, infinite if far; negative
    /// where the disc touches one or cannot be.
    pub(crate) fn room(&self, p: DVec2) -> f64 {
        self.ground.room(p, self.robot.circumscribed_radius)
    }

    /// For each cell, its squared distance to the nearest visible wall, in cells.
    pub(crate) fn wall_distance(&self) -> &[u16] {
        &self.wall_distance
    }

    pub(crate) fn free_cells(&self) -> usize {
        self.free_cells
    }
}

fn too_large(world: &World) -> MappableAreaError {
    let size = world.bounds.size();
    MappableAreaError::Size { width: size.x, height: size.y }
}

/// A point inside the wall, behind a point of its surface.
fn into_wall(point: WallPoint) -> DVec2 {
    point.position - point.normal * INTO_WALL
}

/// The open cells that are connected to free ones across their sides.
fn joined(frame: ScoreFrame, free: &[bool], open: &[bool]) -> Vec<bool> {
    let mut joined = free.to_vec();
    let mut grown: Vec<usize> = (0..free.len()).filter(|&cell| free[cell]).collect();
    while let Some(cell) = grown.pop() {
        for (x, y) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            if let Some(next) = frame.neighbour(cell, x, y)
                && open[next]
                && !joined[next]
            {
                joined[next] = true;
                grown.push(next);
            }
        }
    }
    joined
}

#[cfg(test)]
pub(crate) mod tests;
