//! Errors that name the file or option that they concern.
//!
//! Readers and writers of this crate take streams and do not know file names. The caller that opened the file or
//! read the command line puts the name before the error, always in the same form:
//!
//! ```
//! use envgen::WorldSpec;
//! use envgen::located::Locate;
//!
//! let path = "narrow.envgen.ron".as_ref();
//! let error = WorldSpec::from_ron("Hallway(widht: 1.0)").in_file(path).unwrap_err();
//! assert!(error.to_string().starts_with("narrow.envgen.ron: "));
//! let error = "-1".parse::<u64>().in_option("--seed", "-1").unwrap_err();
//! assert!(error.to_string().starts_with("--seed -1: "));
//! ```

use std::error::Error;
use std::fmt::{self, Debug, Display};
use std::path::Path;

/// An error with the file or option that it concerns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Located<E> {
    /// The file name, or the option with its value.
    pub place: String,
    /// The error.
    pub error: E,
}

impl<E: Display> Display for Located<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.error)
    }
}

impl<E: Debug + Display> Error for Located<E> {}

/// Adds to an error the file or option that it concerns.
pub trait Locate<T, E> {
    /// Adds a file name to the error.
    ///
    /// # Errors
    /// Returns the error with the file name.
    fn in_file(self, path: &Path) -> Result<T, Located<E>>;

    /// Adds an option of the command line and its value to the error.
    ///
    /// # Errors
    /// Returns the error with the option and its value.
    fn in_option(self, option: &str, value: impl Display) -> Result<T, Located<E>>;
}

impl<T, E> Locate<T, E> for Result<T, E> {
    fn in_file(self, path: &Path) -> Result<T, Located<E>> {
        self.map_err(|error| Located { place: path.display().to_string(), error })
    }

    fn in_option(self, option: &str, value: impl Display) -> Result<T, Located<E>> {
        self.map_err(|error| Located { place: format!("{option} {value}"), error })
    }
}
