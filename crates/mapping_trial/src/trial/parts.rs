//! Custom parts of a trial: estimators, policies and sensors that are not built in.

use std::sync::Arc;

use envgen::geometry::{Pose, Rect};
use envgen::scenario::ScenarioState;
use serde::{Deserialize, Serialize};

use super::{TrialObserver, TrialSettings};
use crate::backend::Sensors;
use crate::lidar::LaserSensor;
use crate::odometry::WheelSensor;
use crate::policy::ExplorationPolicy;
use crate::slam::Slam;

/// What a part gets to know when it is made.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The robot, its laser and wheels, the time limit and the seed.
    pub settings: &'a TrialSettings,
    /// The poses where the robots start, in the map's frame.
    pub starts: &'a [Pose],
    /// The area to map, in the map's frame: the bounds of the world.
    pub area: Rect,
    /// Whether there are doors that open and close: what looks like a wall may be a closed door.
    pub doors: bool,
    /// The doors, people and smoke at the start, for the robot backend only; `None` if nothing moves.
    pub scenario: Option<&'a ScenarioState>,
}

/// The role of a part in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PartRole {
    /// Estimates the poses and the map.
    Slam,
    /// Decides where the robots go.
    #[serde(rename = "operator", alias = "policy")]
    Policy,
    /// Turns exact ranges into scans.
    Laser,
    /// Turns motions into odometry.
    Odometry,
}

impl PartRole {
    /// Returns the role in words.
    pub fn text(self) -> &'static str {
        match self {
            PartRole::Slam => "SLAM",
            PartRole::Policy => "policy",
            PartRole::Laser => "laser",
            PartRole::Odometry => "odometry",
        }
    }
}

/// A custom part as logs and reports name it. They cannot make the part again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForeignPart {
    /// Its role.
    pub role: PartRole,
    /// Its name, as returned by the part.
    pub name: String,
}

/// A function that makes one part.
type Make<T> = Arc<dyn Fn(&Setup<'_>) -> Box<T> + Send + Sync>;

/// A function that makes one part per robot, given the robot's number.
type MakeEach<T> = Arc<dyn Fn(&Setup<'_>, usize) -> Box<T> + Send + Sync>;

/// Functions that make the custom parts of a trial, and an observer, for any number of trials.
#[derive(Clone, Default)]
pub struct TrialParts {
    slam: Option<Make<dyn Slam + Send + Sync>>,
    policy: Option<Make<dyn ExplorationPolicy + Send + Sync>>,
    laser: Option<MakeEach<dyn LaserSensor + Send + Sync>>,
    odometry: Option<MakeEach<dyn WheelSensor + Send + Sync>>,
    observer: Option<Make<dyn TrialObserver + Send + Sync>>,
}

impl TrialParts {
    /// Makes the estimator with `make`, in place of the one of the settings.
    #[must_use]
    pub fn slam<S: Slam + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>) -> S + Send + Sync + 'static,
    ) -> Self {
        self.slam = Some(Arc::new(move |setup| Box::new(make(setup))));
        self
    }

    /// Makes the policy with `make`, in place of the one of the settings.
    #[must_use]
    pub fn policy<O: ExplorationPolicy + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>) -> O + Send + Sync + 'static,
    ) -> Self {
        self.policy = Some(Arc::new(move |setup| Box::new(make(setup))));
        self
    }

    /// Makes the laser of each robot with `make`, given the robot's number (from 0), in place of the
    /// error model of the settings.
    #[must_use]
    pub fn laser<L: LaserSensor + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>, usize) -> L + Send + Sync + 'static,
    ) -> Self {
        self.laser = Some(Arc::new(move |setup, robot| Box::new(make(setup, robot))));
        self
    }

    /// Makes the wheel sensor of each robot with `make`, given the robot's number (from 0), in place of
    /// the error model of the settings.
    #[must_use]
    pub fn odometry<W: WheelSensor + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>, usize) -> W + Send + Sync + 'static,
    ) -> Self {
        self.odometry = Some(Arc::new(move |setup, robot| Box::new(make(setup, robot))));
        self
    }

    /// Makes an observer of the trial with `make`. Logs and reports do not name it, since it changes
    /// nothing.
    #[must_use]
    pub fn observer<O: TrialObserver + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>) -> O + Send + Sync + 'static,
    ) -> Self {
        self.observer = Some(Arc::new(move |setup| Box::new(make(setup))));
        self
    }

    /// Returns whether a custom part is plugged in for a role.
    pub fn has(&self, role: PartRole) -> bool {
        match role {
            PartRole::Slam => self.slam.is_some(),
            PartRole::Policy => self.policy.is_some(),
            PartRole::Laser => self.laser.is_some(),
            PartRole::Odometry => self.odometry.is_some(),
        }
    }

    /// Makes the sensors of a robot, given its number: those plugged in, or else the built-in ones.
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
        let TrialSettings { slam, wheel_calibration, body, laser, .. } = setup.settings;
        match &self.slam {
            Some(make) => make(setup),
            None => slam.build(setup.starts, body, laser, *wheel_calibration),
        }
    }

    pub(super) fn make_policy(
        &self,
        setup: &Setup<'_>,
    ) -> Option<Box<dyn ExplorationPolicy + Send + Sync>> {
        let TrialSettings { policy, body, laser, .. } = setup.settings;
        let built_in =
            || policy.map(|kind| crate::policy::build(kind, setup.starts.len(), body, laser));
        self.policy.as_ref().map_or_else(built_in, |make| Some(make(setup)))
    }

    pub(super) fn make_observer(
        &self,
        setup: &Setup<'_>,
    ) -> Option<Box<dyn TrialObserver + Send + Sync>> {
        self.observer.as_ref().map(|make| make(setup))
    }

    /// Returns the names of the plugged-in parts. All robots have equal sensors.
    pub(super) fn foreign(
        &self,
        slam: &dyn Slam,
        policy: Option<&dyn ExplorationPolicy>,
        sensors: &[Sensors],
    ) -> Vec<ForeignPart> {
        let mut parts = Vec::new();
        let mut add = |role, name: &str| {
            if self.has(role) {
                parts.push(ForeignPart { role, name: name.to_owned() });
            }
        };
        add(PartRole::Slam, slam.name());
        add(PartRole::Policy, policy.map_or("", ExplorationPolicy::name));
        if let Some(Sensors { laser, odometry }) = sensors.first() {
            add(PartRole::Laser, laser.name());
            add(PartRole::Odometry, odometry.name());
        }
        parts
    }
}
