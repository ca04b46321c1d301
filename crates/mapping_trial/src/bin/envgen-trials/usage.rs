//! Errors in the arguments.

use std::error::Error;

use envgen::assignment::AssignmentError;
use envgen::export::OutputError;
use envgen::import::ImportError;
use envgen::located::Located;
use envgen::{SettingsError, SpecError};
use mapping_trial::experiment::survey::SurveyError;
use mapping_trial::profile::ProfileError;
use mapping_trial::robot::RobotError;
use thiserror::Error;

/// Arguments that are not valid.
#[derive(Debug, Error)]
#[error("{0}")]
pub(crate) struct Usage(pub(crate) String);

/// Whether an error is in the arguments, by the rules of the command `envgen`.
pub(crate) fn is_usage(error: &(dyn Error + 'static)) -> bool {
    error.is::<Usage>()
        || error.is::<SpecError>()
        || error.is::<SettingsError>()
        || error.is::<Located<AssignmentError>>()
        || error.is::<Located<SpecError>>()
        || error.is::<Located<SettingsError>>()
        || error.is::<Located<OutputError>>()
        || error.is::<Located<RobotError>>()
        || error.is::<Located<SurveyError>>()
        || error
            .downcast_ref()
            .is_some_and(|Located { error, .. }| !matches!(error, ProfileError::Unreadable { .. }))
        || error
            .downcast_ref()
            .is_some_and(|Located { error, .. }| matches!(error, ImportError::UnknownEnding { .. }))
}

#[cfg(test)]
mod tests {
    use envgen::located::Locate;

    use super::*;

    #[test]
    fn errors_of_values_are_of_the_arguments() {
        let error = || SpecError::new("difficulty", 99, "a number from 0 to 10");
        let located = Err::<(), _>(error()).in_option("--set", "difficulty=99").unwrap_err();
        let errors: [Box<dyn Error>; 3] =
            [error().into(), located.into(), Usage("--set a".to_owned()).into()];
        assert!(errors.iter().all(|error| is_usage(&**error)));
        let failed: Box<dyn Error> = "the disk is full".into();
        assert!(!is_usage(&*failed));
    }
}
