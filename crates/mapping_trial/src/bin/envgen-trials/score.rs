//! The subcommand `envgen-trials score`.

use std::error::Error;
use std::fmt::Write;
use std::fs::File;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use envgen::export::ros_map::{RosCell, RosMap};
use envgen::geometry::{Pose, wrap_angle};
use envgen::import;
use envgen::import::ros_map::read_ros_map;
use envgen::located::Locate;
use envgen::text_file;
use mapping_trial::map::OccupancyMap;
use mapping_trial::robot::Robot;
use mapping_trial::score::{
    MapScores, Reference, TrajectoryPair, TrajectoryScores, alignment, fit,
};
use mapping_trial::tum::{self, TimedPose};
use serde::Serialize;

use crate::spinner::spinner;
use crate::start_argument::start;
use crate::trajectory_gaps::{Gaps, LONGEST, missing_share};
use crate::usage::Usage;
use crate::warning::{warn, warn_of_map};
use crate::{json, stdout};

/// Least fraction of a map's free cells that have to be ground for no warning.
const LEAST_GROUND: f64 = 0.5;

/// A robot that gets through narrow passages: about the smallest that can be scored.
const NARROW: &str = "(length: 0.22, width: 0.22, swing_radius: 0.16, laser_offset: 0.0)";

/// Least fraction of a map's walls that have to be near true ones for no warning of the frame: in a wrong frame up to
/// three tenths were.
const LEAST_PRECISION: f64 = 0.5;

/// Greatest error of positions in metres that is right enough for a warning of the headings, and for none of the frame.
const RIGHT: f64 = 0.5;

/// Least median error of headings in radians for a warning of the headings.
const WRONG_HEADINGS: f64 = 0.5;

/// Least error of positions as they are, in times of that after the alignment, for a warning of the frame.
const WRONG_FRAME: f64 = 4.0;

/// Greatest fraction of the true path for which an estimate may be missing without a warning.
const MOST_MISSING: f64 = 0.1;

#[derive(Args)]
#[expect(clippy::doc_markdown, reason = "help texts are not Markdown")]
pub(crate) struct Arguments {
    /// The map to score: the YAML file of a ROS map, as map_saver_cli of Nav2 writes it.
    #[arg(long, value_name = "FILE.yaml")]
    map: PathBuf,

    /// The world that was mapped, in any format that `envgen convert` reads.
    #[arg(long, value_name = "FILE")]
    world: PathBuf,

    /// The frame of the map and of the estimated trajectory. start: its origin is the pose where the robot started, as
    /// in maps of SLAM programs. world: the frame of the world, as in maps of this project's trials.
    #[arg(long, value_enum, default_value_t = Frame::Start)]
    frame: Frame,

    /// Where the robot started, in metres and degrees; a heading that is left out is 0 [default: the start of the
    /// world].
    #[arg(long, value_name = "X,Y,HEADING", value_parser = start, allow_hyphen_values = true)]
    start: Option<Pose>,

    /// Moves the map to where its walls match those of the world best, by at most 1.5 m and 17 degrees.
    #[arg(long)]
    fit: bool,

    /// The estimated trajectory in the TUM format; for several robots, once for each.
    #[arg(long, value_name = "FILE.tum", requires = "truth")]
    trajectory: Vec<PathBuf>,

    /// The true trajectory in the TUM format, in the frame of the world and with the same clock; once for each
    /// --trajectory, in the same order.
    #[arg(long, value_name = "FILE.tum", requires = "trajectory")]
    truth: Vec<PathBuf>,

    /// A RON file with the robot, such as `(length: 0.4, width: 0.4)` [default: the Pioneer 3-AT].
    #[arg(long, value_name = "FILE.ron")]
    robot: Option<PathBuf>,

    /// Prints JSON.
    #[arg(long)]
    json: bool,
}

/// The frame of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Frame {
    Start,
    World,
}

/// The output as JSON.
#[derive(Serialize)]
struct Report {
    /// Description of the world, such as `indoor, seed 3`.
    world: String,
    /// Digest of the world's geometry.
    world_digest: String,
    /// Pose of the map's frame in the world's frame, for which the map is scored.
    frame: Pose,
    /// The scores of the map.
    map: MapScores,
    /// M, from 0 to 10, where 10 is the most difficult; absent without a trajectory.
    mapping: Option<f64>,
    /// The scores of the trajectory; absent if none is given.
    trajectory: Option<Trajectory>,
}

