//! The builder of trials.

use std::sync::Arc;

use envgen::World;
use envgen::geometry::Pose;
use envgen::scenario::{Scenario, ScenarioState};
use envgen::world::Digest;
use glam::DVec2;

use super::clock::Clock;
use super::command_log::CommandLog;
use super::error::TrialError;
use super::log_world::LogWorld;
use super::parts::{PartRole, Setup, TrialParts};
use super::running::{Trajectory, Trial};
use super::settings::TrialSettings;
use super::start::{Moving, starts};
use crate::autonomy::Autonomy;
use crate::backend::{RobotBackend, Sensors};
use crate::flat::{FlatSimulator, FlatWorld};
use crate::lidar::LaserSensor;
use crate::mappable_area::MappableArea;
use crate::odometry::WheelSensor;
use crate::policy::ExplorationPolicy;
use crate::robot::Robot;
use crate::score::{Reference, SweptCells};
use crate::slam::Slam;

/// Builds a trial from settings and parts. Parts that are not plugged in are made from the settings.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::backend::Command;
/// use mapping_trial::policy::{Decision, ExplorationPolicy, PolicyInput};
/// use mapping_trial::trial::{Trial, TrialSettings};
///
/// /// Drives ahead until it touches something.
/// struct Ahead;
///
/// impl ExplorationPolicy for Ahead {
///     fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
///         if view.seen.bumped {
///             return Decision::Finished;
///         }
///         Decision::Drive(Command { speed: 0.5, turn_rate: 0.0 })
///     }
/// }
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let settings = TrialSettings { time_limit: 60.0, ..Default::default() };
/// let mut trial = Trial::builder(&world, settings).policy(|_| Ahead).build_flat()?;
/// while trial.step() {}
/// let scores = trial.score(&trial.reference(&world)?)?;
/// assert!(scores.coverage > 0.1 && scores.collisions == 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct TrialBuilder<'w> {
    world: &'w World,
    settings: TrialSettings,
    parts: TrialParts,
    /// The poses where the robots start, once they are known.
    starts: Vec<Pose>,
    /// Area in square metres that can be mapped, if it is known.
    area: Option<f64>,
    /// The area in square metres that a robot can map from a position, once it is measured.
    measured: Option<(Robot, DVec2, f64)>,
    source: Option<LogWorld>,
    scenario: Option<Scenario>,
    /// The state of the scenario at its start, once it is known.
    state: Option<ScenarioState>,
}

impl<'w> TrialBuilder<'w> {
    /// Creates a builder for a trial with these settings in a world.
    pub fn new(world: &'w World, settings: TrialSettings) -> Self {
        TrialBuilder {
            world,
            settings,
            parts: TrialParts::default(),
            starts: Vec::new(),
            area: None,
            measured: None,
            source: None,
            scenario: None,
            state: None,
        }
    }

    /// Adds doors, people and smoke. A custom backend gets them in [`Setup::scenario`], and returns
    /// their state from [`RobotBackend::scenario`].
    #[must_use]
    pub fn scenario(mut self, scenario: Scenario) -> Self {
        (self.scenario, self.state) = (Some(scenario), None);
        self
    }

