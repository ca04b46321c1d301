//! `envgen generate`.

use std::process::ExitCode;

use clap::Args;
use envgen::{WorldBlueprint, WorldMetrics};

use crate::failure::Failure;
use crate::moving::Moving;
use crate::progress::steps;
use crate::source::{Source, note};
use crate::writing::Writing;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,

    #[command(flatten)]
    writing: Writing,

    #[command(flatten)]
    moving: Moving,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    // All mistakes in the arguments are found before any work is done.
    let source = &arguments.source;
    let (spec, moving) = source.spec_and_scenario()?;
    let mut files =
        arguments.writing.begin(&[source.inputs(), arguments.moving.inputs()].concat())?;
    let steps = steps(1 + files.count());
    steps.begin(format!("generating a world of the kind {}", spec.kind()));
    let blueprint =
        spec.generate(source.seed).map_err(|error| source.ungenerated(spec.kind(), error))?;
    let world = blueprint.to_world();
    files.scenario = arguments.moving.scenario(&world, moving, source.seed)?;
    files.write(&world, Some(&blueprint), &steps)?;
    for setting in source.without_effect(&spec, &world) {
        note(&format!("{setting} changes nothing in this world"));
    }
    if let WorldBlueprint::Indoor(plan) = &blueprint {
        plan.calibration_doubts().iter().for_each(|doubt| note(&doubt.to_string()));
    }
    if let WorldMetrics::Landscape(metrics) = blueprint.metrics()
        && let Some(error) = metrics.total_edge_error.filter(|error| *error != 0)
    {
        note(&format!(
            "no landscape of this total_edge was found; the nearest that was found is {error:+} off"
        ));
    }
    Ok(ExitCode::SUCCESS)
}
