//! Rapier as a world seen from above needs it.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    NoUserData, RapierConfiguration, RapierContextInitialization, RapierPhysicsPlugin, TimestepMode,
};
use bevy_rapier2d::rapier::dynamics::IntegrationParameters;

/// Adds rapier for worlds seen from above: no gravity, metres, and steps of fixed length in
/// `FixedUpdate`.
///
/// Rapier's own defaults pull everything to -y and let the steps follow the clock, so that no two
/// runs are alike. Apps that add `RapierPhysicsPlugin` themselves do without this plugin; it then
/// warns and changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TopDownPhysicsPlugin {
    steps_a_second: f64,
    substeps: usize,
}

impl TopDownPhysicsPlugin {
    /// With so many steps a second, from 1 to 100 000; other numbers give Bevy's default of 64.
    pub fn new(steps_a_second: f64) -> Self {
        let allowed = (1.0..=1e5).contains(&steps_a_second);
        let steps_a_second = if allowed { steps_a_second } else { 64.0 };
        TopDownPhysicsPlugin { steps_a_second, substeps: 1 }
    }

    /// Steps as mapping trials need them: 20 a second, each in 4 substeps.
    #[cfg(feature = "trial")]
    pub fn for_trials() -> Self {
        TopDownPhysicsPlugin::new(1.0 / mapping_trial::body::TICK).with_substeps(4)
    }

    /// With each step in so many equal ones of rapier, from 1 to 1000. Forces and commands act for
    /// whole steps.
    pub fn with_substeps(self, substeps: usize) -> Self {
        TopDownPhysicsPlugin { substeps: substeps.clamp(1, 1000), ..self }
    }
}

impl Default for TopDownPhysicsPlugin {
    fn default() -> Self {
        TopDownPhysicsPlugin::new(64.0)
    }
}

impl Plugin for TopDownPhysicsPlugin {
    fn build(&self, app: &mut App) {
        if app.is_plugin_added::<RapierPhysicsPlugin<NoUserData>>() {
            log::warn!(
                "`RapierPhysicsPlugin` is there already: `TopDownPhysicsPlugin` does nothing"
            );
            return;
        }
        let dt = (1.0 / self.steps_a_second) as f32;
        let rapier_configuration =
            RapierConfiguration { gravity: Vec2::ZERO, ..RapierConfiguration::new(1.0) };
        let integration_parameters = IntegrationParameters { dt, ..default() };
        app.insert_resource(Time::<Fixed>::from_hz(self.steps_a_second))
            .insert_resource(TimestepMode::Fixed { dt, substeps: self.substeps })
            .add_plugins(
                RapierPhysicsPlugin::<NoUserData>::default()
                    .with_custom_initialization(
                        RapierContextInitialization::InitializeDefaultRapierContext {
                            integration_parameters,
                            rapier_configuration,
                        },
                    )
                    .in_fixed_schedule(),
            );
    }
}
