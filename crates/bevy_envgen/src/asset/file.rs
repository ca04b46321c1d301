//! The assets of specs and rooms, and the loaders of their files.

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AsyncReadExt, LoadContext};
use bevy::prelude::*;
use envgen::indoor::{Catalogue, CatalogueError, RoomDesign, RoomError, room_from_ron};
use envgen::text_file::without_mark;
use envgen::{SettingsError, SpecError, WorldSpec};
use thiserror::Error;

/// The size in bytes of the largest file that is read.
pub const MAX_FILE_BYTES: usize = 4 << 20;

/// An asset with a spec, loaded from a file such as `hall.envgen.ron`, which has the RON of a [`WorldSpec`]:
/// `Hallway(segments: 80)`.
///
/// The setting `rooms` of an indoor map may have paths of room files beside names of rooms:
/// `Indoor(rooms: ["dark", "rooms/cell.room.ron"])`. Paths are relative to the file. The rooms are added to
/// the catalogue, and the spec is reloaded when one of their files changes.
#[derive(Asset, TypePath, Clone, Debug, PartialEq)]
pub struct WorldAsset {
    /// The spec, which is valid.
    pub spec: WorldSpec,
}

/// An asset with a room, loaded from a file such as `cell.room.ron`, which has the form of the rooms in
/// `envgen`'s catalogues.
#[derive(Asset, TypePath, Clone, Debug, PartialEq)]
pub struct RoomAsset {
    /// The room, which is valid.
    pub design: RoomDesign,
}

/// An error of loading a spec or a room.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WorldLoadError {
    /// The file could not be read.
    #[error(transparent)]
    Read(#[from] std::io::Error),
    /// The file is too large.
    #[error("the file has more than {MAX_FILE_BYTES} bytes")]
    TooLong,
    /// The file is not text.
    #[error("the file is not UTF-8: {0}")]
    Text(#[from] std::str::Utf8Error),
    /// The text is not the RON of a spec.
    #[error(transparent)]
    Ron(#[from] SettingsError),
    /// The spec is invalid.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The text is not the RON of a room.
    #[error("not the RON of a room, at {0}")]
    RoomRon(#[from] Box<ron::error::SpannedError>),
    /// The room is invalid.
    #[error(transparent)]
    Room(#[from] RoomError),
    /// A room that the spec names could not be loaded.
    #[error("the room {path} cannot be loaded: {reason}")]
    RoomFile {
        /// The path of the room's file, relative to the file of the spec.
        path: String,
        /// The reason why it cannot be loaded.
        reason: String,
    },
    /// The rooms together are not a valid catalogue.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
}

/// Loads [`WorldAsset`]s.
#[derive(Default, TypePath)]
pub(super) struct WorldLoader;

/// Loads [`RoomAsset`]s.
#[derive(Default, TypePath)]
pub(super) struct RoomLoader;

/// The ending of room files.
const ROOM_ENDING: &str = ".room.ron";

impl AssetLoader for WorldLoader {
    type Asset = WorldAsset;
    type Settings = ();
    type Error = WorldLoadError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<WorldAsset, WorldLoadError> {
        let mut spec = WorldSpec::from_ron(&read(reader).await?)?;
        if let WorldSpec::Indoor(indoor) = &mut spec {
            let mut designs = Vec::new();
            for name in indoor.rooms.iter_mut().filter(|name| name.ends_with(ROOM_ENDING)) {
                let failed =
                    |reason: String| WorldLoadError::RoomFile { path: name.clone(), reason };
                let path =
                    context.path().resolve_embed_str(name).map_err(|e| failed(e.to_string()))?;
                let room = context.load_builder().load_value::<RoomAsset>(path).await;
                let design = room.map_err(|error| failed(error.to_string()))?.take().design;
                name.clone_from(&design.name);
                designs.push(design);
            }
            if !designs.is_empty() {
                let known = indoor.catalogue.as_ref().unwrap_or(Catalogue::builtin());
                indoor.catalogue = Some(known.with(designs)?);
            }
        }
        spec.validate()?;
        Ok(WorldAsset { spec })
    }

    fn extensions(&self) -> &[&str] {
        &["envgen.ron"]
    }
}

impl AssetLoader for RoomLoader {
    type Asset = RoomAsset;
    type Settings = ();
    type Error = WorldLoadError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        _: &mut LoadContext<'_>,
    ) -> Result<RoomAsset, WorldLoadError> {
        let design = room_from_ron(&read(reader).await?)?;
        design.validate()?;
        Ok(RoomAsset { design })
    }

    fn extensions(&self) -> &[&str] {
        &["room.ron"]
    }
}

/// Reads a UTF-8 text of at most [`MAX_FILE_BYTES`], without a byte order mark.
async fn read(reader: &mut dyn Reader) -> Result<String, WorldLoadError> {
    let mut bytes = Vec::new();
    let mut part = [0; 4096];
    loop {
        let read = reader.read(&mut part).await?;
        if read == 0 {
            return Ok(without_mark(std::str::from_utf8(&bytes)?).to_owned());
        }
        bytes.extend_from_slice(&part[..read]);
        if bytes.len() > MAX_FILE_BYTES {
            return Err(WorldLoadError::TooLong);
        }
    }
}
