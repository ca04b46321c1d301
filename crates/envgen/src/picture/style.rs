//! The colours of everything.
//!
//! Colour-blind people can distinguish them too: hues after M. Okabe and K. Ito, Color Universal Design
//! (2008), difficulties after `YlOrRd` of C. Brewer's colour schemes for maps (2003), whose lightness
//! falls throughout, and landscape classes after P. Tol's "light" scheme (Colour Schemes,
//! SRON/EPS/TN/09-002).

use std::fmt;

use crate::world::{ObstacleKind, SurfaceKind, WallKind};

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Color(pub(super) [u8; 3]);

pub(super) const fn rgb(hex: u32) -> Color {
    let [_, r, g, b] = hex.to_be_bytes();
    Color([r, g, b])
}

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

impl Color {
    /// The colour between this one (0) and another (1).
    pub(super) fn mix(self, other: Color, share: f64) -> Color {
        let mixed = |i: usize| {
            let (a, b) = (f64::from(self.0[i]), f64::from(other.0[i]));
            (a + (b - a) * share).round() as u8
        };
        Color([mixed(0), mixed(1), mixed(2)])
    }

    /// Perceived lightness, 0 to 1 (the luma of ITU-R BT.601).
    pub(super) fn lightness(self) -> f64 {
        let [r, g, b] = self.0.map(f64::from);
        (0.299 * r + 0.587 * g + 0.114 * b) / 255.0
    }
}

pub(super) const PAGE: Color = rgb(0xff_ff_ff);
pub(super) const PLAN: Color = rgb(0xfa_f9_f6);
pub(super) const FRAME: Color = rgb(0xb8_bb_c2);
pub(super) const GRID: Color = rgb(0xd9_d8_d3);
pub(super) const INK: Color = rgb(0x25_2a_31);
pub(super) const QUIET_INK: Color = rgb(0x6b_72_7c);
pub(super) const START: Color = rgb(0x00_72_b2);
pub(super) const GOAL: Color = rgb(0xd5_5e_00);

pub(super) const TREE: Color = rgb(0x74_b8_87);
pub(super) const TREE_EDGE: Color = rgb(0x2a_6b_4a);

pub(super) const ASPHALT: Color = rgb(0x9c_a1_aa);
pub(super) const ROAD_EDGE: Color = rgb(0x5f_65_70);
pub(super) const MARKING: Color = rgb(0xff_ff_ff);

pub(super) const DOOR_OPEN: Color = rgb(0xd6_f0_e6);
pub(super) const DOOR_OPEN_EDGE: Color = rgb(0x00_9e_73);
pub(super) const DOOR_CLOSED: Color = rgb(0xb5_4a_1f);
pub(super) const DOOR_CLOSED_EDGE: Color = rgb(0x6e_2a_10);

/// A room without a difficulty.
pub(super) const ROOM: Color = rgb(0xe8_ea_ee);
pub(super) const ROOM_EDGE: Color = rgb(0xa9_a4_9a);
pub(super) const DARK: Color = rgb(0x2b_32_52);

pub(super) const CURVE_LEFT: Color = rgb(0x00_72_b2);
pub(super) const CURVE_RIGHT: Color = rgb(0xd5_5e_00);

/// How a filled part looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Style {
    /// Name in the legend.
    pub(super) name: &'static str,
    pub(super) fill: Color,
    pub(super) edge: Color,
    /// Width of the edge in px. Walls have an edge of their own colour, so that thin ones stay visible.
    pub(super) edge_width: f64,
    pub(super) texture: Texture,
}

/// The texture of an area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Texture {
    Plain,
    Dots,
    Crosses,
    Waves,
    Treads,
}

impl Style {
    const fn solid(name: &'static str, fill: u32) -> Style {
        Style::borderless(name, rgb(fill))
    }

    /// An area whose edge has its own colour.
    const fn borderless(name: &'static str, fill: Color) -> Style {
        Style { name, fill, edge: fill, edge_width: 0.7, texture: Texture::Plain }
    }

    pub(super) const fn edged(name: &'static str, fill: Color, edge: Color) -> Style {
        Style { name, fill, edge, edge_width: 0.8, texture: Texture::Plain }
    }

    const fn textured(self, texture: Texture) -> Style {
        Style { texture, ..self }
    }
}

