//! The drawing of several mapping trials in one app.

use bevy::prelude::*;
use bevy_envgen::testing::step;
use bevy_mapping_trial::view::{ShowWholeMap, TrialSights};

use super::view::{app, drive, hallway, trial, watch};

#[test]
fn the_arrows_of_each_trial_fit_its_own_map() {
    let world = hallway();
    let mut app = app();
    let roots = [10, 400].map(|ticks| {
        let root = watch(&mut app, &world, trial(&world, 1));
        drive(&mut app, root, ticks);
        root
    });
    for margin in [1.0, 30.0] {
        let cameras = roots
            .map(|trial| app.world_mut().spawn((Camera2d, ShowWholeMap { trial, margin })).id());
        step(&mut app, 2);
        let [first, second] = roots.map(|root| {
            let map = app.world().get::<TrialSights>(root).unwrap().map.unwrap();
            let side = (map.size().max_element() + 2.0 * margin).max(10.0);
            let mut below = app.world_mut().query::<&Children>();
            let below = below.query(app.world()).iter_descendants(root).collect::<Vec<_>>();
            let is_mark = |entity: &&Entity| {
                let name = app.world().get::<Name>(**entity);
                name.is_some_and(|name| name.as_str() == "mark of robot 0")
            };
            let mark = *below.iter().find(is_mark).expect("an arrow");
            let scale = app.world().get::<Transform>(mark).unwrap().scale;
            assert!((scale.x - 0.06 * side).abs() < 1e-3, "{scale} for {side} m");
            scale.x
        });
        assert!((first - second).abs() > 0.01, "{first} {second}");
        for camera in cameras {
            app.world_mut().despawn(camera);
        }
    }
}
