//! Pictures of maps, with trajectories: the robot's map, the mappable area, and their differences.

use envgen::geometry::{Pose, Rect, unit_vector};
use envgen::palette::{Srgb, map};
use envgen::picture::Figure;
use glam::DVec2;

use crate::map::{DECIDED, OccupancyMap, RESOLUTION, TILE};
use crate::mappable_area::MappableArea;
use envgen::distance::squared_distances;

/// Greatest number of pixels along a side. Larger areas have coarser pixels.
const MAX_SIDE: f64 = 4000.0;

/// Distance in metres up to which a wall counts as mapped in its place, as in the scores.
const IN_PLACE: f64 = 0.30;

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum PixelClass {
    Unknown,
    Free,
    Wall,
    /// A wall of the map that the world does not have.
    False,
    /// A wall that the map does not show.
    Missed,
    /// Ground that the map does not show as free.
    Unseen,
    TruePath,
    EstimatedPath,
    /// Where no robot can see, and there is nothing to map.
    Outside,
}

/// The colour of each class, and what it means.
const LEGEND: [(Srgb, &str); 9] = [
    (map::UNKNOWN, "unknown"),
    (map::FREE, "free"),
    (map::OCCUPIED, "wall"),
    (map::FALSE_WALL, "wall only in the map"),
    (map::MISSED_WALL, "missed wall"),
    (map::NOT_MAPPED, "free but not mapped"),
    (map::TRUE_TRAJECTORY, "true trajectory"),
    (map::ESTIMATED_TRAJECTORY, "estimated trajectory"),
    (map::OUTSIDE, "nothing to map"),
];

/// A picture of an area, pixel by pixel.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::picture::Picture;
/// use mapping_trial::robot::Robot;
/// use mapping_trial::mappable_area::MappableArea;
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let area = MappableArea::new(&world, &Robot::default())?;
/// // A map without errors over the mappable area.
/// let picture = Picture::of_errors(&area, &area.perfect_map(), world.bounds);
/// let svg = picture.figure("perfect", vec!["coverage 100 %".to_owned()]).svg()?;
/// assert!(svg.starts_with("<svg"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Picture {
    area: Rect,
    /// Side of a pixel in metres.
    pixel: f64,
    width: usize,
    height: usize,
    /// From the lower left, row by row.
    classes: Vec<PixelClass>,
}

impl Picture {
    /// Draws a map: free cells white, occupied ones black, unknown ones grey, as usual for ROS maps. In
    /// large areas, where a pixel covers several cells, it is black if one of them is occupied,
    /// otherwise white if one is free.
    pub fn of_map(map: &OccupancyMap, area: Rect) -> Self {
        let mut picture = Picture::empty(area);
        let size = DVec2::new(picture.width as f64, picture.height as f64);
        // Pixels begin where cells do. Cells are counted in `f64`, since an area may be larger than maps.
        let first = (picture.area.min / RESOLUTION + 0.5).floor();
        let scale = (picture.pixel / RESOLUTION).round();
        for ((col, row), cells) in map.tiles() {
            let corner = DVec2::new(f64::from(col), f64::from(row)) * f64::from(TILE) - first;
            let end = corner + f64::from(TILE);
            if end.cmple(DVec2::ZERO).any() || corner.cmpge(size * scale).any() {
                continue;
            }
            for (row, cells) in cells.chunks_exact(TILE as usize).enumerate() {
                for (col, &odds) in cells.iter().enumerate().filter(|(_, odds)| is_known(**odds)) {
                    let cell = corner + DVec2::new(col as f64, row as f64);
                    let at = (cell / scale).floor();
                    if at.cmplt(DVec2::ZERO).any() || at.cmpge(size).any() {
                        continue;
                    }
                    let class = &mut picture.classes[at.y as usize * picture.width + at.x as usize];
                    if odds > 0 {
                        *class = PixelClass::Wall;
                    } else if *class == PixelClass::Unknown {
                        *class = PixelClass::Free;
                    }
                }
            }
        }
        picture
    }

    /// Draws the mappable area: ground that the robot can reach white, walls that can be seen from
    /// there black, the rest light grey.
    pub fn of_truth(truth: &MappableArea, area: Rect) -> Self {
        let mut picture = Picture::of_map(&truth.perfect_map(), area);
        for class in picture.classes.iter_mut().filter(|class| **class == PixelClass::Unknown) {
            *class = PixelClass::Outside;
        }
        picture
    }

