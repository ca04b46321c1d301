//! The subcommand `envgen-trials generate`.

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use envgen::assignment::{Assignment, assignments};
use envgen::calibration::{Dials, Estimate};
use envgen::export::{Job, Output};
use envgen::indoor::{IndoorSpec, Profile, Request};
use envgen::located::Locate;
use envgen::whole_file::commit_all;
use envgen::{Blueprint, Seed, Spec, WorldBlueprint, WorldKind, WorldSpec};
use mapping_trial::difficulty::{NEAR_REQUEST, Panel, Verified, most_trials, verified};

use crate::panel::PanelOptions;
use crate::progress::Progress;
use crate::stdout;
use crate::usage::Usage;
use crate::warning::{warn, warn_of_coverage};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Changes a setting of indoor maps (see `envgen kinds indoor`), such as `difficulty=7`; may be given several
    /// times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,

    /// The seed: the same settings, panel and seed give the same map.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    seed: Seed,

    /// Number of trials under each condition of the last measurement.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,

    /// A file to write; may be given several times. The ending of its name selects the format.
    #[arg(long, value_name = "FILE", required = true)]
    out: Vec<PathBuf>,

    #[command(flatten)]
    panel: PanelOptions,
}

impl Arguments {
    /// The spec, for the robots of the panel. It is checked before the anchors, which take minutes.
    fn spec(&self, panel: &Panel) -> Result<IndoorSpec, Box<dyn Error>> {
        let mut spec =
            WorldSpec::from(IndoorSpec { profile: Profile::Calibrated, ..Default::default() });
        let settings = assignments("--set", &self.settings, WorldKind::Indoor.settings())?;
        for Assignment { name, value, text } in &settings {
            spec.set(name, value).in_option("--set", text)?;
        }
        let names: Vec<_> = settings.iter().map(|setting| setting.name).collect();
        if names.contains(&"candidate") {
            let text = "--set candidate: the trials choose the candidate".to_owned();
            return Err(Usage(text).into());
        }
        let WorldSpec::Indoor(mut spec) = spec else { unreachable!("the kind is never set") };
        spec.fix_given(&names).in_option("--set", "difficulty")?;
        let is_given = names.contains(&"robot_radius");
        if !is_given {
            spec.robot_radius = robot_radius(panel);
        }
        match spec.validate() {
            Err(error) if error.field == "robot_radius" && !is_given => {
                let text = format!("{error}; it is that of the panel's largest robot");
                return Err(Usage(text).into());
            }
            checked => checked?,
        }
        spec.request().check(&spec, spec.reachable())?;
        // Dials that can be reached alone may not be reachable together.
        spec.candidates(self.seed).map_err(|error| Usage(error.to_string()))?;
        Ok(spec)
    }
}

/// The radius of the largest robot of a panel in whole centimetres, and at least that of the default
/// robot of maps.
fn robot_radius(panel: &Panel) -> f64 {
    let radii = panel.conditions.iter().map(|condition| condition.robot.circumscribed_radius);
    let largest = radii.fold(0.0, f64::max);
    // Whole centimetres stay as they are, whatever their rounding.
    ((100.0 * largest - 1e-9).ceil() / 100.0).max(IndoorSpec::default().robot_radius)
}

/// Rejects formats that cannot hold an indoor map, before any trial runs. A format that cannot hold the
/// first candidate can hold none.
fn check_formats(outputs: &[Output], spec: &IndoorSpec, seed: Seed) -> Result<(), Box<dyn Error>> {
    let plan = spec.generate(seed)?;
    let (world, blueprint) = (plan.to_world(), WorldBlueprint::Indoor(plan));
    for output in outputs {
        let job = Job { blueprint: Some(&blueprint), ..Job::for_path(&world, &output.asked) };
        output.check(&job).map_err(|error| Usage(error.to_string()))?;
    }
    Ok(())
}

pub(crate) fn run(arguments: &Arguments, threads: usize) -> Result<(), Box<dyn Error>> {
    let panel = arguments.panel.panel()?;
    let spec = arguments.spec(&panel)?;
    let outputs = Output::all(&arguments.out, &arguments.panel.inputs())?;
    check_formats(&outputs, &spec, arguments.seed)?;
    let mut files = outputs.iter().map(Output::create).collect::<Result<Vec<_>, _>>()?;
    let scale = arguments.panel.scale(&panel, threads)?;
    let bar = Progress::new();
    let most = most_trials(&panel, arguments.seeds) as u64;
    bar.set("trials", 0, most);
    let found = verified(&spec, arguments.seed, &panel, &scale, arguments.seeds, &mut |trials| {
        bar.set("trials", trials as u64, most);
    });
    bar.finish();
    let found = found?;
    let blueprint = WorldBlueprint::Indoor(found.plan.clone());
    for (output, file) in outputs.iter().zip(&mut files) {
        let job = Job { blueprint: Some(&blueprint), ..Job::for_path(&found.world, &output.asked) };
        output.write(&job, file)?;
    }
    commit_all(files)?;
    stdout::print(&text(&found, spec.request(), spec.reachable()))?;
    warn_of_coverage(&found.measurement);
    for text in missed(spec.request(), found.measurement.intervals()) {
        warn(&text);
    }
    Ok(())
}

fn text(found: &Verified, request: Request, reachable: Dials<[f64; 2]>) -> String {
    let mut text = String::new();
    let measured = &found.measurement.measured;
    for line in compared(request, found.measurement.intervals(), reachable) {
        writeln!(text, "{line}").ok();
    }
    let race = race(request, &found.race);
    writeln!(
        text,
        "measured by {} new trials; the candidates in the race: {race}",
        measured.trials
    )
    .ok();
    text
}

