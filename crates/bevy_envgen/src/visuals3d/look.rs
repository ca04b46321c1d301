//! The finish and the colour of the bodies of a world.

use bevy::prelude::*;
use envgen::World as EnvgenWorld;
use envgen::pieces::{Piece, Role};
use envgen::world::{ObstacleKind, PartKind, SurfaceKind, WallKind};

use super::finish::Finish;
use super::palette::Palette3d;
use crate::visuals::color;

/// Returns the finish and the colour of a body, or `None` for bodies that are drawn elsewhere, such as the
/// classes of landscapes, which are drawn by their cells.
pub(super) fn look(
    truth: &EnvgenWorld,
    piece: &Piece<'_>,
    palette: &Palette3d,
) -> Option<(Finish, Color)> {
    let Some(part) = piece.part else { return Some((Finish::Ground, palette.ground)) };
    let index = part.index as usize;
    let own = color(piece.color);
    if truth.visible_range(part).is_some() {
        return Some((Finish::Metal, palette.dark));
    }
    Some(match part.kind {
        PartKind::Wall => match truth.walls.get(index)?.kind {
            WallKind::Partition => (Finish::Plain, palette.partition),
            WallKind::Kerb => (Finish::Ground, palette.kerb),
            _ => (Finish::Wall, palette.wall),
        },
        PartKind::Tree if piece.role == Role::Crown => (Finish::Leaves, palette.crown),
        PartKind::Tree => (Finish::Bark, palette.trunk),
        PartKind::RoadStrip => (Finish::Ground, palette.road),
        PartKind::Room => (Finish::Floor, palette.room),
        PartKind::Doorway if piece.role == Role::Lintel => (Finish::Wall, palette.wall),
        PartKind::Doorway => (Finish::Plain, palette.door),
        PartKind::Obstacle => match truth.obstacles.get(index)?.kind {
            ObstacleKind::Other => (Finish::Ground, palette.rock),
            kind => (finish_of(kind), own),
        },
        PartKind::Surface => match truth.surfaces.get(index)?.kind {
            SurfaceKind::Class(_) => return None,
            SurfaceKind::Hallway | SurfaceKind::OpenArea => (Finish::Floor, palette.hallway),
            SurfaceKind::Water => (Finish::Water, palette.water),
            SurfaceKind::Stairs => (Finish::Ground, own),
            SurfaceKind::Slippery => (Finish::Metal, own),
            _ => (Finish::Ground, own),
        },
        PartKind::Start | PartKind::Goal | PartKind::Victim | PartKind::Ground => return None,
    })
}

fn finish_of(kind: ObstacleKind) -> Finish {
    match kind {
        ObstacleKind::Screen
        | ObstacleKind::Container
        | ObstacleKind::Boiler
        | ObstacleKind::Pipe => Finish::Metal,
        ObstacleKind::Statue | ObstacleKind::Rubble | ObstacleKind::Stairs => Finish::Ground,
        _ => Finish::Plain,
    }
}
