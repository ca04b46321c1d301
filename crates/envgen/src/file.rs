//! World files: a whole world as JSON or RON, read back to the same bits.
//!
//! Both formats hold the fields of [`World`], with the schema version first. JSON is compact. RON has one line per
//! part, so that a world can be edited by hand and its changes can be reviewed.

use std::io::{self, Read, Write};

use ron::ser::PrettyConfig;
use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

use crate::text_file;
use crate::world::{SCHEMA_VERSION, Violation, World};

/// The greatest length of a world file that is read, in bytes. Longer files are refused before they fill the
/// memory.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// The deepest nesting of the provenance's spec that is written. The readers stop at 128 levels, so that no file
/// can exhaust the stack, and RON counts two levels for each level of a value.
pub const MAX_SPEC_DEPTH: usize = 32;

/// The keyword of the PNG text chunk that marks a picture of a world, which contains no classes.
#[cfg(feature = "picture")]
pub(crate) const PICTURE_KEY: &str = "envgen-picture";

/// The reasons why a world file could not be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// Reading or writing failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file has another schema version.
    #[error("the world file has schema version {found}, expected {SCHEMA_VERSION}")]
    Schema {
        /// The schema version of the file.
        found: u64,
    },
    /// The text is not the JSON of a world.
    #[error("not the JSON of a world: {0}")]
    Json(serde_json::Error),
    /// The text is not the RON of a world.
    #[error("not the RON of a world, at {0}")]
    Ron(Box<ron::error::SpannedError>),
    /// The world could not be written as RON.
    #[error("the world cannot be written as RON: {0}")]
    WriteRon(Box<ron::Error>),
    /// The world breaks an invariant.
    #[error("the world is broken: {0}")]
    World(#[from] Violation),
    /// The file is too long.
    #[error("the file is longer than {MAX_FILE_BYTES} bytes")]
    TooLong,
    /// The provenance's spec is nested too deeply to be read back.
    #[error("the provenance's spec is nested more than {MAX_SPEC_DEPTH} levels deep")]
    TooDeep,
}

/// The one field that files of every schema version have.
#[derive(Deserialize)]
#[serde(rename = "World")]
struct AnyVersion {
    schema: u64,
}