/// The scores of a trajectory.
#[derive(Serialize)]
struct Trajectory {
    /// Number of poses that are scored.
    poses: usize,
    /// Number of poses before the first true pose, after the last one, or in a gap between true poses.
    outside: usize,
    /// Scores in the frame of the map.
    as_is: TrajectoryScores,
    /// Scores after the alignment, for which the position errors are least.
    aligned: TrajectoryScores,
    /// Pose of the trajectory's frame in the world's frame after the alignment.
    alignment: Pose,
}

/// Endings of images of ROS maps.
const IMAGES: [&str; 2] = ["pgm", "png"];

pub(crate) fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let path = &arguments.world;
    let world = import::read_world(path).in_file(path)?;
    let robot = match &arguments.robot {
        None => Robot::default(),
        Some(path) => Robot::from_ron(&text_file::read(path).in_file(path)?).in_file(path)?,
    };
    let start = arguments.start.or(world.start);
    let start = start.ok_or("the world has no start: use --start X,Y,HEADING").in_file(path)?;
    let path = &arguments.map;
    if path
        .extension()
        .is_some_and(|ending| IMAGES.iter().any(|name| ending.eq_ignore_ascii_case(name)))
    {
        let error =
            format!("--map {}: give the .yaml of the map, which names its image", path.display());
        return Err(Usage(error).into());
    }
    let ros_map = read_ros_map(&mut File::open(path).in_file(path)?, path).in_file(path)?;
    warn_of_map(path);
    let (estimated, truth) = (&arguments.trajectory, &arguments.truth);
    if estimated.len() != truth.len() {
        let (estimated, truth) = (estimated.len(), truth.len());
        let error = format!(
            "--trajectory is given {estimated} times and --truth {truth} times: each robot needs both"
        );
        return Err(Usage(error).into());
    }
    let tracks = estimated.iter().zip(truth);
    let tracks =
        tracks.map(|(estimated, truth)| Ok(Track::new(read_tum(estimated)?, read_tum(truth)?)));
    let tracks: Vec<Track> = tracks.collect::<Result<_, Box<dyn Error>>>()?;
    for (track, path) in tracks.iter().zip(&arguments.truth) {
        if let Some((start, end)) = track.gaps.longest() {
            let (path, count) = (path.display(), track.gaps.count());
            warn(&format!(
                "{path}: true poses are more than {LONGEST} s apart while the robot moves, for the longest time from \
                 {start} s to {end} s: estimated poses between them are not scored (gaps: {count})"
            ));
        }
    }

    let spinner = spinner("scoring");
    let reference =
        Reference::from_start(&world, &robot, start.position).in_file(&arguments.world)?;
    let mut frame = match arguments.frame {
        Frame::Start => start,
        Frame::World => Pose::default(),
    };
    if arguments.fit {
        let own = OccupancyMap::from_ros_map(&ros_map, Pose::default()).in_file(path)?;
        frame = fit(&reference, &own, frame);
    }
    let drawn = OccupancyMap::from_ros_map(&ros_map, frame).in_file(path)?;
    let map = MapScores::of(&reference, &drawn);
    let mut is_ground = ground_share(&ros_map, &map);
    if is_ground < LEAST_GROUND {
        // A large robot sees ground through passages that are too narrow for it.
        let narrow = Robot { laser_mount: robot.laser_mount, ..Robot::from_ron(NARROW)? };
        if let Ok(open) = Reference::from_start(&world, &narrow, start.position) {
            is_ground = is_ground.max(ground_share(&ros_map, &MapScores::of(&open, &drawn)));
        }
    }
    let trajectory = if tracks.is_empty() { None } else { Some(score(&tracks, frame)?) };
    spinner.finish_and_clear();
    let has = |cell| ros_map.cells.contains(&cell);
    if !has(RosCell::Free) {
        warn("the map has no free cell: check `mode`, `negate` and `free_thresh`");
    } else if has(RosCell::Occupied) && map.precision_30 < LEAST_PRECISION {
        let options = match (arguments.frame, arguments.fit) {
            (Frame::World, false) => "check --frame, or use --fit if the frame is known roughly",
            (Frame::World, true) => "check --frame",
            (Frame::Start, false) => {
                "check --frame and --start, or use --fit if the frame is known roughly"
            }
            (Frame::Start, true) => "check --frame and --start",
        };
        warn(&format!(
            "only {:.0} % of the map's walls are near walls of the world: {options}",
            100.0 * map.precision_30
        ));
    } else if is_ground < LEAST_GROUND {
        warn(&format!(
            "only {:.0} % of the map's free cells are open ground of the world: what the robot has not seen must be \
             unknown in the map, or it counts as covered",
            100.0 * is_ground
        ));
    }

    for (track, path) in tracks.iter().zip(&arguments.trajectory) {
        let missing = missing_share(&track.estimated, &track.truth);
        if missing > MOST_MISSING {
            warn(&format!(
                "{}: no pose for {:.0} % of the true path: errors there do not count",
                path.display(),
                100.0 * missing
            ));
        }
    }
    if let Some(trajectory) = &trajectory {
        warn_of_trajectory(&tracks, frame, trajectory);
    }

    let report = Report {
        world: world.provenance.name(),
        world_digest: world.digest().to_string(),
        frame,
        map,
        mapping: trajectory.as_ref().map(|trajectory| map.mapping(&trajectory.as_is)),
        trajectory,
    };
    if arguments.json { json::print(&report) } else { Ok(stdout::print(&text(&report))?) }
}

