//! Saving documents to files in every format for worlds.

use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

use envgen::edit::Document;
use envgen::export::{Format, Job, Output, write_whole};
use envgen::indoor::{Catalogue, Cell, FloorPlan, PlacedRoom};
use envgen::located::Locate;
use envgen::whole_file::create_folder;
use envgen::world::Contents;
use envgen::{Blueprint, World, import};

/// The folder of files for which no name was given.
pub(crate) const FOLDER: &str = "out/edit";

/// What was saved.
pub(crate) struct Saved {
    /// The files, and what is not in them, in one line.
    pub(crate) text: String,
    /// Whether the files hold the whole document, so that nothing is lost when the window closes.
    pub(crate) is_whole: bool,
}

/// Whether a file of this name gives a document back when it is opened again.
pub(crate) fn gives_back(path: &Path) -> bool {
    let format = Format::from_path(path);
    format.is_ok_and(|of| matches!(of, Format::Json | Format::Ron | Format::WorldGenerator))
}

/// Returns those of the files that saving to a path writes that exist.
pub(crate) fn existing(path: &Path) -> Vec<PathBuf> {
    // What has no format is refused when it is saved.
    let files = Output::all(&[path.to_owned()], &[]).unwrap_or_default();
    files.into_iter().map(|file| file.path).filter(|path| path.exists()).collect()
}

/// Writes a document as a whole or not at all, in the format that the ending of the file's name
/// selects. Rooms of projects are those of a catalogue when they are opened again.
pub(crate) fn save(
    document: &Document,
    catalogue: &Catalogue,
    path: &Path,
) -> Result<Saved, Box<dyn Error>> {
    let format = Format::from_path(path)?;
    // Other folders must exist, so that a mistyped name creates no folder.
    if path.parent() == Some(Path::new(FOLDER)) {
        create_folder(FOLDER.as_ref()).in_file(FOLDER.as_ref())?;
    }
    let (world, blueprint) = (document.certified_world(), document.blueprint());
    let job = Job { blueprint: blueprint.as_ref(), ..Job::for_path(&world, path) };
    let written = write_whole(&job, path)?;
    let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
    let saved = format!("saved {}", names.join(" and "));
    let lacks = match (format, document.plan()) {
        (Format::WorldGenerator, Some(plan)) => {
            lacks_of_project(plan, document.world(), catalogue, path)?
                .map(|lacks| format!("it lacks {lacks}; only .ron and .json files hold all"))
        }
        _ if gives_back(path) => None,
        _ => Some("only .ron and .json files hold all that can be changed".to_owned()),
    };
    let is_whole = lacks.is_none();
    let text = lacks.map_or(saved.clone(), |lacks| format!("{saved}; {lacks}"));
    Ok(Saved { text, is_whole })
}

/// Returns what the project in a file lacks of the plan that was written to it, or `None` if the file gives the same
/// world when it is opened again.
fn lacks_of_project(
    plan: &FloorPlan,
    world: &World,
    catalogue: &Catalogue,
    path: &Path,
) -> Result<Option<String>, Box<dyn Error>> {
    let mut file = File::open(path).in_file(path)?;
    let again = match import::read_world_generator_project(&mut file, catalogue, &[]) {
        Ok(project) => project.plan.to_world(),
        Err(error) => return Ok(Some(format!("rooms: {error}"))),
    };
    if again.digest() == world.digest() {
        return Ok(None);
    }
    let designed = |room: &PlacedRoom| room.contents == Contents::AsDesigned;
    let compared = [
        (plan.rooms().iter().all(designed), "contents of rooms"),
        (again.doorways == world.doorways, "places of doorways"),
        (!plan.grid().cells().contains(&Cell::Open), "open areas"),
        (again.start == world.start, "the start"),
    ];
    let lacks = compared.iter().filter(|(is_same, _)| !is_same).map(|(_, part)| *part);
    let lacks: Vec<_> = lacks.collect();
    Ok(Some(if lacks.is_empty() { "settings of rooms".to_owned() } else { lacks.join(", ") }))
}
