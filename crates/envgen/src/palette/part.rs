//! The colours of the parts of worlds.

use super::hue::{GREEN, ORANGE, PURPLE, QUIET_INK};
use super::scale::{class, difficulty};
use super::srgb::Srgb;
use crate::world::{ObstacleKind, SurfaceKind, WallKind};

/// The colours of a part: of its area, and of the line around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartColor {
    /// The colour of the area.
    pub fill: Srgb,
    /// The colour of the line around the area.
    pub edge: Srgb,
}

impl PartColor {
    const fn new(fill: u32, edge: u32) -> PartColor {
        PartColor { fill: Srgb::hex(fill), edge: Srgb::hex(edge) }
    }

    /// Creates the colours of a part whose edge cannot be distinguished from its area.
    const fn plain(fill: u32) -> PartColor {
        PartColor::new(fill, fill)
    }
}

/// A tree.
pub const TREE: PartColor = PartColor::new(0x74_b8_87, 0x2a_6b_4a);
/// A road.
pub const ROAD: PartColor = PartColor::new(0x9c_a1_aa, 0x5f_65_70);
/// The lines between the lanes of a road.
pub const ROAD_MARKING: Srgb = Srgb::hex(0xff_ff_ff);
/// A lit room without a difficulty.
pub const ROOM: PartColor = PartColor::new(0xe8_ea_ee, 0xa9_a4_9a);
/// The colour that is mixed into the floors of unlit rooms, and of the hatching on them.
pub const UNLIT: Srgb = Srgb::hex(0x2b_32_52);
/// A doorway that a robot can pass.
pub const OPEN_DOORWAY: PartColor = PartColor { fill: Srgb::hex(0xd6_f0_e6), edge: GREEN };
/// A doorway with a closed door.
pub const CLOSED_DOORWAY: PartColor = PartColor::new(0xb5_4a_1f, 0x6e_2a_10);
/// A victim: a person to be found.
pub const VICTIM: PartColor = PartColor { fill: PURPLE, edge: Srgb::hex(0x7a_2f_5a) };

/// A person who moves in the scenario.
pub const PERSON: PartColor = PartColor { fill: GREEN, edge: Srgb::hex(0x00_4a_36) };
/// The leaf of a moving door.
pub const LEAF: PartColor = CLOSED_DOORWAY;
/// Smoke, which is transparent.
pub const SMOKE: PartColor = PartColor { fill: QUIET_INK, edge: QUIET_INK };

/// Returns the colour of the floor of a room, lit or unlit, with a difficulty from 0 to 10 if it has one.
pub fn room_floor(rated: Option<f64>, lit: bool) -> Srgb {
    let color = rated.map_or(ROOM.fill, difficulty);
    if lit { color } else { color.mix(UNLIT, 0.18) }
}

/// Returns the colours of a wall.
pub const fn wall(kind: WallKind) -> PartColor {
    match kind {
        WallKind::Wall => PartColor::plain(0x3b_42_4d),
        WallKind::EndCap => PartColor::plain(0xa3_3b_78),
        WallKind::Alcove => PartColor::plain(0x3a_7c_a8),
        WallKind::Partition => PartColor::plain(0x8a_90_9b),
        WallKind::Kerb => PartColor::plain(0xb5_9f_7b),
    }
}

/// A wall or an obstacle with a limited visible range.
pub const DARK: PartColor = PartColor::new(0x0b_0d_12, 0xf2_c1_4e);

/// Returns the colours of an obstacle.
pub const fn obstacle(kind: ObstacleKind) -> PartColor {
    match kind {
        ObstacleKind::DoorPost => PartColor { fill: ORANGE, edge: Srgb::hex(0x8a_5a_00) },
        ObstacleKind::Crate => PartColor::new(0xd8_b3_7a, 0x7a_55_25),
        ObstacleKind::Desk => PartColor::new(0xc9_9a_6b, 0x6f_49_22),
        ObstacleKind::Chair => PartColor::new(0x5f_86_b3, 0x2b_46_69),
        ObstacleKind::Screen => PartColor::new(0x4a_4f_58, 0x16_19_1e),
        ObstacleKind::Cabinet => PartColor::new(0x9c_84_6a, 0x4d_3d_2c),
        ObstacleKind::Counter => PartColor::new(0x8f_b8_c9, 0x33_5f_73),
        ObstacleKind::Container => PartColor::new(0x2f_8f_8b, 0x0f_4d_4a),
        ObstacleKind::Boiler => PartColor::new(0xb8_6b_52, 0x5c_2a_1b),
        ObstacleKind::Pipe => PartColor::new(0x9a_a3_ad, 0x4b_53_5e),
        ObstacleKind::Statue => PartColor::new(0x8d_8f_86, 0x3f_41_3a),
        ObstacleKind::Panel => PartColor::new(0x6f_77_85, 0x33_39_44),
        ObstacleKind::Rubble => PartColor::new(0x8a_7a_6c, 0x45_3a_30),
        ObstacleKind::Stairs => PartColor::new(0xc3_c7_d0, 0x5a_62_70),
        ObstacleKind::Other => PartColor::new(0xb7_9c_c8, 0x5d_43_70),
    }
}

/// Returns the colours of a surface. Pieces of one class join without a line between them.
pub fn surface(kind: SurfaceKind) -> PartColor {
    match kind {
        SurfaceKind::Uneven => PartColor::new(0xee_e2_bf, 0xb9_a0_5f),
        SurfaceKind::Debris => PartColor::new(0xdd_d5_cd, 0x8c_7d_6f),
        SurfaceKind::Water => PartColor::new(0xb5_dc_f2, 0x4f_9b_c8),
        SurfaceKind::Stairs => PartColor::new(0xe3_e4_e8, 0x7d_84_90),
        SurfaceKind::Slippery => PartColor::new(0xd9_e3_ec, 0x7f_95_ab),
        SurfaceKind::Loose => PartColor::new(0xe6_d3_ae, 0x9a_7a_45),
        SurfaceKind::Hallway => PartColor::plain(0xd3_ec_c8),
        SurfaceKind::OpenArea => PartColor::plain(0xe9_f5_d8),
        SurfaceKind::Class(number) => {
            let fill = class(number);
            PartColor { fill, edge: fill }
        }
    }
}
