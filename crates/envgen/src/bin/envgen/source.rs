//! The input of a command: a kind or a spec file with settings and a seed, or a world file.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use clap::Args;
use envgen::assignment::{Assignment, assignments};
use envgen::import;
use envgen::indoor::world_generator::{HALLWAY, LibraryRoom};
use envgen::indoor::{Catalogue, PlacedRoom, Profile};
use envgen::located::Locate;
use envgen::scenario::ScenarioSpec;
use envgen::text_file;
use envgen::{
    Blueprint, GenerateError, Seed, SettingsError, SpecError, World, WorldKind, WorldSpec,
};

use crate::failure::{Failure, print_line};

/// The greatest number of parts, cells or points that are generated to find settings without effect.
const MOST_WORK: f64 = 1e5;

#[derive(Args)]
pub(crate) struct Source {
    /// A kind (see `envgen kinds`), or a RON file with a spec, such as `Hallway(segments: 80)`.
    #[arg(value_name = "KIND|FILE.ron")]
    what: String,

    /// The seed: the same settings and seed give the same world.
    #[arg(long, default_value_t = Seed(0), value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Seed,

    /// Changes a setting (see `envgen kinds`), such as `width=3`; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,

    #[command(flatten)]
    rooms: Rooms,
}

impl Source {
    /// The spec with its settings, checked.
    pub(crate) fn spec(&self) -> Result<WorldSpec, Failure> {
        let spec = self.unset()?;
        let settings = self.settings(spec.kind())?;
        self.with_settings(spec, &settings)
    }

    /// As [`Source::spec`], with the settings of what moves, if any is set.
    pub(crate) fn spec_and_scenario(&self) -> Result<(WorldSpec, Option<ScenarioSpec>), Failure> {
        let spec = self.unset()?;
        let kind = spec.kind();
        let is_moving = |name: &str| {
            ScenarioSpec::SETTINGS.iter().any(|setting| setting.name == name)
                && !kind.settings().iter().any(|setting| setting.name == name)
        };
        let (moving, still): (Vec<_>, Vec<_>) =
            self.settings(kind)?.into_iter().partition(|setting| is_moving(setting.name));
        let tables = [kind.settings(), ScenarioSpec::SETTINGS];
        for Assignment { name, text, .. } in &still {
            let is_known =
                kind.setting(name).map_err(|_| SettingsError::unknown_setting(kind, name, &tables));
            is_known.in_option("--set", text)?;
        }
        let spec = self.with_settings(spec, &still)?;
        let mut scenario = ScenarioSpec::default();
        for Assignment { name, value, text } in &moving {
            scenario.set(name, value).in_option("--set", text)?;
        }
        scenario.validate().map_err(|error| self.blame(error, &moving))?;
        Ok((spec, (!moving.is_empty()).then_some(scenario)))
    }

