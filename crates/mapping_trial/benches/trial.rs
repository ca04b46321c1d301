//! Trials of 20 simulated minutes against real time, and where their time goes.
//!
//! `cargo bench -p mapping_trial --bench trial`

use std::sync::Arc;

use bench_ratio::{Times, faster, seconds};
use envgen::geometry::Pose;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::backend::{Command, Condition, Observation, RobotBackend};
use mapping_trial::flat::{FlatSimulator, FlatWorld};
use mapping_trial::score::Reference;
use mapping_trial::slam::SlamKind;
use mapping_trial::trial::{Setup, Trial, TrialSettings};

/// Maps that are driven; the best of each part's rounds is added up over them.
const MAPS: u64 = 4;

/// Rounds of each part.
const ROUNDS: usize = 3;

/// How many times faster than real time a trial is to be.
const REAL_TIME: f64 = 1000.0;

/// A simulator that remembers its commands.
struct Recorder {
    bodies: FlatSimulator,
    commands: Vec<Command>,
}

impl RobotBackend for Recorder {
    fn engine(&self) -> &str {
        "recorder"
    }

    fn observe(&mut self, robot: usize) -> Observation {
        self.bodies.observe(robot)
    }

    fn advance(&mut self, commands: &[Command]) {
        self.commands.extend_from_slice(commands);
        self.bodies.advance(commands);
    }

    fn pose(&self, robot: usize) -> Pose {
        self.bodies.pose(robot)
    }

    fn condition(&self, robot: usize) -> Condition {
        self.bodies.condition(robot)
    }

    fn collisions(&self, robot: usize) -> u32 {
        self.bodies.collisions(robot)
    }
}

/// Best of a few rounds, in seconds.
fn best<T>(mut work: impl FnMut() -> T) -> f64 {
    (0..ROUNDS).map(|_| seconds(&mut work)).fold(f64::INFINITY, f64::min)
}

fn simulator(flat: &Arc<FlatWorld>, settings: &TrialSettings, starts: &[Pose]) -> FlatSimulator {
    let TrialSettings { body, laser, odometry, seed, .. } = settings;
    FlatSimulator::new(flat.clone(), body, starts, laser, odometry, *seed)
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn main() {
    let (mut whole, mut bodies, mut wheels, mut replay, mut score) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut maps = Vec::new();
    for map in 0..MAPS {
        let world = IndoorSpec::default().generate(Seed(map)).expect("defaults").to_world();
        let settings = TrialSettings { seed: Seed(map), ..TrialSettings::default() };
        let flat = Arc::new(FlatWorld::new(&world, &settings.body).expect("a robot"));
        let truth = Reference::new(&world, &settings.body).expect("a start");
        let run = || {
            let builder = Trial::builder(&world, settings.clone());
            let mut trial = builder.build_flat_in(flat.clone()).expect("free");
            while trial.step() {}
            trial
        };

        let trial = run();
        let log = trial.log();
        let (run, scored) = (best(run), best(|| trial.score(&truth)));
        maps.push((run + scored, trial.time()));
        whole += run;
        score += scored;
        replay += best(|| replayed(&log, &world, &flat, settings.slam));
        wheels += best(|| replayed(&log, &world, &flat, SlamKind::DeadReckoning));
        let recorded = recorded(&world, &flat, &settings);
        bodies +=
            best(|| drive(simulator(&flat, &settings, &[trial.trajectory(0).poses[0]]), &recorded));
    }
    let maps: Times = maps.into_iter().collect();
    faster("trials of 20 minutes, scored, against real time", maps.summed(), REAL_TIME);
    let share = |part: f64| 100.0 * part / (whole + score);
    println!("  rays, bodies and noise    {:4.0} %", share(bodies));
    println!("  drawing the map           {:4.0} %", share(wheels - bodies));
    println!("  matching scans            {:4.0} %", share(replay - wheels));
    println!("  planning and driving      {:4.0} %", share(whole - replay));
    println!("  score                     {:4.0} %", share(score));
}

/// The log again, with another estimator.
fn replayed(
    log: &mapping_trial::trial::TrialLog,
    world: &World,
    flat: &Arc<FlatWorld>,
    slam: SlamKind,
) -> Trial<FlatSimulator> {
    let mut trial = log
        .replay_with(world, |builder| {
            builder.settings(|settings| settings.slam = slam).build_flat_in(flat.clone())
        })
        .expect("its own world");
    log.run_through(&mut trial);
    trial
}

/// The commands of a trial, tick by tick.
fn recorded(world: &World, flat: &Arc<FlatWorld>, settings: &TrialSettings) -> Vec<Command> {
    let place = |setup: &Setup<'_>, _| Recorder {
        bodies: simulator(flat, setup.settings, setup.starts),
        commands: Vec::new(),
    };
    let mut trial = Trial::builder(world, settings.clone()).build(place).expect("free");
    while trial.step() {}
    trial.bodies().commands.clone()
}

/// The robot backend alone.
fn drive(mut bodies: FlatSimulator, commands: &[Command]) -> FlatSimulator {
    for command in commands {
        bodies.observe(0);
        bodies.advance(std::slice::from_ref(command));
    }
    bodies
}
