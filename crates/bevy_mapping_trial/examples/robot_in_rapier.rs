//! A robot in rapier that follows a hallway with its laser, driven by velocity commands.
//!
//! `cargo run --release --example robot_in_rapier`

#![expect(clippy::print_stdout, reason = "the output of an example")]

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::{TimeUpdateStrategy, common_conditions::on_timer};
use bevy_envgen::prelude::*;
use bevy_mapping_trial::prelude::*;

/// The simulated seconds, and the distance in metres from the start that the robot must reach in them.
const END: f32 = 20.0;
const LEAST_DISTANCE: f64 = 5.0;

fn main() -> AppExit {
    App::new()
        .add_plugins((MinimalPlugins, TransformPlugin, TopDownPhysicsPlugin::default()))
        .add_plugins((EnvgenPlugins::default(), RobotPlugin::default()))
        // One step of physics per frame, as fast as the computer can. Every run is the same.
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .add_systems(Startup, ask_for_hallway)
        .add_systems(FixedUpdate, steer.before(RobotSystems::Drive))
        .add_systems(Update, (report.run_if(on_timer(Duration::from_secs(4))), end).chain())
        .add_observer(spawn_robot)
        .run()
}

fn ask_for_hallway(mut commands: Commands) {
    commands.spawn(Environment::new(HallwaySpec::default(), 7));
}

fn spawn_robot(
    ready: On<EnvironmentReady>,
    worlds: Query<&EnvironmentLandmarks>,
    mut commands: Commands,
) -> Result {
    let start = worlds.get(ready.entity)?.start.ok_or("the hallway has no start")?;
    commands.spawn((RobotModel::default(), LaserScanner::default(), start.pose));
    Ok(())
}

/// Returns the shortest ranges to the right, ahead and to the left. The 181 beams run from right to left.
/// Beams without an echo are infinite, and lost ones are NaN, which `min` ignores.
fn nearest(scan: &LaserScan) -> [f64; 3] {
    [20..80, 80..101, 101..161]
        .map(|beams| scan.ranges.get(beams).unwrap_or_default().iter().copied().fold(8.0, f64::min))
}

/// Drives on while there is free space ahead, and turns to the side with more free space.
fn steer(mut robots: Query<(&LaserScan, &mut DriveCommand)>) {
    for (scan, mut command) in &mut robots {
        let [right, ahead, left] = nearest(scan);
        command.speed = 0.5 * (ahead - 0.3).clamp(0.0, 1.0);
        command.turn_rate = 1.5 * (left - right);
    }
}

fn report(time: Res<Time>, robot: Single<(&TruePose, &LaserScan)>) {
    let (TruePose { position, heading }, scan) = *robot;
    let [right, ahead, left] = nearest(scan);
    println!("{:>2.0} s: at {position:.2}, heading {heading:.2} rad", time.elapsed_secs());
    println!("      {right:.2} m right, {ahead:.2} m ahead, {left:.2} m left");
}

/// Ends the app, with an error if the robot has not driven far enough or has collided.
fn end(time: Res<Time>, robots: Query<(&TruePose, &Bumper)>, mut exit: MessageWriter<AppExit>) {
    if time.elapsed_secs() > END {
        // The hallway starts at the origin.
        let far = |pose: &TruePose| pose.position.length() > LEAST_DISTANCE;
        let drove = robots.iter().any(|(pose, bumper)| far(pose) && bumper.collisions == 0);
        exit.write(if drove { AppExit::Success } else { AppExit::error() });
    }
}
