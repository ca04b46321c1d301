//! The panel whose trials measure difficulty, and its scale.

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use envgen::calibration::Scale;
use envgen::indoor::STEP;
use envgen::located::Locate;
use envgen::text_file;
use envgen::world::Digest;
use mapping_trial::difficulty::{Anchors, Panel, reference_scale};
use mapping_trial::experiment::survey::{Condition, Record};
use mapping_trial::experiment::{Shard, policy_name};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::policy::PolicyKind;
use mapping_trial::profile::{self, named_or_read};
use mapping_trial::robot::Robot;
use mapping_trial::slam::{SlamKind, WheelCalibration};
use mapping_trial::trial::TrialSettings;

use crate::survey;
use crate::usage::Usage;
use crate::warning::{print, warn};

/// Options that replace parts of the panel.
#[derive(Args)]
#[expect(clippy::doc_markdown, reason = "help texts are not Markdown")]
pub(crate) struct PanelOptions {
    /// A RON file with a panel of your own: the conditions of the trials, in place of the reference panel.
    #[arg(long, value_name = "FILE.ron")]
    panel: Option<PathBuf>,

    /// A RON file with the robot of all conditions, such as `(length: 0.4, width: 0.4)`.
    #[arg(long, value_name = "FILE.ron")]
    robot: Option<PathBuf>,

    /// The laser of all conditions: lms200_mm, lms200_mm_rough, usarsim, urg_04lx, wide_12m, or a RON file with one
    /// such as `(beams: 360, field_of_view: 6.2657, max_range: 3.5)`.
    #[arg(long, value_name = "NAME|FILE.ron")]
    laser: Option<String>,

    /// What the wheels measure in all conditions: skid, mild, poor, exact, or a RON file with other errors.
    #[arg(long, value_name = "NAME|FILE.ron")]
    odometry: Option<String>,

    /// The estimator of poses and map in all conditions: scan_to_map, pose_graph or dead_reckoning.
    #[arg(long, value_parser = SlamKind::named)]
    slam: Option<SlamKind>,

    /// The systematic errors of the wheels that SLAM learns in all conditions: none, turns or turns_and_distances.
    #[arg(long, value_name = "ERRORS", value_parser = WheelCalibration::named)]
    wheel_calibration: Option<WheelCalibration>,

    /// The exploration policy of all conditions: nearest, info_gain, cautious, wall_follow, corridors or tour.
    #[arg(long = "policy", alias = "operator", value_parser = PolicyKind::named)]
    policy: Option<PolicyKind>,

    /// A driver program that drives in all conditions in place of the policy, such as
    /// `python3 examples/drivers/explorer.py`; docs/driver-protocol.md describes its input and output. Each trial
    /// starts the program once, and several run at the same time.
    #[arg(long, value_name = "COMMAND", conflicts_with = "policy")]
    driver: Option<String>,

    /// Simulated time per square metre that can be mapped after which each trial ends, at least 300 s in all [default: that
    /// of the panel, 2 for a robot of 0.7 m/s].
    #[arg(long, value_name = "SECONDS")]
    time_per_area: Option<f64>,

    /// The folder of the anchors' trials, which define the scale of a panel [default: a folder for each panel]. The
    /// scale of the reference panel is built in; it is measured only with this option or --anchor-seeds.
    #[arg(long, value_name = "FOLDER")]
    anchors: Option<PathBuf>,

    /// Number of trials per anchor and condition [default: 1].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000))]
    anchor_seeds: Option<u32>,
}

