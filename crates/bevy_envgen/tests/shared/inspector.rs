//! Lists what inspectors see of the components and resources of a crate.

use std::collections::BTreeSet;

use bevy::ecs::reflect::{ReflectComponent, ReflectResource};
use bevy::prelude::*;
use bevy::reflect::TypeInfo;

/// The components and resources of a crate, by their paths.
#[derive(Default)]
pub(crate) struct Inspected {
    /// The number of types that are in the type registry of the app.
    pub(crate) known: usize,
    /// The types that are not in the registry.
    pub(crate) unknown: BTreeSet<String>,
    /// The types that are in the registry, but are opaque.
    pub(crate) closed: BTreeSet<String>,
}

/// Inspects the components and resources of a crate in an app.
pub(crate) fn inspect(app: &App, name_of_crate: &str) -> Inspected {
    let world = app.world();
    let registry = world.resource::<AppTypeRegistry>().read();
    let mut inspected = Inspected::default();
    for info in world.components().iter_registered() {
        let name = info.name().to_string();
        if name.split("::").next() != Some(name_of_crate) {
            continue;
        }
        let Some(kind) = info.type_id().and_then(|id| registry.get(id)) else {
            inspected.unknown.insert(name);
            continue;
        };
        inspected.known += 1;
        let reflects =
            kind.data::<ReflectComponent>().is_some() || kind.data::<ReflectResource>().is_some();
        assert!(reflects, "{name} is registered, but neither as component nor resource");
        if matches!(kind.type_info(), TypeInfo::Opaque(_)) {
            inspected.closed.insert(name);
        }
    }
    inspected
}
