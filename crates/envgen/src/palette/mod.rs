//! The colours of worlds and maps, which are the same in all pictures: SVG, PNG, Bevy and reports.
//!
//! | what | where |
//! |---|---|
//! | basic hues, start, goal, page | the constants of this module |
//! | walls, obstacles, surfaces and other parts | [`wall`], [`obstacle`], [`surface`], [`TREE`], [`ROAD`] and others |
//! | scales | [`difficulty`], [`class`], [`ordered_class`] |
//! | occupancy grids and trajectories | [`map`] |
//!
//! The colours are also distinguishable for people who are colour-blind: hues after M. Okabe and K. Ito, Color
//! Universal Design (2008); difficulties after `YlOrRd` of C. Brewer's colour schemes for maps (2003), whose
//! lightness falls throughout; and landscape classes after P. Tol's "light" scheme (Colour Schemes,
//! SRON/EPS/TN/09-002).
//!
//! ```
//! use envgen::palette::{self, Srgb};
//! use envgen::world::WallKind;
//!
//! assert_eq!(palette::START.to_string(), "#0072b2");
//! assert_eq!(palette::wall(WallKind::Wall).fill, Srgb([0x3b, 0x42, 0x4d]));
//! assert!(palette::difficulty(8.0).lightness() < palette::difficulty(2.0).lightness());
//! ```

mod hue;
pub mod map;
mod part;
mod scale;
mod srgb;

pub use hue::{
    BLUE, FRAME, GOAL, GREEN, GRID, INK, ORANGE, PAGE, PLAN, PURPLE, QUIET_INK, SKY_BLUE, START,
    VERMILION,
};
pub use part::{
    CLOSED_DOORWAY, DARK, LEAF, OPEN_DOORWAY, PERSON, PartColor, ROAD, ROAD_MARKING, ROOM, SMOKE,
    TREE, UNLIT, VICTIM, obstacle, room_floor, surface, wall,
};
pub use scale::{CLASSES, class, difficulty, ordered_class};
pub use srgb::Srgb;
