//! Rasters of classes from ESRI ASCII grids, PNG images, JSON and MovingAI maps.

use std::collections::BTreeSet;
use std::io::Read;

use glam::DVec2;
use serde::Deserialize;
use thiserror::Error;

use crate::file::{self, FileError};
use crate::landscape::MAX_CELLS;
use crate::world::ClassRaster;

/// The reasons why no raster of classes could be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RasterFileError {
    /// Reading failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// The ending of the file's name does not belong to any raster format.
    #[error("`{0}` is not a raster of classes: its name must end in {ENDINGS}")]
    UnknownEnding(String),
    /// The image is a picture that this crate drew.
    #[error("the image is a picture of a world; write the classes themselves as `.classes.png`")]
    Picture,
    /// There are no cells, or too many.
    #[error("the raster must have from 1 to {MAX_CELLS} cells, got {rows} rows of {cols}")]
    Size {
        /// Number of rows.
        rows: u64,
        /// Number of columns.
        cols: u64,
    },
    /// A line of the file has a mistake.
    #[error("line {line}: {what}")]
    Line {
        /// The number of the line, counted from 1.
        line: usize,
        /// The mistake.
        what: String,
    },
    /// The number of values differs from that in the header.
    #[error("the file must have values for {rows} rows of {cols} cells, got {found}")]
    Values {
        /// Number of rows in the header.
        rows: u64,
        /// Number of columns in the header.
        cols: u64,
        /// Number of values in the file.
        found: u64,
    },
    /// There are too many classes.
    #[error("the raster must have at most 65535 different values, got {0}")]
    Classes(usize),
    /// The JSON has another structure.
    #[error("not the JSON of a landscape, of a world with a raster, or of a list of rows: {0}")]
    Json(serde_json::Error),
    /// The JSON contains neither cells nor a raster.
    #[error("the JSON holds neither `cells` nor a `raster`")]
    NoCells,
    /// The image cannot be read.
    #[cfg(feature = "picture")]
    #[error("not a PNG image: {0}")]
    Png(#[from] png::DecodingError),
}

#[cfg(feature = "picture")]
const ENDINGS: &str = ".asc, .json, .map or .png";
#[cfg(not(feature = "picture"))]
const ENDINGS: &str = ".asc, .json or .map";

/// A raster that was read from a file, with the values of its classes in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedRaster {
    /// The raster.
    pub raster: ClassRaster,
    /// The file's values, with that of class `k + 1` at index `k`, if they cannot be class numbers themselves
    /// because one of them is not from 1 to 65535. Classes are then numbered in the order of the values.
    pub labels: Option<Vec<i64>>,
}

impl ImportedRaster {
    /// Creates a raster from the file's values; `None` is no data.
    pub(super) fn new(
        rows: u64,
        cols: u64,
        cell: f64,
        origin: DVec2,
        values: &[Option<i64>],
    ) -> Result<Self, RasterFileError> {
        check_size(rows, cols)?;
        if values.len() as u64 != rows * cols {
            return Err(RasterFileError::Values { rows, cols, found: values.len() as u64 });
        }
        let fits = |value: i64| (1..=65_535).contains(&value);
        let (cells, labels) = if values.iter().flatten().all(|&value| fits(value)) {
            (values.iter().map(|value| value.map_or(0, |value| value as u16)).collect(), None)
        } else {
            let labels: BTreeSet<i64> = values.iter().flatten().copied().collect();
            if labels.len() > 65_535 {
                return Err(RasterFileError::Classes(labels.len()));
            }
            let labels: Vec<i64> = labels.into_iter().collect();
            let number = |value: &Option<i64>| {
                let place = value.and_then(|value| labels.binary_search(&value).ok());
                place.map_or(0, |place| place as u16 + 1)
            };
            (values.iter().map(number).collect(), Some(labels))
        };
        let (rows, cols, speeds) = (rows as u32, cols as u32, Vec::new());
        Ok(ImportedRaster {
            raster: ClassRaster { rows, cols, cell, origin, cells, speeds },
            labels,
        })
    }
}

pub(super) fn check_size(rows: u64, cols: u64) -> Result<(), RasterFileError> {
    match rows.checked_mul(cols) {
        Some(1..=MAX_CELLS) => Ok(()),
        _ => Err(RasterFileError::Size { rows, cols }),
    }
}