    /// Compares a map with the mappable area: walls in their place black, walls that do not exist
    /// vermilion, walls that the map does not show blue, ground that it does not show as free light
    /// blue, and light grey where there is nothing to map.
    pub fn of_errors(truth: &MappableArea, map: &OccupancyMap, area: Rect) -> Self {
        let mut picture = Picture::of_map(map, area);
        let perfect = Picture::of_truth(truth, area);
        let near = |picture: &Picture| {
            let walls: Vec<bool> =
                picture.classes.iter().map(|class| *class == PixelClass::Wall).collect();
            let limit = IN_PLACE / picture.pixel;
            let squared = squared_distances(picture.width, &walls);
            squared.into_iter().map(|d| f64::from(d) <= limit * limit).collect::<Vec<bool>>()
        };
        let (near_map, near_truth) = (near(&picture), near(&perfect));
        for (i, class) in picture.classes.iter_mut().enumerate() {
            *class = match (*class, perfect.classes[i]) {
                (PixelClass::Wall, _) if near_truth[i] => PixelClass::Wall,
                (PixelClass::Wall, _) => PixelClass::False,
                (_, PixelClass::Wall) if !near_map[i] => PixelClass::Missed,
                (PixelClass::Unknown, PixelClass::Free) => PixelClass::Unseen,
                (PixelClass::Unknown, PixelClass::Outside) => PixelClass::Outside,
                (found, _) => found,
            };
        }
        picture
    }

    /// Draws a robot's true trajectory in green.
    pub fn draw_true_path(&mut self, poses: &[Pose]) {
        self.draw_path(poses, PixelClass::TruePath);
    }

    /// Draws a robot's estimated trajectory in pink.
    pub fn draw_estimated_path(&mut self, poses: &[Pose]) {
        self.draw_path(poses, PixelClass::EstimatedPath);
    }

    /// Returns the picture with its scale, a legend of its colours, and notes below, to be written as
    /// SVG or PNG.
    pub fn figure(&self, title: &str, notes: Vec<String>) -> Figure {
        // The top row comes first.
        let rows = self.classes.chunks_exact(self.width).rev();
        Figure {
            title: title.to_owned(),
            cell: self.pixel,
            width: self.width as u32,
            cells: rows.flatten().map(|class| *class as u8).collect(),
            colors: LEGEND.map(|(color, name)| (color, name.to_owned())).to_vec(),
            notes,
        }
    }

    fn empty(area: Rect) -> Self {
        let size = area.size().max(DVec2::splat(RESOLUTION));
        let scale = (size.max_element() / RESOLUTION / MAX_SIDE).ceil().max(1.0);
        let pixel = scale * RESOLUTION;
        let low = (area.min / pixel).floor() * pixel;
        let cells =
            ((area.max - low) / pixel).ceil().clamp(DVec2::ONE, DVec2::splat(MAX_SIDE + 1.0));
        let (width, height) = (cells.x as usize, cells.y as usize);
        let area = Rect::new(low, low + cells * pixel);
        Picture { area, pixel, width, height, classes: vec![PixelClass::Unknown; width * height] }
    }

    /// A line three pixels wide along the poses, an arrow's head at the start and a ring at the end.
    fn draw_path(&mut self, poses: &[Pose], class: PixelClass) {
        for pose in poses {
            self.dot(pose.position, 1.5 * self.pixel, class);
        }
        if let (Some(start), Some(end)) = (poses.first(), poses.last()) {
            // A triangle that points in the robot's heading.
            for step in 0..=20 {
                let along = f64::from(step) / 20.0;
                let half = 0.25 * (1.0 - along);
                let ahead = unit_vector(start.heading);
                let middle = start.position + ahead * (0.7 * along - 0.2);
                for side in -5..=5 {
                    let off = ahead.perp() * half * f64::from(side) / 5.0;
                    self.dot(middle + off, 1.5 * self.pixel, class);
                }
            }
            for step in 0..48 {
                let turn = std::f64::consts::TAU * f64::from(step) / 48.0;
                self.dot(end.position + unit_vector(turn) * 0.35, 1.5 * self.pixel, class);
            }
        }
    }