impl PanelOptions {
    /// The files that are read.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        let profiles = [&self.laser, &self.odometry].into_iter().flatten();
        let profiles = profiles.filter(|name| profile::is_file(name)).map(PathBuf::from);
        [&self.panel, &self.robot].into_iter().flatten().cloned().chain(profiles).collect()
    }

    /// The panel.
    pub(crate) fn panel(&self) -> Result<Panel, Box<dyn Error>> {
        let mut panel = match &self.panel {
            None => Panel::reference(),
            Some(path) => Panel::from_ron(&text_file::read(path).in_file(path)?).in_file(path)?,
        };
        let robot = self.robot.as_ref().map(|path| {
            let text = text_file::read(path).in_file(path)?;
            Ok::<_, Box<dyn Error>>((path, Robot::from_ron(&text).in_file(path)?))
        });
        if let Some((path, robot)) = robot.transpose()? {
            let file = path.file_name().unwrap_or(path.as_os_str()).display();
            change(&mut panel, &format!("robot {file}"), |one| one.robot = robot.clone());
        }
        if let Some(laser) = &self.laser {
            let profile: LaserProfile = named_or_read(laser).in_option("--laser", laser)?;
            if let Some(text) = self.slam.unwrap_or_default().doubt(&profile) {
                warn(&text);
            }
            let laser = file_name(laser);
            change(&mut panel, &format!("laser {laser}"), |one| {
                one.name = sensed_by(laser, one);
                one.laser = profile.clone();
            });
        }
        if let Some(odometry) = &self.odometry {
            let profile: OdometryProfile =
                named_or_read(odometry).in_option("--odometry", odometry)?;
            change(&mut panel, &format!("odometry {}", file_name(odometry)), |one| {
                one.odometry = profile.clone();
            });
        }
        if let Some(slam) = self.slam {
            change(&mut panel, &format!("slam {}", slam.name().unwrap_or_default()), |one| {
                one.slam = slam
            });
        }
        if let Some(errors) = self.wheel_calibration {
            let what = format!("wheel calibration {}", errors.name().unwrap_or_default());
            change(&mut panel, &what, |one| one.wheel_calibration = errors);
        }
        if let Some(policy) = self.policy {
            change(&mut panel, &format!("policy {}", policy_name(policy)), |one| {
                one.name = driven_by(policy_name(policy), one);
                (one.policy, one.driver) = (policy, None);
            });
        }
        if let Some(line) = &self.driver {
            mapping_trial::driver::command(line)
                .map_err(|error| Usage(format!("--driver {line}: {error}")))?;
            change(&mut panel, &format!("driver {line}"), |one| {
                one.name = driven_by("driver", one);
                // The policy does not drive. With the same one in all conditions, those that differed
                // in it alone become one.
                one.policy = Condition::default().policy;
                one.driver = Some(line.clone());
            });
        }
        if let Some(seconds) = self.time_per_area {
            TrialSettings { time_per_area: Some(seconds), ..Default::default() }
                .validate()
                .map_err(|error| Usage(format!("--time-per-area {seconds}: {error}")))?;
            change(&mut panel, &format!("{seconds} s/m^2"), |one| {
                one.time_per_area = Some(seconds)
            });
        }
        Ok(panel)
    }

    /// Returns the scale of a panel. Its anchors are measured if needed.
    pub(crate) fn scale(&self, panel: &Panel, threads: usize) -> Result<Scale, Box<dyn Error>> {
        let is_asked_for = self.anchors.is_some() || self.anchor_seeds.is_some();
        if *panel == Panel::reference() && !is_asked_for {
            return Ok(reference_scale().clone());
        }
        let anchors = Anchors::first();
        let survey = anchors.survey(panel, self.anchor_seeds.unwrap_or(1));
        let folder = self.anchors.clone().unwrap_or_else(|| {
            let digest = Digest::of(&survey).to_string();
            PathBuf::from("out").join(format!("anchors-{}", &digest[..12]))
        });
        let trials = survey.trials();
        print(&format!("the {trials} trials of the panel's anchors are in {}", folder.display()));
        let folder = survey::run(&survey, &folder, Shard::WHOLE, threads)?;
        for text in warnings(&anchors, panel, folder.records()) {
            warn(&text);
        }
        Ok(anchors.scale(panel, folder.records())?)
    }
}

/// Returns why the scale of a panel may be another than it seems: its robots cannot map some anchors, or
/// only parts of them.
fn warnings<'a>(
    anchors: &Anchors,
    panel: &Panel,
    records: impl IntoIterator<Item = &'a Record>,
) -> Vec<String> {
    let (failed, all) = (anchors.failed(records), anchors.survey(panel, 1).maps().count());
    let failed = (failed > 0).then(|| {
        format!(
            "trials cannot run in {failed} of the {all} anchors; the scale is that of the others"
        )
    });
    let radii = panel.conditions.iter().map(|condition| condition.robot.circumscribed_radius);
    let need = 2.0 * (radii.fold(0.0, f64::max) + STEP);
    let narrowest = anchors.narrowest_doorway().filter(|doorway| need > doorway + 1e-9);
    let narrow = narrowest.map(|doorway| {
        format!(
            "the panel's largest robot needs doorways of {need:.2} m, those of the anchors are of {doorway:.2} m: it \
             maps only a part of each hard anchor, and 10 is the difficulty of that part"
        )
    });
    failed.into_iter().chain(narrow).collect()
}

/// Changes every condition of a panel, merges those that are now the same, and adds the change to the
/// panel's name.
fn change(panel: &mut Panel, what: &str, change: impl Fn(&mut Condition)) {
    let before = panel.conditions.clone();
    panel.conditions.iter_mut().for_each(change);
    if panel.conditions == before {
        return;
    }
    panel.name = format!("{}, {what}", panel.name);
    panel.drop_repeated();
    // Other conditions may have the same name now.
    for i in 1..panel.conditions.len() {
        let (known, rest) = panel.conditions.split_at_mut(i);
        let Some(own) = rest.first_mut() else { continue };
        let is_known = |name: &String| known.iter().any(|one| one.name == *name);
        let numbered = (2..).map(|n| format!("{} ({n})", own.name));
        let mut names = std::iter::once(own.name.clone()).chain(numbered);
        own.name = names.find(|name| !is_known(name)).unwrap_or_default();
    }
}

/// Returns the name of a file without its folders, or a name as it is.
fn file_name(name: &str) -> &str {
    Path::new(name).file_name().and_then(|name| name.to_str()).unwrap_or(name)
}

