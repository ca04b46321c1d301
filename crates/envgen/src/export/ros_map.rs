//! Occupancy grids in the format of ROS's `map_server` and Nav2: a YAML description and an image.
//!
//! Format: <http://wiki.ros.org/map_server>, and Nav2's `nav2_map_server`.

use std::f64::consts::SQRT_2;
use std::io::{self, Write};

use glam::DVec2;

use super::yaml::quoted;
use crate::flood::flood;
use crate::generate::Spec;
use crate::geometry::{Pose, Shape, edges};
use crate::hallway::Ends;
use crate::occupancy::{self, Coverage, OccupancyError, OccupancyGrid};
use crate::spec::{WorldKind, WorldSpec};
use crate::world::World;

/// The greatest number of cells of a map that is read or written.
pub const MAX_CELLS: u64 = 1 << 26;

/// The allowed cell sides of maps that are read, in metres. With the greatest, a map holds the largest world.
pub const RESOLUTIONS: std::ops::RangeInclusive<f64> = 1e-3..=1e5;

/// An upper bound, in cells, of the rounding error of the position of an outline.
const ROUNDING: f64 = 1e-6;

/// The default side in metres of the cells of a written map, unless the world is too large for it.
pub const RESOLUTION: f64 = 0.05;

/// The greatest number of cells of a map if no resolution is given. Its image has 17 MB.
pub const USUAL_CELLS: u64 = 1 << 24;

/// The probability of occupancy above which a cell of a written map is occupied.
pub const OCCUPIED_THRESHOLD: f64 = 0.65;

/// The probability of occupancy below which a cell of a written map is free. The grey of unknown cells, 205, is
/// just not below it.
pub const FREE_THRESHOLD: f64 = 0.196;

/// The state of a cell of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RosCell {
    /// The cell is unknown.
    Unknown,
    /// The cell is free.
    Free,
    /// The cell is occupied.
    Occupied,
}

impl RosCell {
    /// Returns the grey of the cell in the image.
    fn grey(self) -> u8 {
        match self {
            RosCell::Unknown => 205,
            RosCell::Free => 254,
            RosCell::Occupied => 0,
        }
    }
}

/// A map: square cells over a rectangle that may be rotated.
///
/// ```
/// use envgen::export::ros_map::{RosCell, RosMap};
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let map = RosMap::of_world(&world, 0.05)?;
/// assert!(map.cells.contains(&RosCell::Free));
/// let (mut yaml, mut image) = (Vec::new(), Vec::new());
/// map.write_yaml("hallway.pgm", &mut yaml)?;
/// map.write_pgm(&mut image)?;
/// assert!(image.starts_with(b"P5"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RosMap {
    /// Number of columns.
    pub cols: usize,
    /// Side of a cell in metres.
    pub resolution: f64,
    /// The lower left corner of the lowest, leftmost cell, and the direction of the rows.
    pub origin: Pose,
    /// The cells, row by row from the lowest, with `cols` cells per row.
    pub cells: Vec<RosCell>,
}

impl RosMap {
    /// Creates the map that a robot can learn of a world from its start.
    ///
    /// A cell is occupied if its centre lies in a solid part, or if it is touched by a part that is so thin that it
    /// may miss all centres. The other cells are free if a path over their sides connects them with the start. They
    /// are unknown elsewhere: outside a corridor or a building, in closed rooms, beside a road, and around a
    /// forest. In a world without a start, all of them are free.
    ///
    /// # Errors
    /// When the resolution is not positive, or gives more than [`MAX_CELLS`] cells.
    pub fn of_world(world: &World, resolution: f64) -> Result<Self, OccupancyError> {
        size_in_cells(world, resolution)?;
        let mut grid = OccupancyGrid::empty(world.bounds, resolution)?;
        for solid in world.solids() {
            occupy(&mut grid, &solid.shape);
        }
        let cell = |&occupied: &bool| if occupied { RosCell::Occupied } else { RosCell::Unknown };
        let mut cells: Vec<RosCell> = grid.cells().iter().map(cell).collect();
        let mut open: Vec<bool> = grid.cells().iter().map(|occupied| !occupied).collect();
        close_outside(world, &grid, &mut open);
        match world.start {
            None => open.iter().zip(&mut cells).filter(|(open, _)| **open).for_each(|(_, cell)| {
                *cell = RosCell::Free;
            }),
            Some(start) => {
                if let Some(first) = nearest(&grid, &open, start.position) {
                    flood(grid.cols(), &mut open, first, |run| cells[run].fill(RosCell::Free));
                }
            }
        }
        Ok(RosMap { cols: grid.cols(), resolution, origin: origin(world), cells })
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.cells.len() / self.cols.max(1)
    }

