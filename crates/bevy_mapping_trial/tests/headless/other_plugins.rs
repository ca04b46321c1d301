//! The plugins together with other plugins.

use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{refuse_ambiguities, step, test_app_with};
use bevy_mapping_trial::prelude::*;

#[test]
fn no_two_of_our_systems_are_ambiguous() {
    let fixed = EnvgenPlugins::default().in_schedule(FixedUpdate);
    for envgen in [EnvgenPlugins::default(), fixed] {
        let mut app = test_app_with((envgen, TrialPlugin::default()));
        refuse_ambiguities(&mut app);
        let hallway =
            Environment::new(HallwaySpec::default(), 1).with_pace(GenerationMode::Blocking);
        let moving = ScenarioSpec { people: 2, smoke: 0.1, ..Default::default() };
        app.world_mut().spawn((hallway, EnvironmentScenario::new(moving, 1)));
        step(&mut app, 3);
        assert!(app.world_mut().query::<&Wall>().iter(app.world()).count() > 0);
    }
}

#[cfg(feature = "render3d")]
#[test]
fn no_two_systems_that_draw_are_ambiguous() {
    use bevy_mapping_trial::view::TrialViewPlugin;
    use bevy_mapping_trial::view3d::RobotVisuals3dPlugin;

    let visuals = EnvgenVisuals3dPlugin::default();
    let views = (visuals, TrialViewPlugin::default(), RobotVisuals3dPlugin);
    let mut app = test_app_with((EnvgenPlugins::default(), TrialPlugin::default(), views));
    refuse_ambiguities(&mut app);
    step(&mut app, 3);
}