    /// The settings without which the spec gives the same world and the same promises. Only of worlds that are soon
    /// generated again.
    pub(crate) fn without_effect(&self, spec: &WorldSpec, world: &World) -> Vec<&str> {
        let kind = spec.kind();
        let of_world = |setting: &Assignment<'_>| kind.setting(setting.name).is_ok();
        let Ok(settings) = self.settings(kind) else { return Vec::new() };
        let settings: Vec<_> = settings.into_iter().filter(of_world).collect();
        let has_effect = |left_out: &Assignment<'_>| {
            let others: Vec<_> =
                settings.iter().filter(|other| other.name != left_out.name).copied().collect();
            let without = self.unset().and_then(|unset| self.with_settings(unset, &others)).ok()?;
            let work = settings.len() as f64 * without.work();
            // The default changes nothing either. A calibrated map takes long, and each setting steers its choice.
            if without == *spec || work > MOST_WORK || is_calibrated(&without) {
                return None;
            }
            let other = without.generate(self.seed).ok()?.to_world();
            Some(other.digest() != world.digest() || other.certificate != world.certificate)
        };
        let is_idle = |setting: &&Assignment<'_>| has_effect(setting) == Some(false);
        settings.iter().filter(is_idle).map(|setting| setting.text).collect()
    }

    /// The spec without its settings.
    fn unset(&self) -> Result<WorldSpec, Failure> {
        match self.file() {
            Some(path) => {
                Ok(WorldSpec::from_ron(&text_file::read(path).in_file(path)?).in_file(path)?)
            }
            None => match self.what.parse::<WorldKind>() {
                Ok(kind) => Ok(kind.default_spec()),
                Err(_) if Path::new(&self.what).extension().is_some() => {
                    let text = "is neither a kind nor a spec file (.ron); for world files use `envgen convert`";
                    Err(Failure::Usage(text.to_owned()).about(&self.what))
                }
                Err(error) => Err(error.into()),
            },
        }
    }

    fn with_settings(
        &self,
        mut spec: WorldSpec,
        settings: &[Assignment<'_>],
    ) -> Result<WorldSpec, Failure> {
        for Assignment { name, value, text } in settings {
            spec.set(name, value).in_option("--set", text)?;
        }
        if let WorldSpec::Indoor(indoor) = &mut spec {
            let names: Vec<&str> = settings.iter().map(|setting| setting.name).collect();
            indoor.fix_given(&names).map_err(|error| self.blame(error, settings))?;
        }
        if self.rooms.are_given() {
            self.furnish(&mut spec)?;
        }
        spec.validate().map_err(|error| self.blame(error, settings))?;
        Ok(spec)
    }

    /// The input files.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = self.rooms.files();
        inputs.extend(self.file().map(Path::to_owned));
        inputs
    }

    /// A failure to generate, which names the options of a setting that is not allowed, or else the spec file.
    pub(crate) fn ungenerated(&self, kind: WorldKind, error: GenerateError) -> Failure {
        match (error, self.settings(kind)) {
            (GenerateError::Spec(error), Ok(settings)) => self.blame(error, &settings),
            (error, _) => self.name(error.into()),
        }
    }

    /// A failure, which names the spec file where there is one.
    pub(crate) fn name(&self, failure: Failure) -> Failure {
        match self.file() {
            Some(path) => failure.about(path.display()),
            None => failure,
        }
    }

    /// The spec file, where one is given.
    fn file(&self) -> Option<&Path> {
        let path = Path::new(&self.what);
        let is_ron = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron"));
        is_ron.then_some(path)
    }

    fn settings(&self, kind: WorldKind) -> Result<Vec<Assignment<'_>>, Failure> {
        Ok(assignments("--set", &self.settings, kind.settings())?)
    }

    /// Names the options or the file that a setting that is not allowed comes from.
    fn blame(&self, error: SpecError, settings: &[Assignment<'_>]) -> Failure {
        let are_named =
            settings.iter().filter(|setting| names(&error.field).any(|name| name == setting.name));
        let options: Vec<String> =
            are_named.map(|setting| format!("--set {}", setting.text)).collect();
        if options.is_empty() {
            self.name(error.into())
        } else {
            Failure::from(error).about(options.join(" "))
        }
    }

    /// Gives an indoor map the requested rooms.
    fn furnish(&self, spec: &mut WorldSpec) -> Result<(), Failure> {
        let WorldSpec::Indoor(indoor) = spec else {
            return Err(Failure::Usage(format!("{GIVEN_ROOMS} apply to the kind indoor only")));
        };
        let catalogue = self.rooms.catalogue(indoor.catalogue())?;
        let bare = self.rooms.library()?;
        let bare =
            bare.iter().filter(|room| room.name != HALLWAY && catalogue.get(&room.name).is_none());
        let bare: Vec<_> = bare.map(LibraryRoom::to_design).collect();
        if !bare.is_empty() {
            note(&format!("{} bare rooms of the library have the difficulty 0", bare.len()));
        }
        let all = if bare.is_empty() { Ok(catalogue) } else { catalogue.with(bare) };
        indoor.catalogue = Some(all?);
        Ok(())
    }
}

/// The names of the settings that an error is about, such as both of `rows * cols`.
fn names(field: &str) -> impl Iterator<Item = &str> {
    field.split(|letter: char| !(letter.is_alphanumeric() || letter == '_'))
}

/// A world file.
#[derive(Args)]
pub(crate) struct WorldFile {
    /// A world file: JSON or RON, the raster of a landscape (.asc, .map), a ROS map (.yaml), GeoJSON in metres
    /// (.geojson), a house of HouseExpo (.json), a world of BARN (.world, .npy) or a project of the World Generator
    /// (.xml).
    file: PathBuf,

