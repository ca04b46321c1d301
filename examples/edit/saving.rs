//! Saving documents to files in every format for worlds.

use std::error::Error;
use std::path::Path;

use envgen::WorldBlueprint;
use envgen::edit::Document;
use envgen::export::{Format, Job, write_whole};
use envgen::located::Locate;
use envgen::whole_file::create_folder;
use envgen::world::Contents;

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

/// Writes a document as a whole or not at all, in the format that the ending of the file's name
/// selects.
pub(crate) fn save(document: &Document, path: &Path) -> Result<Saved, Box<dyn Error>> {
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
    let lacks = match (format, &blueprint) {
        (Format::WorldGenerator, Some(WorldBlueprint::Indoor(plan))) => {
            let edited = |room: &&envgen::indoor::PlacedRoom| room.contents != Contents::AsDesigned;
            match plan.rooms().iter().filter(edited).count() {
                0 => None,
                rooms => {
                    Some(format!("it holds no contents, which {rooms} rooms have of their own"))
                }
            }
        }
        _ if gives_back(path) => None,
        _ => Some("only .ron and .json files hold all that can be changed".to_owned()),
    };
    let is_whole = lacks.is_none();
    let text = lacks.map_or(saved.clone(), |lacks| format!("{saved}; {lacks}"));
    Ok(Saved { text, is_whole })
}