    /// Returns the greys of the cells, with the top row first, as in images.
    fn greys(&self) -> Vec<u8> {
        let rows = self.cells.chunks_exact(self.cols.max(1)).rev();
        rows.flatten().map(|cell| cell.grey()).collect()
    }

    /// Writes the description of the map, which contains the name of its image file.
    ///
    /// # Errors
    /// When writing fails.
    pub fn write_yaml(&self, image: &str, out: &mut dyn Write) -> io::Result<()> {
        write_description(image, self.resolution, self.origin, out)
    }

    /// Writes the map's image as a binary PGM: 254 free, 205 unknown, 0 occupied.
    ///
    /// # Errors
    /// When writing fails.
    pub fn write_pgm(&self, out: &mut dyn Write) -> io::Result<()> {
        write!(out, "P5\n{} {}\n255\n", self.cols, self.rows())?;
        out.write_all(&self.greys())
    }

    /// Writes the map's image as a grey PNG, with the same greys.
    ///
    /// # Errors
    /// When writing fails, or the map has no cells.
    #[cfg(feature = "picture")]
    pub fn write_png(&self, out: &mut dyn Write) -> io::Result<()> {
        let side = |len: usize| u32::try_from(len).map_err(io::Error::other);
        let mut encoder = png::Encoder::new(out, side(self.cols)?, side(self.rows())?);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        writer.write_image_data(&self.greys()).map_err(io::Error::other)?;
        writer.finish().map_err(io::Error::other)
    }
}

/// Occupies the cells of a grid whose centres lie in a shape, or that are touched by a shape that is so thin that it
/// may miss all centres.
fn occupy(grid: &mut OccupancyGrid, shape: &Shape) {
    // Rounding must not make a box as thick as a cell count as thinner, nor let it miss all middles.
    let resolution = grid.frame().cell_size;
    let margin = ROUNDING * resolution;
    let thinnest = resolution - margin;
    let thin = match shape {
        Shape::Box { half_size, .. } => 2.0 * half_size.min_element() < thinnest,
        // A disc that is thinner than the diagonal of a cell may have no middle in it.
        Shape::Disc { radius, .. } => 2.0 * radius < SQRT_2 * resolution,
        // The width of a strip is a little more than twice its area over its outline.
        Shape::Polygon { vertices } => {
            let outline: f64 = edges(vertices).map(|(a, b)| a.distance(b)).sum();
            2.0 * shape.area() < thinnest * outline
        }
        Shape::Segment { .. } => false,
    };
    match shape {
        shape if thin => grid.occupy(shape, Coverage::Conservative),
        &Shape::Box { center, half_size, heading }
            if 2.0 * half_size.min_element() < resolution + margin =>
        {
            let half_size = half_size + margin;
            grid.occupy(&Shape::Box { center, half_size, heading }, Coverage::Centre);
        }
        shape => grid.occupy(shape, Coverage::Centre),
    }
}

/// Returns the lower left corner of the map of a world.
pub(super) fn origin(world: &World) -> Pose {
    Pose { position: world.bounds.min, heading: 0.0 }
}

/// Returns the default resolution in metres of the map of a world: [`RESOLUTION`], or the resolution that is
/// coarser by the power of two that gives at most [`USUAL_CELLS`].
///
/// ```
/// use envgen::export::ros_map::{size_in_cells, usual_resolution};
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// let small = ForestSpec::default().generate(Seed(7))?.to_world();
/// assert_eq!(usual_resolution(&small), 0.05);
/// // A square kilometre gets cells of 0.4 m, since 16 million are the most.
/// let large = ForestSpec { width: 1000.0, height: 1000.0, intensity: 0.0, ..Default::default() };
/// let large = large.generate(Seed(7))?.to_world();
/// assert_eq!(usual_resolution(&large), 0.4);
/// assert_eq!(size_in_cells(&large, 0.4)?, [2500, 2500]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn usual_resolution(world: &World) -> f64 {
    let size = world.bounds.size() + RESOLUTION;
    let mut resolution = RESOLUTION;
    let cells = |resolution: f64| (size.x / resolution + 1.0) * (size.y / resolution + 1.0);
    // No wider than can be read.
    while cells(resolution) > USUAL_CELLS as f64 && 2.0 * resolution <= *RESOLUTIONS.end() {
        resolution *= 2.0;
    }
    resolution
}

