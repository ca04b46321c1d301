//! What moves in a generated world.

use std::path::{Path, PathBuf};

use clap::Args;
use envgen::located::Locate;
use envgen::scenario::{Scenario, ScenarioSpec, ScenarioState};
use envgen::text_file;
use envgen::{Seed, World};

use crate::failure::Failure;
use crate::source::note;

#[derive(Args)]
#[command(next_help_heading = "Doors, people and smoke")]
pub(crate) struct Moving {
    /// A scenario: a RON file of doors, people and smoke, in place of settings such as `--set people=4`. Pictures show
    /// a scenario, and an --out that ends with .scenario.ron holds it; other files do not.
    #[arg(long, value_name = "FILE.ron")]
    scenario: Option<PathBuf>,

    /// The seed of doors, people and smoke [default: the seed of the world].
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "scenario")]
    scenario_seed: Option<Seed>,
}

impl Moving {
    /// The input file.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        self.scenario.iter().cloned().collect()
    }

    /// What moves in a world; `None` where nothing does.
    pub(crate) fn scenario(
        &self,
        world: &World,
        spec: Option<ScenarioSpec>,
        seed: Seed,
    ) -> Result<Option<Scenario>, Failure> {
        if let Some(path) = &self.scenario {
            if spec.is_some() {
                let text = "cannot be used with scenario settings such as doors=0.5".to_owned();
                return Err(Failure::Usage(text).about(format!("--scenario {}", path.display())));
            }
            return Ok(Some(read_scenario(path, world)?));
        }
        if let Some(seed) = self.scenario_seed.filter(|_| spec.is_none()) {
            let text = "applies to scenario settings such as doors=0.5, but none is set";
            let failure = Failure::Usage(text.to_owned());
            return Err(failure.about(format!("--scenario-seed {seed}")));
        }
        let Some(spec) = spec else { return Ok(None) };
        if spec.is_still() {
            if spec != ScenarioSpec::default() {
                note("nothing moves: the scenario settings need doors, people or smoke above 0");
            }
            return Ok(None);
        }
        let scenario = Scenario::new(world, &spec, self.scenario_seed.unwrap_or(seed))
            .map_err(|error| Failure::from(error).about("--set"))?;
        if scenario.note().is_some() {
            note(if spec.doors < 1.0 {
                "nothing moves: no doorway drew a door; another --scenario-seed or more doors may"
            } else {
                "nothing moves: no open doorway has room for a door"
            });
        }
        Ok(Some(scenario))
    }
}

/// Reads what moves in a world, which must fit it.
pub(crate) fn read_scenario(path: &Path, world: &World) -> Result<Scenario, Failure> {
    let scenario = Scenario::from_ron(&text_file::read(path).in_file(path)?).in_file(path)?;
    ScenarioState::new(world, &scenario).in_file(path)?;
    if let Some(text) = scenario.note() {
        note(&format!("{}: {text}", path.display()));
    }
    Ok(scenario)
}
