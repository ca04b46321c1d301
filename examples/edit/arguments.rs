//! The command line, and what it opens.

use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

use clap::Parser;
use envgen::assignment::{Assignment, assignments};
use envgen::edit::Document;
use envgen::indoor::{Catalogue, IndoorSpec};
use envgen::located::Locate;
use envgen::{Seed, World, WorldKind, WorldSpec, import};

use crate::saving::{self, FOLDER};
use crate::spec_file;

/// Change a world by hand: rooms, hallways and doorways of indoor maps, and the parts of any other world.
#[derive(Parser, Clone)]
pub(crate) struct Arguments {
    /// A kind of world (see `envgen kinds`), or a file: a world (.ron, .json, .yaml, .geojson, .map and others), a
    /// plan of the World Generator (.xml) or a spec (.ron).
    #[arg(value_name = "KIND|FILE", default_value = WorldKind::Indoor.name())]
    what: String,

    /// The seed of a world of a kind or spec.
    #[arg(long, default_value_t = Seed(0), value_name = "N", allow_negative_numbers = true)]
    seed: Seed,

    /// Change a setting of a kind or spec (see `envgen kinds`); may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,

    /// A folder of *.room.ron files for indoor maps, in addition to the built-in rooms.
    #[arg(long, value_name = "FOLDER")]
    rooms: Option<PathBuf>,

    /// The file that Ctrl+S writes; its ending selects the format [default: the opened file, if it is a world or a
    /// project that can be written again as a whole, else out/edit/NAME.ron or, where that exists, a name with a
    /// number].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Greatest number of parts of a world that the window edits. Each change draws and checks all of them
/// again.
const MOST_PARTS: usize = 200_000;

/// The initial state of the window.
pub(crate) struct Opened {
    pub(crate) document: Document,
    /// The rooms that can be added.
    pub(crate) catalogue: Catalogue,
    /// Kind and seed, or the name of the file.
    pub(crate) name: String,
    /// The file to save to.
    pub(crate) out: PathBuf,
    /// Whether this file is to be replaced: it was opened or named.
    pub(crate) is_own: bool,
    /// A note to the person about what was left out.
    pub(crate) note: Option<String>,
}

impl Arguments {
    /// Opens the world. All errors name the option or the file.
    pub(crate) fn open(&self) -> Result<Opened, Box<dyn Error>> {
        let path = Path::new(&self.what);
        let kind = self.what.parse::<WorldKind>();
        if let (Err(error), false) = (&kind, path.exists() || path.extension().is_some()) {
            return Err(format!("{}: no such file, and {error}", self.what).into());
        }
        let place = if kind.is_ok() { "--set" } else { &self.what };
        let spec = match kind {
            Ok(kind) => Some(kind.default_spec()),
            Err(_) => spec_file::read(path)?,
        };
        let Some(mut spec) = spec else {
            if let Some(setting) = self.settings.first() {
                return Err(format!("--set {setting}: applies to kinds and specs only").into());
            }
            return self.open_world(path);
        };
        self.set(&mut spec)?;
        let mut rooms = Catalogue::builtin().clone();
        if let WorldSpec::Indoor(indoor) = &mut spec {
            rooms = self.catalogue(indoor.catalogue())?;
            indoor.catalogue =
                self.rooms.is_some().then(|| rooms.clone()).or(indoor.catalogue.take());
        } else if let Some(folder) = &self.rooms {
            let folder = folder.display();
            return Err(format!("--rooms {folder}: applies to the kind indoor only").into());
        }
        spec.validate().map_err(|error| format!("{place}: {error}"))?;
        let document =
            Document::from_blueprint(spec.generate(self.seed).in_option("--seed", self.seed)?);
        check_size(&document, &self.what)?;
        let name = format!("{}_{}", spec.kind(), self.seed);
        let out = self.out.clone().unwrap_or_else(|| usual(&name));
        let name = format!("{}, seed {}", spec.kind(), self.seed);
        let is_own = self.out.is_some();
        Ok(Opened { document, catalogue: rooms, name, out, is_own, note: None })
    }

