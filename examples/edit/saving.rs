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

/// Writes a document as a whole or not at all, in the format that the ending of the file's name
/// selects, and returns what was written.
pub(crate) fn save(document: &Document, path: &Path) -> Result<String, Box<dyn Error>> {
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
    Ok(match (format, &blueprint) {
        (Format::WorldGenerator, Some(WorldBlueprint::Indoor(plan))) => {
            let edited = |room: &&envgen::indoor::PlacedRoom| room.contents != Contents::AsDesigned;
            match plan.rooms().iter().filter(edited).count() {
                0 => saved,
                rooms => {
                    format!("{saved}; it holds no contents, which {rooms} rooms have of their own")
                }
            }
        }
        _ => saved,
    })
}
