//! Required components of entities that may precede the plugins.

use bevy::ecs::component::RequiredComponentsError;
use bevy::prelude::*;

/// Makes `R` a required component of `T`, also on the entities with `T` that the app has already spawned. Once
/// there has been such an entity, Bevy registers no more required components of `T`. Several plugins, and the
/// app itself, may require the same component.
pub fn require_component<T: Component, R: Component + Default>(app: &mut App) {
    let registered = app.try_register_required_components::<T, R>();
    let Err(RequiredComponentsError::ArchetypeExists(_)) = registered else { return };
    let world = app.world_mut();
    let mut spawned = world.query_filtered::<Entity, With<T>>();
    let spawned: Vec<Entity> = spawned.iter(world).collect();
    for entity in spawned {
        if let Ok(mut entity) = world.get_entity_mut(entity) {
            entity.insert_if_new(R::default());
        }
    }
    app.add_observer(|added: On<Add, T>, mut commands: Commands| {
        commands.entity(added.entity).try_insert_if_new(R::default());
    });
}