    fn dot(&mut self, at: DVec2, radius: f64, class: PixelClass) {
        let middle = (at - self.area.min) / self.pixel;
        let reach = radius / self.pixel;
        if !middle.is_finite() || middle.abs().max_element() > 2.0 * MAX_SIDE {
            return;
        }
        let (low, high) = ((middle - reach).floor(), (middle + reach).ceil());
        for row in low.y.max(0.0) as usize..(high.y.max(0.0) as usize).min(self.height) {
            for col in low.x.max(0.0) as usize..(high.x.max(0.0) as usize).min(self.width) {
                let centre = DVec2::new(col as f64, row as f64) + 0.5;
                if centre.distance(middle) <= reach {
                    self.classes[row * self.width + col] = class;
                }
            }
        }
    }
}

/// Whether log odds are those of an occupied or a free cell.
fn is_known(odds: i16) -> bool {
    !(-DECIDED..=DECIDED).contains(&odds)
}

#[cfg(test)]
mod tests {
    use envgen::hallway::HallwaySpec;
    use envgen::{Blueprint, Seed, Spec, World};
    use proptest::prelude::*;

    use super::*;
    use crate::map::{CLAMP, Cell, CellIndex, HIT};
    use crate::robot::Robot;

    /// What the cells under a pixel are, each looked at.
    fn look(picture: &Picture, map: &OccupancyMap, col: usize, row: usize) -> PixelClass {
        let corner = picture.area.min + DVec2::new(col as f64, row as f64) * picture.pixel;
        let first = CellIndex::of(corner + 0.5 * RESOLUTION);
        let scale = (picture.pixel / RESOLUTION).round() as i32;
        let cells = (0..scale).flat_map(|y| (0..scale).map(move |x| (x, y)));
        let found: Vec<Cell> = cells
            .map(|(x, y)| map.cell(CellIndex { col: first.col + x, row: first.row + y }))
            .collect();
        if found.contains(&Cell::Occupied) {
            PixelClass::Wall
        } else if found.contains(&Cell::Free) {
            PixelClass::Free
        } else {
            PixelClass::Unknown
        }
    }

    fn world() -> World {
        let spec = HallwaySpec { segments: 3, ..Default::default() };
        spec.generate(Seed(7)).expect("a hallway").to_world()
    }

    fn truth() -> MappableArea {
        MappableArea::new(&world(), &Robot::default()).expect("a start")
    }

    fn count(picture: &Picture, class: PixelClass) -> usize {
        picture.classes.iter().filter(|found| **found == class).count()
    }

    #[test]
    fn no_two_meanings_have_one_colour() {
        for (i, (color, name)) in LEGEND.iter().enumerate() {
            assert!(LEGEND[..i].iter().all(|(other, _)| other != color), "{name}");
        }
    }

    #[test]
    fn the_perfect_map_has_no_errors_and_the_empty_one_nothing_right() {
        let truth = truth();
        let area = truth.frame().area();
        let perfect = Picture::of_errors(&truth, &truth.perfect_map(), area);
        assert!(
            count(&perfect, PixelClass::Wall) > 100 && count(&perfect, PixelClass::Free) > 1000
        );
        for class in [PixelClass::False, PixelClass::Missed, PixelClass::Unseen] {
            assert_eq!(count(&perfect, class), 0, "{class:?}");
        }
        let empty = Picture::of_errors(&truth, &OccupancyMap::new(), area);
        assert_eq!(count(&empty, PixelClass::Missed), count(&perfect, PixelClass::Wall));
        assert_eq!(count(&empty, PixelClass::Unseen), count(&perfect, PixelClass::Free));
    }

    #[test]
    fn a_wall_out_of_place_is_false_and_the_true_one_missed() {
        let truth = truth();
        let mut map = OccupancyMap::new();
        let middle = world().start.expect("a start, a metre from the walls");
        map.add(CellIndex::of(middle.position), 200);
        let picture = Picture::of_errors(&truth, &map, truth.frame().area());
        assert_eq!(count(&picture, PixelClass::False), 1);
    }

    #[test]
    fn figures_hold_the_pixels_top_row_first() {
        let mut map = OccupancyMap::new();
        map.add(CellIndex { col: 0, row: 1 }, 200);
        map.add(CellIndex { col: 1, row: 0 }, -200);
        let area = Rect::new(DVec2::ZERO, DVec2::splat(2.0 * RESOLUTION));
        let figure = Picture::of_map(&map, area).figure("map", Vec::new());
        let named = figure.cells.iter().map(|cell| figure.colors[usize::from(*cell)].1.as_str());
        assert_eq!(named.collect::<Vec<_>>(), ["wall", "unknown", "unknown", "free"]);
        let mut file = Vec::new();
        figure.write_png(&mut file).expect("memory takes all");
        assert!(file.starts_with(b"\x89PNG"));
    }

