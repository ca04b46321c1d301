//! `envgen-trials generate`.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use envgen::export::{Job, Output};
use envgen::indoor::{IndoorSpec, Profile};
use envgen::located::Locate;
use envgen::whole_file::commit_all;
use envgen::{Seed, Spec, WorldBlueprint, WorldKind, WorldSpec};
use mapping_trial::difficulty::{Panel, Verified, most_trials, verified};

use crate::panel::PanelOptions;
use crate::progress;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Sets a setting of indoor maps (see `envgen kinds`), such as `difficulty=7`; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,

    /// The seed from which everything random follows.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    seed: Seed,

    /// Trials under each condition of the last measurement.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,

    /// A file to write; its ending selects the format. May be given several times.
    #[arg(long, value_name = "FILE", required = true)]
    out: Vec<PathBuf>,

    #[command(flatten)]
    panel: PanelOptions,
}

impl Arguments {
    /// The spec, for the robots of the panel: anchors take minutes, so it is checked before.
    fn spec(&self, panel: &Panel) -> Result<IndoorSpec, Box<dyn Error>> {
        let mut spec =
            WorldSpec::from(IndoorSpec { profile: Profile::Calibrated, ..Default::default() });
        let mut names = Vec::new();
        for option in &self.settings {
            let (name, value) = option
                .split_once('=')
                .ok_or_else(|| format!("--set {option}: is not of the form name=value"))?;
            spec.set(name.trim(), value).in_option("--set", option)?;
            names.push(WorldKind::Indoor.setting(name.trim())?.name);
        }
        let WorldSpec::Indoor(mut spec) = spec else { unreachable!("the kind is never set") };
        for name in &names {
            spec.fix(name);
        }
        let is_given = names.contains(&"robot_radius");
        if !is_given {
            spec.robot_radius = robot_radius(panel);
        }
        match spec.validate() {
            Err(error) if error.field == "robot_radius" && !is_given => {
                return Err(format!("{error}; it is that of the panel's largest robot").into());
            }
            checked => checked?,
        }
        spec.request().check(&spec, spec.reachable())?;
        Ok(spec)
    }
}

/// The radius of the largest robot of a panel in whole centimetres, and at least that of the robot for which maps
/// usually are.
fn robot_radius(panel: &Panel) -> f64 {
    let radii = panel.conditions.iter().map(|condition| condition.robot.circumscribed_radius);
    let largest = radii.fold(0.0, f64::max);
    // Whole centimetres stay as they are, whatever their rounding.
    ((100.0 * largest - 1e-9).ceil() / 100.0).max(IndoorSpec::default().robot_radius)
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let panel = arguments.panel.panel()?;
    let spec = arguments.spec(&panel)?;
    let outputs = Output::all(&arguments.out, &arguments.panel.inputs())?;
    let mut files = outputs.iter().map(Output::create).collect::<Result<Vec<_>, _>>()?;
    let scale = arguments.panel.scale(&panel, threads)?;
    let bar = progress::trials(most_trials(&panel, arguments.seeds) as u64, 0);
    let found = verified(&spec, arguments.seed, &panel, &scale, arguments.seeds, &mut |trials| {
        bar.set_position(trials as u64);
    });
    bar.finish_and_clear();
    let found = found?;
    let blueprint = WorldBlueprint::Indoor(found.plan.clone());
    for (output, file) in outputs.iter().zip(&mut files) {
        let job = Job { blueprint: Some(&blueprint), ..Job::for_path(&found.world, &output.asked) };
        output.write(&job, file)?;
    }
    commit_all(files)?;
    print(&found);
    Ok(())
}

#[expect(clippy::print_stdout, reason = "what the command is for")]
fn print(found: &Verified) {
    let measured = &found.measurement.measured;
    for (name, dial) in measured.dials.named() {
        let [low, high] = dial.interval();
        println!("{name:>12} {:5.2}, 95 % from {low:.2} to {high:.2}", dial.value);
    }
    let race: Vec<String> =
        found.race.iter().map(|dials| format!("{:.1}", dials.difficulty.value)).collect();
    println!("measured by {} fresh trials; the race: {}", measured.trials, race.join(", "));
}

#[cfg(test)]
mod tests {
    use mapping_trial::robot::Robot;

    use super::*;

    #[test]
    fn maps_are_for_the_largest_robot_of_the_panel() {
        let mut panel = Panel::reference();
        let usual = IndoorSpec::default().robot_radius;
        assert_eq!(robot_radius(&panel), usual);
        for (radius, expected) in [(0.208, usual), (0.814, 0.82), (0.57, 0.57), (1.1, 1.1)] {
            panel.conditions[3].robot =
                Robot { circumscribed_radius: radius, ..Default::default() };
            assert_eq!(robot_radius(&panel), expected);
        }
    }
}