    fn open_world(&self, path: &Path) -> Result<Opened, Box<dyn Error>> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        let catalogue = self.catalogue(Catalogue::builtin())?;
        // A file of which only a part was read is not replaced by that part.
        let (document, is_whole, note) = if ending.as_deref() == Some("xml") {
            let mut file = File::open(path).in_file(path)?;
            let project = import::read_world_generator_project(&mut file, &catalogue, &[]);
            let project = project.in_file(path)?;
            let elements = project.doors_ignored + project.elements_ignored;
            let ignored = elements + project.attributes_ignored;
            let note = format!("{ignored} elements or attributes of the file have no meaning here");
            // Projects are written with the name of their file.
            let keeps_name = path.file_stem().is_some_and(|stem| stem == project.name.as_str());
            let is_whole = ignored == 0 && keeps_name;
            (Document::from_plan(project.plan), is_whole, (ignored > 0).then_some(note))
        } else {
            let (world, is_whole) = read(path, ending.as_deref())?;
            (Document::from_world(world), is_whole, None)
        };
        check_size(&document, &self.what)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let is_written_again = is_whole && saving::gives_back(path);
        let again = if is_written_again { path.to_owned() } else { usual(&stem) };
        let catalogue = match (&self.rooms, document.plan()) {
            (None, Some(plan)) => IndoorSpec::catalogue(plan.spec()).clone(),
            _ => catalogue,
        };
        let (name, out) = (self.what.clone(), self.out.clone().unwrap_or(again));
        let is_own = is_written_again || self.out.is_some();
        Ok(Opened { document, catalogue, name, out, is_own, note })
    }

    fn set(&self, spec: &mut WorldSpec) -> Result<(), Box<dyn Error>> {
        let settings = assignments("--set", &self.settings, spec.kind().settings())?;
        for Assignment { name, value, text } in &settings {
            spec.set(name, value).in_option("--set", text)?;
        }
        if let WorldSpec::Indoor(indoor) = spec {
            let names: Vec<&str> = settings.iter().map(|setting| setting.name).collect();
            indoor.fix_given(&names)?;
        }
        Ok(())
    }

    fn catalogue(&self, beside: &Catalogue) -> Result<Catalogue, Box<dyn Error>> {
        match &self.rooms {
            Some(folder) => {
                Ok(beside.with_folder(folder).in_option("--rooms", folder.display())?)
            }
            None => Ok(beside.clone()),
        }
    }
}

fn check_size(document: &Document, what: &str) -> Result<(), Box<dyn Error>> {
    let parts = document.world().part_count();
    if parts > MOST_PARTS {
        return Err(format!(
            "{what}: the world has {parts} parts; at most {MOST_PARTS} can be edited in a window"
        )
        .into());
    }
    Ok(())
}

/// Reads a world, and whether its file is one of this project: other programs' files hold more.
fn read(path: &Path, ending: Option<&str>) -> Result<(World, bool), Box<dyn Error>> {
    // The files of HouseExpo end with `.json` as well.
    if ending == Some("json")
        && let Ok(world) = import::read_json(&mut File::open(path).in_file(path)?)
    {
        return Ok((world, true));
    }
    Ok((import::read_world(path).in_file(path)?, ending == Some("ron")))
}

/// Returns the first of the files `STEM.ron`, `STEM_2.ron` and so on that does not exist, since the others may hold the
/// work of earlier sessions.
fn usual(stem: &str) -> PathBuf {
    let named = |name: &str| Path::new(FOLDER).join(format!("{name}.ron"));
    let (mut path, mut number) = (named(stem), 1_u32);
    while path.exists() {
        number += 1;
        path = named(&format!("{stem}_{number}"));
    }
    path
}
