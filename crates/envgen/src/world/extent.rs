//! Vertical extents of parts: a bottom and a top.

use serde::{Deserialize, Serialize};

use crate::error::SpecError;

/// The greatest distance of any part above or below the floor, in metres.
pub const MAX_HEIGHT: f64 = 1000.0;

/// The least height of a part, in metres.
pub const MIN_HEIGHT: f64 = 1e-3;

/// The bottom and the top of a part, in metres above the floor.
///
/// Each kind of part has a default extent. A part states an extent only if it differs from the default, so that
/// worlds of ordinary parts contain no heights:
///
/// ```
/// use envgen::geometry::Shape;
/// use envgen::glam::DVec2;
/// use envgen::world::{Extent, Obstacle, ObstacleKind};
///
/// let shape = Shape::Box { center: DVec2::ZERO, half_size: DVec2::new(0.8, 0.4), heading: 0.0 };
/// let mut desk = Obstacle::new(ObstacleKind::Desk, shape);
/// assert_eq!((desk.extent().bottom(), desk.extent().top()), (0.0, 0.75));
/// // A table top without legs: what is lower passes below it.
/// desk.height = Some(Extent::new(0.7, 0.75)?);
/// assert!(!desk.extent().contains(0.45));
/// # Ok::<(), envgen::SpecError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UncheckedExtent")]
pub struct Extent {
    bottom: f64,
    top: f64,
}

/// An extent as it is read from a file, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedExtent {
    #[serde(default)]
    bottom: f64,
    top: f64,
}

impl TryFrom<UncheckedExtent> for Extent {
    type Error = SpecError;

    fn try_from(ends: UncheckedExtent) -> Result<Self, SpecError> {
        Extent::new(ends.bottom, ends.top)
    }
}

impl Extent {
    /// Creates an extent from a bottom and a top in metres above the floor, each from -[`MAX_HEIGHT`] to
    /// [`MAX_HEIGHT`]; negative numbers are below the floor.
    ///
    /// # Errors
    /// When one of them is out of this range or NaN, or when the top is not at least [`MIN_HEIGHT`] above the bottom.
    pub fn new(bottom: f64, top: f64) -> Result<Self, SpecError> {
        let heights = -MAX_HEIGHT..=MAX_HEIGHT;
        for (name, value) in [("bottom", bottom), ("top", top)] {
            if !heights.contains(&value) {
                let allowed = format!("a number from -{MAX_HEIGHT} to {MAX_HEIGHT}");
                return Err(SpecError::new(name, value, allowed));
            }
        }
        if top - bottom >= MIN_HEIGHT {
            Ok(Extent { bottom, top })
        } else {
            let allowed = format!("at least {MIN_HEIGHT} m above the bottom at {bottom} m");
            Err(SpecError::new("top", top, allowed))
        }
    }

    /// Creates an extent from the floor to a height that is known to be allowed.
    pub(super) const fn up_to(top: f64) -> Self {
        Extent { bottom: 0.0, top }
    }

    /// Creates an extent from a bottom and a top that are known to be allowed.
    pub(crate) const fn between(bottom: f64, top: f64) -> Self {
        Extent { bottom, top }
    }

    /// Returns the extent from the floor to the height of a setting; `None` if the kind of part has this height by
    /// default.
    pub(crate) fn unless_usual(usual: Extent, top: f64) -> Option<Self> {
        (usual.top != top).then_some(Extent { bottom: usual.bottom, top })
    }

    /// Returns the bottom in metres above the floor, negative below it.
    pub fn bottom(self) -> f64 {
        self.bottom
    }

    /// Returns the top in metres above the floor, negative below it.
    pub fn top(self) -> f64 {
        self.top
    }

    /// Returns the distance from bottom to top in metres.
    pub fn height(self) -> f64 {
        self.top - self.bottom
    }

    /// Returns whether a height in metres lies in the extent, its ends included.
    pub fn contains(self, height: f64) -> bool {
        (self.bottom..=self.top).contains(&height)
    }

    /// Returns whether two extents have more than an end in common.
    pub fn overlaps(self, other: Extent) -> bool {
        self.bottom < other.top && other.bottom < self.top
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_extents_are_refused() {
        let error = |bottom, top| Extent::new(bottom, top).unwrap_err().to_string();
        assert_eq!(error(f64::NAN, 1.0), "`bottom` must be a number from -1000 to 1000, got NaN");
        assert_eq!(error(0.0, f64::INFINITY), "`top` must be a number from -1000 to 1000, got inf");
        assert_eq!(
            error(1.0, 1.0),
            "`top` must be at least 0.001 m above the bottom at 1 m, got 1"
        );
        assert_eq!(
            error(1.0, 0.5),
            "`top` must be at least 0.001 m above the bottom at 1 m, got 0.5"
        );
        let read = |text: &str| serde_json::from_str::<Extent>(text);
        assert_eq!(read(r#"{"top": 2.0}"#).ok(), Extent::new(0.0, 2.0).ok());
        assert!(read(r#"{"bottom": 3.0, "top": 2.0}"#).unwrap_err().to_string().contains("`top`"));
        assert!(read(r#"{"bottom": 3.0, "height": 2.0}"#).is_err());
    }
}