/// Walls, in the order in which they are drawn.
const WALLS: &[(WallKind, Style)] = &[
    (WallKind::Kerb, Style::solid("kerb", 0xb5_9f_7b)),
    (WallKind::Partition, Style::solid("partition", 0x8a_90_9b)),
    (WallKind::Alcove, Style::solid("alcove", 0x3a_7c_a8)),
    (WallKind::Wall, Style::solid("wall", 0x3b_42_4d)),
    (WallKind::EndCap, Style::solid("end cap", 0xa3_3b_78)),
];

/// Obstacles, in the order in which they are drawn; kinds that are not listed look like `Other`.
const OBSTACLES: &[(ObstacleKind, Style)] = &[
    (ObstacleKind::Other, OTHER),
    (ObstacleKind::Stairs, Style::edged("flight of stairs", rgb(0xc3_c7_d0), rgb(0x5a_62_70))),
    (ObstacleKind::Pipe, Style::edged("pipe", rgb(0x9a_a3_ad), rgb(0x4b_53_5e))),
    (ObstacleKind::Boiler, Style::edged("boiler", rgb(0xb8_6b_52), rgb(0x5c_2a_1b))),
    (ObstacleKind::Statue, Style::edged("statue", rgb(0x8d_8f_86), rgb(0x3f_41_3a))),
    (ObstacleKind::Counter, Style::edged("counter", rgb(0x8f_b8_c9), rgb(0x33_5f_73))),
    (ObstacleKind::Container, Style::edged("container", rgb(0x2f_8f_8b), rgb(0x0f_4d_4a))),
    (ObstacleKind::Cabinet, Style::edged("cupboard", rgb(0x9c_84_6a), rgb(0x4d_3d_2c))),
    (ObstacleKind::Panel, Style::edged("fallen wall", rgb(0x6f_77_85), rgb(0x33_39_44))),
    (ObstacleKind::Desk, Style::edged("desk", rgb(0xc9_9a_6b), rgb(0x6f_49_22))),
    (ObstacleKind::Chair, Style::edged("chair", rgb(0x5f_86_b3), rgb(0x2b_46_69))),
    (ObstacleKind::Screen, Style::edged("screen", rgb(0x4a_4f_58), rgb(0x16_19_1e))),
    (ObstacleKind::Rubble, Style::edged("rubble", rgb(0x8a_7a_6c), rgb(0x45_3a_30))),
    (ObstacleKind::Crate, Style::edged("crate", rgb(0xd8_b3_7a), rgb(0x7a_55_25))),
    (ObstacleKind::DoorPost, Style::edged("door post", rgb(0xe6_9f_00), rgb(0x8a_5a_00))),
];
const OTHER: Style = Style::edged("obstacle", rgb(0xb7_9c_c8), rgb(0x5d_43_70));

/// Surfaces, in the order in which they are drawn; kinds that are not listed look like a floor.
const SURFACES: &[(SurfaceKind, Style)] = &[
    (SurfaceKind::OpenArea, Style::edged("open area", rgb(0xe9_f5_d8), rgb(0xe9_f5_d8))),
    (SurfaceKind::Hallway, Style::edged("hallway", rgb(0xd3_ec_c8), rgb(0xd3_ec_c8))),
    (
        SurfaceKind::Uneven,
        Style::edged("uneven", rgb(0xee_e2_bf), rgb(0xb9_a0_5f)).textured(Texture::Dots),
    ),
    (
        SurfaceKind::Debris,
        Style::edged("debris", rgb(0xdd_d5_cd), rgb(0x8c_7d_6f)).textured(Texture::Crosses),
    ),
    (
        SurfaceKind::Water,
        Style::edged("water", rgb(0xb5_dc_f2), rgb(0x4f_9b_c8)).textured(Texture::Waves),
    ),
    (
        SurfaceKind::Stairs,
        Style::edged("stairs", rgb(0xe3_e4_e8), rgb(0x7d_84_90)).textured(Texture::Treads),
    ),
];
const FLOOR: Style = Style::edged("floor", rgb(0xf1_ef_ea), rgb(0xe2_df_d8));

pub(super) const ROOM_STYLE: Style = Style::edged("room", ROOM, ROOM_EDGE);
/// People to be found.
pub(super) const VICTIM: Style =
    Style { edge_width: 1.0, ..Style::edged("victim", rgb(0xcc_79_a7), rgb(0x7a_2f_5a)) };
