//! Tables of all trials, as CSV and Parquet.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use serde::Serialize;
use serde_json::Value;

use super::design::Design;
use super::error::ExperimentError;
use super::record::Record;
use super::stats::policy_of;
use crate::trial::EndReason;

/// A column: its name and one value per trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the column in the heads of files.
    pub name: String,
    /// The values.
    pub values: Values,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Integers.
    Whole(Vec<u64>),
    /// Numbers that may be absent for some trials.
    Real(Vec<Option<f64>>),
    /// Words.
    Text(Vec<String>),
}

/// Returns the columns of all trials: identity, M, N, D and their parts, the other scores, the features
/// of the map, the digests, and the error of the last pose.
pub fn columns(design: &Design, records: &[&Record]) -> Vec<Column> {
    let whole = |name: &str, of: &dyn Fn(&Record) -> u64| Column {
        name: name.to_owned(),
        values: Values::Whole(records.iter().map(|record| of(record)).collect()),
    };
    let text = |name: &str, of: &dyn Fn(&Record) -> String| Column {
        name: name.to_owned(),
        values: Values::Text(records.iter().map(|record| of(record)).collect()),
    };
    let levels = records.iter().map(|record| Some(design.level(&record.trial)));
    let mut columns = vec![
        Column { name: "level".to_owned(), values: Values::Real(levels.collect()) },
        whole("map", &|r| u64::from(r.trial.map)),
        whole("noise", &|r| u64::from(r.trial.noise)),
        text("operator", &|r| policy_of(r).to_owned()),
        text("end", &|r| r.end.map_or("", EndReason::name).to_owned()),
    ];
    columns.extend(numbers(records.iter().map(|record| &record.scores)));
    columns.extend(numbers(records.iter().map(|record| &record.features)));
    columns.extend([
        whole("world_seed", &|r| r.world_seed.0),
        whole("noise_seed", &|r| r.noise_seed.0),
        text("world_digest", &|r| r.world_digest.clone()),
        text("log_digest", &|r| r.log_digest.clone()),
        Column {
            name: "pose_error".to_owned(),
            values: Values::Real(records.iter().map(|record| record.pose_error).collect()),
        },
    ]);
    columns
}

/// The numeric fields of structs, beginning with the difficulties and their parts.
fn numbers<T: Serialize>(rows: impl Iterator<Item = T>) -> Vec<Column> {
    let rows: Vec<serde_json::Map<String, Value>> = rows
        .filter_map(|row| match serde_json::to_value(row) {
            Ok(Value::Object(fields)) => Some(flat(fields)),
            _ => None,
        })
        .collect();
    let Some(first) = rows.first() else { return Vec::new() };
    let mut names: Vec<&String> = first.keys().collect();
    let difficulties = ["difficulty", "mapping", "navigation"];
    names.sort_by_key(|name| {
        let place = difficulties.iter().position(|first| first == *name);
        (place.unwrap_or(difficulties.len()), !name.starts_with("e_"), *name)
    });
    let column = |name: &String| {
        let value = |row: &serde_json::Map<String, Value>| row.get(name).cloned();
        let whole: Option<Vec<u64>> =
            rows.iter().map(|row| value(row).and_then(|value| value.as_u64())).collect();
        let values = match whole {
            Some(whole) => Values::Whole(whole),
            None => Values::Real(
                rows.iter().map(|row| value(row).and_then(|value| value.as_f64())).collect(),
            ),
        };
        Column { name: name.clone(), values }
    };
    names.into_iter().map(column).collect()
}

/// Flattens an object: fields of inner objects get both names, as in `score_1_mapping`.
fn flat(fields: serde_json::Map<String, Value>) -> serde_json::Map<String, Value> {
    let mut all = serde_json::Map::new();
    for (name, value) in fields {
        match value {
            Value::Object(inner) => {
                all.extend(
                    inner.into_iter().map(|(part, value)| (format!("{name}_{part}"), value)),
                );
            }
            value => {
                all.insert(name, value);
            }
        }
    }
    all
}

/// Returns the table as CSV (RFC 4180). Numbers keep every digit, and absent values are empty.
pub fn csv(columns: &[Column]) -> Result<Vec<u8>, ExperimentError> {
    let report_error = |error: csv::Error| ExperimentError::Report(error.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| &column.name)).map_err(report_error)?;
    for row in 0..rows(columns) {
        let cells = columns.iter().map(|column| match &column.values {
            Values::Whole(values) => values[row].to_string(),
            Values::Real(values) => values[row].map_or_else(String::new, |x| x.to_string()),
            Values::Text(values) => values[row].clone(),
        });
        writer.write_record(cells).map_err(report_error)?;
    }
    writer.into_inner().map_err(|error| ExperimentError::Report(error.error().to_string()))
}

fn rows(columns: &[Column]) -> usize {
    columns.first().map_or(0, |column| match &column.values {
        Values::Whole(values) => values.len(),
        Values::Real(values) => values.len(),
        Values::Text(values) => values.len(),
    })
}

/// Returns the table as a Parquet file of one row group, without compression.
pub fn parquet(columns: &[Column]) -> Result<Vec<u8>, ExperimentError> {
    write_parquet(columns).map_err(|error| ExperimentError::Report(error.to_string()))
}

fn write_parquet(columns: &[Column]) -> Result<Vec<u8>, ParquetError> {
    let field = |column: &Column| {
        let (physical, repetition, logical) = match &column.values {
            Values::Whole(_) => {
                let unsigned = LogicalType::integer(64, false);
                (Physical::INT64, Repetition::REQUIRED, Some(unsigned))
            }
            Values::Real(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            Values::Text(_) => {
                (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String))
            }
        };
        let field = Type::primitive_type_builder(&column.name, physical);
        field.with_repetition(repetition).with_logical_type(logical).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("trials").with_fields(fields).build()?);
    let properties = Arc::new(WriterProperties::builder().build());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, properties)?;
    let mut group = writer.next_row_group()?;
    for column in columns {
        let Some(mut out) = group.next_column()? else { break };
        match &column.values {
            Values::Whole(values) => {
                // The bits of unsigned numbers.
                let bits: Vec<i64> = values.iter().map(|&value| value.cast_signed()).collect();
                out.typed::<Int64Type>().write_batch(&bits, None, None)?;
            }
            Values::Real(values) => {
                let known: Vec<f64> = values.iter().copied().flatten().collect();
                let levels: Vec<i16> = values.iter().map(|x| i16::from(x.is_some())).collect();
                out.typed::<DoubleType>().write_batch(&known, Some(&levels), None)?;
            }
            Values::Text(values) => {
                let bytes: Vec<ByteArray> =
                    values.iter().map(|text| ByteArray::from(text.as_str())).collect();
                out.typed::<ByteArrayType>().write_batch(&bytes, None, None)?;
            }
        }
        out.close()?;
    }
    group.close()?;
    writer.into_inner()
}
