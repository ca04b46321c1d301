//! Runs a survey in its folder.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::{Survey, SurveyFolder};

use crate::progress::Progress;

/// Runs all trials of a share of a survey that its folder does not hold yet.
pub(crate) fn run(
    survey: &Survey,
    folder: &Path,
    shard: Shard,
    threads: usize,
) -> Result<SurveyFolder, Box<dyn Error>> {
    let mut folder = SurveyFolder::open(folder, survey, shard)?;
    let bar = Progress::new();
    bar.set("trials", folder.records().len() as u64, folder.trials());
    let result = folder.run(threads, &|progress| {
        bar.set("trials", progress.done, progress.all);
        ControlFlow::Continue(())
    });
    bar.finish();
    result?;
    Ok(folder)
}
