//! A world as a plan of the data set HouseExpo: T. Li and others, HouseExpo: A Large-scale 2D Indoor Layout Dataset
//! for Learning-based Algorithms on Mobile Robots, arXiv:1903.09845.
//!
//! The format contains a single outline of free ground. It is the outline of those cells of a grid that are connected
//! with the start and that no solid enters; solids inside that do not touch it are lost. At lines without thickness,
//! such as the walls of a house that was read, the outline follows the sides of cells that are nearest to the line.
//! Start and goal are in separate fields, which other readers ignore.

use std::collections::BTreeMap;
use std::io::Write;

use glam::DVec2;
use serde::Serialize;

use super::error::ExportError;
use super::ros_map::{nearest, size_in_cells, usual_resolution};
use crate::flood::flood;
use crate::geometry::{Pose, Shape};
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::placement::max_clearance_point;
use crate::provenance::Provenance;
use crate::raycast::Raycaster;
use crate::world::World;

/// A house, with the fields of the data set and some additional ones.
#[derive(Serialize)]
struct House<'a> {
    id: &'a str,
    room_num: usize,
    bbox: Bounds,
    verts: Vec<[f64; 2]>,
    room_category: BTreeMap<&'a str, Vec<[f64; 4]>>,
    start: Option<[f64; 3]>,
    goal: Option<[f64; 3]>,
    provenance: &'a Provenance,
}

#[derive(Serialize)]
struct Bounds {
    min: [f64; 2],
    max: [f64; 2],
}

/// Writes the outline of the ground that can be reached from the start, on a grid with cells of `resolution` metres.
pub(super) fn write(
    world: &World,
    id: &str,
    resolution: Option<f64>,
    out: &mut dyn Write,
) -> Result<(), ExportError> {
    // The stem of `a.house.json` is `a.house`.
    let id = match id.rsplit_once('.') {
        Some((name, ending)) if ending.eq_ignore_ascii_case("house") => name,
        _ => id,
    };
    let side = resolution.unwrap_or_else(|| usual_resolution(world));
    size_in_cells(world, side)?;
    let grid = OccupancyGrid::of(world, side, Coverage::Entered)?;
    let frame = grid.frame();
    let mut open: Vec<bool> = grid.cells().iter().map(|occupied| !occupied).collect();
    // Wide cells may hold the start and a wall.
    let from_start = world.start.and_then(|start| nearest(&grid, &open, start.position));
    let most_clear = || frame.index_at(max_clearance_point(&grid)?);
    let first = from_start.or_else(most_clear).ok_or(ExportError::Empty { part: "free ground" })?;
    let mut region = vec![false; open.len()];
    flood(frame.cols, &mut open, first, |run| region[run].fill(true));
    add_cells_beside_lines(world, &grid, &mut region);
    let corners = outline(frame.cols, &region);
    let verts: Vec<DVec2> = corners.iter().map(|&[col, row]| frame.corner(col, row)).collect();
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for vertex in &verts {
        (min, max) = (min.min(*vertex), max.max(*vertex));
    }
    let mut rooms = BTreeMap::<_, Vec<_>>::new();
    for room in &world.rooms {
        let bounds = room.shape.bounds();
        let [[a, b], [c, d]] = [bounds.min, bounds.max].map(|p| p.to_array());
        rooms.entry(room.name.as_str()).or_default().push([a, b, c, d]);
    }
    let pose = |pose: Pose| [pose.position.x, pose.position.y, pose.heading];
    let house = House {
        id,
        room_num: world.rooms.len(),
        bbox: Bounds { min: min.to_array(), max: max.to_array() },
        verts: verts.iter().map(|vertex| vertex.to_array()).collect(),
        room_category: rooms,
        start: world.start.map(pose),
        goal: world.goal.map(pose),
        provenance: &world.provenance,
    };
    let mut out = std::io::BufWriter::new(out);
    serde_json::to_writer(&mut out, &house).map_err(std::io::Error::from)?;
    out.write_all(b"\n")?;
    Ok(out.flush()?)
}

/// Adds the cells at the border of a region that only lines without thickness occupy, and whose middle is on the
/// region's side of these lines. Without them, an outline that is read and written again would lose a cell on each side.
/// Of a line with the region on both sides, cells on one side are kept out.
fn add_cells_beside_lines(world: &World, grid: &OccupancyGrid, region: &mut [bool]) {
    let frame = grid.frame();
    let is_line = |shape: &Shape| matches!(shape, Shape::Segment { .. });
    if !world.solids().any(|solid| is_line(&solid.shape)) {
        return;
    }
    let Ok(mut thick) = OccupancyGrid::empty(world.bounds, frame.cell_size) else { return };
    for solid in world.solids().filter(|solid| !is_line(&solid.shape)) {
        thick.occupy(&solid.shape, Coverage::Entered);
    }
    let mut at_border: Vec<bool> =
        grid.cells().iter().zip(thick.cells()).map(|(any, thick)| *any && !thick).collect();
    for (cell, open) in at_border.iter_mut().enumerate().filter(|(_, open)| **open) {
        let mut around = (-1..=1).flat_map(|right| (-1..=1).map(move |up| (right, up)));
        *open = around
            .any(|(right, up)| frame.neighbour(cell, right, up).is_some_and(|other| region[other]));
    }
    let rays = Raycaster::new(world);
    // A line through the middle of a cell keeps it out, also where rounding moves the line.
    let reach = frame.cell_size * (1.0 + 1e-9);
    let sees = |cell: usize, beside: usize| {
        let [from, to] = [cell, beside].map(|cell| frame.cell(cell));
        let along = DVec2::new(to.0 as f64 - from.0 as f64, to.1 as f64 - from.1 as f64);
        rays.cast_along(frame.center_of(cell), along, reach).is_none()
    };
    let is_beside = |&cell: &usize| region[cell] && frame.neighbours(cell).any(|i| at_border[i]);
    let mut reached: Vec<usize> = (0..region.len()).filter(is_beside).collect();
    while let Some(cell) = reached.pop() {
        for beside in frame.neighbours(cell) {
            let mut joined = frame.neighbours(beside).filter(|&other| region[other]);
            if at_border[beside] && joined.all(|other| sees(other, beside)) {
                at_border[beside] = false;
                region[beside] = true;
                reached.push(beside);
            }
        }
    }
}

