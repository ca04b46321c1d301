//! The contents of asset files, and their loaders.

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AsyncReadExt, LoadContext};
use bevy::prelude::*;
use envgen::indoor::{Catalogue, CatalogueError, RoomDesign, RoomError, room_from_ron};
use envgen::{SettingsError, SpecError, WorldSpec};
use thiserror::Error;

/// The largest file that is read, in bytes.
pub const MAX_FILE_BYTES: usize = 4 << 20;

/// A spec from a file such as `hall.envgen.ron`, which holds the RON of a [`WorldSpec`]:
/// `Hallway(segments: 80)`.
///
/// The `rooms` of an indoor map may name room files beside the names of rooms:
/// `Indoor(rooms: ["dark", "rooms/cell.room.ron"])`, relative to the file. They join the catalogue,
/// and a change of one of them reloads the spec.
#[derive(Asset, TypePath, Clone, Debug, PartialEq)]
pub struct WorldAsset {
    /// The spec, validated.
    pub spec: WorldSpec,
}

/// A room from a file such as `cell.room.ron`, in the form of `envgen`'s catalogues.
#[derive(Asset, TypePath, Clone, Debug, PartialEq)]
pub struct RoomAsset {
    /// The room, validated.
    pub design: RoomDesign,
}

/// Why a spec or a room could not be loaded.
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
        /// Its file, relative to the spec's.
        path: String,
        /// What is wrong with it.
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

/// Reads a text of at most [`MAX_FILE_BYTES`].
async fn read(reader: &mut dyn Reader) -> Result<String, WorldLoadError> {
    let mut bytes = Vec::new();
    let mut part = [0; 4096];
    loop {
        let read = reader.read(&mut part).await?;
        if read == 0 {
            return Ok(std::str::from_utf8(&bytes)?.to_owned());
        }
        bytes.extend_from_slice(&part[..read]);
        if bytes.len() > MAX_FILE_BYTES {
            return Err(WorldLoadError::TooLong);
        }
    }
}
