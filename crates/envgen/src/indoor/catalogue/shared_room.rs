//! Rooms that are shared between maps, with data that was computed for them.

use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::design::{RoomDesign, RoomError};
use crate::indoor::dimensions::Dimensions;
use crate::indoor::grid::Side;
use crate::indoor::interior::{self, Interior};

/// The number of distinct dimensions for which a room caches its free space.
const REMEMBERED: usize = 4;

/// The number of sets of doorways for which a room caches its cleared version, and the number of parts in all of these.
const REMEMBERED_CLEARED: (usize, usize) = (256, 1 << 16);

/// A room that has passed its checks. It is cheap to clone.
#[derive(Clone)]
pub struct SharedRoom(Arc<Inner>);

struct Inner {
    design: RoomDesign,
    /// The cache of [`SharedRoom::interior`], which does not change any result.
    interiors: Mutex<Vec<(Dimensions, Arc<Interior>)>>,
    /// The cache of [`SharedRoom::cleared`], which does not change any result.
    cleared: Mutex<Vec<(Doorways, Option<SharedRoom>)>>,
    /// The room before it was cleared, and the doorways for which it was cleared.
    before: Option<(Weak<Inner>, Places)>,
}

/// Positions of doorways in the unturned room, sorted.
type Places = Vec<(Side, u32)>;

/// The positions of doorways, and the dimensions that apply there.
type Doorways = (Places, Dimensions);

/// Serialises the room as its design.
impl Serialize for SharedRoom {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.design.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for SharedRoom {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        SharedRoom::new(RoomDesign::deserialize(deserializer)?).map_err(de::Error::custom)
    }
}

impl SharedRoom {
    /// Checks a room and wraps it.
    ///
    /// # Errors
    /// Returns the first rule that the room breaks.
    pub fn new(design: RoomDesign) -> Result<Self, RoomError> {
        design.validate()?;
        let (interiors, cleared) = Default::default();
        Ok(SharedRoom(Arc::new(Inner { design, interiors, cleared, before: None })))
    }

    /// Returns the free space inside the room, which is cached for some dimensions.
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

    /// Returns the room without the contents that block a doorway in a side, `at` half cells from its left or upper
    /// end; `None` if the doorway could still not be used.
    pub(in crate::indoor) fn cleared(
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::Catalogue;

    #[test]
    fn a_room_is_cleared_for_a_set_of_doorways() {
        let dimensions = crate::indoor::IndoorSpec::default().dimensions();
        let lab = Catalogue::builtin().get("computer lab").unwrap();
        let (west, east) = ((Side::West, 1), (Side::East, 3));
        let clear = |room: &SharedRoom, (side, at)| room.cleared(side, at, dimensions).unwrap();
        let one_way = clear(&clear(lab, west), east);
        let other_way = clear(&clear(lab, east), west);
        assert_eq!(one_way, other_way);
        assert!(one_way.obstacles.len() < clear(lab, west).obstacles.len());
        // Computed once, and with the same result for a room that is not the catalogue's own.
        assert!(Arc::ptr_eq(&one_way.0, &other_way.0));
        let copy = clear(&SharedRoom::new((**lab).clone()).unwrap(), west);
        assert_eq!(clear(&copy, east), one_way);
        for (side, at) in [west, east] {
            assert!(!lab.interior(dimensions).port(side, at).usable());
            assert!(one_way.interior(dimensions).port(side, at).usable());
        }
    }
}
