//! Compares a custom SLAM estimator with the built-in ones. It uses wheel odometry whose heading is
//! corrected by the walls, which in buildings are at right angles.
//!
//! `cargo run --release --example custom_slam`

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, TAU};

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::backend::Observation;
use mapping_trial::map::{Estimate, OccupancyMap};
use mapping_trial::names::Named;
use mapping_trial::score::Scores;
use mapping_trial::slam::scan_insertion::ScanInserter;
use mapping_trial::slam::sweep::Sweeper;
use mapping_trial::slam::{Slam, SlamKind};
use mapping_trial::trial::{Setup, Trial, TrialBuilder, TrialSettings};

/// Fraction of the difference between walls and heading that one scan corrects.
const GAIN: f64 = 0.2;

/// Wheel odometry with the walls as a compass, for one robot.
struct WallCompass {
    sweeper: Sweeper,
    painter: ScanInserter,
    map: OccupancyMap,
    trajectory: Vec<Pose>,
}

impl WallCompass {
    fn new(setup: &Setup<'_>) -> Self {
        WallCompass {
            sweeper: Sweeper::new(&setup.settings.body, &setup.settings.laser),
            painter: ScanInserter::new(),
            map: OccupancyMap::new(),
            trajectory: vec![setup.starts[0]],
        }
    }
}

impl Slam for WallCompass {
    fn name(&self) -> &str {
        "wall_compass"
    }

    fn step(&mut self, _robot: usize, seen: &Observation) {
        let Pose { position, heading } = self.trajectory[self.trajectory.len() - 1];
        let half = heading + 0.5 * seen.odometry.turn;
        let position = position + unit_vector(half) * seen.odometry.distance;
        let mut pose = Pose { position, heading: wrap_angle(heading + seen.odometry.turn) };
        if let Some(scan) = &seen.scan {
            let sweep = self.sweeper.sweep(scan);
            // The directions from echo to echo, times four, are the same along all walls.
            let walls = sweep.echoes.windows(2).map(|pair| (pair[1] - pair[0]).as_dvec2());
            let walls = walls.filter(|wall| wall.length() < 0.3).map(|wall| {
                let angle = pose.heading + libm::atan2(wall.y, wall.x);
                unit_vector(4.0 * angle) * wall.length()
            });
            let sum = walls.fold(glam::DVec2::ZERO, |sum, wall| sum + wall);
            if sum.length() > 1.0 {
                let off = libm::atan2(sum.y, sum.x) / TAU * FRAC_PI_2;
                pose.heading = wrap_angle(pose.heading - GAIN * off);
            }
            self.painter.draw(&mut self.map, pose, self.sweeper.laser(), &sweep);
        }
        self.trajectory.push(pose);
    }

    fn estimate(&self, _robot: usize) -> Estimate {
        let pose = self.trajectory[self.trajectory.len() - 1];
        Estimate { pose, deviation: 0.2, heading_deviation: 0.05 }
    }

    fn map(&self) -> &OccupancyMap {
        &self.map
    }

    fn trajectory(&self, _robot: usize) -> Vec<Pose> {
        self.trajectory.clone()
    }
}

/// Runs a trial to its end and scores it.
fn score(world: &World, builder: TrialBuilder<'_>) -> Result<Scores, Box<dyn Error>> {
    let mut trial = builder.build_flat()?;
    while trial.step() {}
    Ok(trial.score(&trial.reference(world)?)?)
}

#[expect(clippy::print_stdout, reason = "what an example is for")]
fn main() -> Result<(), Box<dyn Error>> {
    let world =
        IndoorSpec { width: 8, height: 8, ..Default::default() }.generate(Seed(3))?.to_world();
    let settings = TrialSettings { time_limit: 600.0, ..Default::default() };
    println!("{:<16}{:>7}{:>9}{:>7}", "SLAM", "ATE/m", "F1", "M");
    let row = |name: &str, scores: Scores| {
        let Scores { trajectory_error, f1_30, mapping, .. } = scores;
        println!("{name:<16}{trajectory_error:>7.2}{f1_30:>9.2}{mapping:>7.2}");
    };
    row(
        "wall_compass",
        score(&world, Trial::builder(&world, settings.clone()).slam(WallCompass::new))?,
    );
    for (name, kind) in SlamKind::NAMES {
        let settings = TrialSettings { slam: *kind, ..settings.clone() };
        row(name, score(&world, Trial::builder(&world, settings))?);
    }
    Ok(())
}
