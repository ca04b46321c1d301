//! The largest region of a grid.

use super::frame::GridFrame;

/// Returns the cells of the largest region of open cells that are joined by their sides, in the order in which a
/// search from its first cell finds them. Among regions of equal size, it returns the first. The grid has at most
/// 2^32 cells.
pub(crate) fn largest_region(frame: GridFrame, mut open: Vec<bool>) -> Vec<u32> {
    let (mut largest, mut region) = (Vec::new(), Vec::new());
    for first in 0..open.len() {
        if !std::mem::take(&mut open[first]) {
            continue;
        }
        // The list of the region's cells serves as the queue.
        region.clear();
        region.push(first as u32);
        let mut next = 0;
        while let Some(&cell) = region.get(next) {
            next += 1;
            for cell in frame.neighbours(cell as usize) {
                if std::mem::take(&mut open[cell]) {
                    region.push(cell as u32);
                }
            }
        }
        if region.len() > largest.len() {
            std::mem::swap(&mut largest, &mut region);
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flood::flood;
    use glam::DVec2;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_the_largest_of_all_floods(
            (cols, rows, cells) in (1..10_usize, 1..7_usize).prop_flat_map(|(cols, rows)| {
                let cells = prop::collection::vec(prop::bool::weighted(0.6), cols * rows);
                (Just(cols), Just(rows), cells)
            }),
        ) {
            let frame = GridFrame { origin: DVec2::ZERO, cell_size: 1.0, cols, rows };
            let mut expected = Vec::new();
            let mut open = cells.clone();
            for first in 0..cells.len() {
                let mut region = Vec::new();
                flood(cols, &mut open, first, |run| region.extend(run.map(|cell| cell as u32)));
                region.sort_unstable();
                if region.len() > expected.len() {
                    expected = region;
                }
            }
            let mut found = largest_region(frame, cells);
            found.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}
