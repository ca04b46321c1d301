//! The command line.

use std::error::Error;
use std::path::Path;

use clap::Parser;
use envgen::assignment::{Assignment, assignments};
use envgen::located::Locate;
use envgen::scenario::{Scenario, ScenarioSpec};
use envgen::{Seed, SettingsError, World, WorldKind, WorldSpec, import};

use crate::spec_file;

/// Walk through a world.
#[derive(Parser)]
pub(crate) struct Arguments {
    /// A kind of world (hallway, forest, road, indoor, landscape, cellular), a world file in any
    /// format that `envgen convert` reads, or a spec (.ron).
    #[arg(default_value = "indoor", value_name = "KIND|FILE")]
    world: String,

    /// The seed of the world and of what moves in it.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    seed: Seed,

    /// Add doors, people or smoke to the world, such as doors=0.5, people=4 or smoke=0.2, or change a setting of the
    /// kind of world; may be given several times. `envgen kinds` lists the settings.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,
}

impl Arguments {
    /// Returns the world, and what moves in it.
    pub(crate) fn world(&self) -> Result<(World, Option<Scenario>), Box<dyn Error>> {
        let mut moving = ScenarioSpec::default();
        let spec = self.spec()?;
        let table = spec.as_ref().map_or(&[][..], |spec| spec.kind().settings());
        let mut own = Vec::new();
        for setting in assignments("--set", &self.settings, table)? {
            let Assignment { name, value, text } = setting;
            if ScenarioSpec::SETTINGS.iter().any(|known| known.name == name) {
                moving.set(name, value).in_option("--set", text)?;
            } else {
                own.push(setting);
            }
        }
        let world = match spec {
            Some(mut spec) => {
                let kind = spec.kind();
                let tables = [kind.settings(), ScenarioSpec::SETTINGS];
                let names: Vec<&str> = own.iter().map(|setting| setting.name).collect();
                for Assignment { name, value, text } in own {
                    let known = kind.setting(name);
                    known
                        .map_err(|_| SettingsError::unknown_setting(kind, name, &tables))
                        .in_option("--set", text)?;
                    spec.set(name, value).in_option("--set", text)?;
                }
                if let WorldSpec::Indoor(indoor) = &mut spec {
                    indoor.fix_given(&names)?;
                }
                spec.generate(self.seed)?.to_world()
            }
            None => {
                if let Some(Assignment { text, .. }) = own.first() {
                    return Err(format!("--set {text}: the file holds a finished world").into());
                }
                import::read_world(Path::new(&self.world)).in_file(Path::new(&self.world))?
            }
        };
        let moving =
            if moving.is_still() { None } else { Some(Scenario::new(&world, &moving, self.seed)?) };
        Ok((world, moving))
    }

    /// Returns the spec; `None` for the file of a finished world. A kind is one even if a file has its name.
    fn spec(&self) -> Result<Option<WorldSpec>, Box<dyn Error>> {
        let path = Path::new(&self.world);
        match self.world.parse::<WorldKind>() {
            Ok(kind) => Ok(Some(kind.default_spec())),
            Err(_) if path.exists() || path.extension().is_some() => spec_file::read(path),
            Err(error) => Err(format!("{}: no such file, and {error}", self.world).into()),
        }
    }
}