/// Formats what the race measured of each candidate, by each requested dial.
fn race(request: Request, race: &[Dials<Estimate>]) -> String {
    let requested = request.0.named().into_iter().enumerate().filter_map(|(i, (name, wanted))| {
        wanted?;
        let values = race.iter().map(|dials| format!("{:.1}", dials.named()[i].1.value));
        Some(format!("{name} {}", values.collect::<Vec<String>>().join(", ")))
    });
    requested.collect::<Vec<String>>().join("; ")
}

/// Formats each measured dial; for requested dials, with the request and the range of the settings.
fn compared(
    request: Request,
    measured: Dials<(f64, [f64; 2])>,
    reachable: Dials<[f64; 2]>,
) -> [String; 3] {
    request.0.zip(measured.zip(reachable)).named().map(|(name, (wanted, (dial, [least, most])))| {
        let (value, [low, high]) = dial;
        let asked = wanted.map_or_else(String::new, |wanted| {
            format!("; requested {wanted:.2}, predicted reach from {least:.1} to {most:.1}")
        });
        format!("{name:>12} {value:5.2}, 95 % from {low:.2} to {high:.2}{asked}")
    })
}

/// Returns a statement for each requested dial whose measured value is not near the request.
fn missed(request: Request, measured: Dials<(f64, [f64; 2])>) -> Vec<String> {
    let dials = request.0.zip(measured).named();
    let missed = dials.into_iter().filter_map(|(name, (wanted, (value, [low, high])))| {
        let wanted = wanted?;
        let off = (value - wanted).abs();
        let is_beyond_noise = !(low - NEAR_REQUEST..=high + NEAR_REQUEST).contains(&wanted);
        if is_beyond_noise {
            Some(format!(
                "the measured {name} misses the request: {wanted:.2} is more than {NEAR_REQUEST} outside the \
                 interval from {low:.2} to {high:.2}; another --seed has other candidates"
            ))
        } else if off > NEAR_REQUEST {
            Some(format!(
                "the measured {name} is {off:.2} from the request, which may be noise of the trials: more --seeds \
                 measure it more precisely, and another --seed has other candidates"
            ))
        } else {
            None
        }
    });
    missed.collect()
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

    fn measured(value: f64, half: f64) -> Dials<(f64, [f64; 2])> {
        let interval = [value - half, value + half];
        Dials { difficulty: (), mapping: (), navigation: () }.map(|()| (value, interval))
    }

    #[test]
    fn requests_are_shown_beside_what_was_measured() {
        let request = Request(Dials { difficulty: None, mapping: Some(3.0), navigation: None });
        let reachable = Dials::default().map(|_: f64| [0.54, 9.1]);
        let expected = [
            "  difficulty  4.00, 95 % from 3.61 to 4.39",
            "     mapping  4.00, 95 % from 3.61 to 4.39; requested 3.00, predicted reach from 0.5 to 9.1",
            "  navigation  4.00, 95 % from 3.61 to 4.39",
        ];
        assert_eq!(compared(request, measured(4.0, 0.39), reachable), expected);
    }

    #[test]
    fn races_are_shown_by_the_requested_dials() {
        let estimate = |value| Estimate { value, standard_error: 0.3 };
        let racer = |d, m, n| Dials { difficulty: d, mapping: m, navigation: n }.map(estimate);
        let racers = [racer(5.0, 3.04, 6.2), racer(4.5, 2.96, 5.0)];
        let shown = |difficulty, mapping, navigation| {
            race(Request(Dials { difficulty, mapping, navigation }), &racers)
        };
        assert_eq!(shown(Some(5.0), None, None), "difficulty 5.0, 4.5");
        assert_eq!(shown(None, Some(3.0), Some(6.0)), "mapping 3.0, 3.0; navigation 6.2, 5.0");
    }

    #[test]
    fn requests_may_be_missed_by_noise() {
        let whole = |wanted| Dials { difficulty: Some(wanted), mapping: None, navigation: None };
        let found = |wanted, value| missed(Request(whole(wanted)), measured(value, 0.7));
        assert_eq!(found(6.5, 6.5 - NEAR_REQUEST + 0.01), Vec::<String>::new());
        let texts = found(6.5, 5.2);
        assert!(
            texts.len() == 1
                && texts[0]
                    .starts_with("the measured difficulty is 1.30 from the request, which may be"),
            "{texts:?}"
        );
    }

    #[test]
    fn requests_are_missed_beyond_the_interval_and_what_is_near() {
        let whole = |wanted| Dials { difficulty: Some(wanted), mapping: None, navigation: None };
        let found = |wanted, value| missed(Request(whole(wanted)), measured(value, 0.39));
        let half = 0.39 + NEAR_REQUEST;
        for off in [-half - 0.01, -half + 0.01, 0.0, half - 0.01, half + 0.01] {
            let texts = found(5.0, 5.0 + off);
            let is_missed = texts.iter().any(|text| text.contains("misses the request"));
            assert_eq!(is_missed, off.abs() > half, "{off}: {texts:?}");
        }
        let expected = "the measured difficulty misses the request: 5.00 is more than 0.7 outside the interval \
                        from 6.61 to 7.39; another --seed has other candidates";
        assert_eq!(found(5.0, 7.0), [expected]);
        // Only what is requested is missed, and each dial by itself.
        let both = Dials { difficulty: None, mapping: Some(3.0), navigation: Some(6.8) };
        let texts = missed(Request(both), measured(7.0, 0.2));
        assert!(texts.len() == 1 && texts[0].starts_with("the measured mapping "), "{texts:?}");
    }
}
