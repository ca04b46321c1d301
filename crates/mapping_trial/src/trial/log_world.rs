//! The world of a log: its provenance, or the world itself.

use envgen::reproduction::{Reproduction, edited, reproduce};
use envgen::{Provenance, World, WorldSpec};
use serde::{Deserialize, Serialize};

use super::error::TrialError;

/// The source of a log's world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogWorld {
    /// A spec, a seed and edits, from which the same world is generated again.
    Generated(Provenance),
    /// The world itself, if it was read from a file or changed by hand.
    Given(Box<World>),
}

impl LogWorld {
    /// Returns the smaller representation of a world. Whatever its provenance claims, the cost follows
    /// from the world's size.
    pub(super) fn of(world: &World) -> LogWorld {
        match reproduce(world) {
            Reproduction::Same(_) => LogWorld::Generated(world.provenance.clone()),
            _ => LogWorld::Given(Box::new(world.clone())),
        }
    }

    /// Returns the world, generated again or as given.
    ///
    /// # Errors
    ///
    /// If this version cannot read or generate the spec of the provenance.
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
    let blueprint = edited(spec.generate(seed)?, &provenance.edits).map_err(TrialError::Edits)?;
    let mut world = blueprint.to_world();
    // It is not generated again.
    world.provenance.measured.clone_from(&provenance.measured);
    Ok(world)
}

#[cfg(test)]
mod tests {
    use envgen::calibration::{Dials, Estimate};
    use envgen::indoor::{Edit, IndoorSpec, PlanEditor};
    use envgen::{Blueprint, MeasuredDifficulty, Seed, Spec};

    use super::*;

    #[test]
    fn edits_and_measured_difficulty_are_kept() {
        let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
        let plan = spec.generate(Seed(2)).unwrap();
        let mut editor = PlanEditor::new(plan.clone());
        editor.apply(Edit::RemoveRoom { room: 0 }).unwrap();
        let edited = editor.into_plan().to_world();
        let mut measured = plan.to_world();
        let dial = Estimate { value: 5.0, standard_error: 0.4 };
        measured.provenance.measured = Some(Box::new(MeasuredDifficulty {
            panel: "reference".to_owned(),
            panel_version: 1,
            dials: Dials { difficulty: dial, mapping: dial, navigation: dial },
            trials: 12,
            noise_seed: Seed(1),
        }));
        for world in [edited, measured] {
            let of_log = LogWorld::of(&world);
            assert!(matches!(of_log, LogWorld::Generated(_)));
            assert_eq!(of_log.world(), Ok(world));
        }
    }
}
