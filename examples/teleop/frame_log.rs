//! A log of the duration of every frame.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use bevy::prelude::*;
use envgen::whole_file::refuse_inputs;

use crate::session::Session;

/// A CSV file with one row per frame.
#[derive(Resource)]
pub(crate) struct FrameLog(BufWriter<File>);

impl FrameLog {
    pub(crate) fn create(path: &Path, inputs: &[PathBuf]) -> io::Result<Self> {
        refuse_inputs(path, inputs)?;
        let mut file = BufWriter::new(File::create(path)?);
        writeln!(file, "frame,seconds,frame_ms,ticks")?;
        Ok(FrameLog(file))
    }
}

/// Adds a row, which others can read at once. After an error nothing more is written.
pub(crate) fn write(
    mut log: ResMut<FrameLog>,
    time: Res<Time<Real>>,
    session: Res<Session>,
    mut frame: Local<u64>,
    mut commands: Commands,
) {
    *frame += 1;
    let (seconds, delta) = (time.elapsed_secs_f64(), 1e3 * time.delta_secs_f64());
    let row = writeln!(log.0, "{},{seconds:.4},{delta:.3},{}", *frame, session.ticks);
    if let Err(problem) = row.and_then(|()| log.0.flush()) {
        #[expect(clippy::print_stderr, reason = "errors belong on stderr")]
        {
            eprintln!("the frame log is incomplete: {problem}");
        }
        commands.remove_resource::<FrameLog>();
    }
}
