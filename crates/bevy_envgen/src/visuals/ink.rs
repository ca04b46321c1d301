//! The groups of parts with one colour: their layers and materials.

use std::collections::BTreeMap;

use bevy::prelude::*;

use super::palette::Palette;

/// Distance in z between layers.
pub(super) const LAYER: f32 = 0.01;

/// The groups of parts with one colour, from the lowest layer to the highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Ink {
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

impl Ink {
    pub(super) fn layer(self) -> f32 {
        let order = match self {
            Ink::Class(_) => 0.0,
            Ink::Floor => 1.0,
            Ink::Slippery => 1.6,
            Ink::Loose => 1.8,
            Ink::Rough => 2.0,
            Ink::Water => 3.0,
            Ink::DarkRoom | Ink::Room => 1.5,
            Ink::Road => 4.0,
            Ink::Doorway => 5.0,
            Ink::Wall => 6.0,
            Ink::Tree => 7.0,
            Ink::Obstacle | Ink::Dark => 8.0,
            Ink::Start | Ink::Goal | Ink::Victim => 9.0,
            Ink::Leaf => 9.5,
            Ink::Person => 10.0,
            Ink::Face => 10.5,
        };
        order * LAYER
    }

    pub(super) fn color(self, palette: &Palette) -> Color {
        match self {
            Ink::Class(class) => {
                let classes = palette.classes.len().max(1);
                let place = usize::from(class.max(1) - 1) % classes;
                palette.classes.get(place).copied().unwrap_or(palette.floor)
            }
            Ink::Floor => palette.floor,
            Ink::Slippery => palette.slippery,
            Ink::Loose => palette.loose,
            Ink::Rough => palette.rough,
            Ink::Water => palette.water,
            Ink::DarkRoom => palette.dark_room,
            Ink::Room => palette.room,
            Ink::Road => palette.road,
            Ink::Doorway => palette.doorway,
            Ink::Wall => palette.wall,
            Ink::Tree => palette.tree,
            Ink::Obstacle => palette.obstacle,
            Ink::Dark => palette.dark,
            Ink::Start => palette.start,
            Ink::Goal => palette.goal,
            Ink::Victim => palette.victim,
            Ink::Leaf => palette.leaf,
            Ink::Person => palette.person,
            Ink::Face => palette.face,
        }
    }
}

/// The materials of the inks used so far, shared by all environments, with the colours that they
/// were made from.
#[derive(Resource, Default)]
pub(super) struct Inks(BTreeMap<Ink, (Color, Handle<ColorMaterial>)>);

/// The material of an ink.
pub(super) fn material(world: &mut World, ink: Ink, color: Color) -> Option<Handle<ColorMaterial>> {
    if let Some((known, handle)) = world.resource::<Inks>().0.get(&ink)
        && *known == color
    {
        return Some(handle.clone());
    }
    let handle = world.get_resource_mut::<Assets<ColorMaterial>>()?.add(color);
    world.resource_mut::<Inks>().0.insert(ink, (color, handle.clone()));
    Some(handle)
}
