//! Runs a survey in its folder.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::{Survey, SurveyFolder};

use crate::progress;

/// Runs all trials of a share of a survey that its folder does not hold yet.
pub(crate) fn run(
    survey: &Survey,
    folder: &Path,
    shard: Shard,
    threads: usize,
) -> Result<SurveyFolder, Box<dyn Error>> {
    let mut folder = SurveyFolder::open(folder, survey, shard)?;
    let bar = progress::trials(folder.trials(), folder.records().len() as u64);
    let result = folder.run(threads, &|progress| {
        bar.set_position(progress.done);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    result?;
    Ok(folder)
}
