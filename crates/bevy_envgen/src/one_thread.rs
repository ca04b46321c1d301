//! Schedules on one thread.

use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;

/// Lets the systems of all schedules that an app has run on one thread. In tests and headless trials they are many
/// and short: with threads they would mostly wait for each other.
pub fn run_on_one_thread(app: &mut App) {
    for (_, schedule) in app.world_mut().resource_mut::<Schedules>().iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
}
