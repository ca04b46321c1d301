//! Bevy assets for specs and rooms in files.

pub(crate) mod file;
mod watch;

pub use file::{MAX_FILE_BYTES, RoomAsset, WorldAsset, WorldLoadError};
pub use watch::EnvgenAssetPlugin;
