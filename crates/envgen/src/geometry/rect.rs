//! Axis-aligned rectangles.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// An axis-aligned rectangle in metres.
///
/// ```
/// use envgen::geometry::Rect;
/// use envgen::glam::DVec2;
///
/// let room = Rect::new(DVec2::ZERO, DVec2::new(4.0, 3.0));
/// assert_eq!((room.center(), room.size()), (DVec2::new(2.0, 1.5), DVec2::new(4.0, 3.0)));
/// assert!(room.grown(0.1).contains_rect(room));
/// assert!(!room.contains(DVec2::new(4.5, 1.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rect {
    /// The corner with the least x and y.
    pub min: DVec2,
    /// The corner with the greatest x and y.
    pub max: DVec2,
}

impl Rect {
    /// Creates the rectangle between two corners, of which `min` is the lower left.
    pub const fn new(min: DVec2, max: DVec2) -> Self {
        Rect { min, max }
    }

    /// Returns the smallest rectangle that contains all points; `None` if there are no points.
    ///
    /// ```
    /// use envgen::geometry::Rect;
    /// use envgen::glam::DVec2;
    ///
    /// let points = [DVec2::new(1.0, 5.0), DVec2::new(3.0, 2.0), DVec2::new(2.0, 4.0)];
    /// let rect = Rect::around(points).expect("there are points");
    /// assert_eq!((rect.min, rect.max), (DVec2::new(1.0, 2.0), DVec2::new(3.0, 5.0)));
    /// assert_eq!(Rect::around([]), None);
    /// ```
    pub fn around(points: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        points.into_iter().fold(None, |rect, p| {
            Some(rect.map_or(Rect::new(p, p), |r: Rect| Rect::new(r.min.min(p), r.max.max(p))))
        })
    }

    /// Returns the smallest rectangle that contains both rectangles.
    pub fn union(self, other: Rect) -> Rect {
        Rect::new(self.min.min(other.min), self.max.max(other.max))
    }

    /// Returns the rectangle enlarged by `margin` on every side.
    ///
    /// ```
    /// use envgen::geometry::Rect;
    /// use envgen::glam::DVec2;
    ///
    /// let area = Rect::new(DVec2::ZERO, DVec2::new(4.0, 3.0));
    /// assert_eq!(area.grown(0.5).size(), DVec2::new(5.0, 4.0));
    /// // A negative margin leaves a border free.
    /// assert_eq!(area.grown(-1.0).size(), DVec2::new(2.0, 1.0));
    /// ```
    pub fn grown(self, margin: f64) -> Rect {
        Rect::new(self.min - DVec2::splat(margin), self.max + DVec2::splat(margin))
    }

    /// Returns the width and height.
    pub fn size(self) -> DVec2 {
        self.max - self.min
    }

    /// Returns the centre.
    pub fn center(self) -> DVec2 {
        (self.min + self.max) * 0.5
    }

    /// Returns whether a point lies inside the rectangle or on its border.
    pub fn contains(self, p: DVec2) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    /// Returns whether another rectangle lies inside this one, borders included.
    pub fn contains_rect(self, other: Rect) -> bool {
        self.contains(other.min) && self.contains(other.max)
    }

    /// Returns whether two rectangles have a point in common.
    pub fn overlaps(self, other: Rect) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}
