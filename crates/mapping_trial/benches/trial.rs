//! Trials against real time, where their time goes, and what they take in open worlds and among people.
//!
//! `cargo bench -p mapping_trial --bench trial`

use std::sync::Arc;

use bench_ratio::{Times, at_most, faster, seconds};
use envgen::forest::ForestSpec;
use envgen::geometry::Pose;
use envgen::indoor::IndoorSpec;
use envgen::landscape::{Algorithm, ClassOrder, LandscapeSpec};
use envgen::scenario::{Scenario, ScenarioSpec};
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

/// How many times faster than real time a trial is to be: on the default maps of 48 x 48 m, on maps of 30 x 30 m, and
/// with 50 people and 20 doors in 48 x 48 m.
const REAL_TIME: f64 = 1000.0;
const REAL_TIME_30: f64 = 2500.0;
const REAL_TIME_PEOPLE: f64 = 300.0;

/// How much longer a trial in an open world is to take at most than one in an indoor map of the same area.
const OPEN: f64 = 2.0;

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

/// Seconds of a trial with its scores, the best of a few rounds, and simulated seconds.
fn trial(world: &World, settings: &TrialSettings, scenario: Option<&Scenario>) -> (f64, f64) {
    let flat = Arc::new(FlatWorld::new(world, &settings.body).expect("a robot"));
    let truth = Reference::new(world, &settings.body).expect("a start");
    let mut simulated = 0.0;
    let wall = best(|| {
        let mut builder = Trial::builder(world, settings.clone());
        if let Some(scenario) = scenario {
            builder = builder.scenario(scenario.clone());
        }
        let mut trial = builder.build_flat_in(flat.clone()).expect("free");
        while trial.step() {}
        simulated = trial.time();
        trial.score(&truth)
    });
    (wall, simulated)
}

fn main() {
    parts();
    let by_area = |seed: u64| TrialSettings {
        seed: Seed(seed),
        time_per_area: Some(2.0),
        ..TrialSettings::default()
    };
    let of_side = |side: u32, seed: u64| {
        let spec = IndoorSpec { width: side, height: side, ..IndoorSpec::default() };
        spec.generate(Seed(seed)).expect("a map").to_world()
    };
    let indoor: Vec<(f64, f64)> =
        (0..MAPS).map(|seed| trial(&of_side(10, seed), &by_area(seed), None)).collect();
    let times: Times = indoor.iter().copied().collect();
    faster("trials of 30 x 30 m, scored, against real time", times.summed(), REAL_TIME_30);

    let forest = ForestSpec {
        width: 30.0,
        height: 30.0,
        intensity: 0.02,
        radius: 0.3,
        min_distance: 2.0,
        clearing: 1.5,
        ..ForestSpec::default()
    };
    let landscape = LandscapeSpec {
        rows: 60,
        cols: 60,
        cell_size: 0.5,
        entropy: 1.9,
        algorithm: Algorithm::Smooth,
        order: ClassOrder::Descending,
        speeds: vec![1.0, 1.0, 0.8, 0.6, 1.0, 0.4, 0.2, 0.0, 0.0],
        ..LandscapeSpec::default()
    };
    let open = |world: &dyn Fn(Seed) -> World| -> Times {
        let walls = (0..MAPS).map(|seed| trial(&world(Seed(seed)), &by_area(seed), None).0);
        walls.zip(indoor.iter().map(|(wall, _)| *wall)).collect()
    };
    let forests = open(&|seed| forest.generate(seed).expect("a forest").to_world());
    at_most("trials in open forests, against indoor maps", forests.summed(), OPEN);
    let landscapes = open(&|seed| landscape.generate(seed).expect("a landscape").to_world());
    at_most("trials in landscapes, against indoor maps", landscapes.summed(), OPEN);

    let people = ScenarioSpec { people: 50, doors: 1.0, ..ScenarioSpec::default() };
    let among: Times = (0..MAPS)
        .map(|seed| {
            let world = of_side(16, seed);
            let mut scenario = Scenario::new(&world, &people, Seed(seed)).expect("room");
            scenario.doors.truncate(20);
            let settings = TrialSettings { seed: Seed(seed), ..TrialSettings::default() };
            trial(&world, &settings, Some(&scenario))
        })
        .collect();
    faster(
        "trials among 50 people and 20 doors, against real time",
        among.summed(),
        REAL_TIME_PEOPLE,
    );
}

/// Trials of 20 simulated minutes in the default maps, and where their time goes.
#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn parts() {
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
    log.run_through(&mut trial).expect("the log's commands");
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
