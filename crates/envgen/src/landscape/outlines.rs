//! The cells of a raster as simple polygons.

use crate::geometry::Shape;
use crate::world::ClassRaster;

/// A run of cells of one key in a row, and the piece that it continues.
#[derive(Clone, Copy)]
struct Run {
    key: u16,
    from: usize,
    to: usize,
    piece: usize,
    /// Number of runs in the row below that touch it.
    touched: u32,
}

/// A piece of a region: one run of columns in each of consecutive rows.
struct Piece {
    key: u16,
    top: usize,
    runs: Vec<(usize, usize)>,
}

/// Returns the cells of each key, except 0, as simple polygons that cover them without overlap.
///
/// A run of cells in a row is joined to the only run of the same key below it, if neither touches another one. A
/// region is thus divided into pieces with one run per row. Whatever the region is, these pieces have no holes and
/// their outlines never touch themselves. It takes O(N).
pub(crate) fn outlines(raster: &ClassRaster, key: impl Fn(u16) -> u16) -> Vec<(u16, Shape)> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut above: Vec<Run> = Vec::new();
    for (r, row) in raster.cells.chunks_exact((raster.cols as usize).max(1)).enumerate() {
        let mut runs: Vec<Run> = Vec::new();
        for (c, &class) in row.iter().enumerate() {
            let key = key(class);
            match runs.last_mut() {
                Some(run) if run.key == key && run.to == c => run.to = c + 1,
                _ if key != 0 => {
                    runs.push(Run { key, from: c, to: c + 1, piece: 0, touched: 0 });
                }
                _ => {}
            }
        }
        // Both lists are in order: one sweep finds which runs touch.
        let mut parents = vec![(0_u32, 0_usize); runs.len()];
        let (mut i, mut j) = (0, 0);
        while i < above.len() && j < runs.len() {
            if above[i].from < runs[j].to
                && runs[j].from < above[i].to
                && above[i].key == runs[j].key
            {
                above[i].touched += 1;
                parents[j] = (parents[j].0 + 1, i);
            }
            if above[i].to <= runs[j].to { i += 1 } else { j += 1 }
        }
        for (j, run) in runs.iter_mut().enumerate() {
            let (many, parent) = parents[j];
            if many == 1 && above[parent].touched == 1 {
                run.piece = above[parent].piece;
                pieces[run.piece].runs.push((run.from, run.to));
            } else {
                run.piece = pieces.len();
                pieces.push(Piece { key: run.key, top: r, runs: vec![(run.from, run.to)] });
            }
        }
        above = runs;
    }
    pieces.into_iter().map(|piece| (piece.key, outline(raster, &piece))).collect()
}

/// Returns the outline of a piece, counter-clockwise: down its left side and up its right side.
fn outline(raster: &ClassRaster, piece: &Piece) -> Shape {
    let frame = raster.frame();
    let corner = |row: usize, col: usize| frame.corner(col, frame.rows - row);
    // The corners along one side, from the piece's end at row `start`; a step to another column
    // has two.
    let side = |start: usize, columns: &mut dyn Iterator<Item = (usize, usize)>, end: usize| {
        let mut corners = Vec::new();
        let mut last = None;
        for (row, col) in columns {
            match last {
                None => corners.push(corner(start, col)),
                Some(last) if last != col => {
                    corners.extend([corner(row, last), corner(row, col)]);
                }
                Some(_) => {}
            }
            last = Some(col);
        }
        corners.extend(last.map(|last| corner(end, last)));
        corners
    };
    let (top, bottom) = (piece.top, piece.top + piece.runs.len());
    let mut left = (top..).zip(&piece.runs).map(|(row, run)| (row, run.0));
    let mut right = piece.runs.iter().enumerate().rev().map(|(k, run)| (top + k + 1, run.1));
    let mut corners = side(top, &mut left, bottom);
    corners.extend(side(bottom, &mut right, top));
    Shape::Polygon { vertices: corners }
}
