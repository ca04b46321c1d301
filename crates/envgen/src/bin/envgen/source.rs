//! What a command starts from: a kind or a spec file with settings and a seed, or a world file.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use envgen::import::{self, ImportError};
use envgen::{Kind, Seed, World, WorldSpec};

use crate::failure::Failure;

/// The longest spec file that is read, in bytes.
const MAX_SPEC_BYTES: u64 = 1 << 28;

#[derive(Args)]
pub(crate) struct Source {
    /// A kind (see `envgen kinds`), or a RON file that holds a spec.
    #[arg(value_name = "KIND|FILE.ron")]
    what: String,

    /// The seed from which everything random follows.
    #[arg(long, default_value_t = Seed(0), value_name = "N")]
    pub(crate) seed: Seed,

    /// Sets a setting (see `envgen kinds`); may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,

    /// A folder of *.room.ron files for indoor maps, beside the built-in rooms; one of a built-in
    /// name takes its place.
    #[arg(long, value_name = "FOLDER")]
    rooms: Option<PathBuf>,
}

impl Source {
    /// The spec with its settings, checked.
    pub(crate) fn spec(&self) -> Result<WorldSpec, Failure> {
        let path = Path::new(&self.what);
        let mut spec = if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron"))
        {
            WorldSpec::from_ron(&read(path)?)
                .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))?
        } else {
            self.what.parse::<Kind>()?.default_spec()
        };
        for setting in &self.settings {
            let Some((name, value)) = setting.split_once('=') else {
                let text = format!("`--set {setting}` is not of the form --set name=value");
                return Err(Failure::Usage(text));
            };
            spec.set(name.trim(), value)?;
        }
        if let Some(folder) = &self.rooms {
            let WorldSpec::Indoor(indoor) = &mut spec else {
                return Err(Failure::Usage("`--rooms` is for the kind indoor".to_owned()));
            };
            let rooms = indoor.catalogue().with_folder(folder);
            indoor.catalogue = Some(rooms.map_err(|error| Failure::Usage(error.to_string()))?);
        }
        spec.validate().map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(spec)
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    let mut text = String::new();
    File::open(path)
        .and_then(|file| file.take(MAX_SPEC_BYTES + 1).read_to_string(&mut text))
        .map_err(|error| Failure::of_file(path, error))?;
    if text.len() as u64 > MAX_SPEC_BYTES {
        return Err(Failure::of_file(path, format!("longer than {MAX_SPEC_BYTES} bytes")));
    }
    Ok(text)
}

/// Reads a world file, by the ending of its name.
pub(crate) fn read_world(path: &Path) -> Result<World, Failure> {
    let reader = import::reader(path).map_err(|error| Failure::Usage(error.to_string()))?;
    let of_file = |error: ImportError| Failure::of_file(path, error);
    let mut file = File::open(path).map_err(|error| Failure::of_file(path, error))?;
    reader(&mut file, path).map_err(of_file)
}
