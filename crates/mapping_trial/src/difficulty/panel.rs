//! Panels: the policies, lasers and estimators under which difficulties are measured.

use envgen::SpecError;
use serde::{Deserialize, Serialize};

use crate::experiment::survey::{Condition, SurveyError, check_conditions, ron_options};

const REFERENCE: &str = include_str!("panel_1.ron");

/// A panel: conditions of trials with equal weight. The difficulty of a world is the mean over them.
///
/// ```
/// use mapping_trial::difficulty::Panel;
///
/// let panel = Panel::reference();
/// assert_eq!((panel.version, panel.conditions.len()), (1, 12));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Panel {
    /// Name of the panel.
    pub name: String,
    /// Version of the panel.
    pub version: u32,
    /// The conditions.
    pub conditions: Vec<Condition>,
}

impl Panel {
    /// Returns the panel to which difficulties refer if no other is given: four policies, each with a
    /// SICK LMS 200, with the same laser with the errors of real scans, and with one of shorter range;
    /// a Pioneer 3-AT, scan-to-map matching, and 2 s per square metre.
    ///
    /// # Panics
    ///
    /// Never: the file is part of the crate, and tested.
    pub fn reference() -> Self {
        read(REFERENCE).expect("panel_1.ron is a panel")
    }

    /// Reads a panel from RON.
    ///
    /// # Errors
    ///
    /// Returns line and column of a syntax error, or names the first value that is not allowed. It is
    /// also an error if other conditions have the name of the [reference](Self::reference) panel.
    pub fn from_ron(text: &str) -> Result<Self, SurveyError> {
        let (panel, reference) = (read(text)?, Panel::reference());
        // Otherwise its measurements would be taken for those of the reference panel.
        if panel.name == reference.name && panel != reference {
            let allowed = "a name of its own: the reference panel has other conditions";
            let error = SpecError::new("name", &panel.name, allowed);
            return Err(SurveyError::Value { place: "panel".to_owned(), error });
        }
        Ok(panel)
    }

    /// Drops conditions that differ from an earlier one only in their names.
    pub fn drop_repeated(&mut self) {
        let mut kept: Vec<Condition> = Vec::new();
        for condition in self.conditions.drain(..) {
            let same = |other: &Condition| {
                Condition { name: condition.name.clone(), ..other.clone() } == condition
            };
            if !kept.iter().any(same) {
                kept.push(condition);
            }
        }
        self.conditions = kept;
    }
}

fn read(text: &str) -> Result<Panel, SurveyError> {
    let panel: Panel = ron_options().from_str(text).map_err(Box::new)?;
    check_conditions(&panel.conditions)?;
    Ok(panel)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::LaserProfile;
    use crate::policy::PolicyKind;

    #[test]
    fn equal_conditions_are_dropped() {
        let mut panel = Panel::reference();
        panel.conditions.iter_mut().for_each(|one| one.laser = LaserProfile::USARSIM);
        panel.drop_repeated();
        assert_eq!(panel.conditions.len(), 4);
        panel.conditions.iter_mut().for_each(|one| one.policy = PolicyKind::Nearest);
        panel.drop_repeated();
        assert_eq!(panel.conditions.len(), 1);
    }

    #[test]
    fn bad_panels_are_refused() {
        let error = |text: &str| Panel::from_ron(text).expect_err("no panel").to_string();
        assert!(error("(name: \"mine\", version: 1, conditions: [])").contains("conditions"));
        let laser =
            error("(name: \"mine\", version: 1, conditions: [(name: \"a\", laser: \"far\")])");
        assert!(laser.contains("`laser` must be one of lms200_mm"), "{laser}");
        let beams =
            error("(name: \"mine\", version: 1, conditions: [(name: \"a\", laser: (beams: 0))])");
        assert!(beams.starts_with("a: `laser.beams` must be a whole number"), "{beams}");
        let name = error("(name: \"reference\", version: 1, conditions: [(name: \"a\")])");
        assert!(name.starts_with("panel: `name` must be a name of its own"), "{name}");
        assert_eq!(Panel::from_ron(REFERENCE), Ok(Panel::reference()));
    }
}
