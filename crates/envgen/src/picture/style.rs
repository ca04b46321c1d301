//! The styles of parts: their names in the legend, the order in which they are drawn, edges and textures. Their
//! colours are those of the [`palette`].

use crate::palette::{self, PartColor, Srgb};
use crate::world::{ObstacleKind, SurfaceKind, WallKind};

/// The style of a filled part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Style {
    /// Name in the legend.
    pub(super) name: &'static str,
    pub(super) fill: Srgb,
    pub(super) edge: Srgb,
    /// Width of the edge in px. Walls have an edge of their own colour, so that thin walls remain visible.
    pub(super) edge_width: f64,
    pub(super) texture: Texture,
}

/// The texture of an area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Texture {
    Plain,
    Dots,
    Rising,
    Falling,
    Crosses,
    Waves,
    Treads,
}

impl Texture {
    /// Whether the floor below is visible through the texture. Such ground can cover whole rooms.
    pub(super) fn is_see_through(self) -> bool {
        matches!(self, Texture::Rising | Texture::Falling)
    }
}

impl Style {
    pub(super) const fn new(name: &'static str, color: PartColor) -> Style {
        let PartColor { fill, edge } = color;
        Style { name, fill, edge, edge_width: 0.8, texture: Texture::Plain }
    }

    const fn with_edge_width(self, edge_width: f64) -> Style {
        Style { edge_width, ..self }
    }
}

pub(super) const ROOM: Style = Style::new("room", palette::ROOM);
/// A victim.
pub(super) const VICTIM: Style = Style::new("victim", palette::VICTIM).with_edge_width(1.0);
/// The leaf of a moving door.
pub(super) const LEAF: Style = Style::new("door that moves", palette::LEAF);
/// A person who moves in the scenario.
pub(super) const PERSON: Style = Style::new("person, and a minute's path", palette::PERSON);
pub(super) const SMOKE: Style = Style::new("smoke", palette::SMOKE);
pub(super) const OPEN_DOOR: Style =
    Style::new("open doorway", palette::OPEN_DOORWAY).with_edge_width(1.0);
pub(super) const CLOSED_DOOR: Style =
    Style::new("closed door", palette::CLOSED_DOORWAY).with_edge_width(1.0);

/// The index in the order of drawing, and the style, of walls with a limited visible range.
pub(super) const DARK_WALL: (u32, Style) =
    (6, Style::new("dark wall", palette::DARK).with_edge_width(0.7));
/// The same for obstacles.
pub(super) const DARK_OBSTACLE: (u32, Style) = (16, Style::new("dark obstacle", palette::DARK));

/// Returns a wall's index in the order of drawing, and its style.
pub(super) fn wall(kind: WallKind) -> (u32, Style) {
    let (order, name) = match kind {
        WallKind::Kerb => (1, "kerb"),
        WallKind::Partition => (2, "partition"),
        WallKind::Alcove => (3, "alcove"),
        WallKind::Wall => (4, "wall"),
        WallKind::EndCap => (5, "end cap"),
    };
    (order, Style::new(name, palette::wall(kind)).with_edge_width(0.7))
}

/// Returns an obstacle's index in the order of drawing, and its style.
pub(super) fn obstacle(kind: ObstacleKind) -> (u32, Style) {
    let (order, name) = match kind {
        ObstacleKind::Other => (1, "obstacle"),
        ObstacleKind::Stairs => (2, "flight of stairs"),
        ObstacleKind::Pipe => (3, "pipe"),
        ObstacleKind::Boiler => (4, "boiler"),
        ObstacleKind::Statue => (5, "statue"),
        ObstacleKind::Counter => (6, "counter"),
        ObstacleKind::Container => (7, "container"),
        ObstacleKind::Cabinet => (8, "cabinet"),
        ObstacleKind::Panel => (9, "fallen wall"),
        ObstacleKind::Desk => (10, "desk"),
        ObstacleKind::Chair => (11, "chair"),
        ObstacleKind::Screen => (12, "screen"),
        ObstacleKind::Rubble => (13, "rubble"),
        ObstacleKind::Crate => (14, "crate"),
        ObstacleKind::DoorPost => (15, "door post"),
    };
    (order, Style::new(name, palette::obstacle(kind)))
}

/// Returns a surface's index in the order of drawing, and its style. Classes are drawn by their number, then the
/// other surfaces.
pub(super) fn surface(kind: SurfaceKind) -> (u32, Style) {
    const FIRST: u32 = 1 << 17;
    let (order, name, texture) = match kind {
        SurfaceKind::Class(class) => {
            let style = Style::new("class", palette::surface(kind)).with_edge_width(0.7);
            return (u32::from(class), style);
        }
        SurfaceKind::OpenArea => (FIRST, "open area", Texture::Plain),
        SurfaceKind::Hallway => (FIRST + 1, "hallway", Texture::Plain),
        SurfaceKind::Uneven => (FIRST + 2, "uneven", Texture::Dots),
        SurfaceKind::Debris => (FIRST + 3, "debris", Texture::Crosses),
        SurfaceKind::Water => (FIRST + 4, "water", Texture::Waves),
        SurfaceKind::Stairs => (FIRST + 5, "stairs", Texture::Treads),
        SurfaceKind::Slippery => (FIRST + 6, "slippery", Texture::Rising),
        SurfaceKind::Loose => (FIRST + 7, "loose", Texture::Falling),
    };
    (order, Style { texture, ..Style::new(name, palette::surface(kind)) })
}
