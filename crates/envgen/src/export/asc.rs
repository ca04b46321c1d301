//! ESRI ASCII grids.

use std::io::{self, Write};

use crate::landscape::metrics::check;
use crate::world::ClassRaster;

/// Writes the classes of a raster as an ESRI ASCII grid, the top row first, 0 as no data. Reading
/// it back with [`read_asc`](crate::import::read_asc) gives the same cells, cell side and place.
///
/// ```
/// use envgen::export::write_asc;
/// use envgen::import::read_asc;
/// use envgen::{Seed, Spec, landscape::LandscapeSpec};
///
/// let raster = LandscapeSpec { cell_size: 2.0, ..Default::default() }.generate(Seed(7))?.to_raster();
/// let mut file = Vec::new();
/// write_asc(&raster, &mut file)?;
/// let read = read_asc(&mut file.as_slice())?.raster;
/// assert_eq!((read.cells, read.cell), (raster.cells, 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the raster's sizes do not fit together, or writing fails.
pub fn write_asc(raster: &ClassRaster, out: &mut dyn Write) -> io::Result<()> {
    check(raster).map_err(io::Error::other)?;
    let ClassRaster { rows, cols, cell, origin, .. } = *raster;
    let (x, y) = (origin.x, origin.y);
    write!(
        out,
        "ncols {cols}\nnrows {rows}\nxllcorner {x}\nyllcorner {y}\ncellsize {cell}\n\
         NODATA_value 0\n"
    )?;
    let mut line = String::new();
    for row in raster.cells.chunks(cols.max(1) as usize) {
        line.clear();
        for class in row {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(&class.to_string());
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
        write_asc(&raster, &mut file).unwrap();
        assert_eq!(read_asc(&mut file.as_slice()).unwrap().raster, raster);
    }
}