    /// Plugs in a custom SLAM estimator.
    #[must_use]
    pub fn slam<S: Slam + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>) -> S + Send + Sync + 'static,
    ) -> Self {
        self.parts = self.parts.slam(make);
        self
    }

    /// Plugs in a custom policy in place of the one of the settings.
    #[must_use]
    pub fn policy<O: ExplorationPolicy + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>) -> O + Send + Sync + 'static,
    ) -> Self {
        self.parts = self.parts.policy(make);
        self
    }

    /// Plugs in a custom laser. `make` is called for each robot; its second argument is the robot's
    /// number, from 0.
    #[must_use]
    pub fn laser<L: LaserSensor + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>, usize) -> L + Send + Sync + 'static,
    ) -> Self {
        self.parts = self.parts.laser(make);
        self
    }

    /// Plugs in a custom wheel sensor. `make` is called for each robot; its second argument is the
    /// robot's number, from 0.
    #[must_use]
    pub fn odometry<W: WheelSensor + Send + Sync + 'static>(
        mut self,
        make: impl Fn(&Setup<'_>, usize) -> W + Send + Sync + 'static,
    ) -> Self {
        self.parts = self.parts.odometry(make);
        self
    }

    /// Uses all these parts in place of those plugged in before.
    #[must_use]
    pub fn parts(mut self, parts: TrialParts) -> Self {
        self.parts = parts;
        self
    }

    /// Sets a known reference for this world, robot and start. If the time limit depends on the area,
    /// this saves the computation of the area.
    #[must_use]
    pub fn reference(mut self, reference: &Reference) -> Self {
        self.area = Some(reference.free_area());
        self
    }

    /// Sets the source of the world, if it is known. Otherwise a world with provenance is generated
    /// again, to check whether the provenance still holds.
    #[must_use]
    pub fn source(mut self, source: LogWorld) -> Self {
        self.source = Some(source);
        self
    }

    /// Changes the settings.
    #[must_use]
    pub fn settings(mut self, change: impl FnOnce(&mut TrialSettings)) -> Self {
        change(&mut self.settings);
        self
    }

    /// Returns what the trial's parts get, for parts that need it before they are made: the settings
    /// with the time limit in effect, the poses where the robots start, and the area to map.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    /// use mapping_trial::trial::{MIN_TIME_BY_AREA, TrialBuilder, TrialSettings};
    ///
    /// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
    /// // 2 s per square metre, but at least 300 s.
    /// let settings = TrialSettings { time_per_area: Some(2.0), ..Default::default() };
    /// let mut builder = TrialBuilder::new(&world, settings);
    /// let setup = builder.setup()?;
    /// assert_eq!(setup.settings.time_limit, MIN_TIME_BY_AREA);
    /// assert_eq!((setup.starts.len(), setup.area), (1, world.bounds));
    /// # Ok::<(), mapping_trial::trial::TrialError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`TrialBuilder::build_flat`].
    pub fn setup(&mut self) -> Result<Setup<'_>, TrialError> {
        self.settings.validate()?;
        let start = self.settings.start.or(self.world.start).ok_or(TrialError::NoStart)?;
        let TrialSettings { robots, body, .. } = &self.settings;
        let moving = match &self.scenario {
            Some(scenario) => {
                let state = match self.state.take() {
                    Some(state) => state,
                    None => {
                        MappableArea::check_size(self.world)?;
                        ScenarioState::new(self.world, scenario)?
                    }
                };
                Moving::new(&scenario.people, self.state.insert(state))
            }
            None => Moving::default(),
        };
        self.starts = starts(self.world, start, *robots, body, &moving)?;
        if self.settings.time_per_area.is_some() {
            let area = self.area(self.starts[0])?;
            self.settings.limit_time(area);
        }
        let TrialBuilder { settings, starts, world, scenario, .. } = self;
        let doors = has_doors(scenario.as_ref());
        Ok(Setup { settings, starts, area: world.bounds, doors, scenario: None })
    }

    /// The area in square metres that can be mapped from a start: that of the reference, or else
    /// measured once for a robot and a start.
    fn area(&mut self, start: Pose) -> Result<f64, TrialError> {
        if let Some(known) = self.area {
            return Ok(known);
        }
        // The area may raise the charge of the battery, but the charge does not change the area.
        let body = Robot { battery: 1.0, ..self.settings.body.clone() };
        let found = match self.measured.take() {
            Some(found) if (&found.0, found.1) == (&body, start.position) => found,
            _ => {
                let area = MappableArea::from_start(self.world, &body, start.position)?;
                (body, start.position, area.free_area())
            }
        };
        let area = found.2;
        self.measured = Some(found);
        Ok(area)
    }

    /// Builds a trial in the flat simulator.
    ///
    /// # Errors
    ///
    /// If a setting is not allowed, or if a start is missing or not free.
    pub fn build_flat(self) -> Result<Trial<FlatSimulator>, TrialError> {
        self.settings.validate()?;
        let flat = Arc::new(FlatWorld::new(self.world, &self.settings.body)?);
        let digest = flat.digest();
        self.place_flat(flat, digest)
    }

    /// Builds a trial in a world that is already indexed, for many trials in one world.
    ///
    /// # Errors
    ///
    /// As [`TrialBuilder::build_flat`], and if the world was not indexed from this world for a robot such
    /// as this one (see [`FlatWorld::check_robot`]).
    pub fn build_flat_in(self, flat: Arc<FlatWorld>) -> Result<Trial<FlatSimulator>, TrialError> {
        self.settings.validate()?;
        flat.check_robot(&self.settings.body)?;
        let (digest, indexed) = (self.world.digest(), flat.digest());
        if indexed != digest {
            let (expected, found) = (digest.to_string(), indexed.to_string());
            return Err(TrialError::OtherFlatWorld { expected, found });
        }
        self.place_flat(flat, digest)
    }

    /// Builds a trial in the world with a digest, which is indexed for its robot.
    fn place_flat(
        self,
        flat: Arc<FlatWorld>,
        digest: Digest,
    ) -> Result<Trial<FlatSimulator>, TrialError> {
        self.build_in(digest, |setup, sensors| {
            let TrialSettings { body, laser, .. } = setup.settings;
            let robots = FlatSimulator::with_sensors(flat, body, setup.starts, laser, sensors);
            match setup.scenario {
                Some(state) => robots.in_scenario(state.clone(), setup.settings.seed),
                None => robots,
            }
        })
    }

    /// Builds a trial with a custom robot backend. `place` creates the backend from the setup with the
    /// starts and from the sensors of each robot.
    ///
    /// # Errors
    ///
    /// As [`TrialBuilder::build_flat`].
    pub fn build<B: RobotBackend>(
        self,
        place: impl FnOnce(&Setup<'_>, Vec<Sensors>) -> B,
    ) -> Result<Trial<B>, TrialError> {
        let digest = self.world.digest();
        self.build_in(digest, place)
    }

    /// Builds a trial with a custom robot backend in the world with a digest, which takes long to compute in
    /// large worlds.
    fn build_in<B: RobotBackend>(
        mut self,
        digest: Digest,
        place: impl FnOnce(&Setup<'_>, Vec<Sensors>) -> B,
    ) -> Result<Trial<B>, TrialError> {
        self.setup()?;
        let TrialBuilder { world, parts, settings, starts, source, scenario, state, .. } =
            &mut self;
        let doors = has_doors(scenario.as_ref());
        let setup = Setup { settings, starts, area: world.bounds, doors, scenario: state.as_ref() };
        // Robots know that there are doors, but not where they are, nor what else moves.
        let blind = Setup { scenario: None, ..setup };
        let slam = parts.make_slam(&blind);
        let policy = parts.make_policy(&blind);
        let observer = parts.make_observer(&blind);
        let sensors: Vec<Sensors> =
            (0..starts.len()).map(|robot| parts.make_sensors(&blind, robot)).collect();
        let foreign =
            parts.foreign(&*slam, policy.as_deref().map(|p| p as &dyn ExplorationPolicy), &sensors);
        let bodies = place(&setup, sensors);
        if parts.has(PartRole::Policy) {
            settings.policy = None;
        }
        let track = |&start: &_| Trajectory { poses: vec![start], ..Trajectory::default() };
        Ok(Trial {
            autonomy: Autonomy::new(
                slam,
                policy,
                starts.len(),
                &settings.body,
                &settings.laser,
                world.bounds,
            )
            .with_doors(doors),
            bodies,
            observer,
            foreign,
            replaced: Vec::new(),
            source: source.take().unwrap_or_else(|| LogWorld::of(world)),
            world_digest: digest.to_string(),
            clock: Clock::default(),
            ends: vec![None; starts.len()],
            finished: vec![false; starts.len()],
            tracks: starts.iter().map(track).collect(),
            commands: vec![CommandLog::default(); starts.len()],
            door_commands: Vec::new(),
            script: None,
            over: false,
            scenario: scenario
                .take()
                .map(|scenario| Box::new((scenario, SweptCells::new(world.bounds)))),
            starts: self.starts,
            settings: self.settings,
        })
    }
}

fn has_doors(scenario: Option<&Scenario>) -> bool {
    scenario.is_some_and(|scenario| !scenario.doors.is_empty())
}

impl Trial<FlatSimulator> {
    /// Creates a trial of built-in parts in the flat simulator.
    ///
    /// # Errors
    ///
    /// If a setting is not allowed, or if a start is missing or not free.
    pub fn flat(world: &World, settings: TrialSettings) -> Result<Self, TrialError> {
        TrialBuilder::new(world, settings).build_flat()
    }

    /// Returns a builder, which builds a trial from parts: SLAM, policy, sensors and robot backend.
    pub fn builder(world: &World, settings: TrialSettings) -> TrialBuilder<'_> {
        TrialBuilder::new(world, settings)
    }
}
