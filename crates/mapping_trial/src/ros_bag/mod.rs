//! Bags of ROS 2 from trials: MCAP files, which Foxglove and Lichtblick show, and which `ros2 bag play`
//! plays into any SLAM of ROS 2. Writing them needs neither ROS nor any other program.
//!
//! | topic | type | when |
//! |---|---|---|
//! | `/scan` | `sensor_msgs/msg/LaserScan` | each scan; by REP 117, with NaN for beams to be ignored |
//! | `/odom` | `nav_msgs/msg/Odometry` | every 0.2 s and at each scan: what the wheels measured |
//! | `/tf` | `tf2_msgs/msg/TFMessage` | with `/odom`: `odom` to `base_link` |
//! | `/tf_static` | `tf2_msgs/msg/TFMessage` | once, latched: `base_link` to `laser` |
//! | `/tf_map` | `tf2_msgs/msg/TFMessage` | with `/odom`: `map` to `odom`, as the trial's own SLAM estimates it |
//! | `/map` | `nav_msgs/msg/OccupancyGrid` | every 60 s and at the end, latched: the map of the trial's own SLAM |
//! | `/ground_truth` | `geometry_msgs/msg/PoseStamped` | with `/odom`: the true pose, in the frame `map` |
//! | `/clock` | `rosgraph_msgs/msg/Clock` | with `/odom`: simulated time, 0 at the start |
//!
//! `/tf_map` is a topic of its own, since a SLAM into which the bag is played publishes that transform
//! itself. Topics and frames of further robots have a prefix: `/robot_2/scan`, `robot_2/base_link`. The
//! frame `map` is that of the world. Attachments hold the report with its scores and the feedback form,
//! the world, and its spec.
//!
//! All times are simulated, and the same trial gives the same bytes.
//!
//! ```
//! use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
//! use mapping_trial::ros_bag::BagRecorder;
//! use mapping_trial::trial::{Trial, TrialParts, TrialSettings};
//!
//! let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
//! let settings = TrialSettings { time_limit: 30.0, ..Default::default() };
//! let recorder = BagRecorder::new(Vec::new());
//! let parts = recorder.watch(TrialParts::default());
//! let mut trial = Trial::builder(&world, settings).parts(parts).build_flat()?;
//! while trial.step() {}
//! let report = trial.report(&world, &trial.reference(&world)?)?;
//! let (bytes, bag) = recorder.finish(&trial, &world, &report)?;
//! assert!(bytes.starts_with(b"\x89MCAP") && bag.messages() > 150);
//! assert!(bag.metadata("trial.mcap").contains("storage_identifier: mcap"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cdr;
mod error;
mod mcap;
mod message;
mod metadata;
mod recording;
mod schema;

use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use envgen::{World, WorldSpec};

pub use self::error::BagError;

use self::mcap::{Attachment, Totals};
use self::metadata::Topic;
use self::recording::{Recording, nanoseconds};
use crate::backend::RobotBackend;
use crate::trial::{Moment, Setup, Trial, TrialObserver, TrialParts, TrialReport};

/// The state of a recorder.
enum State<W> {
    /// The trial has not begun.
    Waiting(W),
    Recording(Box<Recording<W>>),
    Failed(BagError),
    /// The bag is finished.
    Done,
}

/// Records one trial as a bag while the trial runs. Its memory does not grow with the trial, except for
/// the indexes.
pub struct BagRecorder<W> {
    shared: Shared<W>,
}

type Shared<W> = Arc<Mutex<State<W>>>;

/// Gives access to the state, even if another thread panicked while it held it.
fn with_state<W, T>(shared: &Shared<W>, work: impl FnOnce(&mut State<W>) -> T) -> T {
    work(&mut shared.lock().unwrap_or_else(PoisonError::into_inner))
}

