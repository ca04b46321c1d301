//! The rooms that a map may hold.

mod builtin;
mod design;
mod folder;

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, LazyLock, Mutex, PoisonError, Weak};

use ron::extensions::Extensions;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use thiserror::Error;

pub(super) use design::Frame;
pub use design::{DESIGN_UNIT, MAX_ROOM_PARTS, MAX_ROOM_SIZE, RoomDesign, RoomError};
pub use folder::FolderError;

use super::grid::Side;
use super::interior::{self, Dimensions, Interior};

/// Most rooms in a catalogue.
pub const MAX_ROOMS: usize = 10_000;

/// Distinct dimensions for which a room remembers its free space.
const REMEMBERED: usize = 4;

/// The sets of doorways for which a room caches its cleared version, and the parts in all of these.
const REMEMBERED_CLEARED: (usize, usize) = (256, 1 << 16);

/// Why rooms do not make a catalogue.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CatalogueError {
    /// A room is refused.
    #[error(transparent)]
    Room(#[from] RoomError),
    /// Two rooms have one name.
    #[error("there are two rooms with the name `{0}`")]
    Duplicate(String),
    /// There are no rooms, or too many.
    #[error("the catalogue has {0} rooms, expected 1 to {MAX_ROOMS}")]
    Count(usize),
}

/// A room that has passed its checks, cheap to clone.
#[derive(Clone)]
pub struct SharedRoom(Arc<Inner>);

struct Inner {
    design: RoomDesign,
    /// The cache of [`SharedRoom::interior`]; it changes no result.
    interiors: Mutex<Vec<(Dimensions, Arc<Interior>)>>,
    /// The cache of [`SharedRoom::cleared`]; it changes no result.
    cleared: Mutex<Vec<(Doorways, Option<SharedRoom>)>>,
    /// The room before it was cleared, and the doorways that it was cleared for.
    before: Option<(Weak<Inner>, Places)>,
}

/// Positions of doorways in the unturned room, in order.
type Places = Vec<(Side, u32)>;

/// The positions, and the dimensions that apply there.
type Doorways = (Places, Dimensions);

impl SharedRoom {
    /// Checks a room.
    ///
    /// # Errors
    /// The first rule that the room breaks.
    pub fn new(design: RoomDesign) -> Result<Self, RoomError> {
        design.validate()?;
        let (interiors, cleared) = Default::default();
        Ok(SharedRoom(Arc::new(Inner { design, interiors, cleared, before: None })))
    }

    /// The free space inside the room, computed once for the same dimensions.
    ///
    /// # Panics
    /// As [`Interior::new`].
    pub fn interior(&self, dimensions: Dimensions) -> Arc<Interior> {
        let mut known = self.0.interiors.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, interior)) = known.iter().find(|(key, _)| *key == dimensions) {
            return Arc::clone(interior);
        }
        let interior = Arc::new(Interior::new(&self.0.design, dimensions));
        if known.len() == REMEMBERED {
            known.remove(0);
        }
        known.push((dimensions, Arc::clone(&interior)));
        interior
    }

    /// The room without the contents that block a doorway in a side, `at` half cells from its
    /// left or upper end; `None` when the doorway could not be used even so.
    pub(super) fn cleared(
        &self,
        side: Side,
        at: u32,
        dimensions: Dimensions,
    ) -> Option<SharedRoom> {
        // The remaining contents depend on the set of doorways, not on their order.
        let before = self.0.before.as_ref();
        let before = before.and_then(|(room, doorways)| Some((room.upgrade()?, doorways.clone())));
        let (original, mut doorways) = before.unwrap_or_else(|| (Arc::clone(&self.0), Vec::new()));
        if let Err(place) = doorways.binary_search(&(side, at)) {
            doorways.insert(place, (side, at));
        }
        let key = (doorways, dimensions);
        let mut known = original.cleared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, room)) = known.iter().find(|(known, _)| *known == key) {
            return room.clone();
        }
        let design = interior::cleared(&self.0.design, dimensions, side, at);
        let (interiors, cleared) = Default::default();
        let before = Some((Arc::downgrade(&original), key.0.clone()));
        let room = SharedRoom(Arc::new(Inner { design, interiors, cleared, before }));
        // The removed contents may have filled a gap between those that stay.
        let interior = room.interior(dimensions);
        let sound = interior.port(side, at).usable() && interior.overlooked(&room, dimensions) == 0;
        let room = sound.then_some(room);
        let (most, parts) = REMEMBERED_CLEARED;
        if known.len() >= most.min(parts / (1 + original.design.barriers().count())).max(1) {
            known.remove(0);
        }
        known.push((key, room.clone()));
        room
    }
}

impl Deref for SharedRoom {
    type Target = RoomDesign;

    fn deref(&self) -> &RoomDesign {
        &self.0.design
    }
}

impl fmt::Debug for SharedRoom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.design.fmt(f)
    }
}

impl PartialEq for SharedRoom {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0.design == other.0.design
    }
}

/// A list of rooms with distinct names, cheap to clone. It serialises to the list of its rooms, so
/// that a spec with a catalogue of its own is complete.
#[derive(Clone, Debug, PartialEq)]
pub struct Catalogue {
    rooms: Arc<[SharedRoom]>,
}

impl Catalogue {
    /// A catalogue of these rooms, in this order.
    ///
    /// # Errors
    /// When there is no room, two have one name, or one is not sound.
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

    /// The 20 rooms of Zwennes' appendix A, in its order of difficulty.
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

    /// The rooms, in order.
    pub fn rooms(&self) -> &[SharedRoom] {
        &self.rooms
    }

    /// The room with a name.
    pub fn get(&self, name: &str) -> Option<&SharedRoom> {
        self.rooms.iter().find(|room| room.name == name)
    }

    /// This catalogue with further rooms: a room whose name exists already replaces that room, the
    /// others are appended.
    ///
    /// # Errors
    /// As [`Catalogue::new`] for the further rooms, and when there are too many together.
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

/// Reads the text of a `.room.ron` file; the room is not checked yet, see [`RoomDesign::validate`].
///
/// # Errors
/// Line and column of the mistake.
pub fn room_from_ron(text: &str) -> Result<RoomDesign, Box<ron::error::SpannedError>> {
    room_options().from_str(text).map_err(Box::new)
}

/// Writes a room as the text of a `.room.ron` file.
pub fn room_to_ron(room: &RoomDesign) -> String {
    let config = ron::ser::PrettyConfig::default().depth_limit(2);
    room_options().to_string_pretty(room, config).unwrap_or_default()
}

fn room_options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

#[cfg(test)]
mod tests;
