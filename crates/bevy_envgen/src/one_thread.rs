//! Runs the schedules of an app on one thread.

use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;

/// Makes all existing schedules of an app run their systems on one thread. In tests and headless trials the
/// systems are many and short, so that threads would mostly wait for each other.
pub fn run_on_one_thread(app: &mut App) {
    for (_, schedule) in app.world_mut().resource_mut::<Schedules>().iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
}
