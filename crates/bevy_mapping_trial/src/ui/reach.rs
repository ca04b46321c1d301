//! What maps of the profile `calibrated` reach, and whether a request is within it.

use envgen::calibration::Dials;
use envgen::indoor::{IndoorSpec, Profile};
use envgen::{SpecError, WorldSpec};

/// What the last spec reaches, kept until a setting that matters for it changes.
#[derive(Clone, Debug, Default)]
pub(super) struct Reach {
    last: Option<(IndoorSpec, Dials<[f64; 2]>)>,
}

impl Reach {
    /// What maps reach that have the settings of a valid spec; `None` for those that no difficulty can be
    /// requested of.
    pub(super) fn update(&mut self, spec: &WorldSpec) -> Option<Dials<[f64; 2]>> {
        let base = base(spec)?;
        if self.last.as_ref().is_none_or(|(last, _)| *last != base) {
            let reached = base.reachable();
            self.last = Some((base, reached));
        }
        self.last.as_ref().map(|(_, reached)| *reached)
    }

    /// Refuses a valid spec that requests what its maps do not reach.
    pub(super) fn check(&self, spec: &WorldSpec) -> Result<(), SpecError> {
        let (WorldSpec::Indoor(indoor), Some(base)) = (spec, base(spec)) else { return Ok(()) };
        let last = self.last.as_ref().filter(|(last, _)| *last == base);
        let reached = last.map_or_else(|| base.reachable(), |(_, reached)| *reached);
        indoor.request().check(indoor, reached)
    }
}

/// The spec without its request: what is reached depends on the rest.
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
