//! Start poses for robots in worlds that have none.

use glam::DVec2;

use crate::distance::squared_distances;
use crate::geometry::Pose;
use crate::grid::{GridFrame, largest_region};
use crate::occupancy::{Coverage, OccupancyError, OccupancyGrid};
use crate::world::World;

/// Side in metres of the cells of the grid on which a pose is searched.
const GRID: f64 = 0.1;

/// Returns the centre of the cell that is farthest from occupied cells and from the grid's border, in the largest
/// free region of a grid; `None` if no cell is free. Cells are connected by their sides. Distances of 255
/// cells and more count as equal. Among equal cells, the first one is taken, row by row from the lowest.
///
/// ```
/// use envgen::occupancy::{Coverage, OccupancyGrid};
/// use envgen::placement::max_clearance_point;
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let grid = OccupancyGrid::of(&world, 0.1, Coverage::Conservative)?;
/// let place = max_clearance_point(&grid).expect("there is free ground");
/// assert!(world.clearance(place) > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn max_clearance_point(grid: &OccupancyGrid) -> Option<DVec2> {
    let frame = grid.frame();
    let GridFrame { cols, rows, .. } = frame;
    let open = grid.cells().iter().map(|occupied| !occupied).collect();
    let region = largest_region(frame, open);
    let distance = squared_distances(cols, grid.cells());
    let room = |cell: usize| {
        let (col, row) = frame.cell(cell);
        let border = (col + 1).min(cols - col).min(row + 1).min(rows - row) as u64;
        u64::from(distance[cell]).min(border * border)
    };
    // `max_by_key` would take the last of equals.
    let best = region
        .into_iter()
        .map(|cell| cell as usize)
        .min_by_key(|&cell| (std::cmp::Reverse(room(cell)), cell))?;
    Some(frame.center_of(best))
}

/// Returns a pose in the largest free region of a world, as far from solid parts as possible on a grid of 0.1 m;
/// `None` if no cell is free.
///
/// ```
/// use envgen::placement::pose_of_most_clearance;
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// // The middle of a corridor 2 m wide, on a grid of 0.1 m.
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let pose = pose_of_most_clearance(&world)?.expect("there is free ground");
/// assert!(world.clearance(pose.position) > 0.8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the world is too large for a grid of that resolution.
pub fn pose_of_most_clearance(world: &World) -> Result<Option<Pose>, OccupancyError> {
    let grid = OccupancyGrid::of(world, GRID, Coverage::Conservative)?;
    Ok(max_clearance_point(&grid).map(|position| Pose { position, heading: 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid from rows of text, the top one first.
    fn grid(rows: &[&str]) -> OccupancyGrid {
        let cells = rows.iter().rev().flat_map(|row| row.bytes().map(|cell| cell == b'#'));
        let cells: Vec<bool> = cells.collect();
        OccupancyGrid::from_cells(DVec2::new(10.0, 20.0), 0.5, rows[0].len(), cells).unwrap()
    }

    #[test]
    fn the_largest_region_wins_and_its_roomiest_place() {
        let place = max_clearance_point(&grid(&[
            "..#......", //
            "..#......",
            "..#......",
            "..#......",
            "..####..#",
        ]));
        // A knight's move from the wall below, three cells from the borders.
        assert_eq!(place, Some(DVec2::new(13.25, 21.25)));
    }

    #[test]
    fn corners_do_not_join() {
        let place = max_clearance_point(&grid(&["..#", "##.", "#.."]));
        assert_eq!(place, Some(DVec2::new(10.75, 20.25)));
    }

    #[test]
    fn without_free_cells_there_is_no_place() {
        assert_eq!(max_clearance_point(&grid(&["##", "##"])), None);
    }
}
