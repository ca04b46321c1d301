//! Rasters of classes from ESRI ASCII grids, PNG images, JSON and MovingAI maps.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;

use glam::DVec2;
use serde::Deserialize;
use serde_json::Value;
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
    #[error("the raster must have at most 65535 different values, got more")]
    Classes,
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

/// The values of a file's cells, each of which is kept as a number of two bytes.
#[derive(Debug, Default)]
pub(super) struct CellValues {
    /// The number of each cell's value; 0 is no data.
    cells: Vec<u16>,
    /// The numbers of the values, from 1 on in the order in which they were added.
    numbers: BTreeMap<i64, u16>,
    /// The value that was added last, with its number: in most cases the next is the same.
    last: Option<(i64, u16)>,
}

impl CellValues {
    pub(super) fn with_capacity(cells: usize) -> Self {
        CellValues { cells: Vec::with_capacity(cells), ..CellValues::default() }
    }

    /// Adds the value of the next cell; `None` is no data.
    pub(super) fn push(&mut self, value: Option<i64>) -> Result<(), RasterFileError> {
        let number = match (value, self.last) {
            (None, _) => 0,
            (Some(value), Some((last, number))) if value == last => number,
            (Some(value), _) => {
                let next = u16::try_from(self.numbers.len() + 1);
                let number = match self.numbers.entry(value) {
                    Entry::Occupied(known) => *known.get(),
                    Entry::Vacant(new) => *new.insert(next.map_err(|_| RasterFileError::Classes)?),
                };
                self.last = Some((value, number));
                number
            }
        };
        self.cells.push(number);
        Ok(())
    }

    /// The number of cells.
    pub(super) fn len(&self) -> u64 {
        self.cells.len() as u64
    }

    /// The classes of the cells, and the values of the classes if they are not class numbers.
    fn into_classes(self) -> (Vec<u16>, Option<Vec<i64>>) {
        let CellValues { mut cells, numbers, .. } = self;
        let are_classes = numbers.keys().all(|value| (1..=65_535).contains(value));
        let mut classes = vec![0; numbers.len() + 1];
        for (class, (&value, &number)) in (1..=u16::MAX).zip(&numbers) {
            classes[usize::from(number)] = if are_classes { value as u16 } else { class };
        }
        for cell in &mut cells {
            *cell = classes[usize::from(*cell)];
        }
        (cells, (!are_classes).then(|| numbers.into_keys().collect()))
    }
}

impl ImportedRaster {
    pub(super) fn new(
        rows: u64,
        cols: u64,
        cell: f64,
        origin: DVec2,
        values: CellValues,
    ) -> Result<Self, RasterFileError> {
        check_size(rows, cols)?;
        if values.len() != rows * cols {
            return Err(RasterFileError::Values { rows, cols, found: values.len() });
        }
        let (cells, labels) = values.into_classes();
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
    cells: Option<Vec<Vec<CellValue>>>,
    cell: Option<f64>,
    raster: Option<ClassRaster>,
    blueprint: Option<Box<Document>>,
    /// That of a world.
    #[serde(default)]
    provenance: Value,
}

/// Returns the values that the classes of a raster had in the file from which it was read, by what is known about that
/// file: one value for each class, all different.
pub(crate) fn class_labels(source: &Value, raster: &ClassRaster) -> Option<Vec<i64>> {
    let labels = source.get("labels")?.as_array()?;
    let highest = raster.cells.iter().max().copied()?;
    if !(usize::from(highest)..=usize::from(u16::MAX)).contains(&labels.len()) {
        return None;
    }
    let labels: Vec<i64> = labels.iter().map(Value::as_i64).collect::<Option<_>>()?;
    let different: BTreeSet<i64> = labels.iter().copied().collect();
    (different.len() == labels.len()).then_some(labels)
}

/// The value of a cell; 0 is no data.
#[derive(Clone, Copy, Deserialize)]
#[serde(from = "Option<i64>")]
struct CellValue(i64);

impl From<Option<i64>> for CellValue {
    fn from(value: Option<i64>) -> Self {
        CellValue(value.unwrap_or(0))
    }
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
        Document {
            cells: Some(cells),
            cell: None,
            raster: None,
            blueprint: None,
            provenance: Value::Null,
        }
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
        let labels = class_labels(&document.provenance["spec"], &raster);
        return Ok(ImportedRaster { raster, labels });
    }
    let lines = document.cells.ok_or(RasterFileError::NoCells)?;
    let (rows, cols) = (lines.len() as u64, lines.first().map_or(0, Vec::len) as u64);
    check_size(rows, cols)?;
    let mut values = CellValues::with_capacity(lines.iter().map(Vec::len).sum());
    for (line, row) in (1..).zip(&lines) {
        if row.len() as u64 != cols {
            let what =
                format!("row {line} must have {cols} cells as the first has, got {}", row.len());
            return Err(RasterFileError::Line { line, what });
        }
        for &CellValue(value) in row {
            values.push((value != 0).then_some(value))?;
        }
    }
    let cell = document.cell.unwrap_or(1.0);
    if !(cell.is_finite() && cell > 0.0) {
        let what = format!("the side of a cell must be positive, got {cell} m");
        return Err(RasterFileError::Line { line: 1, what });
    }
    ImportedRaster::new(rows, cols, cell, DVec2::ZERO, values)
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
    fn as_many_values_as_classes_are_read() {
        let mut values = CellValues::default();
        for value in (1..=65_535).rev() {
            values.push(Some(value - 1)).unwrap();
        }
        values.push(None).unwrap();
        values.push(Some(7)).unwrap();
        assert!(matches!(values.push(Some(-1)), Err(RasterFileError::Classes)));
        let read = ImportedRaster::new(1, 65_537, 1.0, DVec2::ZERO, values).unwrap();
        // Values are in order, and class k has value k - 1, since a value is 0.
        assert_eq!(read.raster.cells[..2], [65_535, 65_534]);
        assert_eq!(read.raster.cells[65_534..], [1, 0, 8]);
        assert_eq!(read.labels.unwrap()[..3], [0, 1, 2]);
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
