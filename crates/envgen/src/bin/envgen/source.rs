//! What a command starts from: a kind or a spec file with settings and a seed, or a world file.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use envgen::import::{self, ImportError};
use envgen::indoor::world_generator::{HALLWAY, LibraryRoom};
use envgen::indoor::{Catalogue, PlacedRoom};
use envgen::{Blueprint, Kind, Seed, World, WorldSpec};

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

    #[command(flatten)]
    rooms: Rooms,
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
        if self.rooms.are_given() {
            let WorldSpec::Indoor(indoor) = &mut spec else {
                return Err(Failure::Usage(format!("{GIVEN_ROOMS} are for the kind indoor")));
            };
            let catalogue = self.rooms.catalogue(indoor.catalogue())?;
            let bare = self.rooms.library()?;
            let bare = bare
                .iter()
                .filter(|room| room.name != HALLWAY && catalogue.get(&room.name).is_none());
            let bare: Vec<_> = bare.map(LibraryRoom::to_design).collect();
            if !bare.is_empty() {
                note(&format!("{} bare rooms of the library have the difficulty 0", bare.len()));
            }
            let all = if bare.is_empty() { Ok(catalogue) } else { catalogue.with(bare) };
            indoor.catalogue = Some(all.map_err(|error| Failure::Usage(error.to_string()))?);
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

/// A world file.
#[derive(Args)]
pub(crate) struct WorldFile {
    /// A world file: JSON or RON, a landscape's raster, a map of ROS (.yaml) or a project of the World
    /// Generator (.xml).
    file: PathBuf,

    #[command(flatten)]
    rooms: Rooms,
}

impl WorldFile {
    /// Reads it, by the ending of its name, and says on stderr what was left out.
    pub(crate) fn read(&self) -> Result<World, Failure> {
        let path = self.file.as_path();
        let of_file = |error: ImportError| Failure::of_file(path, error);
        let reader = import::reader(path).map_err(|error| Failure::Usage(error.to_string()))?;
        let is_project = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("xml"));
        if !is_project {
            if self.rooms.are_given() {
                let text = format!("{GIVEN_ROOMS} are for projects of the World Generator (.xml)");
                return Err(Failure::Usage(text));
            }
            return reader(&mut open(path)?, path).map_err(of_file);
        }
        let catalogue = self.rooms.catalogue(Catalogue::builtin())?;
        let library = self.rooms.library()?;
        let project = import::read_world_generator_project(&mut open(path)?, &catalogue, &library)
            .map_err(of_file)?;
        let name = path.display();
        if project.doors_ignored > 0 {
            let doors = project.doors_ignored;
            note(&format!("{name}: {doors} doors lead nowhere and are left out"));
        }
        if project.elements_ignored > 0 {
            let elements = project.elements_ignored;
            note(&format!("{name}: {elements} elements are no rooms or doors and are left out"));
        }
        let bare = |room: &&PlacedRoom| catalogue.get(&room.room.name).is_none();
        let bare = project.plan.rooms().iter().filter(bare).count();
        if bare > 0 {
            note(&format!("{name}: {bare} rooms are known by their size alone and are bare"));
        }
        Ok(project.plan.to_world())
    }
}

/// Rooms for indoor maps, beside the built-in ones.
#[derive(Args)]
struct Rooms {
    /// A folder of *.room.ron files for indoor maps, beside the built-in rooms; one of a built-in
    /// name takes its place.
    #[arg(long, value_name = "FOLDER")]
    rooms: Option<PathBuf>,

    /// A room library of the World Generator: rooms of known size and unknown contents, for names
    /// that no room has yet.
    #[arg(long, value_name = "FILE.xml")]
    library: Option<PathBuf>,
}

/// How messages call the options of [`Rooms`].
const GIVEN_ROOMS: &str = "`--rooms` and `--library`";

impl Rooms {
    fn are_given(&self) -> bool {
        self.rooms.is_some() || self.library.is_some()
    }

    fn catalogue(&self, beside: &Catalogue) -> Result<Catalogue, Failure> {
        match &self.rooms {
            Some(folder) => beside.with_folder(folder).map_err(|e| Failure::Usage(e.to_string())),
            None => Ok(beside.clone()),
        }
    }

    fn library(&self) -> Result<Vec<LibraryRoom>, Failure> {
        let Some(path) = &self.library else { return Ok(Vec::new()) };
        import::read_world_generator_library(&mut open(path)?)
            .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
    }
}

fn open(path: &Path) -> Result<File, Failure> {
    File::open(path).map_err(|error| Failure::of_file(path, error))
}

/// Tells a person what is not as asked.
pub(crate) fn note(text: &str) {
    #[expect(clippy::print_stderr, reason = "where the command speaks to a person")]
    {
        eprintln!("note: {text}");
    }
}
