//! The names of profiles, estimators and policies in commands and reports, and how names of others are shown.

use envgen::SpecError;

use crate::lidar::LaserProfile;
use crate::odometry::OdometryProfile;
use crate::policy::PolicyKind;
use crate::slam::{SlamKind, WheelCalibration};

/// A value that has a name in commands and reports.
///
/// ```
/// use mapping_trial::lidar::LaserProfile;
/// use mapping_trial::names::Named;
///
/// assert_eq!(LaserProfile::named("usarsim")?, LaserProfile::USARSIM);
/// assert_eq!(LaserProfile::USARSIM.name(), Some("usarsim"));
/// # Ok::<(), envgen::SpecError>(())
/// ```
pub trait Named: Clone + PartialEq + Sized + 'static {
    /// The field that errors refer to.
    const FIELD: &'static str;

    /// All names, with their values.
    const NAMES: &'static [(&'static str, Self)];

    /// Returns the value of a name.
    ///
    /// # Errors
    ///
    /// If the name is not in [`Named::NAMES`]. The error lists them.
    fn named(name: &str) -> Result<Self, SpecError> {
        let known = Self::NAMES.iter().find(|(known, _)| *known == name);
        known.map(|(_, value)| value.clone()).ok_or_else(|| {
            let names: Vec<&str> = Self::NAMES.iter().map(|(name, _)| *name).collect();
            SpecError::new(Self::FIELD, name, format!("one of {}", names.join(", ")))
        })
    }

    /// Returns the name of this value; `None` for a custom profile.
    fn name(&self) -> Option<&'static str> {
        Self::NAMES.iter().find(|(_, value)| value == self).map(|(name, _)| *name)
    }
}

/// Returns a text of others, such as a person's name, in which control characters, and those that change the direction
/// of writing, are escaped: on a terminal, it changes no colours and no other text, and begins no line.
///
/// ```
/// use mapping_trial::names::printable;
///
/// assert_eq!(printable("Zoë \u{1b}[31m\n"), "Zoë \\u{1b}[31m\\n");
/// assert_eq!(printable("a\u{202e}b"), "a\\u{202e}b");
/// ```
pub fn printable(text: &str) -> String {
    let mut shown = String::new();
    for char in text.chars() {
        match char {
            char if is_printable(char) => shown.push(char),
            char if char.is_control() => shown.extend(char.escape_debug()),
            char => shown.extend(char.escape_unicode()),
        }
    }
    shown
}

/// Whether a character is neither a control character nor one that changes the direction of writing.
pub(crate) fn is_printable(char: char) -> bool {
    let turns = matches!(
        char,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    !(char.is_control() || turns)
}

impl Named for LaserProfile {
    const FIELD: &'static str = "laser";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("lms200_mm", LaserProfile::LMS200_MM),
        ("lms200_mm_rough", LaserProfile::LMS200_MM_ROUGH),
        ("usarsim", LaserProfile::USARSIM),
        ("urg_04lx", LaserProfile::URG_04LX),
        ("wide_12m", LaserProfile::WIDE_12M),
    ];
}

impl Named for OdometryProfile {
    const FIELD: &'static str = "odometry";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("skid", OdometryProfile::SKID),
        ("mild", OdometryProfile::MILD),
        ("poor", OdometryProfile::POOR),
        ("exact", OdometryProfile::EXACT),
    ];
}

impl Named for PolicyKind {
    const FIELD: &'static str = "policy";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("nearest", PolicyKind::Nearest),
        ("info_gain", PolicyKind::InfoGain),
        ("cautious", PolicyKind::Cautious),
        ("wall_follow", PolicyKind::WallFollow),
        ("corridors", PolicyKind::Corridors),
        ("tour", PolicyKind::Tour),
    ];
}

impl Named for SlamKind {
    const FIELD: &'static str = "slam";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("scan_to_map", SlamKind::ScanToMap),
        ("pose_graph", SlamKind::PoseGraph),
        ("dead_reckoning", SlamKind::DeadReckoning),
    ];
}

impl Named for WheelCalibration {
    const FIELD: &'static str = "wheel_calibration";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("none", WheelCalibration::None),
        ("turns", WheelCalibration::Turns),
        ("turns_and_distances", WheelCalibration::TurnsAndDistances),
    ];
}

#[cfg(test)]
mod tests {
    use serde::Serialize;

    use super::*;

    /// The names are those in logs and reports.
    fn as_in_files<T: Named + Serialize>() {
        for (name, value) in T::NAMES {
            assert_eq!(serde_json::to_value(value).expect("a name"), *name);
        }
    }

    #[test]
    fn names_are_those_in_files_and_each_has_one_value() {
        as_in_files::<PolicyKind>();
        as_in_files::<SlamKind>();
        as_in_files::<WheelCalibration>();
        assert!(SlamKind::ALL.iter().all(|kind| kind.name().is_some()));
        for (name, value) in LaserProfile::NAMES {
            assert_eq!(LaserProfile::named(name).as_ref(), Ok(value));
            assert_eq!(value.name(), Some(*name));
        }
        for (name, value) in OdometryProfile::NAMES {
            assert_eq!(value.name(), Some(*name));
        }
    }

    #[test]
    fn an_unknown_name_is_an_error_with_all_known_ones() {
        let error = OdometryProfile::named("slick").expect_err("no such profile");
        let text = "`odometry` must be one of skid, mild, poor, exact, got slick";
        assert_eq!(error.to_string(), text);
    }
}