/// Returns the name of a condition with another driver, which replaces the policy in the name, if it is
/// there.
fn driven_by(driver: &str, condition: &Condition) -> String {
    let policy = policy_name(condition.policy);
    match condition.name.split_once(", ") {
        _ if condition.name == policy => driver.to_owned(),
        Some((first, rest)) if first == policy => format!("{driver}, {rest}"),
        _ => format!("{driver}, {}", condition.name),
    }
}

/// Returns the name of a condition with another laser. What follows the first part of the name is
/// dropped if it refers to the laser before.
fn sensed_by(laser: &str, condition: &Condition) -> String {
    match condition.name.split_once(", ") {
        Some((first, rest))
            if OF_LASERS.contains(&rest) || Some(rest) == condition.laser.name() =>
        {
            format!("{first}, {laser}")
        }
        _ => format!("{}, {laser}", condition.name),
    }
}

/// What the conditions of the reference panel are named after, besides the policy.
const OF_LASERS: [&str; 3] = ["lms200_mm", "rough", "short"];

#[cfg(test)]
mod tests {
    use mapping_trial::score::Scores;

    use super::*;

    fn options() -> PanelOptions {
        PanelOptions {
            panel: None,
            robot: None,
            laser: None,
            odometry: None,
            slam: None,
            wheel_calibration: None,
            policy: None,
            driver: None,
            time_per_area: None,
            anchors: None,
            anchor_seeds: None,
        }
    }

    fn names(options: &PanelOptions) -> (String, Vec<String>) {
        let panel = options.panel().expect("a panel");
        (panel.name, panel.conditions.into_iter().map(|one| one.name).collect())
    }

    #[test]
    fn panels_are_named_by_what_changed() {
        let reference = Panel::reference();
        let unchanged = PanelOptions { slam: Some(SlamKind::ScanToMap), ..options() };
        assert_eq!(unchanged.panel().expect("a panel"), reference);
        let folder = tempfile::tempdir().expect("a folder");
        let robot = folder.path().join("small.ron");
        std::fs::write(&robot, "(length: 0.4, width: 0.4)").expect("a file");
        let changed = PanelOptions {
            robot: Some(robot),
            laser: Some("wide_12m".to_owned()),
            slam: Some(SlamKind::PoseGraph),
            ..options()
        };
        let name = "reference, robot small.ron, laser wide_12m, slam pose_graph";
        assert_eq!(names(&changed).0, name);
    }

    #[test]
    fn anchors_that_a_robot_cannot_map_are_a_warning() {
        let (anchors, mut panel) = (Anchors::first(), Panel::reference());
        let scores = |map| Record { map, scores: Some(Scores::default()), ..Record::default() };
        let records = [scores(0), scores(20)];
        assert_eq!(warnings(&anchors, &panel, &records), [""; 0]);
        panel.conditions[2].robot.circumscribed_radius = 0.36;
        assert_eq!(warnings(&anchors, &panel, &records), [""; 0]);
        panel.conditions[2].robot.circumscribed_radius = 0.814;
        let failed = Record { map: 39, failure: Some("no room".to_owned()), ..Record::default() };
        let found = warnings(&anchors, &panel, &[scores(0), failed]);
        assert_eq!(found.len(), 2);
        assert_eq!(
            found[0],
            "trials cannot run in 1 of the 40 anchors; the scale is that of the others"
        );
        let narrow = "the panel's largest robot needs doorways of 1.73 m, those of the anchors are of 0.82 m";
        assert!(found[1].starts_with(narrow), "{found:?}");
    }

    #[test]
    fn conditions_are_named_after_what_drives() {
        let corridors = PanelOptions { policy: Some(PolicyKind::Corridors), ..options() };
        let three = |who: &str| ["lms200_mm", "rough", "short"].map(|x| format!("{who}, {x}"));
        let (name, conditions) = names(&corridors);
        assert_eq!(
            (name.as_str(), &conditions[..]),
            ("reference, policy corridors", &three("corridors")[..])
        );
        let driver = PanelOptions { driver: Some("sh mine.sh".to_owned()), ..options() };
        let (name, conditions) = names(&driver);
        assert_eq!(
            (name.as_str(), &conditions[..]),
            ("reference, driver sh mine.sh", &three("driver")[..])
        );
        let laser = PanelOptions { laser: Some("urg_04lx".to_owned()), ..options() };
        let (_, conditions) = names(&laser);
        assert!(conditions.contains(&"nearest, urg_04lx".to_owned()), "{conditions:?}");
        assert!(!conditions.iter().any(|name| name.contains("lms200_mm")), "{conditions:?}");
        // Names of your own stay in those of before, and are never the same.
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("panel.ron");
        let conditions = "(name: \"nearest, a\"), (name: \"cautious, a\", policy: cautious, time_limit: 9), \
                          (name: \"b\", time_limit: 7)";
        let text = format!("(name: \"mine\", version: 1, conditions: [{conditions}])");
        std::fs::write(&file, text).expect("a file");
        let mine = PanelOptions { panel: Some(file), ..corridors };
        let (name, conditions) = names(&mine);
        assert_eq!(name, "mine, policy corridors");
        assert_eq!(conditions, ["corridors, a", "corridors, a (2)", "corridors, b"]);
    }
}
