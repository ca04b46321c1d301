//! The colours of the parts of worlds in two dimensions.

use bevy::prelude::*;
use envgen::palette::{self, Srgb};

/// A resource with the colours of the parts of worlds in two dimensions.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct WorldPalette {
    /// Walls, partitions and kerbs.
    pub wall: Color,
    /// Trees.
    pub tree: Color,
    /// Roads.
    pub road: Color,
    /// Floors of lit rooms.
    pub room: Color,
    /// Floors of dark rooms.
    pub dark_room: Color,
    /// Openings in walls.
    pub doorway: Color,
    /// Obstacles.
    pub obstacle: Color,
    /// Uneven ground and debris.
    pub rough: Color,
    /// Water.
    pub water: Color,
    /// Plain floors of hallways and open areas.
    pub floor: Color,
    /// Slippery floors.
    pub slippery: Color,
    /// Loose ground.
    pub loose: Color,
    /// Walls and obstacles that lasers see only from a short distance.
    pub dark: Color,
    /// The start.
    pub start: Color,
    /// The goal.
    pub goal: Color,
    /// People to be found.
    pub victim: Color,
    /// People of scenarios.
    pub person: Color,
    /// The marks on people that show the direction in which they look.
    pub face: Color,
    /// The leaves of doors.
    pub leaf: Color,
    /// Smoke. Its opacity follows from its extinction coefficient.
    pub smoke: Color,
    /// The classes of a landscape, starting with class 1. The colours repeat if there are more classes than
    /// colours.
    pub classes: Vec<Color>,
}

/// The default colours are those of [`envgen::palette`], which SVG and PNG pictures use as well.
impl Default for WorldPalette {
    fn default() -> Self {
        use envgen::world::{ObstacleKind, SurfaceKind, WallKind};
        WorldPalette {
            wall: color(palette::wall(WallKind::Wall).fill),
            tree: color(palette::TREE.fill),
            road: color(palette::ROAD.fill),
            room: color(palette::room_floor(None, true)),
            dark_room: color(palette::room_floor(None, false)),
            doorway: color(palette::OPEN_DOORWAY.fill),
            obstacle: color(palette::obstacle(ObstacleKind::Other).fill),
            rough: color(palette::surface(SurfaceKind::Uneven).fill),
            water: color(palette::surface(SurfaceKind::Water).fill),
            floor: color(palette::surface(SurfaceKind::Hallway).fill),
            // These are transparent, since they cover whole rooms, whose colours must remain visible.
            slippery: color(palette::surface(SurfaceKind::Slippery).fill).with_alpha(0.35),
            loose: color(palette::surface(SurfaceKind::Loose).fill).with_alpha(0.35),
            dark: color(palette::DARK.fill),
            start: color(palette::START),
            goal: color(palette::GOAL),
            victim: color(palette::VICTIM.fill),
            person: color(palette::PERSON.fill),
            face: color(palette::INK),
            leaf: color(palette::LEAF.fill),
            smoke: color(palette::SMOKE.fill),
            classes: (1..=palette::CLASSES).map(|class| color(palette::class(class))).collect(),
        }
    }
}

/// Converts a colour of [`envgen::palette`] to an opaque colour of Bevy.
pub fn color(Srgb([red, green, blue]): Srgb) -> Color {
    Color::srgb_u8(red, green, blue)
}
