//! ESRI ASCII grids.

use std::collections::BTreeSet;
use std::io::{self, Write};

use crate::landscape::metrics::check;
use crate::world::ClassRaster;

/// Writes the classes of a raster as an ESRI ASCII grid, with the top row first and 0 as no data. With labels,
/// class `k + 1` is written as `labels[k]`, and no data as a number that no label has. Reading the file back with
/// [`read_asc`](crate::import::read_asc) gives the same cells, cell side, position and labels.
///
/// ```
/// use envgen::export::write_asc;
/// use envgen::import::read_asc;
/// use envgen::{Seed, Spec, landscape::LandscapeSpec};
///
/// let raster = LandscapeSpec { cell_size: 2.0, ..Default::default() }.generate(Seed(7))?.to_raster();
/// let mut file = Vec::new();
/// write_asc(&raster, None, &mut file)?;
/// let read = read_asc(&mut file.as_slice())?.raster;
/// assert_eq!((read.cells, read.cell), (raster.cells, 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the raster's sizes do not fit together, or when writing fails.
pub fn write_asc(
    raster: &ClassRaster,
    labels: Option<&[i64]>,
    out: &mut dyn Write,
) -> io::Result<()> {
    check(raster).map_err(io::Error::other)?;
    let ClassRaster { rows, cols, cell, origin, .. } = *raster;
    let (x, y) = (origin.x, origin.y);
    let labels = labels.unwrap_or_default();
    let no_data = match labels {
        [] => 0,
        labels => {
            let known: BTreeSet<i64> = labels.iter().copied().collect();
            let mut free = std::iter::once(-9999).chain((i64::MIN..0).rev());
            free.find(|value| !known.contains(value)).unwrap_or(0)
        }
    };
    let value = |class: u16| match usize::from(class).checked_sub(1) {
        None => no_data,
        Some(k) => labels.get(k).copied().unwrap_or(i64::from(class)),
    };
    write!(
        out,
        "ncols {cols}\nnrows {rows}\nxllcorner {x}\nyllcorner {y}\ncellsize {cell}\n\
         NODATA_value {no_data}\n"
    )?;
    let mut line = String::new();
    for row in raster.cells.chunks(cols.max(1) as usize) {
        line.clear();
        for &class in row {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(&value(class).to_string());
        }
        line.push('\n');
        out.write_all(line.as_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::read_asc;
    use glam::DVec2;

    #[test]
    fn a_grid_comes_back() {
        let raster = ClassRaster {
            rows: 2,
            cols: 3,
            cell: 0.1,
            origin: DVec2::new(-1.25, 1e6),
            cells: vec![1, 0, 65_535, 2, 2, 0],
            speeds: Vec::new(),
        };
        let mut file = Vec::new();
        write_asc(&raster, None, &mut file).unwrap();
        assert_eq!(read_asc(&mut file.as_slice()).unwrap().raster, raster);
    }

    #[test]
    fn labels_come_back() {
        for labels in [vec![0, 11, 42], vec![-9999, -1, 7]] {
            let raster = ClassRaster {
                rows: 1,
                cols: 4,
                cell: 1.0,
                origin: DVec2::ZERO,
                cells: vec![2, 0, 3, 1],
                speeds: Vec::new(),
            };
            let mut file = Vec::new();
            write_asc(&raster, Some(&labels), &mut file).unwrap();
            let read = read_asc(&mut file.as_slice()).unwrap();
            assert_eq!((read.raster, read.labels), (raster, Some(labels)));
        }
    }
}