/// Returns the numbers of columns and rows of the map of a world, without making the map.
///
/// # Errors
/// As [`RosMap::of_world`].
pub fn size_in_cells(world: &World, resolution: f64) -> Result<[u64; 2], OccupancyError> {
    occupancy::size_in_cells(world.bounds, resolution, MAX_CELLS)
}

/// Writes the description of a map.
pub(super) fn write_description(
    image: &str,
    resolution: f64,
    origin: Pose,
    out: &mut dyn Write,
) -> io::Result<()> {
    let Pose { position, heading } = origin;
    writeln!(out, "image: {}", quoted(image))?;
    writeln!(out, "mode: trinary")?;
    writeln!(out, "resolution: {resolution:?}")?;
    writeln!(out, "origin: [{:?}, {:?}, {heading:?}]", position.x, position.y)?;
    writeln!(out, "negate: 0")?;
    writeln!(out, "occupied_thresh: {OCCUPIED_THRESHOLD}")?;
    writeln!(out, "free_thresh: {FREE_THRESHOLD}")
}

/// The greatest deviation, in metres, of the drawn edge of a road from the true edge.
const EDGE_TOLERANCE: f64 = 0.01;

/// Closes the cells beyond the bounds, where the centres of the last row and column may lie, and those outside of
/// worlds that are not enclosed by walls: the ground beside a road, and around the area of a forest.
fn close_outside(world: &World, grid: &OccupancyGrid, open: &mut [bool]) {
    let (frame, end) = (grid.frame(), world.bounds.max - 1e-9 * grid.resolution());
    for (cell, open) in open.iter_mut().enumerate() {
        *open &= frame.center_of(cell).cmplt(end).all();
    }
    match world.provenance.original().kind.parse() {
        Ok(WorldKind::Road) if !world.road_strips.is_empty() => {
            let Ok(mut inside) = OccupancyGrid::empty(world.bounds, grid.resolution()) else {
                return;
            };
            for strip in &world.road_strips {
                let edges = strip.mesh(EDGE_TOLERANCE).vertices;
                for pair in edges.windows(4).step_by(2) {
                    let vertices = vec![pair[0], pair[1], pair[3], pair[2]];
                    inside.occupy(&Shape::Polygon { vertices }, Coverage::Centre);
                }
            }
            open.iter_mut().zip(inside.cells()).for_each(|(open, inside)| *open &= inside);
        }
        Ok(WorldKind::Forest) => {
            let Some(WorldSpec::Forest(spec)) = spec_of(world) else { return };
            let area = spec.area();
            // A file may have been moved by other tools.
            if !world.bounds.grown(1e-6).contains_rect(area) {
                return;
            }
            for (cell, open) in open.iter_mut().enumerate() {
                *open &= area.contains(frame.center_of(cell));
            }
        }
        Ok(WorldKind::Hallway) => {
            let Ok(mut ends) = OccupancyGrid::empty(world.bounds, grid.resolution()) else {
                return;
            };
            for [a, b] in open_ends(world) {
                ends.occupy(&Shape::Segment { a, b }, Coverage::Conservative);
            }
            open.iter_mut().zip(ends.cells()).for_each(|(open, is_end)| *open &= !is_end);
        }
        _ => {}
    }
}

/// Returns the spec of a generated world, if it is a valid spec of this version.
fn spec_of(world: &World) -> Option<WorldSpec> {
    let provenance = world.provenance.original();
    let kind: WorldKind = provenance.kind.parse().ok()?;
    if provenance.value_version != kind.value_version() {
        return None;
    }
    WorldSpec::from_provenance(&provenance).ok().filter(|spec| spec.validate().is_ok())
}

