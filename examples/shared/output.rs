//! The files that a trial leaves. Each appears whole or not at all.

use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use atomic_write_file::AtomicWriteFile;
use mapping_trial::body::Bodies;
use mapping_trial::picture::Picture;
use mapping_trial::trial::{Trial, TrialReport};
use mapping_trial::truth::Truth;

/// The folder to write into, made if need be. Said before the trial runs, so that none is lost.
pub(crate) fn folder(path: &Path) -> Result<&Path, Box<dyn Error>> {
    let of_folder = |error: std::io::Error| format!("--out {}: {error}", path.display());
    fs::create_dir_all(path).map_err(of_folder)?;
    AtomicWriteFile::open(path.join("trial"))
        .and_then(AtomicWriteFile::discard)
        .map_err(of_folder)?;
    Ok(path)
}

/// Writes a file, which appears whole or not at all.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = AtomicWriteFile::open(path)?;
    file.write_all(bytes)?;
    file.commit()
}

/// Writes map, truth and errors as pictures, the map for ROS, the log and the report.
pub(crate) fn write<B: Bodies>(
    folder: &Path,
    trial: &Trial<B>,
    truth: &Truth,
    report: &TrialReport,
) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let slam = trial.brain().slam();
    let map = slam.map();
    let area = map.bounds().map_or(truth.frame().area(), |seen| seen.union(truth.frame().area()));
    let picture = |mut picture: Picture, truly: bool, estimated: bool| {
        for robot in 0..trial.robots() {
            if truly {
                picture.draw_true_path(&trial.track(robot).poses);
            }
            if estimated {
                picture.draw_estimated_path(&slam.trajectory(robot));
            }
        }
        let mut bytes = Vec::new();
        picture.write_png(&mut bytes).map(|()| bytes)
    };
    let mut log = Vec::new();
    trial.log().write(&mut log)?;
    let mut json = serde_json::to_vec_pretty(report)?;
    json.push(b'\n');
    let ros = map.to_ros_map()?;
    let (mut ros_yaml, mut ros_image) = (Vec::new(), Vec::new());
    ros.write_yaml("ros_map.pgm", &mut ros_yaml)?;
    ros.write_pgm(&mut ros_image)?;
    let files = [
        ("map.png", picture(Picture::of_map(map, area), false, true)?),
        ("truth.png", picture(Picture::of_truth(truth, area), true, false)?),
        ("overlay.png", picture(Picture::of_errors(truth, map, area), true, true)?),
        ("ros_map.yaml", ros_yaml),
        ("ros_map.pgm", ros_image),
        ("log.json", log),
        ("report.json", json),
    ];
    let mut paths = Vec::new();
    for (name, bytes) in files {
        let path = folder.join(name);
        write_whole(&path, &bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        paths.push(path);
    }
    Ok(paths)
}
