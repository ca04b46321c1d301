//! The rule `preventCycles` (fifth adaptation): horizontal hallways are cut beside the vertical ones.

use crate::indoor::grid::{Cell, Grid};
use crate::seed::Stream;

/// For each column x with x mod `horizontal` = `horizontal` - 1, removes the hallway cells where a horizontal
/// hallway crosses it, and restores one of them. The result is a tree. Returns the removed cells, which a room may
/// take.
pub(in crate::indoor) fn prevent(
    grid: &mut Grid,
    horizontal: u32,
    vertical: u32,
    stream: &mut Stream,
) -> Vec<(u32, u32)> {
    let rows = u64::from(grid.height().div_ceil(vertical));
    let mut removed = Vec::new();
    for x in (horizontal - 1..grid.width()).step_by(horizontal as usize) {
        let kept = stream.below(rows) as u32 * vertical;
        for y in (0..grid.height()).step_by(vertical as usize).filter(|&y| y != kept) {
            grid.set(x, y, Cell::Solid);
            removed.push((x, y));
        }
    }
    removed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::access::hallway_shape;
    use crate::indoor::rules::hallways;
    use crate::seed::Seed;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_left_is_a_tree(
            seed: u64, width in 4..70_u32, height in 4..70_u32, h in 3..70_u32, v in 3..70_u32,
        ) {
            let (h, v) = (h.min(width - 1), v.min(height - 1));
            let mut grid = Grid::new(width, height);
            hallways::place(&mut grid, h, v);
            let before = hallway_shape(&grid);
            prop_assert_eq!(before.parts, 1);
            let columns = u64::from(width.div_ceil(h));
            let rows = u64::from(height.div_ceil(v));
            prop_assert_eq!(before.cycles, (columns - 1) * (rows - 1));
            let removed = prevent(&mut grid, h, v, &mut Seed(seed).stream("test", 0));
            let after = hallway_shape(&grid);
            prop_assert_eq!((after.parts, after.cycles), (1, 0));
            prop_assert_eq!(after.cells + removed.len() as u64, before.cells);
        }
    }
}
