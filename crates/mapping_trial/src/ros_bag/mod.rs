//! Trials as bags of ROS 2: MCAP files that Foxglove and Lichtblick show, that `ros2 bag play` plays into any SLAM
//! of ROS 2, and that need neither ROS nor any other program to be written.
//!
//! | topic | type | when |
//! |---|---|---|
//! | `/scan` | `sensor_msgs/msg/LaserScan` | each scan; no echo is +Inf (REP 117), a beam to be ignored NaN |
//! | `/odom` | `nav_msgs/msg/Odometry` | every 0.2 s and at each scan: what the wheels measured |
//! | `/tf` | `tf2_msgs/msg/TFMessage` | with `/odom`: `odom` to `base_link` |
//! | `/tf_static` | `tf2_msgs/msg/TFMessage` | once, latched: `base_link` to `laser` |
//! | `/tf_map` | `tf2_msgs/msg/TFMessage` | with `/odom`: `map` to `odom`, as the trial's own SLAM estimates it |
//! | `/map` | `nav_msgs/msg/OccupancyGrid` | every 60 s and at the end, latched: the map of the trial's own SLAM |
//! | `/ground_truth` | `geometry_msgs/msg/PoseStamped` | with `/odom`: the true pose, in the frame `map` |
//! | `/clock` | `rosgraph_msgs/msg/Clock` | with `/odom`: simulated time, 0 at the start |
//!
//! `/tf_map` is a topic of its own, since a SLAM that the bag is played into publishes that transform itself. Of
//! further robots topics and frames have a prefix: `/robot_2/scan`, `robot_2/base_link`. The frame `map` is the
//! world's. Attachments hold the report with its scores and the feedback form, the world, and its spec.
//!
//! Times are simulated time only, and the same trial gives the same bytes.
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

/// What a recorder holds.
enum State<W> {
    /// No trial has begun.
    Waiting(W),
    Recording(Box<Recording<W>>),
    Failed(BagError),
    /// It is finished.
    Done,
}

/// Records one trial as a bag, written while the trial runs: the memory that it takes does not grow with the
/// trial, but for the indexes.
pub struct BagRecorder<W> {
    shared: Shared<W>,
}

type Shared<W> = Arc<Mutex<State<W>>>;

/// The state, whatever became of another thread that held it.
fn with_state<W, T>(shared: &Shared<W>, work: impl FnOnce(&mut State<W>) -> T) -> T {
    work(&mut shared.lock().unwrap_or_else(PoisonError::into_inner))
}

impl<W: Write + Send + 'static> BagRecorder<W> {
    /// A recorder that writes to `out`; it makes large writes only.
    pub fn new(out: W) -> Self {
        BagRecorder { shared: Arc::new(Mutex::new(State::Waiting(out))) }
    }

    /// The same parts with this recorder as observer; one trial may be built with them.
    #[must_use]
    pub fn watch(&self, parts: TrialParts) -> TrialParts {
        let shared = self.shared.clone();
        parts.observer(move |setup| {
            with_state(&shared, |state| begin(state, setup));
            Observer { shared: shared.clone() }
        })
    }

    /// Ends the bag of a trial with its last map and its attachments. Returns the writer, and what was written.
    ///
    /// # Errors
    ///
    /// The first error of the writer since the trial began; a world or a map that cannot be written; if not exactly
    /// one trial was built with [`BagRecorder::watch`].
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
        // Worlds that were imported have no spec.
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

/// The end of a recorder that the trial holds.
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

/// What was written to a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bag {
    topics: Vec<Topic>,
    totals: Totals,
}

impl Bag {
    /// Number of messages.
    pub fn messages(&self) -> u64 {
        self.totals.messages()
    }

    /// Number of messages of each topic.
    pub fn topics(&self) -> impl Iterator<Item = (&str, u64)> {
        let names = self.topics.iter().map(|topic| topic.name.as_str());
        names.zip(self.totals.channels.iter().copied())
    }

    /// The text of the `metadata.yaml` that rosbag2 expects in the folder of the bag's file, whose name is given.
    pub fn metadata(&self, file: &str) -> String {
        metadata::metadata(file, &self.topics, &self.totals)
    }
}

#[cfg(test)]
mod tests;