pub(super) const OPEN_DOOR: Style =
    Style { edge_width: 1.0, ..Style::edged("open doorway", DOOR_OPEN, DOOR_OPEN_EDGE) };
pub(super) const CLOSED_DOOR: Style =
    Style { edge_width: 1.0, ..Style::edged("closed door", DOOR_CLOSED, DOOR_CLOSED_EDGE) };

fn find<K: PartialEq>(table: &[(K, Style)], kind: &K) -> Option<(u32, Style)> {
    let place = table.iter().position(|(known, _)| known == kind)?;
    Some((place as u32 + 1, table[place].1))
}

/// A wall's index in the order of drawing, and its style.
pub(super) fn wall(kind: WallKind) -> (u32, Style) {
    find(WALLS, &kind).unwrap_or((0, WALLS[3].1))
}

/// An obstacle's index in the order of drawing, and its style.
pub(super) fn obstacle(kind: ObstacleKind) -> (u32, Style) {
    find(OBSTACLES, &kind).unwrap_or((1, OTHER))
}

/// A surface's index in the order of drawing, and its style: floors, classes by their number, then
/// the others.
pub(super) fn surface(kind: SurfaceKind) -> (u32, Style) {
    if let SurfaceKind::Class(class) = kind {
        let fill = class_color(class);
        // Pieces of one class join without a line between them.
        return (1 + u32::from(class), Style::borderless("class", fill));
    }
    find(SURFACES, &kind).map_or((0, FLOOR), |(place, style)| (place + (1 << 17), style))
}

const DIFFICULTIES: [Color; 6] = [
    rgb(0xff_fb_dc),
    rgb(0xff_e8_97),
    rgb(0xfe_bf_5a),
    rgb(0xf7_8a_48),
    rgb(0xdc_4f_3c),
    rgb(0x9c_22_42),
];

/// The colour of a difficulty from 0 to 10; values outside are clamped.
pub(super) fn difficulty(difficulty: f64) -> Color {
    let at = (difficulty.clamp(0.0, 10.0) / 10.0) * (DIFFICULTIES.len() - 1) as f64;
    let i = (at as usize).min(DIFFICULTIES.len() - 2);
    DIFFICULTIES[i].mix(DIFFICULTIES[i + 1], at - i as f64)
}

const CLASSES: [Color; 9] = [
    rgb(0x77_aa_dd),
    rgb(0xee_dd_88),
    rgb(0x44_bb_99),
    rgb(0xee_88_66),
    rgb(0xbb_cc_33),
    rgb(0xff_aa_bb),
    rgb(0x99_dd_ff),
    rgb(0xaa_aa_00),
    rgb(0xcc_cc_cc),
];

/// The colour of a landscape class, counted from 1. The first nine are chosen to be distinguishable;
/// later ones are their mixtures with their second neighbours and with the ink.
pub(super) fn class_color(class: u16) -> Color {
    let index = usize::from(class.saturating_sub(1));
    let (i, round) = (index % CLASSES.len(), index / CLASSES.len());
    let next = CLASSES[(i + 2) % CLASSES.len()];
    let color = match round {
        0 => CLASSES[i],
        _ => CLASSES[i].mix(next, 0.15 * (round % 4) as f64).mix(INK, 0.22 * (round % 3) as f64),
    };
    color.mix(PAGE, 0.15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difficulties_darken_all_the_way() {
        let lightness: Vec<_> =
            (0..=100).map(|d| difficulty(f64::from(d) / 10.0).lightness()).collect();
        assert!(lightness.windows(2).all(|pair| pair[0] > pair[1]), "{lightness:?}");
        assert_eq!(difficulty(-3.0), difficulty(0.0));
        assert_eq!(difficulty(99.0), difficulty(10.0));
    }

    #[test]
    fn the_first_classes_differ() {
        let distance = |a: Color, b: Color| -> u32 {
            (0..3).map(|i| u32::from(a.0[i].abs_diff(b.0[i]))).sum()
        };
        for a in 1..=9 {
            for b in 1..a {
                assert!(distance(class_color(a), class_color(b)) > 50, "{a} and {b}");
            }
        }
        for class in 10..=27 {
            assert_ne!(class_color(class), class_color(class - 9), "{class}");
        }
    }
}
