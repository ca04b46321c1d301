//! Worlds written as files of other programs' formats, one module a format.

pub mod csv;
pub mod opendrive;