/// Returns the lines across the open ends of a hallway, from the outside of one wall to the outside of the other.
fn open_ends(world: &World) -> Vec<[DVec2; 2]> {
    let original = world.provenance.original();
    let (Some(WorldSpec::Hallway(spec)), Some(seed)) = (spec_of(world), original.seed) else {
        return Vec::new();
    };
    // Changed by hand it may lead elsewhere.
    if spec.ends == Ends::Closed || world.provenance.edited || original.edited {
        return Vec::new();
    }
    let Ok(hallway) = spec.generate(seed) else { return Vec::new() };
    let layout = hallway.layout();
    let faces = [layout.left_face(), layout.right_face()];
    let across = |end: fn(&[DVec2]) -> Option<&DVec2>| {
        let [left, right] = [end(&faces[0])?, end(&faces[1])?];
        let wall = (left - right).normalize_or_zero() * spec.wall_thickness;
        Some([left + wall, right - wall])
    };
    // A file may have been moved by other tools.
    let bounds = world.bounds.grown(1e-6);
    let is_here = |end: &[DVec2; 2]| end.iter().all(|p| bounds.contains(*p));
    let ends = [across(<[DVec2]>::first), across(<[DVec2]>::last)];
    ends.into_iter().flatten().filter(is_here).collect()
}

