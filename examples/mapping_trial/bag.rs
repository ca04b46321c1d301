//! The bag of a trial for ROS 2, with the files for scoring another SLAM's map of the same world.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use envgen::World;
use envgen::certificate::{Verdict, verify};
use envgen::located::Locate;
use envgen::whole_file::{WholeFile, commit_all, create_folder, refuse_inputs};
use mapping_trial::backend::{RobotBackend, TICK};
use mapping_trial::ros_bag::BagRecorder;
use mapping_trial::trial::{Trial, TrialParts, TrialReport};
use mapping_trial::tum::{self, TimedPose};

/// Name of the file that rosbag2 expects beside the file of the bag.
const METADATA: &str = "metadata.yaml";

/// The bag that `--log` requests. An interrupted trial leaves no file.
pub(crate) struct Bag {
    path: PathBuf,
    /// Name of the file without its ending.
    stem: String,
    recorder: BagRecorder<WholeFile>,
    /// The other files, which are begun before the trial, so that nothing is lost if they cannot be
    /// written.
    metadata: WholeFile,
    world: WholeFile,
    /// True and estimated poses of each robot.
    tracks: Vec<[WholeFile; 2]>,
    /// Whether there is a bag of this name.
    replaces: bool,
}

impl Bag {
    /// Begins the files of a trial with a number of robots.
    pub(crate) fn begin<P: AsRef<Path>>(
        path: &Path,
        inputs: &[P],
        robots: u32,
    ) -> Result<Self, Box<dyn Error>> {
        let (Some(stem), Some("mcap")) =
            (path.file_stem(), path.extension().and_then(|ending| ending.to_str()))
        else {
            return Err(format!("--log {}: must end in .mcap", path.display()).into());
        };
        let stem = stem.to_string_lossy().into_owned();
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        create_folder(folder.unwrap_or(Path::new("."))).in_option("--log", path.display())?;
        let metadata = path.with_file_name(METADATA);
        refuse_other_bag(&metadata, path)?;
        let replaces = metadata.is_file() && path.is_file();
        let begin = |path: &Path| -> Result<WholeFile, Box<dyn Error>> {
            refuse_inputs(path, inputs).in_file(path)?;
            Ok(WholeFile::create(path).in_file(path)?)
        };
        let tracks = (0..robots as usize).map(|robot| {
            let [truth, estimate] = track_names(&stem, robot);
            Ok([begin(&path.with_file_name(truth))?, begin(&path.with_file_name(estimate))?])
        });
        let tracks = tracks.collect::<Result<_, Box<dyn Error>>>()?;
        Ok(Bag {
            recorder: BagRecorder::new(begin(path)?),
            metadata: begin(&metadata)?,
            world: begin(&path.with_file_name(format!("{stem}.world.json")))?,
            tracks,
            path: path.to_owned(),
            stem,
            replaces,
        })
    }

    /// Returns the parts of a trial, with the recorder.
    pub(crate) fn watch(&self, parts: TrialParts) -> TrialParts {
        self.recorder.watch(parts)
    }

    /// Completes the files, and returns their paths.
    pub(crate) fn finish<B: RobotBackend>(
        mut self,
        trial: &Trial<B>,
        world: &World,
        report: &TrialReport,
    ) -> Result<Vec<PathBuf>, Box<dyn Error>> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (file, bag) = self.recorder.finish(trial, world, report).in_file(&self.path)?;
        self.metadata.write_all(bag.metadata(&name).as_bytes())?;
        // Other maps of this world are scored from where this robot started.
        let mut world = world.clone();
        let start = Some(trial.trajectory(0).poses[0]);
        if world.start != start {
            world.start = start;
            // No spec has this start, and claims about the other start may not hold.
            world.provenance.edited = true;
            world.provenance.edits.clear();
            world.provenance.measured = None;
            let held = verify(&world).into_iter().filter(|(_, verdict)| *verdict == Verdict::Holds);
            world.certificate = held.map(|(claim, _)| claim).collect();
        }
        self.world.write_all(world.to_json()?.as_bytes())?;
        let mut files = vec![file, self.metadata, self.world];
        let beside = |name: String| self.path.with_file_name(name);
        let mut paths = vec![
            self.path.clone(),
            beside(METADATA.to_owned()),
            beside(format!("{}.world.json", self.stem)),
        ];
        let robots = self.tracks.len();
        for (robot, tracks) in self.tracks.into_iter().enumerate() {
            let truth = &trial.trajectory(robot).poses;
            // The first estimate precedes the first observation.
            let estimated = trial.autonomy().slam().trajectory(robot);
            let estimated = estimated.get(1..).unwrap_or_default();
            let names = track_names(&self.stem, robot);
            for ((mut file, name), poses) in
                tracks.into_iter().zip(names).zip([truth.as_slice(), estimated])
            {
                let path = beside(name);
                let mut text = Vec::new();
                let timed = poses.iter().take(truth.len()).enumerate();
                let timed = timed.map(|(tick, &pose)| TimedPose { time: tick as f64 * TICK, pose });
                tum::write(timed, &mut text)?;
                file.write_all(&text).in_file(&path)?;
                files.push(file);
                paths.push(path);
            }
        }
        commit_all(files)?;
        if self.replaces {
            // The bag that was replaced may have had more robots.
            for robot in robots.. {
                let old = track_names(&self.stem, robot).map(|name| self.path.with_file_name(name));
                if !old.iter().all(|path| path.is_file()) {
                    break;
                }
                for path in &old {
                    std::fs::remove_file(path).in_file(path)?;
                }
            }
        }
        Ok(paths)
    }
}

/// Names of the files with the true and the estimated poses of a robot.
fn track_names(stem: &str, robot: usize) -> [String; 2] {
    let number = if robot == 0 { String::new() } else { format!("_{}", robot + 1) };
    ["truth", "estimate"].map(|of| format!("{stem}.{of}{number}.tum"))
}

/// Rejects a folder whose metadata describe another bag, since they would be overwritten.
fn refuse_other_bag(metadata: &Path, path: &Path) -> Result<(), Box<dyn Error>> {
    let Ok(text) = std::fs::read_to_string(metadata) else { return Ok(()) };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let lines = || text.lines().map(|line| line.trim().trim_start_matches("- "));
    if lines().any(|line| line.trim_matches('"') == name) {
        return Ok(());
    }
    let (log, metadata) = (path.display(), metadata.display());
    Err(format!("--log {log}: {metadata} describes another bag: give each log a folder of its own")
        .into())
}
