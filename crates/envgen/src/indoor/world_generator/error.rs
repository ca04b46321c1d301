//! Errors of reading files of the World Generator.

use thiserror::Error;

/// The greatest length of a text that is read, in bytes.
pub const MAX_TEXT: usize = 64 << 20;

/// The reasons why a file of the World Generator could not be read.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WorldGeneratorError {
    /// The text is longer than any file of the tool.
    #[error("the text must have at most {MAX_TEXT} bytes, got {0}")]
    TooLong(usize),
    /// The text is not well-formed XML, or it ends early.
    #[error("not XML at byte {position}: {reason}")]
    Xml {
        /// The position in bytes.
        position: u64,
        /// The reason.
        reason: String,
    },
    /// The document declares a type or entities, which files of the tool never do.
    #[error("a document type at byte {0}, which these files must not have")]
    DocumentType(u64),
    /// The root is a different element.
    #[error("the root element must be `{expected}`, got `{found}`")]
    Root {
        /// The root's name.
        found: String,
        /// The expected name.
        expected: &'static str,
    },
    /// An element lacks a required attribute, or an attribute has a value that is not allowed.
    #[error("`{element}` {number}: `{attribute}` must be {allowed}, got {value}")]
    Attribute {
        /// The element's name.
        element: &'static str,
        /// The number of the element among those of its kind, counted from 1.
        number: usize,
        /// The attribute's name.
        attribute: &'static str,
        /// Its value, or `nothing`.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// Neither the catalogue nor the library has the room.
    #[error("room {number}, `{name}`, is neither in the catalogue nor in a library")]
    UnknownRoom {
        /// The number of the room, counted from 1.
        number: usize,
        /// The room's name.
        name: String,
    },
    /// A room extends beyond the world.
    #[error("room {number}, `{name}`, reaches outside the world")]
    Outside {
        /// The number of the room, counted from 1.
        number: usize,
        /// The room's name.
        name: String,
    },
    /// Two rooms overlap.
    #[error("room {number}, `{name}`, overlaps another at x {x}, y {y}")]
    Overlap {
        /// The number of the room, counted from 1.
        number: usize,
        /// The room's name.
        name: String,
        /// Row of the first cell that both rooms have.
        x: u32,
        /// Column of the first cell that both rooms have.
        y: u32,
    },
    /// A library describes a room twice.
    #[error("the library has two rooms with the name `{0}`")]
    Duplicate(String),
}