impl World {
    /// Returns the world as JSON, on one line.
    ///
    /// # Errors
    /// When the world breaks an invariant, or its provenance is nested too deeply.
    pub fn to_json(&self) -> Result<String, FileError> {
        let mut text = Vec::new();
        self.write_json(&mut text)?;
        // JSON is UTF-8 throughout.
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    /// Writes the world as JSON on one line that ends with a line break.
    ///
    /// # Errors
    /// When the world breaks an invariant, its provenance is nested too deeply, or writing fails.
    pub fn write_json(&self, out: &mut dyn Write) -> Result<(), FileError> {
        self.check_writable()?;
        let mut out = io::BufWriter::with_capacity(1 << 16, out);
        serde_json::to_writer(&mut out, self).map_err(io::Error::from)?;
        out.write_all(b"\n")?;
        Ok(out.flush()?)
    }

    /// Reads a world from JSON and checks it.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, World, hallway::HallwaySpec};
    ///
    /// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// let text = world.to_json()?;
    /// assert_eq!(World::from_json(&text)?, world);
    /// // What is read is checked.
    /// assert!(World::from_json(&text.replace("\"schema\":1", "\"schema\":999")).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the text is not the JSON of a world, has another schema version, or holds a world that
    /// breaks an invariant.
    pub fn from_json(text: &str) -> Result<World, FileError> {
        let world: World =
            serde_json::from_str(text).map_err(|error| {
                match serde_json::from_str::<AnyVersion>(text) {
                    Ok(AnyVersion { schema }) => other_schema(schema, FileError::Json(error)),
                    Err(_) => FileError::Json(error),
                }
            })?;
        world.check()?;
        Ok(world)
    }

    /// Returns the world as RON, with one line per part.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, World, forest::ForestSpec};
    ///
    /// let world = ForestSpec::default().generate(Seed(7))?.to_world();
    /// let text = world.to_ron()?;
    /// assert!(text.lines().count() > world.trees.len());
    /// assert_eq!(World::from_ron(&text)?, world);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the world breaks an invariant, or its provenance is nested too deeply.
    pub fn to_ron(&self) -> Result<String, FileError> {
        self.check_writable()?;
        let layout = PrettyConfig::new().depth_limit(2).indentor("  ").new_line("\n");
        let mut text = ron_options()
            .to_string_pretty(self, layout)
            .map_err(|error| FileError::WriteRon(Box::new(error)))?;
        text.push('\n');
        Ok(text)
    }

    /// Writes the world as RON, with one line per part.
    ///
    /// # Errors
    /// When the world breaks an invariant, its provenance is nested too deeply, or writing fails.
    pub fn write_ron(&self, out: &mut dyn Write) -> Result<(), FileError> {
        Ok(out.write_all(self.to_ron()?.as_bytes())?)
    }

    /// Reads a world from RON and checks it.
    ///
    /// # Errors
    /// When the text is not the RON of a world, has another schema version, or holds a world that
    /// breaks an invariant.
    pub fn from_ron(text: &str) -> Result<World, FileError> {
        let world: World = ron_options().from_str(text).map_err(|error| {
            let error = FileError::Ron(Box::new(error));
            match ron_options().from_str::<AnyVersion>(text) {
                Ok(AnyVersion { schema }) => other_schema(schema, error),
                Err(_) => error,
            }
        })?;
        world.check()?;
        Ok(world)
    }

    /// Checks that a file of this world could be read back.
    fn check_writable(&self) -> Result<(), FileError> {
        self.check()?;
        if is_deeper(&self.provenance.spec, MAX_SPEC_DEPTH) {
            return Err(FileError::TooDeep);
        }
        Ok(())
    }
}

/// Reads a text file of at most [`MAX_FILE_BYTES`].
pub(crate) fn read_text(input: &mut dyn Read) -> Result<String, FileError> {
    read_at_most(input, MAX_FILE_BYTES)
}

fn read_at_most(input: &mut dyn Read, limit: u64) -> Result<String, FileError> {
    text_file::read_at_most(input, limit).map_err(|error| match error.kind() {
        io::ErrorKind::FileTooLarge => FileError::TooLong,
        _ => error.into(),
    })
}

/// Reads a binary file of at most [`MAX_FILE_BYTES`].
#[cfg(any(feature = "barn", feature = "picture", feature = "ros"))]
pub(crate) fn read_bytes(input: &mut dyn Read) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    let read = input.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)?;
    if read as u64 > MAX_FILE_BYTES { Err(FileError::TooLong) } else { Ok(bytes) }
}

fn other_schema(found: u64, otherwise: FileError) -> FileError {
    if found == u64::from(SCHEMA_VERSION) { otherwise } else { FileError::Schema { found } }
}

fn ron_options() -> ron::Options {
    ron::Options::default().with_recursion_limit(128)
}

/// Whether arrays and objects of a value are nested more than `limit` levels deep. The search stops at the limit,
/// so that it needs no more stack than that.
fn is_deeper(value: &Value, limit: usize) -> bool {
    match value {
        Value::Array(items) => limit == 0 || items.iter().any(|item| is_deeper(item, limit - 1)),
        Value::Object(items) => limit == 0 || items.values().any(|item| is_deeper(item, limit - 1)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endless_files_are_refused() {
        let read = |mut file: &[u8]| read_at_most(&mut file, 5);
        assert_eq!(read(b"12345").unwrap(), "12345");
        assert!(matches!(read(b"123456"), Err(FileError::TooLong)));
        assert!(matches!(read(b"\xff"), Err(FileError::Io(_))));
        assert!(matches!(read_at_most(&mut io::repeat(b' '), 1000), Err(FileError::TooLong)));
    }
}
