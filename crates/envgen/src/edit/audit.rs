//! Audits: what an editor shows about a world after each change.

use crate::calibration::{Calibration, Prediction};
use crate::certificate::{Claim, Doubt, Unreached, Verdict, unreached, verify_claims};
use crate::difficulty::{DifficultyVector, Platform};
use crate::world::World;

/// The state of a world: which of its promises hold, and which of its places cannot be reached.
///
/// ```
/// use envgen::edit::Audit;
/// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
///
/// let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
/// let mut world = spec.generate(Seed(2))?.to_world();
/// let promises = world.certificate.clone();
/// assert!(Audit::of(&world, &promises).broken().is_empty());
/// world.doorways.iter_mut().for_each(|door| door.open = false);
/// let audit = Audit::of(&world, &promises);
/// assert!(!audit.broken().is_empty());
/// assert!(audit.unreached?.is_some_and(|places| places.rooms.len() > 5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Audit {
    /// The promises, each with the result of its check.
    pub promises: Vec<(Claim, Verdict)>,
    /// Radius in metres of the robot that should reach all places: that of the promises, or otherwise that of the
    /// default [`Platform`].
    pub radius: f64,
    /// The places that the robot cannot reach; `None` if the world has no start, or if the robot does not fit there.
    pub unreached: Result<Option<Unreached>, Doubt>,
}

impl Audit {
    /// Checks a world against promises, which may differ from those of its certificate.
    pub fn of(world: &World, promises: &[Claim]) -> Self {
        let radius = promises.iter().find_map(|claim| match claim {
            Claim::Connected { radius } | Claim::EveryPlaceReachable { radius } => Some(*radius),
            _ => None,
        });
        let radius = radius.unwrap_or(Platform::default().circumscribed_radius);
        Audit {
            promises: verify_claims(world, promises),
            radius,
            unreached: unreached(world, radius),
        }
    }

    /// Returns the promises that do not hold.
    pub fn broken(&self) -> Vec<Claim> {
        let broken = self.promises.iter().filter(|(_, verdict)| *verdict == Verdict::Broken);
        broken.map(|(claim, _)| *claim).collect()
    }
}

/// Predicts the difficulty that trials with the default robot would measure in a world; `None` for kinds that are
/// not calibrated, and if the robot does not fit. It takes several times as long as an [`Audit`].
pub fn predict(world: &World) -> Option<Prediction> {
    let calibration = Calibration::of_world(world)?;
    let vector = DifficultyVector::of(world, &Platform::default()).ok()?;
    Some(calibration.predict(&vector))
}
