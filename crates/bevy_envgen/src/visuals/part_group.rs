//! The groups of parts with the same colour: their layers and materials.

use std::collections::BTreeMap;

use bevy::prelude::*;

use super::palette::WorldPalette;

/// The distance in z between layers.
pub(super) const LAYER: f32 = 0.01;

/// A group of parts with the same colour. The variants are in the order of layers, from the lowest to the
/// highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PartGroup {
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

impl PartGroup {
    pub(super) fn layer(self) -> f32 {
        let order = match self {
            PartGroup::Class(_) => 0.0,
            PartGroup::Floor => 1.0,
            PartGroup::Slippery => 1.6,
            PartGroup::Loose => 1.8,
            PartGroup::Rough => 2.0,
            PartGroup::Water => 3.0,
            PartGroup::DarkRoom | PartGroup::Room => 1.5,
            PartGroup::Road => 4.0,
            PartGroup::Doorway => 5.0,
            PartGroup::Wall => 6.0,
            PartGroup::Tree => 7.0,
            PartGroup::Obstacle | PartGroup::Dark => 8.0,
            PartGroup::Start | PartGroup::Goal | PartGroup::Victim => 9.0,
            PartGroup::Leaf => 9.5,
            PartGroup::Person => 10.0,
            PartGroup::Face => 10.5,
        };
        order * LAYER
    }

    pub(super) fn color(self, palette: &WorldPalette) -> Color {
        match self {
            PartGroup::Class(class) => {
                let classes = palette.classes.len().max(1);
                let place = usize::from(class.max(1) - 1) % classes;
                palette.classes.get(place).copied().unwrap_or(palette.floor)
            }
            PartGroup::Floor => palette.floor,
            PartGroup::Slippery => palette.slippery,
            PartGroup::Loose => palette.loose,
            PartGroup::Rough => palette.rough,
            PartGroup::Water => palette.water,
            PartGroup::DarkRoom => palette.dark_room,
            PartGroup::Room => palette.room,
            PartGroup::Road => palette.road,
            PartGroup::Doorway => palette.doorway,
            PartGroup::Wall => palette.wall,
            PartGroup::Tree => palette.tree,
            PartGroup::Obstacle => palette.obstacle,
            PartGroup::Dark => palette.dark,
            PartGroup::Start => palette.start,
            PartGroup::Goal => palette.goal,
            PartGroup::Victim => palette.victim,
            PartGroup::Leaf => palette.leaf,
            PartGroup::Person => palette.person,
            PartGroup::Face => palette.face,
        }
    }
}

/// A resource with the materials of the parts drawn so far, which all environments share, and with the
/// colours from which they were made.
#[derive(Resource, Default)]
pub(super) struct GroupMaterials(BTreeMap<PartGroup, (Color, Handle<ColorMaterial>)>);

/// Returns the material of a group of parts.
pub(super) fn material(
    world: &mut World,
    group: PartGroup,
    color: Color,
) -> Option<Handle<ColorMaterial>> {
    if let Some((known, handle)) = world.resource::<GroupMaterials>().0.get(&group)
        && *known == color
    {
        return Some(handle.clone());
    }
    let handle = world.get_resource_mut::<Assets<ColorMaterial>>()?.add(color);
    world.resource_mut::<GroupMaterials>().0.insert(group, (color, handle.clone()));
    Some(handle)
}
