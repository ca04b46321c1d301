//! Rooms from files in a user's folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{Catalogue, CatalogueError, MAX_ROOMS, RoomDesign, RoomError, room_from_ron};
use crate::text_file;

/// The greatest size of a room file in bytes.
const MAX_FILE: u64 = 4 << 20;

/// The ending of the name of a room file.
const ENDING: &str = ".room.ron";

/// The reasons why a folder of rooms could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FolderError {
    /// A file or the folder could not be read.
    #[error("{path}: {source}")]
    Read {
        /// The path.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// There is no such folder.
    #[error("there is no folder `{0}`")]
    Missing(PathBuf),
    /// A file is not the RON of a room.
    #[error("{path}: {source}")]
    Ron {
        /// The file.
        path: PathBuf,
        /// The mistake, with line and column.
        source: Box<ron::error::SpannedError>,
    },
    /// A file is too long for a room.
    #[error("{path} must have at most {MAX_FILE} bytes, got {bytes}")]
    TooLong {
        /// The file.
        path: PathBuf,
        /// The file's size in bytes.
        bytes: u64,
    },
    /// A file contains an invalid room.
    #[error("{path}: {source}")]
    Room {
        /// The file.
        path: PathBuf,
        /// The rule that the room breaks.
        source: RoomError,
    },
    /// The rooms together do not make a catalogue.
    #[error("{path}: {source}")]
    Catalogue {
        /// The folder.
        path: PathBuf,
        /// The cause.
        source: CatalogueError,
    },
}

impl Catalogue {
    /// Reads every `*.room.ron` file of a folder, in the order of the file names.
    ///
    /// ```no_run
    /// use envgen::indoor::{Catalogue, IndoorSpec};
    ///
    /// let catalogue = Some(Catalogue::read_folder("my_rooms".as_ref())?);
    /// let spec = IndoorSpec { catalogue, ..Default::default() };
    /// # Ok::<(), envgen::indoor::FolderError>(())
    /// ```
    ///
    /// # Errors
    /// Names the file that does not contain a valid room, or the folder if its rooms do not make a catalogue.
    pub fn read_folder(folder: &Path) -> Result<Catalogue, FolderError> {
        let rooms = read_rooms(folder)?;
        Catalogue::new(rooms)
            .map_err(|source| FolderError::Catalogue { path: folder.to_owned(), source })
    }

    /// Returns this catalogue with the rooms of a folder, joined as by [`Catalogue::with`].
    ///
    /// # Errors
    /// As [`Catalogue::read_folder`].
    pub fn with_folder(&self, folder: &Path) -> Result<Catalogue, FolderError> {
        let rooms = read_rooms(folder)?;
        self.with(rooms)
            .map_err(|source| FolderError::Catalogue { path: folder.to_owned(), source })
    }
}

fn read_rooms(folder: &Path) -> Result<Vec<RoomDesign>, FolderError> {
    let failed = |path: &Path, source| FolderError::Read { path: path.to_owned(), source };
    if !folder.is_dir() {
        return Err(FolderError::Missing(folder.to_owned()));
    }
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(|source| failed(folder, source))? {
        let path = entry.map_err(|source| failed(folder, source))?.path();
        let is_room = path
            .file_name()
            .is_some_and(|name| name.to_str().is_some_and(|name| name.ends_with(ENDING)));
        if is_room {
            paths.push(path);
        }
        if paths.len() > MAX_ROOMS {
            let source = CatalogueError::Count(paths.len());
            return Err(FolderError::Catalogue { path: folder.to_owned(), source });
        }
    }
    paths.sort();
    let mut rooms = Vec::with_capacity(paths.len());
    for path in paths {
        let data = fs::metadata(&path).map_err(|source| failed(&path, source))?;
        // Devices and pipes have no length, and may have no end.
        if !data.is_file() {
            return Err(failed(&path, io::Error::other("it is not a file")));
        }
        if data.len() > MAX_FILE {
            return Err(FolderError::TooLong { path, bytes: data.len() });
        }
        let text = text_file::read(&path).map_err(|source| failed(&path, source))?;
        let room = room_from_ron(&text)
            .map_err(|source| FolderError::Ron { path: path.clone(), source })?;
        room.validate().map_err(|source| FolderError::Room { path: path.clone(), source })?;
        rooms.push(room);
    }
    Ok(rooms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::catalogue::room_to_ron;

    fn read(files: &[(&str, &str)]) -> Result<Catalogue, String> {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        Catalogue::read_folder(folder.path()).map_err(|error| error.to_string())
    }

    const CELL: &str = "(name: \"cell\", width: 1, height: 1, difficulty: 3)";

    #[test]
    fn rooms_come_in_the_order_of_their_files() {
        let hall = CELL.replace("cell", "hall");
        let rooms =
            read(&[("b.room.ron", CELL), ("a.room.ron", &hall), ("notes.txt", "no room")]).unwrap();
        let names: Vec<_> = rooms.rooms().iter().map(|room| room.name.as_str()).collect();
        assert_eq!(names, ["hall", "cell"]);
        let all = Catalogue::builtin().with(rooms.rooms().iter().map(|r| (**r).clone())).unwrap();
        assert_eq!((all.rooms().len(), all.rooms()[21].name.as_str()), (22, "cell"));
        // A room of a known name takes its place.
        let dark = [RoomDesign::bare("dark", 2, 2, 1.0)];
        let all = all.with(dark).unwrap();
        assert_eq!((all.rooms().len(), all.rooms()[0].width), (22, 2));
        assert_eq!(all.with([]), Err(CatalogueError::Count(0)));
    }

    #[test]
    fn every_builtin_room_survives_a_file() {
        for room in Catalogue::builtin().rooms() {
            let text = room_to_ron(room);
            let back = read(&[("room.room.ron", &text)]).unwrap();
            assert_eq!(*back.rooms()[0], **room);
        }
    }

    #[test]
    fn bad_files_are_named() {
        let error = |files: &[(&str, &str)]| read(files).unwrap_err();
        assert!(error(&[]).contains("rooms, got 0"));
        assert!(error(&[("a.room.ron", CELL), ("b.room.ron", CELL)]).contains("two rooms"));
        for (text, says) in [
            ("(name: \"cell\", width: -1, height: 1, difficulty: 3)", "1:24"),
            ("(name: \"cell\", width: 1, height: 1", "1:"),
            ("", "a.room.ron"),
            ("(name: \"cell\", width: 0, height: 1, difficulty: 3)", "cells, got 0 by 1"),
            ("(name: \"cell\", width: 1, height: 1, difficulty: 3, color: 4)", "color"),
            (
                "(name: \"cell\", width: 1, height: 1, difficulty: 3, obstacles: [(kind: desk, \
                 shape: disc(center: (2.8, 1.0), radius: 0.5))])",
                "outside",
            ),
        ] {
            let error = error(&[("a.room.ron", text)]);
            assert!(error.contains("a.room.ron") && error.contains(says), "{error}");
        }
        let missing = Catalogue::read_folder(Path::new("no/such/folder")).unwrap_err();
        assert_eq!(missing.to_string(), "there is no folder `no/such/folder`");
    }
}
