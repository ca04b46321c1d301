//! The files that a trial writes. Each is written as a whole or not at all.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use envgen::located::Locate;
use envgen::whole_file::{self, WholeFile, commit_all};
use mapping_trial::backend::RobotBackend;
use mapping_trial::picture::Picture;
use mapping_trial::score::{Reference, Scores};
use mapping_trial::trial::{Trial, TrialReport};

/// Returns the output folder, which is created if needed. Errors are reported before the trial runs, so
/// that no trial is lost.
pub(crate) fn folder(path: &Path) -> Result<&Path, Box<dyn Error>> {
    whole_file::create_folder(path).in_option("--out", path.display())?;
    Ok(path)
}

/// The files that a trial writes: pictures of the map, of the mappable area and of the errors, the map
/// for ROS, the log and the report.
pub(crate) const FILES: [&str; 7] = [
    "map.png",
    "truth.png",
    "overlay.png",
    "ros_map.yaml",
    "ros_map.pgm",
    "log.json",
    "report.json",
];

/// Writes all [`FILES`], or none if one cannot be written.
pub(crate) fn write<B: RobotBackend>(
    folder: &Path,
    trial: &Trial<B>,
    truth: &Reference,
    report: &TrialReport,
) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let slam = trial.autonomy().slam();
    let map = slam.map();
    let area = map.bounds().map_or(truth.frame().area(), |seen| seen.union(truth.frame().area()));
    let notes = notes(report);
    let picture = |mut picture: Picture, of: &str, truly: bool, estimated: bool| {
        for robot in 0..trial.robots() {
            if truly {
                picture.draw_true_path(&trial.trajectory(robot).poses);
            }
            if estimated {
                picture.draw_estimated_path(&slam.trajectory(robot));
            }
        }
        let mut bytes = Vec::new();
        let title = format!("{of}, {}", report.world.name());
        let figure = picture.figure(&title, notes.clone());
        figure.write_png(&mut bytes).map(|()| bytes)
    };
    let mut log = Vec::new();
    trial.log().write(&mut log)?;
    let mut json = serde_json::to_vec_pretty(report)?;
    json.push(b'\n');
    let ros = map.to_ros_map()?;
    let (mut ros_yaml, mut ros_image) = (Vec::new(), Vec::new());
    ros.write_yaml("ros_map.pgm", &mut ros_yaml)?;
    ros.write_pgm(&mut ros_image)?;
    let contents = [
        picture(Picture::of_map(map, area), "map", false, true)?,
        picture(Picture::of_truth(truth, area), "mappable area", true, false)?,
        picture(Picture::of_errors(truth, map, area), "map over the mappable area", true, true)?,
        ros_yaml,
        ros_image,
        log,
        json,
    ];
    let paths = FILES.map(|name| folder.join(name));
    let mut files = Vec::new();
    for (path, bytes) in paths.iter().zip(contents) {
        let mut file = WholeFile::create(path).in_file(path)?;
        file.write_all(&bytes).in_file(path)?;
        files.push(file);
    }
    commit_all(files)?;
    Ok(paths.to_vec())
}

/// Returns the notes below the pictures: settings that differ from the defaults, and the scores.
fn notes(report: &TrialReport) -> Vec<String> {
    let Scores { difficulty, mapping, navigation, coverage, f1_30, time, distance, .. } =
        report.scores;
    let scores =
        format!("difficulty {difficulty:.2}, mapping {mapping:.2}, navigation {navigation:.2}");
    let map = format!(
        "coverage {:.1} %, F1 {f1_30:.2}; {distance:.0} m in {time:.0} s",
        100.0 * coverage
    );
    let mut notes = vec![report.world.changed_settings(), scores, map];
    notes.retain(|note| !note.is_empty());
    notes
}
