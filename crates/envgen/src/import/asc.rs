//! ESRI ASCII grids.

use std::io::Read;

use glam::DVec2;

use super::raster::{CellValues, ImportedRaster, RasterFileError, check_size};
use crate::file;

/// The default no-data value, if the header does not give one.
const NO_DATA: f64 = -9999.0;

/// Reads an ESRI ASCII grid of whole numbers: `ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or
/// `yllcenter`, `cellsize` and, optionally, `NODATA_value`, which may be `nan`; then the values, with the top row
/// first. Source: ESRI ASCII raster format, `ArcGIS` documentation.
///
/// ```
/// use envgen::glam::DVec2;
/// use envgen::import::read_asc;
///
/// let text = "ncols 2\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\n1 2\n-9999 1\n";
/// let raster = read_asc(&mut text.as_bytes())?.raster;
/// assert_eq!((raster.origin, raster.cell), (DVec2::new(100.0, 200.0), 10.0));
/// // The top row comes first; no data is class 0.
/// assert_eq!(raster.cells, [1, 2, 0, 1]);
/// # Ok::<(), envgen::import::RasterFileError>(())
/// ```
///
/// # Errors
/// Names the line that contains the mistake.
pub fn read_asc(input: &mut dyn Read) -> Result<ImportedRaster, RasterFileError> {
    let text = file::read_text(input)?;
    let wrong = |line: usize, what: String| RasterFileError::Line { line, what };
    let (mut cols, mut rows, mut cell, mut no_data) = (None, None, None, NO_DATA);
    let (mut x, mut y, mut centred) = (0.0, 0.0, [false; 2]);
    let mut lines = (1..).zip(text.lines()).peekable();
    while let Some(&(number, line)) = lines.peek() {
        let mut words = line.split_whitespace();
        let Some(key) = words.next() else {
            lines.next();
            continue;
        };
        let key = key.to_ascii_lowercase();
        if !key.starts_with(|c: char| c.is_ascii_alphabetic()) || key == "nan" || key == "inf" {
            break;
        }
        let word = words.next().unwrap_or_default();
        let value: f64 = word
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite() || key == "nodata_value")
            .ok_or_else(|| wrong(number, format!("`{key}` must be a number, got `{word}`")))?;
        let whole = || {
            let wrong = || wrong(number, format!("`{key}` must be a whole number, got `{word}`"));
            word.parse::<u64>().map_err(|_| wrong())
        };
        match key.as_str() {
            "ncols" => cols = Some(whole()?),
            "nrows" => rows = Some(whole()?),
            "cellsize" => cell = Some((number, value)),
            "nodata_value" => no_data = value,
            "xllcorner" => x = value,
            "yllcorner" => y = value,
            "xllcenter" => (x, centred[0]) = (value, true),
            "yllcenter" => (y, centred[1]) = (value, true),
            _ => return Err(wrong(number, format!("`{key}` is not a key of an ESRI ASCII grid"))),
        }
        lines.next();
    }
    let next = lines.peek().map_or(1, |line| line.0);
    let missing = |key: &str| wrong(next, format!("the header has no `{key}`"));
    let cols = cols.ok_or_else(|| missing("ncols"))?;
    let rows = rows.ok_or_else(|| missing("nrows"))?;
    let (at, cell) = cell.ok_or_else(|| missing("cellsize"))?;
    if cell <= 0.0 {
        return Err(wrong(at, format!("`cellsize` must be positive, got {cell}")));
    }
    check_size(rows, cols)?;
    let mut values = CellValues::default();
    for (number, line) in lines {
        for word in line.split_ascii_whitespace() {
            let value: f64 = word
                .parse()
                .map_err(|_| wrong(number, format!("expected a number, got `{word}`")))?;
            values.push(if value == no_data || (value.is_nan() && no_data.is_nan()) {
                None
            } else if value.fract() == 0.0 && value.abs() < 9e15 {
                Some(value as i64)
            } else {
                return Err(wrong(number, format!("expected a whole number, got `{word}`")));
            })?;
        }
        if values.len() > rows * cols {
            break;
        }
    }
    let shift = |centred: bool| if centred { 0.5 * cell } else { 0.0 };
    let origin = DVec2::new(x - shift(centred[0]), y - shift(centred[1]));
    ImportedRaster::new(rows, cols, cell, origin, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: &str = "ncols 3\nNROWS 2\nxllcenter 10.5\nyllcorner 20\ncellsize 1.0\n\
                        NODATA_value -1\n1 2 -1\n 3 3 1\n";

    #[test]
    fn a_grid_is_read() {
        let ImportedRaster { raster, labels } = read_asc(&mut GRID.as_bytes()).unwrap();
        assert_eq!((raster.rows, raster.cols, raster.cell), (2, 3, 1.0));
        assert_eq!(raster.origin, DVec2::new(10.0, 20.0));
        assert_eq!((raster.cells, labels), (vec![1, 2, 0, 3, 3, 1], None));
    }

    #[test]
    fn no_data_can_be_no_number() {
        // As GDAL writes rasters of numbers with a point.
        let text = GRID.replace("NODATA_value -1\n1 2 -1", "NODATA_value  nan\n nan 2.0 NaN");
        let raster = read_asc(&mut text.as_bytes()).unwrap().raster;
        assert_eq!(raster.cells, [0, 2, 0, 3, 3, 1]);
    }

    #[test]
    fn values_that_are_no_class_numbers_are_labels() {
        let text = GRID.replace("1 2 -1", "0 311 -1");
        let ImportedRaster { raster, labels } = read_asc(&mut text.as_bytes()).unwrap();
        assert_eq!(raster.cells, [1, 4, 0, 3, 3, 2]);
        assert_eq!(labels, Some(vec![0, 1, 3, 311]));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (from, to, what) in [
            ("ncols 3", "ncols x", "line 1: `ncols` must be a number, got `x`"),
            ("ncols 3\n", "", "the header has no `ncols`"),
            ("ncols 3", "ncols -3", "`ncols` must be a whole number, got `-3`"),
            ("ncols 3", "ncols 1000000000", "got 2 rows of 1000000000"),
            ("NROWS 2", "NROWS 0", "the raster must have from 1 to"),
            ("cellsize 1.0", "cellsize 0", "line 5: `cellsize` must be positive, got 0"),
            ("cellsize 1.0", "cellsize inf", "line 5"),
            ("1 2 -1", "1 2", "values for 2 rows of 3 cells, got 5"),
            ("1 2 -1", "1 2 3 4", "values for 2 rows of 3 cells, got 7"),
            ("1 2 -1", "1 2.5 3", "line 7: expected a whole number, got `2.5`"),
            ("1 2 -1", "1 NaN 3", "line 7: expected a whole number, got `NaN`"),
            ("1 2 -1", "1 two 3", "line 7: expected a number, got `two`"),
            ("cellsize", "cellsise", "not a key"),
        ] {
            let error = read_asc(&mut GRID.replace(from, to).as_bytes()).unwrap_err().to_string();
            assert!(error.contains(what), "{to}: {error}");
        }
    }
}