/// Returns the open cell whose centre is nearest to a point.
pub(super) fn nearest(grid: &OccupancyGrid, open: &[bool], p: DVec2) -> Option<usize> {
    let frame = grid.frame();
    if let Some(cell) = frame.index_at(p).filter(|&cell| open[cell]) {
        return Some(cell);
    }
    let distance = |cell: &usize| frame.center_of(*cell).distance_squared(p);
    let cells = (0..open.len()).filter(|&cell| open[cell]);
    cells.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Blueprint, Spec};
    use crate::geometry::Rect;
    use crate::hallway::{Corners, HallwaySpec};
    use crate::provenance::Provenance;
    use crate::seed::Seed;
    use crate::world::{MAX_COORDINATE, Wall, WallKind};

    fn world() -> World {
        let bounds = Rect::new(DVec2::new(-1.0, 2.0), DVec2::new(1.0, 3.0));
        let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        let rect = Rect::new(DVec2::new(-1.0, 2.5), DVec2::new(0.0, 3.0));
        world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(rect)));
        world
    }

    #[test]
    fn files_are_as_the_format_says() {
        let map = RosMap::of_world(&world(), 0.5).unwrap();
        let mut image = Vec::new();
        map.write_pgm(&mut image).unwrap();
        assert_eq!(image, b"P5\n4 2\n255\n\x00\x00\xfe\xfe\xfe\xfe\xfe\xfe");
        let mut yaml = Vec::new();
        map.write_yaml("a \"b\".pgm", &mut yaml).unwrap();
        let expected = "image: \"a \\\"b\\\".pgm\"\nmode: trinary\nresolution: 0.5\n\
                        origin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
                        free_thresh: 0.196\n";
        assert_eq!(String::from_utf8(yaml).unwrap(), expected);
    }

    #[test]
    fn thin_walls_stay_closed() {
        let mut world = world();
        let shape = Shape::thick_segment(DVec2::new(-1.0, 2.1), DVec2::new(1.0, 2.1), 0.01, 0.0);
        world.walls.push(Wall::new(WallKind::Wall, shape));
        let map = RosMap::of_world(&world, 0.5).unwrap();
        assert!(map.cells[..4].iter().all(|cell| *cell == RosCell::Occupied));
    }

    #[test]
    fn free_cells_do_not_leak() {
        // Thin walls of rounded corners, which are polygons.
        let hallway =
            HallwaySpec { corners: Corners::Rounded, wall_thickness: 0.04, ..Default::default() };
        let world = hallway.generate(Seed(7)).unwrap().to_world();
        for resolution in [0.05, 0.1, 0.2] {
            let map = RosMap::of_world(&world, resolution).unwrap();
            let free = map.cells.iter().filter(|&&cell| cell == RosCell::Free).count();
            let area = free as f64 * resolution * resolution;
            assert!((200.0..300.0).contains(&area), "{resolution}: {area}");
        }
        // A wall across a world whose last row and column lie beyond the bounds.
        let mut world = World::new(
            Provenance::other("manual", serde_json::Value::Null),
            Rect::new(DVec2::ZERO, DVec2::splat(4.0)),
        );
        let rect = Rect::new(DVec2::new(2.0, 0.0), DVec2::new(2.9, 4.0));
        world.walls.push(Wall::new(WallKind::Wall, Shape::from_rect(rect)));
        world.start = Some(Pose::new(1.0, 1.0, 0.0));
        for resolution in [0.9, 0.8, 0.75, 0.6, 0.5] {
            let map = RosMap::of_world(&world, resolution).unwrap();
            for (cell, state) in map.cells.iter().enumerate() {
                let x = ((cell % map.cols) as f64 + 0.5) * resolution;
                assert!(*state != RosCell::Free || x < 2.0, "{resolution}: cell {cell}");
            }
        }
    }

    #[test]
    fn the_size_of_a_map_is_known_before_it_is_made() {
        // Bounds that are a whole number of cells, up to rounding.
        for (seed, resolution) in (0..20).flat_map(|seed| [(seed, 0.05), (seed, 0.1), (seed, 0.3)])
        {
            let world = HallwaySpec::default().generate(Seed(seed)).unwrap().to_world();
            let map = RosMap::of_world(&world, resolution).unwrap();
            let made = [map.cols as u64, map.rows() as u64];
            assert_eq!(size_in_cells(&world, resolution), Ok(made), "{seed} at {resolution} m");
        }
    }

    #[test]
    fn large_worlds_get_larger_cells() {
        let mut world = world();
        world.bounds.max = DVec2::splat(1000.0);
        let error = RosMap::of_world(&world, 0.05).unwrap_err().to_string();
        assert!(error.contains("about 1.22e-1 m or more") && error.contains("67108864"), "{error}");
        assert_eq!(usual_resolution(&world), 0.4);
        assert_eq!(size_in_cells(&world, 0.4), Ok([2503, 2495]));
        assert!(RosMap::of_world(&world, f64::NAN).is_err());
        assert!(RosMap::of_world(&world, -1.0).is_err());
    }

    #[test]
    fn the_largest_worlds_have_a_map() {
        let bounds = Rect::new(DVec2::splat(-MAX_COORDINATE), DVec2::splat(MAX_COORDINATE));
        let world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
        let usual = usual_resolution(&world);
        let [cols, rows] = size_in_cells(&world, usual).unwrap();
        assert!(cols * rows <= USUAL_CELLS && RESOLUTIONS.contains(&usual), "{usual} m");
    }

    fn free_area(world: &World, resolution: f64) -> f64 {
        let map = RosMap::of_world(world, resolution).unwrap();
        let free = map.cells.iter().filter(|cell| **cell == RosCell::Free).count();
        free as f64 * resolution * resolution
    }

    #[test]
    fn walls_as_thick_as_a_cell_stay_closed() {
        for seed in 0..20 {
            let spec = HallwaySpec { segments: 20, ..Default::default() };
            let resolution = spec.wall_thickness;
            let hallway = spec.generate(Seed(seed)).unwrap();
            let corridor = spec.width * hallway.layout().length();
            let free = free_area(&hallway.to_world(), resolution);
            assert!((0.8..1.3).contains(&(free / corridor)), "seed {seed}: {free} of {corridor}");
        }
    }

    #[test]
    fn what_is_beyond_open_ends_is_unknown() {
        for seed in 0..20 {
            let corners = if seed % 2 == 0 { Corners::Square } else { Corners::Rounded };
            let spec =
                HallwaySpec { segments: 20, ends: Ends::Open, corners, ..Default::default() };
            let hallway = spec.generate(Seed(seed)).unwrap();
            let corridor = spec.width * hallway.layout().length();
            let free = free_area(&hallway.to_world(), 0.05);
            assert!((0.9..1.2).contains(&(free / corridor)), "seed {seed}: {free} of {corridor}");
        }
    }

    #[test]
    fn no_tree_is_too_thin_for_a_cell() {
        let mut world = world();
        world.walls.clear();
        for i in 0..100 {
            let at = DVec2::new(-0.9 + 0.0187 * f64::from(i), 2.1 + 0.0071 * f64::from(i));
            world.trees = vec![crate::world::Tree::new(at, 0.06)];
            let map = RosMap::of_world(&world, 0.1).unwrap();
            assert!(map.cells.contains(&RosCell::Occupied), "a tree at {at}");
        }
    }

    #[test]
    fn a_forest_ends_at_its_area_without_a_certificate() {
        let spec = crate::forest::ForestSpec { width: 10.0, height: 10.0, ..Default::default() };
        let mut world = spec.generate(Seed(3)).unwrap().to_world();
        let map = RosMap::of_world(&world, 0.1).unwrap();
        world.certificate.clear();
        assert_eq!(RosMap::of_world(&world, 0.1).unwrap(), map);
    }
}
