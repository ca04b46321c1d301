//! The colours of worlds in three dimensions.

use bevy::prelude::*;
use envgen::palette;

use crate::visuals::color;

/// A resource with the colours of worlds in three dimensions. Obstacles, rough ground and the classes of
/// landscapes have the colours of [`envgen::palette`]. Walls and floors are lighter than in two dimensions,
/// where they need more contrast.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct Palette3d {
    /// Walls of buildings.
    pub wall: Color,
    /// Walls inside rooms.
    pub partition: Color,
    /// Kerbs of roads.
    pub kerb: Color,
    /// Ceilings.
    pub ceiling: Color,
    /// Lamps under ceilings.
    pub lamp: Color,
    /// The ground around worlds, and of worlds without floors.
    pub ground: Color,
    /// The ground of forests, and beside roads and landscapes.
    pub meadow: Color,
    /// Obstacles of no particular kind, such as rocks of landscapes and blocks of arenas.
    pub rock: Color,
    /// Floors of rooms.
    pub room: Color,
    /// Floors of hallways and open areas.
    pub hallway: Color,
    /// Roads.
    pub road: Color,
    /// The markings between the lanes of roads.
    pub marking: Color,
    /// Trunks of trees.
    pub trunk: Color,
    /// Crowns of trees.
    pub crown: Color,
    /// Doors.
    pub door: Color,
    /// Water. Its alpha is its opacity.
    pub water: Color,
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
    /// The heads of people of scenarios.
    pub head: Color,
    /// Smoke.
    pub smoke: Color,
}

impl Default for Palette3d {
    fn default() -> Self {
        Palette3d {
            wall: Color::srgb_u8(0xec, 0xe8, 0xe0),
            partition: Color::srgb_u8(0xb4, 0xbb, 0xc6),
            kerb: Color::srgb_u8(0xa9, 0xa5, 0x9c),
            ceiling: Color::srgb_u8(0xee, 0xed, 0xe9),
            lamp: Color::srgb_u8(0xff, 0xf6, 0xe4),
            ground: Color::srgb_u8(0xb2, 0xad, 0xa2),
            meadow: Color::srgb_u8(0x7d, 0x92, 0x5c),
            rock: Color::srgb_u8(0x9a, 0x93, 0x88),
            room: Color::srgb_u8(0xbf, 0xb9, 0xae),
            hallway: Color::srgb_u8(0xa7, 0xb9, 0xa4),
            road: Color::srgb_u8(0x55, 0x58, 0x5c),
            marking: color(palette::ROAD_MARKING),
            trunk: Color::srgb_u8(0x7a, 0x5c, 0x43),
            crown: Color::srgb_u8(0x4d, 0x8a, 0x55),
            door: Color::srgb_u8(0xb9, 0x8d, 0x6a),
            water: Color::srgb_u8(0x3f, 0x83, 0xa8).with_alpha(0.8),
            dark: Color::srgb_u8(0x1a, 0x1c, 0x22),
            start: color(palette::START),
            goal: color(palette::GOAL),
            victim: color(palette::VICTIM.fill),
            person: color(palette::PERSON.fill),
            head: Color::srgb_u8(0xd9, 0xa8, 0x82),
            smoke: Color::srgb_u8(0x77, 0x77, 0x7a),
        }
    }
}
