//! Where a log's world comes from.

use envgen::reproduction::{Reproduction, reproduce};
use envgen::{Provenance, World, WorldSpec};
use serde::{Deserialize, Serialize};

use super::error::TrialError;

/// Where a log's world comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogWorld {
    /// Spec and seed give the same world again.
    Generated(Provenance),
    /// The world itself, where it was read from a file or changed by hand.
    Given(Box<World>),
}

impl LogWorld {
    /// The smaller representation of a world. Whatever its provenance claims, the cost follows from the
    /// world's size.
    pub(super) fn of(world: &World) -> LogWorld {
        match reproduce(world) {
            Reproduction::Same(_) => LogWorld::Generated(world.provenance.clone()),
            _ => LogWorld::Given(Box::new(world.clone())),
        }
    }

    /// The world, generated again or as given.
    ///
    /// # Errors
    ///
    /// A provenance whose spec this version cannot read or generate.
    pub fn world(&self) -> Result<World, TrialError> {
        match self {
            LogWorld::Generated(provenance) => generate(provenance),
            LogWorld::Given(world) => Ok((**world).clone()),
        }
    }
}

fn generate(provenance: &Provenance) -> Result<World, TrialError> {
    let spec = WorldSpec::from_provenance(provenance)?;
    let seed = provenance.seed.ok_or(TrialError::NoSeed)?;
    Ok(spec.generate(seed)?.to_world())
}