    #[command(flatten)]
    rooms: Rooms,
}

impl WorldFile {
    /// The input files.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        [self.rooms.files(), import::input_files(&self.file)].concat()
    }

    /// Reads it in the format of its name's ending, and reports on stderr what was left out.
    pub(crate) fn read(&self) -> Result<World, Failure> {
        let path = self.file.as_path();
        let reader = import::reader(path)?;
        let is_project = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("xml"));
        if !is_project {
            if self.rooms.are_given() {
                let text =
                    format!("{GIVEN_ROOMS} apply to projects of the World Generator (.xml) only");
                return Err(Failure::Usage(text));
            }
            let world = reader(&mut open(path)?, path).in_file(path)?;
            if let Some(text) = import::ros_map::unknown_cells_warning(path) {
                note(&format!("{}: {text}", path.display()));
            }
            return Ok(world);
        }
        let catalogue = self.rooms.catalogue(Catalogue::builtin())?;
        let library = self.rooms.library()?;
        let project = import::read_world_generator_project(&mut open(path)?, &catalogue, &library)
            .in_file(path)?;
        let name = path.display();
        if project.doors_ignored > 0 {
            let doors = project.doors_ignored;
            note(&format!("{name}: {doors} doors lead nowhere and are left out"));
        }
        if project.elements_ignored > 0 {
            let elements = project.elements_ignored;
            note(&format!(
                "{name}: {elements} elements are neither rooms nor doors and are left out"
            ));
        }
        if project.attributes_ignored > 0 {
            let attributes = project.attributes_ignored;
            note(&format!("{name}: {attributes} attributes have no meaning here and are left out"));
        }
        let bare = |room: &&PlacedRoom| catalogue.get(&room.room.name).is_none();
        let bare = project.plan.rooms().iter().filter(bare).count();
        if bare > 0 {
            note(&format!("{name}: {bare} rooms are empty because only their size is known"));
        }
        Ok(project.plan.to_world())
    }
}

/// Rooms for indoor maps, beside the built-in ones.
#[derive(Args)]
struct Rooms {
    /// A folder of *.room.ron files for indoor maps, in addition to the built-in rooms; a room with the
    /// name of a built-in one replaces it.
    #[arg(long, value_name = "FOLDER")]
    rooms: Option<PathBuf>,

    /// A room library of the World Generator. It adds an empty room of the given size for each name that no room
    /// has yet.
    #[arg(long, value_name = "FILE.xml")]
    library: Option<PathBuf>,
}

/// How messages name the options of [`Rooms`].
const GIVEN_ROOMS: &str = "`--rooms` and `--library`";

impl Rooms {
    fn are_given(&self) -> bool {
        self.rooms.is_some() || self.library.is_some()
    }

    /// The files of both options; a folder that cannot be listed cannot be read either.
    fn files(&self) -> Vec<PathBuf> {
        let rooms = self.rooms.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten();
        let rooms = rooms.filter_map(|entry| Some(entry.ok()?.path()));
        rooms.chain(self.library.clone()).collect()
    }

    fn catalogue(&self, beside: &Catalogue) -> Result<Catalogue, Failure> {
        match &self.rooms {
            Some(folder) => {
                Ok(beside.with_folder(folder).in_option("--rooms", folder.display())?)
            }
            None => Ok(beside.clone()),
        }
    }

    fn library(&self) -> Result<Vec<LibraryRoom>, Failure> {
        let Some(path) = &self.library else { return Ok(Vec::new()) };
        // A file that is not a library is a bad argument.
        let read = import::read_world_generator_library(&mut open(path)?);
        read.map_err(|error| {
            Failure::Usage(error.to_string()).about(format!("--library {}", path.display()))
        })
    }
}

fn open(path: &Path) -> Result<File, Failure> {
    Ok(File::open(path).in_file(path)?)
}

/// Prints a note for the user on stderr.
pub(crate) fn note(text: &str) {
    print_line(&format!("note: {text}"));
}

fn is_calibrated(spec: &WorldSpec) -> bool {
    matches!(spec, WorldSpec::Indoor(indoor) if indoor.profile == Profile::Calibrated)
}