/// The fraction of a map's free cells that are ground which the robot of the scores can cover.
fn ground_share(ros_map: &RosMap, scores: &MapScores) -> f64 {
    let free = ros_map.cells.iter().filter(|cell| **cell == RosCell::Free).count() as f64;
    let free_area = free * ros_map.resolution * ros_map.resolution;
    scores.coverage * scores.free_area / free_area.max(f64::MIN_POSITIVE)
}

/// Warns about a trajectory in another frame than the map's, and about headings that are not those of the motion.
fn warn_of_trajectory(tracks: &[Track], frame: Pose, trajectory: &Trajectory) {
    let [as_is, aligned] =
        [&trajectory.as_is, &trajectory.aligned].map(|scores| scores.trajectory_error);
    if as_is > RIGHT.max(WRONG_FRAME * aligned) {
        warn(&format!(
            "the trajectory errs by {as_is:.2} m as it is, and by {aligned:.2} m after the alignment: check --frame and \
             --start, which are those of the map and of the trajectory"
        ));
    }
    let mut errors: Vec<f64> = Vec::new();
    for (truth, estimated) in tracks.iter().map(Track::pairs) {
        let pairs = truth.iter().zip(&estimated);
        errors.extend(pairs.map(|(a, b)| wrap_angle(a.heading - frame.compose(*b).heading).abs()));
    }
    errors.sort_by(f64::total_cmp);
    let median = errors.get(errors.len() / 2).copied().unwrap_or_default();
    if as_is <= RIGHT && median > WRONG_HEADINGS {
        warn(&format!(
            "half of the headings err by more than {:.0} degrees, although the positions are right: check the order of \
             the quaternions, which is qx qy qz qw",
            median.to_degrees()
        ));
    }
}

fn read_tum(path: &Path) -> Result<Vec<TimedPose>, Box<dyn Error>> {
    Ok(tum::read(&text_file::read(path).in_file(path)?).in_file(path)?)
}

/// The trajectories of a robot.
struct Track {
    estimated: Vec<TimedPose>,
    truth: Vec<TimedPose>,
    gaps: Gaps,
}

impl Track {
    fn new(estimated: Vec<TimedPose>, truth: Vec<TimedPose>) -> Self {
        let gaps = Gaps::of(&truth);
        Track { estimated, truth, gaps }
    }

    /// The true poses that are known at the times of estimated ones, with these.
    fn pairs(&self) -> (Vec<Pose>, Vec<Pose>) {
        let times = self.estimated.iter().map(|pose| pose.time);
        let known = tum::at_times(&self.truth, times).zip(&self.estimated);
        let known = known.filter(|(_, estimated)| !self.gaps.contain(estimated.time));
        known.filter_map(|(truth, estimated)| Some((truth?, estimated.pose))).unzip()
    }
}

