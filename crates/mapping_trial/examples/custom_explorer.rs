//! Compares a custom exploration policy with the built-in ones.
//!
//! `cargo run --release --example custom_explorer`

use std::error::Error;

use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, World};
use mapping_trial::backend::Command;
use mapping_trial::names::Named;
use mapping_trial::policy::{Decision, ExplorationPolicy, PolicyInput, PolicyKind};
use mapping_trial::score::Scores;
use mapping_trial::trial::{Trial, TrialBuilder, TrialSettings};

/// Drives straight ahead until an obstacle is near, then turns to where the laser sees farthest.
struct Bounce {
    /// Turn rate in rad/s while it turns.
    turning: Option<f64>,
}

impl ExplorationPolicy for Bounce {
    fn name(&self) -> &str {
        "bounce"
    }

    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        // Lost beams are NaN and beams without an echo are infinite: both fail the comparison.
        let beams = || view.scan.ranges.iter().enumerate();
        let near = beams().any(|(beam, &range)| {
            view.laser.angle(beam).abs() < 0.8 && range < view.body.circumscribed_radius + 0.3
        });
        let turn_rate = match (near || view.seen.bumped, self.turning) {
            (false, _) => 0.0,
            (true, Some(turn_rate)) => turn_rate,
            (true, None) => {
                let reach = |range: f64| if range.is_nan() { 0.0 } else { range };
                let farthest = beams().max_by(|a, b| reach(*a.1).total_cmp(&reach(*b.1)));
                let angle = farthest.map_or(1.0, |(beam, _)| view.laser.angle(beam));
                0.8_f64.copysign(angle)
            }
        };
        self.turning = (turn_rate != 0.0).then_some(turn_rate);
        let speed = if turn_rate == 0.0 { 0.4 } else { 0.0 };
        Decision::Drive(Command { speed, turn_rate })
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
    println!("{:<12}{:>9}{:>7}{:>7}{:>7}", "policy", "coverage", "M", "N", "D");
    let row = |name: &str, scores: Scores| {
        let Scores { coverage, mapping, navigation, difficulty, .. } = scores;
        println!("{name:<12}{coverage:>9.2}{mapping:>7.2}{navigation:>7.2}{difficulty:>7.2}");
    };
    let own = Trial::builder(&world, settings.clone()).policy(|_| Bounce { turning: None });
    row("bounce", score(&world, own)?);
    for (name, kind) in PolicyKind::NAMES {
        let settings = TrialSettings { policy: Some(*kind), ..settings.clone() };
        row(name, score(&world, Trial::builder(&world, settings))?);
    }
    Ok(())
}
