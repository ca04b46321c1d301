//! The dials that maps of the profile `calibrated` can reach, and whether a request is within reach.

use envgen::calibration::Dials;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::{SpecError, WorldSpec};

/// The dials that are within reach of the last spec, kept until a setting changes on which they depend.
#[derive(Clone, Debug, Default)]
pub(super) struct Reach {
    last: Option<(IndoorSpec, Dials<[f64; 2]>)>,
}

impl Reach {
    /// Returns the dials that maps with the settings of a valid spec can reach, or `None` for specs without a
    /// requested difficulty.
    pub(super) fn update(&mut self, spec: &WorldSpec) -> Option<Dials<[f64; 2]>> {
        let base = base(spec)?;
        if self.last.as_ref().is_none_or(|(last, _)| *last != base) {
            let reached = base.reachable();
            self.last = Some((base, reached));
        }
        self.last.as_ref().map(|(_, reached)| *reached)
    }

    /// Returns an error if a valid spec requests what its maps cannot reach.
    pub(super) fn check(&self, spec: &WorldSpec) -> Result<(), SpecError> {
        let (WorldSpec::Indoor(indoor), Some(base)) = (spec, base(spec)) else { return Ok(()) };
        let last = self.last.as_ref().filter(|(last, _)| *last == base);
        let reached = last.map_or_else(|| base.reachable(), |(_, reached)| *reached);
        indoor.request().check(indoor, reached)
    }
}

/// Returns the spec without its request, since what is within reach depends only on the rest.
fn base(spec: &WorldSpec) -> Option<IndoorSpec> {
    let WorldSpec::Indoor(spec) = spec else { return None };
    (spec.profile == Profile::Calibrated).then(|| IndoorSpec {
        difficulty: 0.0,
        mapping: None,
        navigation: None,
        candidate: 0,
        ..spec.clone()
    })
}
