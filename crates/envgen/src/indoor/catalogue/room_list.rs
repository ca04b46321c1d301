//! Lists of rooms with distinct names.

use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use thiserror::Error;

use super::{RoomDesign, RoomError, SharedRoom, builtin, room_from_ron};

/// The greatest number of rooms in a catalogue.
pub const MAX_ROOMS: usize = 10_000;

/// The reasons why rooms do not make a catalogue.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CatalogueError {
    /// A room is invalid.
    #[error(transparent)]
    Room(#[from] RoomError),
    /// Two rooms have the same name.
    #[error("there are two rooms with the name `{0}`")]
    Duplicate(String),
    /// There are no rooms, or too many.
    #[error("the catalogue must have 1 to {MAX_ROOMS} rooms, got {0}")]
    Count(usize),
}

/// A list of rooms with distinct names, which is cheap to clone. It serialises to the list of its rooms, so that a
/// spec with its own catalogue is complete.
#[derive(Clone, Debug, PartialEq)]
pub struct Catalogue {
    rooms: Arc<[SharedRoom]>,
}

impl Catalogue {
    /// Creates a catalogue of the given rooms, in this order.
    ///
    /// # Errors
    /// When there are no rooms, when two have the same name, or when one is invalid.
    pub fn new(rooms: impl IntoIterator<Item = RoomDesign>) -> Result<Self, CatalogueError> {
        let mut names = BTreeSet::new();
        let mut shared = Vec::new();
        for room in rooms {
            if !names.insert(room.name.clone()) {
                return Err(CatalogueError::Duplicate(room.name));
            }
            shared.push(SharedRoom::new(room)?);
            if shared.len() > MAX_ROOMS {
                return Err(CatalogueError::Count(shared.len()));
            }
        }
        if shared.is_empty() {
            return Err(CatalogueError::Count(0));
        }
        Ok(Catalogue { rooms: shared.into() })
    }

    /// Returns the 20 rooms of Zwennes' appendix A, in its order of difficulty.
    ///
    /// ```
    /// use envgen::indoor::Catalogue;
    ///
    /// let rooms = Catalogue::builtin();
    /// assert_eq!(rooms.rooms().len(), 20);
    /// assert_eq!(rooms.get("water room").map(|room| room.difficulty), Some(9.0));
    /// ```
    pub fn builtin() -> &'static Catalogue {
        static BUILTIN: LazyLock<Catalogue> = LazyLock::new(|| {
            let rooms = builtin::FILES.iter().map(|(file, text)| match room_from_ron(text) {
                Ok(room) => room,
                Err(error) => unreachable!("the room file {file} of this crate: {error}"),
            });
            match Catalogue::new(rooms) {
                Ok(catalogue) => catalogue,
                Err(error) => unreachable!("the rooms of this crate: {error}"),
            }
        });
        &BUILTIN
    }

    /// Returns the rooms, in order.
    pub fn rooms(&self) -> &[SharedRoom] {
        &self.rooms
    }

    /// Returns the room with a name.
    pub fn get(&self, name: &str) -> Option<&SharedRoom> {
        self.rooms.iter().find(|room| room.name == name)
    }

    /// Returns this catalogue with further rooms. A room whose name already exists replaces that room; the others
    /// are appended.
    ///
    /// # Errors
    /// As [`Catalogue::new`] for the further rooms, and when there are too many rooms in total.
    pub fn with(
        &self,
        rooms: impl IntoIterator<Item = RoomDesign>,
    ) -> Result<Self, CatalogueError> {
        let mut all = self.rooms.to_vec();
        for room in Catalogue::new(rooms)?.rooms.iter() {
            match all.iter_mut().find(|known| known.name == room.name) {
                Some(known) => *known = room.clone(),
                None => all.push(room.clone()),
            }
        }
        if all.len() > MAX_ROOMS {
            return Err(CatalogueError::Count(all.len()));
        }
        Ok(Catalogue { rooms: all.into() })
    }
}

impl Serialize for Catalogue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.rooms.iter().map(|room| &**room))
    }
}

impl<'de> Deserialize<'de> for Catalogue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rooms = Vec::<RoomDesign>::deserialize(deserializer)?;
        Catalogue::new(rooms).map_err(de::Error::custom)
    }
}
