//! The report of an experiment: a self-contained page, and the tables.

pub(crate) mod colors;
pub(crate) mod figures;
mod levels;
mod maps;
mod numbers;
pub(crate) mod page;
pub(crate) mod pieces;
mod rules;
mod statistics;
mod trials;
mod words;

use std::path::PathBuf;

use serde::Serialize;

use super::design::{Design, Shard};
use super::error::ExperimentError;
use super::record::Record;
use super::stats::{Analysis, analyse};
use super::store::Experiment;
use super::{table, write as files};

pub use super::write::REPORT as FILES;

/// The statistics in the file.
#[derive(Serialize)]
struct Summary<'a> {
    design: &'a Design,
    analysis: &'a Analysis,
}

/// Writes the report of a complete experiment, and returns the paths of its files. The trials whose
/// maps it shows run again on `threads` threads, 0 for one per core.
///
/// # Errors
///
/// If trials are missing or now give other results, or if a file cannot be written.
pub fn write(experiment: &Experiment, threads: usize) -> Result<Vec<PathBuf>, ExperimentError> {
    experiment.require_all()?;
    if experiment.shard() != Shard::WHOLE {
        let reason = format!("this is share {} of the trials: merge all", experiment.shard());
        return Err(ExperimentError::Content { path: experiment.folder().to_owned(), reason });
    }
    let design = experiment.design();
    let records: Vec<&Record> = experiment.records().collect();
    let analysis = analyse(design, &records);
    let report_error = |error: serde_json::Error| ExperimentError::Report(error.to_string());
    let mut summary = serde_json::to_vec_pretty(&Summary { design, analysis: &analysis })
        .map_err(report_error)?;
    summary.push(b'\n');
    let columns = table::columns(design, &records);
    let maps = maps::draw(experiment, &records, threads)?;
    let html = page::page(design, &records, &analysis, &maps)?;
    let levels = figures::absolute(design, &analysis.main)?.into_bytes();
    let contents =
        [html.into_bytes(), summary, table::csv(&columns)?, table::parquet(&columns)?, levels];
    let mut paths = Vec::new();
    for (name, bytes) in FILES.into_iter().zip(contents) {
        let path = experiment.folder().join(name);
        files::whole(&path, &bytes)?;
        paths.push(path);
    }
    Ok(paths)
}
