//! The groups of parts with one colour: their layers and materials.

use std::collections::BTreeMap;

use bevy::prelude::*;

use super::palette::WorldPalette;

/// Distance in z between layers.
pub(super) const LAYER: f32 = 0.01;

/// The groups of parts with one colour, from the lowest layer to the highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PartColor {
    Class(u16),
    Floor,
    Slippery,
    Loose,
    Rough,
    Water,
    DarkRoom,
    Room,
    Road,
    Doorway,
    Wall,
    Tree,
    Obstacle,
    Dark,
    Start,
    Goal,
    Victim,
    Leaf,
    Person,
    Face,
}

impl PartColor {
    pub(super) fn layer(self) -> f32 {
        let order = match self {
            PartColor::Class(_) => 0.0,
            PartColor::Floor => 1.0,
            PartColor::Slippery => 1.6,
            PartColor::Loose => 1.8,
            PartColor::Rough => 2.0,
            PartColor::Water => 3.0,
            PartColor::DarkRoom | PartColor::Room => 1.5,
            PartColor::Road => 4.0,
            PartColor::Doorway => 5.0,
            PartColor::Wall => 6.0,
            PartColor::Tree => 7.0,
            PartColor::Obstacle | PartColor::Dark => 8.0,
            PartColor::Start | PartColor::Goal | PartColor::Victim => 9.0,
            PartColor::Leaf => 9.5,
            PartColor::Person => 10.0,
            PartColor::Face => 10.5,
        };
        order * LAYER
    }

    pub(super) fn color(self, palette: &WorldPalette) -> Color {
        match self {
            PartColor::Class(class) => {
                let classes = palette.classes.len().max(1);
                let place = usize::from(class.max(1) - 1) % classes;
                palette.classes.get(place).copied().unwrap_or(palette.floor)
            }
            PartColor::Floor => palette.floor,
            PartColor::Slippery => palette.slippery,
            PartColor::Loose => palette.loose,
            PartColor::Rough => palette.rough,
            PartColor::Water => palette.water,
            PartColor::DarkRoom => palette.dark_room,
            PartColor::Room => palette.room,
            PartColor::Road => palette.road,
            PartColor::Doorway => palette.doorway,
            PartColor::Wall => palette.wall,
            PartColor::Tree => palette.tree,
            PartColor::Obstacle => palette.obstacle,
            PartColor::Dark => palette.dark,
            PartColor::Start => palette.start,
            PartColor::Goal => palette.goal,
            PartColor::Victim => palette.victim,
            PartColor::Leaf => palette.leaf,
            PartColor::Person => palette.person,
            PartColor::Face => palette.face,
        }
    }
}

/// The materials of the parts drawn so far, shared by all environments, with the colours that they
/// were made from.
#[derive(Resource, Default)]
pub(super) struct PartColors(BTreeMap<PartColor, (Color, Handle<ColorMaterial>)>);

/// The material of parts that have this colour.
pub(super) fn material(
    world: &mut World,
    part: PartColor,
    color: Color,
) -> Option<Handle<ColorMaterial>> {
    if let Some((known, handle)) = world.resource::<PartColors>().0.get(&part)
        && *known == color
    {
        return Some(handle.clone());
    }
    let handle = world.get_resource_mut::<Assets<ColorMaterial>>()?.add(color);
    world.resource_mut::<PartColors>().0.insert(part, (color, handle.clone()));
    Some(handle)
}
