//! Sets up rapier for worlds that are seen from above.

use std::fmt::Display;

use bevy::prelude::*;
use bevy_rapier2d::plugin::systems::writeback_rigid_bodies;
use bevy_rapier2d::prelude::{
    CollisionEvent, ContactForceEvent, MassModifiedMessage, PhysicsSet, RapierBevyComponentApply,
    RapierConfiguration, RapierContextInitialization, RapierPhysicsPlugin, TimestepMode,
};
use bevy_rapier2d::rapier::dynamics::IntegrationParameters;
use envgen::SpecError;

use super::HeightHooks;
use super::turned;

/// Adds rapier for worlds that are seen from above: without gravity, in metres, and with steps of a fixed
/// length in `FixedUpdate`. Contacts are filtered by [`HeightHooks`].
///
/// By default, rapier has gravity along -y and steps of varying length, so that no two runs are the same.
/// Apps that add `RapierPhysicsPlugin` themselves do not need this plugin, which then logs a warning and
/// changes nothing. Only with this plugin do bodies below a turned entity, such as the robots of a trial in a turned
/// environment, have right transforms: `bevy_rapier2d` 0.36 writes wrong ones. Such bodies are moved by their
/// `Transform`: a pose that the app sets in rapier's own `RigidBodySet` is undone by the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TopDownPhysicsPlugin {
    steps_per_second: f64,
    substeps: usize,
}

impl TopDownPhysicsPlugin {
    /// Creates the plugin with `steps_per_second` steps per second, from 1 to 100,000.
    ///
    /// # Panics
    /// Panics if the number is out of range or not a number, which is a mistake in the program.
    pub fn new(steps_per_second: f64) -> Self {
        if !(1.0..=1e5).contains(&steps_per_second) {
            refuse("steps_per_second", steps_per_second, "a number from 1 to 100000");
        }
        TopDownPhysicsPlugin { steps_per_second, substeps: 1 }
    }

    /// Divides each step into `substeps` equal steps of rapier, from 1 to 1000. Forces and commands are
    /// constant during a whole step.
    ///
    /// # Panics
    /// Panics if the number is out of range, which is a mistake in the program.
    pub fn with_substeps(self, substeps: usize) -> Self {
        if !(1..=1000).contains(&substeps) {
            refuse("substeps", substeps, "a whole number from 1 to 1000");
        }
        TopDownPhysicsPlugin { substeps, ..self }
    }
}

/// Returns whether rapier's plugin is added, with any hooks. An app may have either of the two resources for
/// another reason, so it checks both.
fn has_rapier(app: &App) -> bool {
    let world = app.world();
    world.contains_resource::<RapierContextInitialization>()
        && world.contains_resource::<Messages<MassModifiedMessage>>()
}

/// Panics because of an argument that is out of range.
fn refuse(argument: &str, value: impl Display, allowed: &str) -> ! {
    panic!("TopDownPhysicsPlugin: {}", SpecError::new(argument, value, allowed));
}

impl Default for TopDownPhysicsPlugin {
    fn default() -> Self {
        TopDownPhysicsPlugin::new(64.0)
    }
}

impl Plugin for TopDownPhysicsPlugin {
    fn build(&self, app: &mut App) {
        if has_rapier(app) {
            log::warn!(
                "`RapierPhysicsPlugin` is already added: `TopDownPhysicsPlugin` does nothing"
            );
            return;
        }
        let dt = (1.0 / self.steps_per_second) as f32;
        let rapier_configuration =
            RapierConfiguration { gravity: Vec2::ZERO, ..RapierConfiguration::new(1.0) };
        let integration_parameters = IntegrationParameters { dt, ..default() };
        app.insert_resource(Time::<Fixed>::from_hz(self.steps_per_second))
            .insert_resource(TimestepMode::Fixed { dt, substeps: self.substeps })
            // Rapier itself does not register its messages, so Bevy would not clear them.
            .add_message::<CollisionEvent>()
            .add_message::<ContactForceEvent>()
            .add_message::<MassModifiedMessage>()
            .add_plugins(
                RapierPhysicsPlugin::<HeightHooks<'static, 'static>>::default()
                    .with_custom_initialization(
                        RapierContextInitialization::InitializeDefaultRapierContext {
                            integration_parameters,
                            rapier_configuration,
                        },
                    )
                    .in_fixed_schedule(),
            )
            .add_systems(
                FixedUpdate,
                (
                    turned::restore.in_set(PhysicsSet::SyncBackend).after(RapierBevyComponentApply),
                    turned::correct.in_set(PhysicsSet::Writeback).after(writeback_rigid_bodies),
                ),
            );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};

    /// Returns the panic message of a constructor that rejects its argument.
    fn refusal(construct: impl FnOnce() -> TopDownPhysicsPlugin) -> Option<String> {
        let panic = catch_unwind(AssertUnwindSafe(construct)).err()?;
        panic.downcast_ref::<String>().cloned()
    }

    #[test]
    fn impossible_steps_are_refused_by_name() {
        for steps in [f64::NAN, f64::INFINITY, -64.0, 0.0, 0.999, 100_001.0] {
            let said = refusal(|| TopDownPhysicsPlugin::new(steps)).unwrap();
            assert!(said.contains("`steps_per_second`") && said.contains("100000"), "{said}");
        }
        for substeps in [0, 1001, usize::MAX] {
            let said = refusal(|| TopDownPhysicsPlugin::default().with_substeps(substeps)).unwrap();
            assert!(said.contains("`substeps`") && said.contains("1000"), "{said}");
        }
        for steps in [1.0, 20.0, 1e5] {
            assert_eq!(TopDownPhysicsPlugin::new(steps).steps_per_second, steps);
        }
        assert_eq!(TopDownPhysicsPlugin::default().with_substeps(1000).substeps, 1000);
    }
}
