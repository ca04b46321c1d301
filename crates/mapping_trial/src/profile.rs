//! Profiles of lasers and wheels: the built-in ones by name, and others from files.

use std::fmt;
use std::io;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use envgen::{SpecError, text_file};
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, MapAccess, Visitor};
use serde::{Deserializer, Serialize, Serializer};
use thiserror::Error;

use crate::lidar::LaserProfile;
use crate::names::Named;
use crate::odometry::OdometryProfile;

/// A profile that programs and files give by the name of a built-in one, or by its numbers.
pub trait Profile: Named + Serialize + DeserializeOwned {
    /// An example of its RON.
    const EXAMPLE: &'static str;

    /// Checks every number.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed.
    fn check(&self) -> Result<(), SpecError>;

    /// Reads a profile from RON, and checks it. Fields that are absent have the values of the default
    /// profile.
    ///
    /// ```
    /// use mapping_trial::lidar::LaserProfile;
    /// use mapping_trial::profile::Profile;
    ///
    /// let laser = LaserProfile::from_ron("(beams: 360, field_of_view: 6.2657, max_range: 3.5)")?;
    /// assert_eq!((laser.beams, laser.sigma), (360, LaserProfile::default().sigma));
    /// let error = LaserProfile::from_ron("(beams: 0)").unwrap_err().to_string();
    /// assert!(error.starts_with("`laser.beams` must be a whole number from 1"), "{error}");
    /// # Ok::<(), mapping_trial::profile::ProfileError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns a syntax error, or names the first field whose value is not allowed.
    fn from_ron(text: &str) -> Result<Self, ProfileError> {
        let ron = |error: ron::error::SpannedError| ProfileError::Ron {
            field: Self::FIELD,
            example: Self::EXAMPLE,
            error: Box::new(error),
        };
        let profile: Self = ron::from_str(text).map_err(ron)?;
        profile.check()?;
        Ok(profile)
    }
}

impl Profile for LaserProfile {
    const EXAMPLE: &'static str = "(beams: 360, max_range: 3.5)";

    fn check(&self) -> Result<(), SpecError> {
        self.validate()
    }
}

impl Profile for OdometryProfile {
    const EXAMPLE: &'static str = "(k_tt: 0.002, b_t: 0.1)";

    fn check(&self) -> Result<(), SpecError> {
        self.validate()
    }
}

/// An error in a profile.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProfileError {
    /// A syntax error or an unknown field, with its line and column.
    #[error("not the RON of a profile of the {field} such as `{example}`, at {error}")]
    Ron {
        /// What the profile is of: laser or odometry.
        field: &'static str,
        /// An example.
        example: &'static str,
        /// The error.
        error: Box<ron::error::SpannedError>,
    },
    /// A number outside of its limits, or a name that does not exist.
    #[error(transparent)]
    Value(#[from] SpecError),
    /// A file that cannot be read.
    #[error("{path}: {error}")]
    Unreadable {
        /// The path of the file.
        path: PathBuf,
        /// The cause.
        error: io::Error,
    },
    /// An error in the text of a file.
    #[error("{path}: {error}")]
    File {
        /// The path of the file.
        path: PathBuf,
        /// The error.
        error: Box<ProfileError>,
    },
}

/// Returns whether an option such as `--laser` gives a file, not a name: its text ends with `.ron`.
pub fn is_file(text: &str) -> bool {
    Path::new(text).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron"))
}

/// Returns the profile that an option such as `--laser` gives: a built-in one by its name, or one from
/// the RON file with this name.
///
/// # Errors
///
/// If there is no profile with this name, or if the file cannot be read or holds no profile.
pub fn named_or_read<T: Profile>(text: &str) -> Result<T, ProfileError> {
    if !is_file(text) {
        return T::named(text).map_err(|SpecError { field, value, allowed }| {
            SpecError { field, value, allowed: format!("{allowed} or a file (.ron)") }.into()
        });
    }
    let path = Path::new(text);
    let read = text_file::read(path)
        .map_err(|error| ProfileError::Unreadable { path: path.to_owned(), error })?;
    T::from_ron(&read)
        .map_err(|error| ProfileError::File { path: path.to_owned(), error: Box::new(error) })
}

/// Writes a built-in profile as its name, and any other by its numbers, for
/// `#[serde(with = "mapping_trial::profile")]`.
///
/// # Errors
///
/// If the serializer fails.
pub fn serialize<T: Profile, S: Serializer>(profile: &T, serializer: S) -> Result<S::Ok, S::Error> {
    match profile.name() {
        Some(name) => serializer.serialize_str(name),
        None => profile.serialize(serializer),
    }
}

/// Reads what [`serialize`] writes.
///
/// # Errors
///
/// If there is no profile with the name, or a field does not exist. Numbers are not checked.
pub fn deserialize<'de, T: Profile, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    deserializer.deserialize_any(NameOrNumbers(PhantomData))
}

struct NameOrNumbers<T>(PhantomData<T>);

impl<'de, T: Profile> Visitor<'de> for NameOrNumbers<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the name of a profile, or its numbers such as `{}`", T::EXAMPLE)
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<T, E> {
        T::named(name).map_err(E::custom)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map))
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Condition {
        #[serde(with = "crate::profile")]
        laser: LaserProfile,
        #[serde(with = "crate::profile")]
        odometry: OdometryProfile,
    }

    #[test]
    fn conditions_hold_names_or_numbers() {
        let named = r#"{"laser":"urg_04lx","odometry":"poor"}"#;
        let read: Condition = serde_json::from_str(named).expect("names");
        assert_eq!(
            (&read.laser, &read.odometry),
            (&LaserProfile::URG_04LX, &OdometryProfile::POOR)
        );
        assert_eq!(serde_json::to_string(&read).expect("JSON"), named);
        let own: Condition =
            ron::from_str("(laser: (beams: 360, max_range: 12), odometry: \"exact\")")
                .expect("RON");
        let expected = LaserProfile { beams: 360, max_range: 12.0, ..LaserProfile::default() };
        assert_eq!(own.laser, expected);
        for text in [serde_json::to_string(&own).expect("JSON"), ron::to_string(&own).expect("RON")]
        {
            let again: Condition = if text.starts_with('{') {
                serde_json::from_str(&text).expect("JSON")
            } else {
                ron::from_str(&text).expect("RON")
            };
            assert_eq!(again, own);
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error = |text: &str| ron::from_str::<Condition>(text).unwrap_err().to_string();
        let unknown = error("(laser: \"far\", odometry: \"poor\")");
        assert!(unknown.contains("`laser` must be one of lms200_mm, "), "{unknown}");
        let field = error("(laser: (beems: 3), odometry: \"poor\")");
        assert!(field.contains("beems"), "{field}");
        let kind = error("(laser: 3, odometry: \"poor\")");
        assert!(kind.contains("the name of a profile, or its numbers such as `(beams"), "{kind}");
        let error = |text: &str| named_or_read::<LaserProfile>(text).unwrap_err().to_string();
        assert!(error("far").contains("wide_12m or a file (.ron), got far"), "{}", error("far"));
        assert!(error("missing.ron").starts_with("missing.ron: "), "{}", error("missing.ron"));
        let text = LaserProfile::from_ron("beams").unwrap_err().to_string();
        assert!(
            text.starts_with("not the RON of a profile of the laser such as `(beams"),
            "{text}"
        );
    }
}
