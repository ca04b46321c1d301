//! Generates plans from the settings, or from settings that the profile `calibrated` draws.

use super::blueprint::FloorPlan;
use super::calibrated;
use super::custom_laws::IndoorLaws;
use super::error::IndoorError;
use super::spec::{IndoorSpec, Profile};
use super::stages::{Stage, plan_as_set};
use crate::seed::Seed;

/// Generates the plan of a valid spec. Distributions of the caller replace its own; `after` is called after every
/// stage.
fn plan(
    spec: &IndoorSpec,
    seed: Seed,
    laws: &IndoorLaws<'_>,
    after: &mut dyn FnMut(Stage),
) -> Result<FloorPlan, IndoorError> {
    match spec.profile {
        Profile::Thesis | Profile::Guaranteed => plan_as_set(spec, seed, laws, after),
        Profile::Calibrated => calibrated::plan(spec, seed, laws, after),
    }
}

impl IndoorSpec {
    /// Generates a plan as [`Spec::generate`](crate::Spec::generate) does, and calls `after` after every stage,
    /// such as for clocks and progress bars, which this crate does not have.
    ///
    /// # Errors
    /// As [`Spec::generate`](crate::Spec::generate).
    pub fn generate_observed(
        &self,
        seed: Seed,
        after: &mut dyn FnMut(Stage),
    ) -> Result<FloorPlan, IndoorError> {
        self.check()?;
        plan(self, seed, &IndoorLaws::default(), after)
    }
}

#[cfg(feature = "rand")]
impl IndoorSpec {
    /// Generates a plan from other distributions than the spec's. If `laws` is empty, the result is the plan of
    /// [`Spec::generate`](crate::Spec::generate). Otherwise the provenance cannot contain the distributions and is
    /// therefore marked as edited.
    ///
    /// # Errors
    /// As [`Spec::generate`](crate::Spec::generate), and when a distribution gives a number that is not allowed:
    /// [`IndoorError`].
    pub fn generate_with_laws(
        &self,
        seed: Seed,
        laws: &IndoorLaws<'_>,
    ) -> Result<FloorPlan, IndoorError> {
        self.check()?;
        plan(self, seed, laws, &mut |_| ())
    }
}