/// Any JSON that contains a raster: a landscape's blueprint, a line of `envgen sample`, or a world.
#[derive(Deserialize)]
struct Document {
    cells: Option<Vec<Vec<Option<i64>>>>,
    cell: Option<f64>,
    raster: Option<ClassRaster>,
    blueprint: Option<Box<Document>>,
}

/// Reads the raster of a landscape's JSON, of a line of `envgen sample`, of a world, or of a plain list of rows. 0
/// and null are no data. A cell has a side of 1 m unless another one is given.
///
/// # Errors
/// When there is no raster, or when its rows have different lengths.
pub fn read_raster_json(input: &mut dyn Read) -> Result<ImportedRaster, RasterFileError> {
    let text = file::read_text(input)?;
    let mut document = if text.trim_start().starts_with('[') {
        let cells = serde_json::from_str(&text).map_err(RasterFileError::Json)?;
        Document { cells: Some(cells), cell: None, raster: None, blueprint: None }
    } else {
        serde_json::from_str(&text).map_err(RasterFileError::Json)?
    };
    while let Some(inner) = document.blueprint.take() {
        document = *inner;
    }
    if let Some(raster) = document.raster {
        check_size(u64::from(raster.rows), u64::from(raster.cols))?;
        let (rows, cols) = (u64::from(raster.rows), u64::from(raster.cols));
        if raster.cells.len() as u64 != rows * cols {
            return Err(RasterFileError::Values { rows, cols, found: raster.cells.len() as u64 });
        }
        return Ok(ImportedRaster { raster, labels: None });
    }
    let lines = document.cells.ok_or(RasterFileError::NoCells)?;
    let (rows, cols) = (lines.len() as u64, lines.first().map_or(0, Vec::len) as u64);
    check_size(rows, cols)?;
    let mut values = Vec::with_capacity(lines.iter().map(Vec::len).sum());
    for (line, row) in (1..).zip(&lines) {
        if row.len() as u64 != cols {
            let what =
                format!("row {line} must have {cols} cells as the first has, got {}", row.len());
            return Err(RasterFileError::Line { line, what });
        }
        values.extend(row.iter().map(|value| value.filter(|&value| value != 0)));
    }
    let cell = document.cell.unwrap_or(1.0);
    if !(cell.is_finite() && cell > 0.0) {
        let what = format!("the side of a cell must be positive, got {cell} m");
        return Err(RasterFileError::Line { line: 1, what });
    }
    ImportedRaster::new(rows, cols, cell, DVec2::ZERO, &values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ImportedRaster, RasterFileError> {
        read_raster_json(&mut text.as_bytes())
    }

    #[test]
    fn every_form_of_json_is_read() {
        let plain = read("[[1, 2, 0], [3, null, 1]]").unwrap();
        assert_eq!(plain.raster.cells, [1, 2, 0, 3, 0, 1]);
        assert_eq!((plain.raster.rows, plain.raster.cols, plain.raster.cell), (2, 3, 1.0));
        let landscape = read(r#"{"rows": 1, "cols": 2, "cell": 0.5, "cells": [[7, 8]]}"#).unwrap();
        assert_eq!((landscape.raster.cells, landscape.raster.cell), (vec![7, 8], 0.5));
        let line = read(r#"{"kind": "landscape", "blueprint": {"cells": [[7], [8]]}}"#).unwrap();
        assert_eq!(line.raster.rows, 2);
        let codes = read("[[-3, 100000, 0, 5]]").unwrap();
        assert_eq!(codes.raster.cells, [1, 3, 0, 2]);
        assert_eq!(codes.labels, Some(vec![-3, 5, 100_000]));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error = |text: &str| read(text).unwrap_err().to_string();
        assert!(error("[[1, 2], [3]]").contains("row 2 must have 2 cells as the first has, got 1"));
        assert!(error("[]").contains("from 1 to"));
        assert!(error("[[]]").contains("from 1 to"));
        assert!(error("{}").contains("neither"));
        assert!(error("[[1.5]]").contains("not the JSON"));
        assert!(error(r#"{"cells": [[1]], "cell": -1}"#).contains("positive"));
        let raster =
            r#"{"raster": {"rows": 2, "cols": 2, "cell": 1, "origin": [0, 0], "cells": [1]}}"#;
        assert!(error(raster).contains("values for 2 rows of 2 cells, got 1"), "{}", error(raster));
        assert!(error("nonsense").contains("not the JSON"));
    }
}