/// Returns the corners, as columns and rows, of the outer border of a region of cells that are joined by their
/// sides. They are counter-clockwise if rows count upwards.
fn outline(cols: usize, region: &[bool]) -> Vec<[usize; 2]> {
    let Some(first) = region.iter().position(|&cell| cell) else { return Vec::new() };
    let (cols, rows) = (cols as isize, (region.len() / cols) as isize);
    let is_in = |col: isize, row: isize| {
        (0..cols).contains(&col) && (0..rows).contains(&row) && region[(row * cols + col) as usize]
    };
    let start = [first as isize % cols, first as isize / cols];
    // Along the lower side of the lowest, leftmost cell, with the region to the left.
    let (mut at, mut along) = (start, [1, 0]);
    let mut corners = Vec::new();
    loop {
        at = [at[0] + along[0], at[1] + along[1]];
        // The cells ahead, to the left and to the right of the step that would go straight on.
        let left = [-along[1], along[0]];
        let cell = |side: [isize; 2]| {
            let toward = |i: usize| (along[i] + side[i] - 1).div_euclid(2);
            is_in(at[0] + toward(0), at[1] + toward(1))
        };
        let right = [along[1], -along[0]];
        let turned = match (cell(left), cell(right)) {
            // A region that touches itself at a corner keeps its cells apart there.
            (false, _) => left,
            (true, true) => right,
            (true, false) => along,
        };
        if turned != along {
            corners.push([at[0] as usize, at[1] as usize]);
        }
        along = turned;
        if at == start && along == [1, 0] {
            return corners;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Blueprint, Spec};
    use crate::geometry::polygon_contains;
    use crate::hallway::HallwaySpec;
    use crate::seed::Seed;
    use proptest::prelude::*;

    #[test]
    fn an_outline_has_the_area_of_the_free_ground() {
        // A straight hallway of 2 m by 36 m, whose walls lie on the borders of cells.
        for seed in 1..4 {
            let (pitch, width, wall_thickness) = (3.0, 2.0, 0.2);
            let spec =
                HallwaySpec { segments: 12, pitch, width, wall_thickness, ..Default::default() };
            let world = spec.generate(Seed(seed)).unwrap().to_world();
            let mut bytes = Vec::new();
            write(&world, "a.house", None, &mut bytes).unwrap();
            let house: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
            let verts: Vec<DVec2> = serde_json::from_value(house["verts"].clone()).unwrap();
            let area = Shape::Polygon { vertices: verts }.area();
            assert!((area - 72.0).abs() < 1e-6, "{area}");
        }
    }

    #[test]
    fn outlines_by_hand() {
        assert_eq!(outline(1, &[true]), [[1, 0], [1, 1], [0, 1], [0, 0]]);
        assert_eq!(outline(3, &[false, true, true]), [[3, 0], [3, 1], [1, 1], [1, 0]]);
        // An L of three cells.
        let corners = outline(2, &[true, true, true, false]);
        assert_eq!(corners, [[2, 0], [2, 1], [1, 1], [1, 2], [0, 2], [0, 0]]);
        // A ring: only the outer border.
        let ring = [true, true, true, true, false, true, true, true, true];
        assert_eq!(outline(3, &ring), [[3, 0], [3, 3], [0, 3], [0, 0]]);
    }

    proptest! {
        #[test]
        fn an_outline_holds_the_region_and_what_it_encloses(
            cells in prop::collection::vec(prop::bool::weighted(0.6), 56),
            first in 0..56_usize,
        ) {
            let mut open = cells;
            open[first] = true;
            let mut region = vec![false; 56];
            flood(8, &mut open, first, |run| region[run].fill(true));
            let corners = outline(8, &region);
            let polygon: Vec<DVec2> =
                corners.iter().map(|&[x, y]| DVec2::new(x as f64, y as f64)).collect();
            // Outside is what is reached from beyond the grid, past corners as well.
            let mut outside = [false; 90];
            for _ in 0..90 {
                for at in 0..90_usize {
                    let (col, row) = (at % 10, at / 10);
                    let is_region = (1..9).contains(&col) && (1..8).contains(&row)
                        && region[(row - 1) * 8 + col - 1];
                    let is_border = col == 0 || col == 9 || row == 0 || row == 8;
                    let beside = |c: usize, r: usize| outside[r * 10 + c];
                    let near = (row.saturating_sub(1)..=(row + 1).min(8)).any(|r| {
                        (col.saturating_sub(1)..=(col + 1).min(9)).any(|c| beside(c, r))
                    });
                    outside[at] |= !is_region && (is_border || near);
                }
            }
            for at in 0..56_usize {
                let middle = DVec2::new((at % 8) as f64 + 0.5, (at / 8) as f64 + 0.5);
                let is_outside = outside[(at / 8 + 1) * 10 + at % 8 + 1];
                prop_assert_eq!(polygon_contains(&polygon, middle), !is_outside, "{}", at);
            }
        }
    }
}
