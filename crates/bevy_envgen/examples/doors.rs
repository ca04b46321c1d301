//! An indoor map with people, and with doors that open, close and slam at random, but do not hit anyone in
//! front of them.
//!
//! `cargo run --release --example doors`

#![expect(clippy::print_stdout, reason = "the output of an example")]

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::time::common_conditions::on_timer;
use bevy_envgen::prelude::*;

/// The simulated seconds.
const END: f32 = 12.0;

/// A resource with the numbers of times that doors have fully opened and closed, or were blocked.
#[derive(Resource, Default)]
struct Changes {
    opened: usize,
    closed: usize,
    blocked: usize,
}

fn main() -> AppExit {
    App::new()
        .add_plugins((MinimalPlugins, TransformPlugin, TopDownPhysicsPlugin::default()))
        .add_plugins(EnvgenPlugins::default())
        // One step of physics per frame, as fast as the computer can. Every run is the same.
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .init_resource::<Changes>()
        .add_systems(Startup, ask_for_rooms)
        .add_systems(Update, (report.run_if(on_timer(Duration::from_secs(2))), end).chain())
        .add_observer(count)
        .run()
}

fn ask_for_rooms(mut commands: Commands) {
    let rooms = Environment::new(IndoorSpec::default(), 4).with_pace(GenerationMode::Blocking);
    let (door_open, door_closed, waiting) = (4.0, 4.0, 1.0);
    let moving =
        ScenarioSpec { doors: 1.0, door_open, door_closed, people: 8, waiting, ..default() };
    commands.spawn((rooms, EnvironmentScenario::new(moving, 4)));
}

fn count(changed: On<DoorChanged>, mut changes: ResMut<Changes>) {
    match changed.change {
        DoorChange::Opened => changes.opened += 1,
        DoorChange::Closed => changes.closed += 1,
        DoorChange::Blocked => changes.blocked += 1,
    }
}

fn report(time: Res<Time>, doors: Query<&Door>, people: Query<&Person>, changes: Res<Changes>) {
    let count_at = |openness: f64| doors.iter().filter(|door| door.openness() == openness).count();
    let (open, closed) = (count_at(1.0), count_at(0.0));
    let moving = doors.iter().count() - open - closed;
    let walking = people.iter().filter(|person| person.velocity != Vec2::ZERO).count();
    println!("{:>2.0} s: {open} open, {closed} closed, {moving} move", time.elapsed_secs());
    let Changes { opened, closed, blocked } = *changes;
    println!("      opened {opened} times, closed {closed} times, blocked {blocked} times");
    println!("      {walking} people walk");
}

fn end(time: Res<Time>, changes: Res<Changes>, mut exit: MessageWriter<AppExit>) {
    if time.elapsed_secs() > END {
        let moved = changes.opened > 0 && changes.closed > 0;
        exit.write(if moved { AppExit::Success } else { AppExit::error() });
    }
}