/// Scores the estimated poses of each robot against the true ones at the same times. All estimates are
/// in the frame of the map.
fn score(tracks: &[Track], frame: Pose) -> Result<Trajectory, Box<dyn Error>> {
    let pairs: Vec<(Vec<Pose>, Vec<Pose>)> = tracks.iter().map(Track::pairs).collect();
    if pairs.iter().any(|(truth, _)| truth.is_empty()) {
        let error = "--trajectory and --truth have no time in common outside gaps: both need the same clock";
        return Err(error.into());
    }
    let scores = |frame: Pose| {
        // The world's own frame changes no bit.
        let moved = |poses: &Vec<Pose>| match frame {
            frame if frame == Pose::default() => poses.clone(),
            frame => poses.iter().map(|pose| frame.compose(*pose)).collect::<Vec<_>>(),
        };
        let moved: Vec<Vec<Pose>> = pairs.iter().map(|(_, estimated)| moved(estimated)).collect();
        let pairs = pairs.iter().zip(&moved);
        let pairs: Vec<_> =
            pairs.map(|((truth, _), estimated)| TrajectoryPair { truth, estimated }).collect();
        TrajectoryScores::of(&pairs)
    };
    let (truth, estimated): (Vec<Vec<Pose>>, Vec<Vec<Pose>>) = pairs.iter().cloned().unzip();
    let (truth, estimated) = (truth.concat(), estimated.concat());
    let best = alignment(&TrajectoryPair { truth: &truth, estimated: &estimated });
    let given: usize = tracks.iter().map(|track| track.estimated.len()).sum();
    Ok(Trajectory {
        poses: truth.len(),
        outside: given - truth.len(),
        as_is: scores(frame)?,
        aligned: scores(best)?,
        alignment: best,
    })
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    let Report { world, frame, map, mapping, trajectory, .. } = report;
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let metres = |distance: f64| format!("{distance:.3} m");
    let some = |distance: Option<f64>| distance.map_or("-".to_owned(), metres);
    writeln!(
        text,
        "{world}: {:.0} m^2 to map; the map's frame is at ({:.3}, {:.3}) m, {:.2} degrees\n",
        map.free_area,
        frame.position.x,
        frame.position.y,
        frame.heading.to_degrees()
    )
    .ok();
    let row = |text: &mut String, name: &str, value: String, meaning: &str| {
        writeln!(text, "{name:<22}{value:>9}  {meaning}").ok();
    };
    if let Some(mapping) = mapping {
        row(
            &mut text,
            "M  of mapping",
            format!("{mapping:.2}"),
            "walls, use, pose, coverage, from 0 to 10",
        );
    }
    row(&mut text, "coverage", percent(map.coverage), "of the reachable ground shown as free");
    row(&mut text, "wall precision", percent(map.precision_30), "within 0.30 m");
    row(&mut text, "wall recall", percent(map.recall_30), "within 0.30 m");
    row(&mut text, "wall F1", percent(map.f1_30), "within 0.30 m");
    row(&mut text, "wall F1, strict", percent(map.f1_15), "within 0.15 m");
    row(
        &mut text,
        "wall distance",
        metres(map.wall_distance),
        "mean, in both directions, cut at 1 m",
    );
    row(&mut text, "ghosting", percent(map.ghosting), "of the walls mapped twice");
    row(
        &mut text,
        "navigability",
        percent(map.navigability),
        "of 40 paths planned on the map arrive",
    );
    let Some(trajectory) = trajectory else { return text };
    writeln!(
        text,
        "\n{} poses, {} outside the true trajectory",
        trajectory.poses, trajectory.outside
    )
    .ok();
    for (of, scores) in [("as it is", trajectory.as_is), ("aligned", trajectory.aligned)] {
        writeln!(text, "{of}:").ok();
        row(&mut text, "trajectory error", metres(scores.trajectory_error), "RMSE");
        row(&mut text, "relative error", some(scores.relative_error_near), "over 1 m");
        row(&mut text, "relative error, far", some(scores.relative_error_far), "over 20 m");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use mapping_trial::mappable_area::MappableArea;

    #[test]
    fn the_narrow_robot_is_narrow_and_can_be_scored() {
        let narrow = Robot::from_ron(NARROW).expect("a robot");
        assert_eq!(narrow.circumscribed_radius, 0.16);
        MappableArea::check_robot(&narrow).expect("a size that can be scored");
    }
}
