//! Pictures of the paper's maps: the world, and the robot's map of it.

use envgen::picture::{self, PictureOptions};
use rayon::prelude::*;

use crate::experiment::design::TrialId;
use crate::experiment::error::ExperimentError;
use crate::experiment::record::Record;
use crate::experiment::site::Site;
use crate::experiment::store::Experiment;
use crate::picture::Picture;

/// Greatest number of maps of a level that are shown.
const SHOWN: u32 = 2;

/// Pictures of one map, as PNG.
pub(super) struct MapPictures {
    pub(super) record: Record,
    /// The true world.
    pub(super) world: Vec<u8>,
    /// The robot's map, with the estimated trajectory.
    pub(super) map: Vec<u8>,
    /// That map over the mappable area, with both trajectories.
    pub(super) errors: Vec<u8>,
}

/// Runs the first policy's trials on the paper's maps again and draws them.
pub(super) fn draw(
    experiment: &Experiment,
    records: &[&Record],
    threads: usize,
) -> Result<Vec<MapPictures>, ExperimentError> {
    let design = experiment.design();
    let Some(&policy) = design.replay.policies.first() else { return Ok(Vec::new()) };
    let is_shown =
        |trial: &TrialId| design.is_replay(trial) && trial.policy == policy && trial.map < SHOWN;
    let shown: Vec<&Record> =
        records.iter().filter(|record| is_shown(&record.trial)).copied().collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| ExperimentError::Threads(error.to_string()))?;
    pool.install(|| shown.into_par_iter().map(|record| pictures(experiment, record)).collect())
}

fn pictures(experiment: &Experiment, record: &Record) -> Result<MapPictures, ExperimentError> {
    let design = experiment.design();
    let report_error = |error: &dyn std::error::Error| ExperimentError::Report(error.to_string());
    let site = Site::new(design, &record.trial)?;
    let (again, run) = site.run(design, &record.trial)?;
    experiment.require_same(record, &again)?;
    let (map, truth) = (run.autonomy().slam().map(), &site.truth);
    // The robot's map may reach beyond the world where its poses are wrong.
    let area = map.bounds().map_or(site.world.bounds, |seen| seen.union(site.world.bounds));
    let estimated = run.autonomy().slam().trajectory(0);
    let png = |picture: Picture| {
        let mut bytes = Vec::new();
        let figure = picture.figure("", Vec::new());
        figure.write_png(&mut bytes).map(|()| bytes).map_err(|error| report_error(&error))
    };
    let mut own = Picture::of_map(map, area);
    own.draw_estimated_path(&estimated);
    let mut errors = Picture::of_errors(truth, map, area);
    errors.draw_true_path(&run.trajectory(0).poses);
    errors.draw_estimated_path(&estimated);
    let options = PictureOptions {
        width: 640,
        height: 640,
        margin: 0,
        title: Some(String::new()),
        legend: false,
        names: false,
        ..PictureOptions::default()
    };
    Ok(MapPictures {
        record: record.clone(),
        world: picture::png(&site.world, &options).map_err(|error| report_error(&error))?,
        map: png(own)?,
        errors: png(errors)?,
    })
}