impl<W: Write + Send + 'static> BagRecorder<W> {
    /// Creates a recorder that writes to `out`. It only makes large writes.
    pub fn new(out: W) -> Self {
        BagRecorder { shared: Arc::new(Mutex::new(State::Waiting(out))) }
    }

    /// Returns the given parts with this recorder as observer. Only one trial may be built with them.
    #[must_use]
    pub fn watch(&self, parts: TrialParts) -> TrialParts {
        let shared = self.shared.clone();
        parts.observer(move |setup| {
            with_state(&shared, |state| begin(state, setup));
            Observer { shared: shared.clone() }
        })
    }

    /// Ends the bag of a trial with its last map and its attachments. Returns the writer, and what was
    /// written.
    ///
    /// # Errors
    ///
    /// Returns the first error of the writer since the trial began. It is also an error if a world or a
    /// map cannot be written, or if not exactly one trial was built with [`BagRecorder::watch`].
    pub fn finish<B: RobotBackend>(
        self,
        trial: &Trial<B>,
        world: &World,
        report: &TrialReport,
    ) -> Result<(W, Bag), BagError> {
        let state = with_state(&self.shared, |state| std::mem::replace(state, State::Done));
        let mut recording = match state {
            State::Recording(recording) => recording,
            State::Failed(error) => return Err(error),
            State::Waiting(_) | State::Done => return Err(BagError::NoTrial),
        };
        let end = nanoseconds(trial.time());
        recording.add_map(end, trial.autonomy().slam().map())?;
        let mut json = serde_json::to_vec_pretty(report).map_err(io::Error::from)?;
        json.push(b'\n');
        let world_json = world.to_json()?;
        // Imported worlds have no spec.
        let spec = WorldSpec::from_provenance(&world.provenance).map(|spec| spec.to_ron()).ok();
        let files = [
            ("report.json", "application/json", Some(&json[..])),
            ("world.json", "application/json", Some(world_json.as_bytes())),
            ("spec.envgen.ron", "text/plain", spec.as_deref().map(str::as_bytes)),
        ];
        for (name, media_type, data) in files {
            if let Some(data) = data {
                recording.attach(end, Attachment { name, media_type, data })?;
            }
        }
        let (out, topics, totals) = recording.finish()?;
        Ok((out, Bag { topics, totals }))
    }
}

/// Begins the recording of a trial.
fn begin<W: Write>(state: &mut State<W>, setup: &Setup<'_>) {
    *state = match std::mem::replace(state, State::Done) {
        State::Waiting(out) => match Recording::new(out, setup) {
            Ok(recording) => State::Recording(Box::new(recording)),
            Err(error) => State::Failed(error.into()),
        },
        State::Recording(_) => State::Failed(BagError::ManyTrials),
        other => other,
    };
}

/// The part of a recorder that belongs to the trial.
struct Observer<W> {
    shared: Shared<W>,
}

impl<W: Write + Send> TrialObserver for Observer<W> {
    fn observe(&mut self, moment: &Moment<'_>) {
        with_state(&self.shared, |state| {
            if let State::Recording(recording) = state
                && let Err(error) = recording.add(moment)
            {
                *state = State::Failed(error);
            }
        });
    }
}

/// A summary of what was written to a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bag {
    topics: Vec<Topic>,
    totals: Totals,
}

impl Bag {
    /// Returns the number of messages.
    pub fn messages(&self) -> u64 {
        self.totals.messages()
    }

    /// Returns the number of messages of each topic.
    pub fn topics(&self) -> impl Iterator<Item = (&str, u64)> {
        let names = self.topics.iter().map(|topic| topic.name.as_str());
        names.zip(self.totals.channels.iter().copied())
    }

    /// Returns the text of the `metadata.yaml` that rosbag2 expects in the folder of the bag's file,
    /// which is named `file`.
    pub fn metadata(&self, file: &str) -> String {
        metadata::metadata(file, &self.topics, &self.totals)
    }
}

#[cfg(test)]
mod tests;