    #[test]
    fn what_is_known_is_shown_wherever_it_is() {
        let truth = truth();
        let mut map = truth.perfect_map();
        let known = truth.frame().area();
        // Also in the outermost cells.
        let bounds = map.bounds().expect("there are cells");
        for p in [bounds.min + 0.5 * RESOLUTION, bounds.max - 0.5 * RESOLUTION] {
            map.add(CellIndex::of(p), HIT);
        }
        // The whole map and parts of it, also with several cells per pixel, and nothing of it.
        for (from, to) in [(-1.0, 2.0), (0.3, 0.6), (-40.0, 30.0), (0.5, 50.0), (2.0, 3.0)] {
            let corner = |x: f64, y: f64| known.min + known.size() * DVec2::new(x, y);
            let picture = Picture::of_map(&map, Rect::new(corner(from, -0.2), corner(to, 0.8)));
            for (i, class) in picture.classes.iter().enumerate() {
                let expected = look(&picture, &map, i % picture.width, i / picture.width);
                assert_eq!(*class, expected, "from {from} to {to}, pixel {i}");
            }
        }
    }

    #[test]
    fn a_small_map_is_drawn_in_an_area_of_any_size() {
        let mut map = OccupancyMap::new();
        (0..20).for_each(|col| map.add(CellIndex { col, row: 3 }, CLAMP));
        map.add(CellIndex { col: 0, row: 0 }, -CLAMP);
        for half in [5e3, 1e6, 5e7, 1e8, 1e12] {
            // The map is in one quarter, in a pixel of its own.
            let area = Rect::new(DVec2::splat(-half), DVec2::splat(half));
            let picture = Picture::of_map(&map, area);
            let known: Vec<usize> = (0..picture.classes.len())
                .filter(|&i| picture.classes[i] != PixelClass::Unknown)
                .collect();
            assert_eq!(known.len(), 1, "{half}");
            assert_eq!(picture.classes[known[0]], PixelClass::Wall, "{half}");
            let at =
                DVec2::new((known[0] % picture.width) as f64, (known[0] / picture.width) as f64);
            let low = picture.area.min + at * picture.pixel;
            assert!(low.abs().max_element() < 1e-3 * picture.pixel, "{half}: {low}");
        }
        // Far from the map there is nothing.
        let far = Picture::of_map(&map, Rect::new(DVec2::splat(1e9), DVec2::splat(1e9 + 1.0)));
        assert_eq!(count(&far, PixelClass::Unknown), far.classes.len());
        Picture::of_map(&map, Rect::new(DVec2::splat(-1e300), DVec2::splat(1e300)));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn every_pixel_shows_the_cells_below_it(
            cells in prop::collection::vec((-90..90_i32, -90..90_i32, any::<bool>()), 0..40),
            x in -6.0..6.0_f64, y in -6.0..6.0_f64, long in 0.01..700.0_f64, wide in 0.01..3.0_f64,
        ) {
            let mut map = OccupancyMap::new();
            for (col, row, occupied) in cells {
                map.add(CellIndex { col, row }, if occupied { CLAMP } else { -CLAMP });
            }
            let low = DVec2::new(x, y);
            let picture = Picture::of_map(&map, Rect::new(low, low + DVec2::new(long, wide)));
            for (i, class) in picture.classes.iter().enumerate() {
                prop_assert_eq!(*class, look(&picture, &map, i % picture.width, i / picture.width));
            }
        }
    }

    #[test]
    fn paths_stay_inside_and_huge_areas_get_coarse() {
        let area = Rect::new(DVec2::splat(-1000.0), DVec2::splat(1000.0));
        let mut picture = Picture::of_map(&OccupancyMap::new(), area);
        assert!(picture.width <= 4001 && picture.pixel > 0.4);
        let far =
            [Pose::new(0.0, 0.0, 0.0), Pose::new(1e9, 0.0, 0.0), Pose::new(f64::NAN, 0.0, 0.0)];
        picture.draw_true_path(&far);
        picture.draw_estimated_path(&far[..1]);
        assert!(count(&picture, PixelClass::EstimatedPath) > 0);
    }
}
