//! An indoor map whose doors open, close and slam on a schedule that the seed determines.
//!
//! `cargo run --release --example doors`

#![expect(clippy::print_stdout, reason = "the output of an example")]

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::time::common_conditions::on_timer;
use bevy_envgen::prelude::*;

/// Simulated seconds.
const END: f32 = 12.0;

/// How often doors have fully opened and closed so far.
#[derive(Resource, Default)]
struct Stops {
    opened: usize,
    closed: usize,
}

fn main() -> AppExit {
    App::new()
        .add_plugins((MinimalPlugins, TransformPlugin, TopDownPhysicsPlugin::default()))
        .add_plugins(EnvgenPlugins::default())
        // One step of physics per frame, as fast as the computer can: the same in every run.
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .init_resource::<Stops>()
        .add_systems(Startup, ask_for_rooms)
        .add_systems(Update, (report.run_if(on_timer(Duration::from_secs(2))), end).chain())
        .add_observer(count)
        .run()
}

fn ask_for_rooms(mut commands: Commands) {
    let rooms = Environment::new(IndoorSpec::default(), 4).with_pace(GenerationMode::Blocking);
    commands.spawn((rooms, DoorSchedule { mean_wait: 4.0, slam: 0.2 }));
}

fn count(stopped: On<DoorStopped>, mut stops: ResMut<Stops>) {
    if stopped.open {
        stops.opened += 1;
    } else {
        stops.closed += 1;
    }
}

fn report(time: Res<Time>, doors: Query<&Door>, stops: Res<Stops>) {
    let count_at = |openness: f32| doors.iter().filter(|door| door.openness() == openness).count();
    let (open, closed) = (count_at(1.0), count_at(0.0));
    let moving = doors.iter().count() - open - closed;
    println!("{:>2.0} s: {open} open, {closed} closed, {moving} move", time.elapsed_secs());
    println!("      opened {} times, closed {} times", stops.opened, stops.closed);
}

fn end(time: Res<Time>, stops: Res<Stops>, mut exit: MessageWriter<AppExit>) {
    if time.elapsed_secs() > END {
        let moved = stops.opened > 0 && stops.closed > 0;
        exit.write(if moved { AppExit::Success } else { AppExit::error() });
    }
}
