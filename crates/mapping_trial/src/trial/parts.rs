//! The parts of a trial that are not built in: estimators, policies and sensors of one's own.

use std::sync::Arc;

use envgen::geometry::Pose;
use serde::{Deserialize, Serialize};

use super::TrialSettings;
use crate::backend::Sensors;
use crate::lidar::LaserSensor;
use crate::odometry::WheelSensor;
use crate::policy::{self, ExplorationPolicy};
use crate::slam::Slam;

/// What a part may know when it is made.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The robot, its laser and wheels, the time limit and the seed.
    pub settings: &'a TrialSettings,
    /// Where the robots start, in the map's frame.
    pub starts: &'a [Pose],
}

/// What a part of a trial does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PartRole {
    /// Estimates poses and the map.
    Slam,
    /// Decides where to go.
    #[serde(rename = "operator", alias = "policy")]
    Policy,
    /// Turns exact ranges into scans.
    Laser,
    /// Turns motions into odometry.
    Odometry,
}

impl PartRole {
    /// The role in words.
    pub fn text(self) -> &'static str {
        match self {
            PartRole::Slam => "SLAM",
            PartRole::Policy => "policy",
            PartRole::Laser => "laser",
            PartRole::Odometry => "odometry",
        }
    }
}

/// A part that was plugged in, as logs and reports name it: nobody but its author can make it again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForeignPart {
    /// What it does.
    pub role: PartRole,
    /// What it calls itself.
    pub name: String,
}

/// A maker of one part.
type Make<T> = Arc<dyn Fn(&Setup<'_>) -> Box<T> + Send + Sync>;

/// A maker of one part for the robot of a number.
type MakeEach<T> = Arc<dyn Fn(&Setup<'_>, usize) -> Box<T> + Send + Sync>;

/// Makers of the parts that take the place of built-in ones, for any number of trials.
#[derive(Clone, Default)]
pub struct TrialParts {
    slam: Option<Make<dyn Slam + Send + Sync>>,
    operator: Option<Make<dyn ExplorationPolicy + Send + Sync>>,
    laser: Option<MakeEach<dyn LaserSensor + Send + Sync>>,
    odometry: Option<MakeEach<dyn WheelSensor + Send + Sync>>,
}

impl TrialParts {
    /// With an estimator that `make` makes, in place of the settings' own.
    #[must_use]
    pub fn slam<S: Slam + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>) -> S + Send + Sync + 'static,
    ) -> Self {
        self.slam = Some(Arc::new(move |setup| Box::new(make(setup))));
        self
    }

    /// With an operator that `make` makes, in place of the settings' own.
    #[must_use]
    pub fn policy<O: ExplorationPolicy + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>) -> O + Send + Sync + 'static,
    ) -> Self {
        self.operator = Some(Arc::new(move |setup| Box::new(make(setup))));
        self
    }

    /// With a laser that `make` makes for the robot of a number, in place of the settings' own error
    /// model.
    #[must_use]
    pub fn laser<L: LaserSensor + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>, usize) -> L + Send + Sync + 'static,
    ) -> Self {
        self.laser = Some(Arc::new(move |setup, robot| Box::new(make(setup, robot))));
        self
    }

    /// With wheels that `make` makes for the robot of a number, in place of the settings' own error
    /// model.
    #[must_use]
    pub fn odometry<W: WheelSensor + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>, usize) -> W + Send + Sync + 'static,
    ) -> Self {
        self.odometry = Some(Arc::new(move |setup, robot| Box::new(make(setup, robot))));
        self
    }

    /// Whether a role is taken by a part that is not built in.
    pub fn has(&self, role: PartRole) -> bool {
        match role {
            PartRole::Slam => self.slam.is_some(),
            PartRole::Policy => self.operator.is_some(),
            PartRole::Laser => self.laser.is_some(),
            PartRole::Odometry => self.odometry.is_some(),
        }
    }

    /// The sensors of the robot of a number: those plugged in, else the built-in ones.
    pub(super) fn make_sensors(&self, setup: &Setup<'_>, robot: usize) -> Sensors {
        let TrialSettings { laser, odometry, seed, .. } = setup.settings;
        let mut sensors = Sensors::new(laser, odometry, *seed, robot as u64);
        if let Some(make) = &self.laser {
            sensors.laser = make(setup, robot);
        }
        if let Some(make) = &self.odometry {
            sensors.odometry = make(setup, robot);
        }
        sensors
    }

    pub(super) fn make_slam(&self, setup: &Setup<'_>) -> Box<dyn Slam + Send + Sync> {
        let TrialSettings { slam, body, laser, .. } = setup.settings;
        match &self.slam {
            Some(make) => make(setup),
            None => slam.build(setup.starts, body, laser),
        }
    }

    pub(super) fn make_operator(
        &self,
        setup: &Setup<'_>,
    ) -> Option<Box<dyn ExplorationPolicy + Send + Sync>> {
        let TrialSettings { operator, body, laser, .. } = setup.settings;
        let built_in = || operator.map(|kind| policy::build(kind, setup.starts.len(), body, laser));
        self.operator.as_ref().map_or_else(built_in, |make| Some(make(setup)))
    }

    /// The names of what was plugged in; robots have equal sensors.
    pub(super) fn foreign(
        &self,
        slam: &dyn Slam,
        operator: Option<&dyn ExplorationPolicy>,
        sensors: &[Sensors],
    ) -> Vec<ForeignPart> {
        let mut parts = Vec::new();
        let mut add = |role, name: &str| {
            if self.has(role) {
                parts.push(ForeignPart { role, name: name.to_owned() });
            }
        };
        add(PartRole::Slam, slam.name());
        add(PartRole::Policy, operator.map_or("", ExplorationPolicy::name));
        if let Some(Sensors { laser, odometry }) = sensors.first() {
            add(PartRole::Laser, laser.name());
            add(PartRole::Odometry, odometry.name());
        }
        parts
    }
}
