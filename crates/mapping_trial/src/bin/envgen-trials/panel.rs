//! The panel that drives, and its scale.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use envgen::calibration::Scale;
use envgen::located::Locate;
use envgen::world::Digest;
use mapping_trial::difficulty::{Anchors, Panel, reference_scale};
use mapping_trial::experiment::Shard;
use mapping_trial::experiment::survey::Condition;
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;
use mapping_trial::robot::Robot;
use mapping_trial::slam::{SlamKind, WheelCalibration};

use crate::survey;

/// Options that replace parts of the panel.
#[derive(Args)]
#[expect(clippy::doc_markdown, reason = "help texts are not Markdown")]
pub(crate) struct PanelOptions {
    /// A panel of your own, in RON.
    #[arg(long, value_name = "FILE.ron")]
    panel: Option<PathBuf>,

    /// The robot of all conditions, in RON, such as `(length: 0.4, width: 0.4)`.
    #[arg(long, value_name = "FILE.ron")]
    robot: Option<PathBuf>,

    /// The laser of all conditions.
    #[arg(long, value_name = "NAME")]
    laser: Option<String>,

    /// How poses and map are estimated in all conditions: scan_to_map, pose_graph or dead_reckoning.
    #[arg(long, value_parser = SlamKind::named)]
    slam: Option<SlamKind>,

    /// Which systematic errors of the wheels are learned in all conditions: none, turns or turns_and_distances.
    #[arg(long, value_name = "ERRORS", value_parser = WheelCalibration::named)]
    wheel_calibration: Option<WheelCalibration>,

    /// The only policy that drives: nearest, info_gain, cautious, wall_follow or corridors.
    #[arg(long = "policy", alias = "operator", value_parser = PolicyKind::named)]
    policy: Option<PolicyKind>,

    /// A program of your own that drives in all conditions in place of the policy, such as
    /// `python3 examples/drivers/explorer.py`: docs/driver-protocol.md describes the lines that it reads and writes.
    /// One is started for each trial, several at once.
    #[arg(long, value_name = "COMMAND", conflicts_with = "policy")]
    driver: Option<String>,

    /// The folder of the anchors' trials, which make the scale of a panel that is not the reference; a panel
    /// has a folder of its own if none is given.
    #[arg(long, value_name = "FOLDER")]
    anchors: Option<PathBuf>,

    /// Trials per anchor and condition.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    anchor_seeds: u32,
}

impl PanelOptions {
    /// The files that are read.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        [&self.panel, &self.robot].into_iter().flatten().cloned().collect()
    }

    /// The panel.
    pub(crate) fn panel(&self) -> Result<Panel, Box<dyn Error>> {
        let mut panel = match &self.panel {
            None => Panel::reference(),
            Some(path) => {
                Panel::from_ron(&std::fs::read_to_string(path).in_file(path)?).in_file(path)?
            }
        };
        let before = panel.conditions.clone();
        if let Some(path) = &self.robot {
            let robot =
                Robot::from_ron(&std::fs::read_to_string(path).in_file(path)?).in_file(path)?;
            panel.conditions.iter_mut().for_each(|one| one.robot = robot.clone());
        }
        if let Some(laser) = &self.laser {
            LaserProfile::named(laser).in_option("--laser", laser)?;
            panel.conditions.iter_mut().for_each(|one| one.laser.clone_from(laser));
        }
        for condition in &mut panel.conditions {
            condition.slam = self.slam.unwrap_or(condition.slam);
            condition.wheel_calibration =
                self.wheel_calibration.unwrap_or(condition.wheel_calibration);
            condition.policy = self.policy.unwrap_or(condition.policy);
        }
        if let Some(line) = &self.driver {
            mapping_trial::driver::command(line).in_option("--driver", line)?;
            for condition in &mut panel.conditions {
                // The policy does not drive: with one for all, conditions that differ by it alone are one.
                condition.policy = Condition::default().policy;
                condition.driver = Some(line.clone());
            }
        }
        if panel.conditions != before {
            panel.name = format!("{}, changed", panel.name);
            panel.drop_repeated();
        }
        Ok(panel)
    }

    /// The scale of a panel, whose anchors are measured if need be.
    pub(crate) fn scale(&self, panel: &Panel, threads: usize) -> Result<Scale, Box<dyn Error>> {
        if *panel == Panel::reference() && self.anchors.is_none() {
            return Ok(reference_scale().clone());
        }
        let anchors = Anchors::first();
        let survey = anchors.survey(panel, self.anchor_seeds);
        let folder = self.anchors.clone().unwrap_or_else(|| {
            let digest = Digest::of(&survey).to_string();
            PathBuf::from("out").join(format!("anchors-{}", &digest[..12]))
        });
        let folder = survey::run(&survey, &folder, Shard::WHOLE, threads)?;
        Ok(anchors.scale(panel, folder.records())?)
    }
}
