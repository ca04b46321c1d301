//! The flat simulator: a fast robot backend in which robots are discs that collide with solids and
//! slide along them.

mod moving;

use std::sync::Arc;

use envgen::clearance_index::ClearanceIndex;
use envgen::geometry::{Pose, unit_vector, wrap_angle};
use envgen::raycast::{Raycaster, ScanPattern};
use envgen::scenario::{self, DoorCommand, ScenarioState};
use envgen::surface_index::SurfaceIndex;
use envgen::world::{Digest, Extent};
use envgen::{Seed, SpecError, World};
use glam::DVec2;

use self::moving::Moving;

use crate::backend::{Command, Condition, Observation, RobotBackend, Sensors, TICK};
use crate::lidar::{LaserProfile, Rays, UNSEEN};
use crate::odometry::{Increment, OdometryProfile};
use crate::robot::Robot;
use crate::water;

/// Greatest number of times that a disc is pushed out of solids before it returns to where it was.
const PUSHES: usize = 8;

/// Depth in metres to which a disc may overlap a solid.
const SLACK: f64 = 1e-6;

/// Ticks without contact after which the next contact is another collision.
const TICKS_BETWEEN_COLLISIONS: u32 = 10;

/// A world indexed for the flat simulator. Trials in the same world may share it.
#[derive(Clone, Debug)]
pub struct FlatWorld {
    rays: Raycaster,
    near: ClearanceIndex,
    grounds: SurfaceIndex,
    /// Digest of the world.
    digest: Digest,
    /// The greatest circumscribed radius of its robots in metres.
    radius: f64,
    /// The extent of its robots.
    extent: Extent,
    /// Height of their lasers in metres.
    laser_height: f64,
}

impl FlatWorld {
    /// Indexes a world for robots that are as high as `robot` and not larger, with their lasers as high
    /// as its laser. What is below or above the laser is not seen, and what is above the body stops no
    /// robot.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    /// use mapping_trial::flat::FlatWorld;
    /// use mapping_trial::trial::{Trial, TrialError, TrialSettings};
    ///
    /// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// let settings = TrialSettings::default();
    /// let flat = Arc::new(FlatWorld::new(&world, &settings.body)?);
    /// for seed in [Seed(1), Seed(2)] {
    ///     let settings = TrialSettings { seed, ..settings.clone() };
    ///     Trial::builder(&world, settings).build_flat_in(flat.clone())?;
    /// }
    /// let other = HallwaySpec::default().generate(Seed(8))?.to_world();
    /// let error = Trial::builder(&other, settings).build_flat_in(flat).err();
    /// assert!(matches!(error, Some(TrialError::OtherFlatWorld { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If [`Robot::validate`] rejects the robot.
    pub fn new(world: &World, robot: &Robot) -> Result<Self, SpecError> {
        robot.validate()?;
        Ok(FlatWorld {
            rays: Raycaster::at_height(world, robot.laser_mount.height),
            near: ClearanceIndex::within(world, robot.circumscribed_radius + 0.1, robot.extent()?)?,
            grounds: SurfaceIndex::new(world),
            digest: world.digest(),
            radius: robot.circumscribed_radius,
            extent: robot.extent()?,
            laser_height: robot.laser_mount.height,
        })
    }

    /// Returns the digest of the world that was indexed.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// Checks that the world is indexed for a robot: that it is not larger than the one of
    /// [`FlatWorld::new`], is as high, and has its laser as high. Otherwise it would drive into walls,
    /// or see what its laser does not meet.
    ///
    /// # Errors
    ///
    /// Names the first field that differs, or that [`Robot::validate`] rejects.
    pub fn check_robot(&self, robot: &Robot) -> Result<(), SpecError> {
        robot.validate()?;
        let indexed = |field: &str, value: f64, allowed: String| {
            let allowed = format!("{allowed}: the world was indexed for such robots");
            SpecError::new(field, value, allowed).within("body")
        };
        let radius = robot.circumscribed_radius;
        if radius > self.radius {
            return Err(indexed(
                "circumscribed_radius",
                radius,
                format!("at most {}", self.radius),
            ));
        }
        let height = robot.laser_mount.height;
        if height != self.laser_height {
            return Err(indexed("laser_mount.height", height, self.laser_height.to_string()));
        }
        if robot.extent()? != self.extent {
            // Both lasers are as high, thus the bodies are not.
            let top = self.extent.top();
            let at_most = if top > height { "" } else { "at most " };
            return Err(indexed("height", robot.height, format!("{at_most}{top}")));
        }
        Ok(())
    }
}

/// The flat simulator: robots are discs of their circumscribed radius.
///
/// A disc that touches a solid slides along it. The contact stalls its wheels, so that odometry
/// measures the distance that the disc really moved. Robots are solid to each other, and their lasers
/// see each other. Ground of speed 0 stops a disc at its centre, and in water a robot drowns.
///
/// ```
/// use std::sync::Arc;
///
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::backend::{Command, RobotBackend};
/// use mapping_trial::flat::{FlatSimulator, FlatWorld};
/// use mapping_trial::{lidar::LaserProfile, odometry::OdometryProfile, robot::Robot};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let (robot, start) = (Robot::default(), world.start.expect("hallways have a start"));
/// let flat = Arc::new(FlatWorld::new(&world, &robot)?);
/// let (laser, wheels) = (LaserProfile::default(), OdometryProfile::EXACT);
/// let mut simulator = FlatSimulator::new(flat, &robot, &[start], &laser, &wheels, Seed(1));
/// // A second ahead: the Pioneer accelerates by 0.5 m/s^2.
/// for _ in 0..20 {
///     simulator.observe(0);
///     simulator.advance(&[Command { speed: 0.7, turn_rate: 0.0 }]);
/// }
/// let driven = start.to_local(simulator.pose(0).position);
/// assert!((0.2..0.3).contains(&driven.x) && driven.y.abs() < 1e-9);
/// assert_eq!(simulator.collisions(0), 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct FlatSimulator {
    world: Arc<FlatWorld>,
    robot: Robot,
    laser: LaserProfile,
    fan: ScanPattern,
    ticks: u32,
    discs: Vec<Disc>,
    exact: Vec<f64>,
    /// The beams that end at a part too dark to be seen from there, and their exact ranges.
    unseen: Vec<(usize, f64)>,
    /// The doors, people and smoke of a scenario.
    moving: Option<Box<Moving>>,
    directions: Vec<DVec2>,
}

struct Disc {
    pose: Pose,
    speed: f64,
    turn_rate: f64,
    condition: Condition,
    touching: bool,
    collisions: u32,
    person_collisions: u32,
    /// Ticks since the last contact of each kind.
    clear: [u32; 2],
    /// What the wheels measured in the last tick.
    measured: Increment,
    sensors: Sensors,
}

impl FlatSimulator {
    /// The name of the backend in logs and reports.
    pub const ENGINE: &str = "flat";

    /// Creates robots at their starts. The noise of their sensors follows from the seed.
    ///
    /// # Panics
    ///
    /// If one of the profiles is not valid, or if [`FlatWorld::check_robot`] rejects the robot.
    #[track_caller]
    pub fn new(
        world: Arc<FlatWorld>,
        robot: &Robot,
        starts: &[Pose],
        laser: &LaserProfile,
        odometry: &OdometryProfile,
        seed: Seed,
    ) -> Self {
        let sensors = (0..starts.len() as u64)
            .map(|number| Sensors::new(laser, odometry, seed, number))
            .collect();
        FlatSimulator::with_sensors(world, robot, starts, laser, sensors)
    }

    /// Creates robots with custom sensors, one set per start.
    ///
    /// # Panics
    ///
    /// If the laser's profile is not valid, or if [`FlatWorld::check_robot`] rejects the robot.
    #[track_caller]
    pub fn with_sensors(
        world: Arc<FlatWorld>,
        robot: &Robot,
        starts: &[Pose],
        laser: &LaserProfile,
        sensors: Vec<Sensors>,
    ) -> Self {
        let fan = match world.check_robot(robot).and_then(|()| laser.fan()) {
            Ok(fan) => fan,
            Err(error) => panic!("{error}"),
        };
        let discs = starts.iter().zip(sensors).map(|(&pose, sensors)| Disc {
            pose,
            speed: 0.0,
            turn_rate: 0.0,
            condition: Condition::Operational,
            touching: false,
            collisions: 0,
            person_collisions: 0,
            clear: [TICKS_BETWEEN_COLLISIONS; 2],
            measured: Increment::default(),
            sensors,
        });
        FlatSimulator {
            world,
            robot: robot.clone(),
            laser: laser.clone(),
            fan,
            ticks: 0,
            discs: discs.collect(),
            exact: Vec::new(),
            unseen: Vec::new(),
            moving: None,
            directions: Vec::new(),
        }
    }

    /// Adds everything that moves in a scenario of the same world. People and door leaves are solid and
    /// seen by lasers, and smoke blinds the lasers. Random draws of smoke follow from the seed.
    #[must_use]
    pub fn in_scenario(mut self, state: ScenarioState, seed: Seed) -> Self {
        self.moving = Some(Box::new(Moving::new(state, &self.laser, seed)));
        self
    }

    /// The exact ranges of a robot's scan from a pose. Returns the beams that read 0 in smoke.
    fn scan(&mut self, robot: usize, from: Pose) -> Vec<usize> {
        let (rays, max_range) = (&self.world.rays, self.laser.max_range);
        self.exact.clear();
        self.unseen.clear();
        for (beam, hit) in rays.hits(from, &self.fan, max_range).enumerate() {
            self.exact.push(hit.map_or(max_range, |hit| hit.distance));
            if let Some(hit) = hit.filter(|&hit| rays.is_unseen(hit)) {
                self.unseen.push((beam, hit.distance));
            }
        }
        self.see_others(robot, from);
        let zero = self.see_moving(robot, from);
        for &(beam, distance) in &self.unseen {
            if self.exact[beam] >= distance {
                self.exact[beam] = UNSEEN;
            }
        }
        zero
    }

    /// Shortens ranges that end at a door leaf or a person, and applies smoke. Returns the beams that
    /// then read 0.
    fn see_moving(&mut self, robot: usize, from: Pose) -> Vec<usize> {
        let Some(moving) = &mut self.moving else { return Vec::new() };
        let beams = 0..self.exact.len();
        self.directions.clear();
        self.directions
            .extend(beams.map(|beam| unit_vector(from.heading + self.laser.angle(beam))));
        let (from, max_range) = (from.position, self.laser.max_range);
        let rays = Rays { from, directions: &self.directions, max_range };
        moving.see((robot, self.ticks), &rays, &mut self.exact)
    }

    /// Shortens ranges that end at another robot.
    fn see_others(&mut self, robot: usize, from: Pose) {
        for (_, other) in self.discs.iter().enumerate().filter(|&(i, _)| i != robot) {
            let to = other.pose.position - from.position;
            for (beam, range) in self.exact.iter_mut().enumerate() {
                let direction = unit_vector(from.heading + self.laser.angle(beam));
                let (along, across) = (to.dot(direction), to.perp_dot(direction));
                let half2 = self.robot.circumscribed_radius * self.robot.circumscribed_radius
                    - across * across;
                if along > 0.0 && half2 >= 0.0 {
                    *range = range.min((along - half2.sqrt()).max(0.0));
                }
            }
        }
    }

    /// The final position of a disc that moves to `to`, and what it touches.
    fn slide(&self, robot: usize, from: DVec2, to: DVec2) -> (DVec2, Touches) {
        let radius = self.robot.circumscribed_radius;
        let mut at = to;
        let mut touching = [false; 2];
        let mut deepest = 0.0;
        for _ in 0..PUSHES {
            deepest = 0.0;
            let mut push = DVec2::ZERO;
            let mut nearest = Touched::Solid;
            let mut press = |toward: DVec2, gap: f64, what: Touched| {
                let depth = radius - gap;
                if depth > deepest {
                    deepest = depth;
                    nearest = what;
                    // A centre on an outline is pushed back to the side that it came from.
                    let away = (at - toward).try_normalize();
                    push = away.or((from - at).try_normalize()).unwrap_or(DVec2::ZERO) * depth;
                }
            };
            self.world.near.contacts(at, radius, |c| press(c.point, c.distance, Touched::Solid));
            for (i, other) in self.discs.iter().enumerate() {
                let middle = other.pose.position;
                let gap = at.distance(middle) - radius;
                if i != robot {
                    press(middle, gap, Touched::Solid);
                }
            }
            if let Some(moving) = &self.moving {
                moving.press(at, |point, gap, is_person| {
                    press(point, gap, if is_person { Touched::Person } else { Touched::Solid });
                });
            }
            if deepest <= 0.0 {
                break;
            }
            touching[nearest as usize] = true;
            at += push;
        }
        // The disc is wedged: it stays where it is, unless it was no better before.
        if deepest > SLACK && self.depth(robot, at) > self.depth(robot, from).max(SLACK) {
            at = from;
        }
        let ground = self.world.grounds.at(at);
        if ground.speed == 0.0 && !ground.water {
            return (from, [true, touching[Touched::Person as usize]]);
        }
        (at, touching)
    }

    /// How deep a disc at a position overlaps any solid, in metres.
    fn depth(&self, robot: usize, at: DVec2) -> f64 {
        let radius = self.robot.circumscribed_radius;
        let others = self.discs.iter().enumerate().filter(|&(i, _)| i != robot);
        let mut gap = others
            .map(|(_, other)| at.distance(other.pose.position) - radius)
            .fold(self.world.near.clearance(at), f64::min);
        if let Some(moving) = &self.moving {
            moving.press(at, |_, distance, _| gap = gap.min(distance));
        }
        (radius - gap).max(0.0)
    }

    fn move_disc(&mut self, robot: usize, command: Command) {
        let Robot { max_speed, max_turn_rate, acceleration, turn_acceleration, .. } = self.robot;
        let disc = &self.discs[robot];
        let from = disc.pose;
        let ground = self.world.grounds.at(from.position);
        let limit = max_speed * ground.speed;
        let command = command.finite();
        let wanted = command.speed.clamp(-limit, limit);
        let speed = toward(disc.speed, wanted, acceleration * TICK);
        let wanted = command.turn_rate.clamp(-max_turn_rate, max_turn_rate);
        let turn_rate = toward(disc.turn_rate, wanted, turn_acceleration * TICK);

        let turn = turn_rate * TICK;
        let ahead = unit_vector(from.heading + 0.5 * turn);
        let (position, touched) =
            self.slide(robot, from.position, from.position + ahead * speed * TICK);
        let distance = (position - from.position).dot(ahead);
        let water = self.world.grounds.at(position).water;

        let touching = touched.contains(&true);
        let disc = &mut self.discs[robot];
        disc.pose = Pose { position, heading: wrap_angle(from.heading + turn) };
        disc.turn_rate = turn_rate;
        // What stops the disc stops its wheels; what pushes it does not drive them.
        disc.speed = if touching { limited(distance / TICK, speed) } else { speed };
        let rolled = Increment { distance: ground.rolled(distance), turn };
        disc.measured = disc.sensors.odometry.measure(rolled, ground.odometry_noise);
        let counts = [&mut disc.collisions, &mut disc.person_collisions];
        for ((count, clear), touched) in counts.into_iter().zip(&mut disc.clear).zip(touched) {
            *count += u32::from(touched && *clear >= TICKS_BETWEEN_COLLISIONS);
            *clear = if touched { 0 } else { clear.saturating_add(1) };
        }
        disc.touching = touching;
        if water {
            disc.condition = Condition::Drowned;
            (disc.speed, disc.turn_rate, disc.touching) = (0.0, 0.0, false);
        }
    }
}

/// Limits a speed to the magnitude of another, but for rounding.
fn limited(speed: f64, greatest: f64) -> f64 {
    const ROUNDING: f64 = 1e-6;
    if speed.abs() > greatest.abs() + ROUNDING { greatest.abs().copysign(speed) } else { speed }
}

/// The kinds of what a disc touches.
#[derive(Clone, Copy)]
enum Touched {
    Solid,
    Person,
}

/// Whether a disc touches each kind.
type Touches = [bool; 2];

impl RobotBackend for FlatSimulator {
    fn engine(&self) -> &str {
        FlatSimulator::ENGINE
    }

    fn observe(&mut self, robot: usize) -> Observation {
        let time = f64::from(self.ticks) * TICK;
        let due = self.ticks.is_multiple_of(self.laser.ticks_a_scan);
        let scan = due.then(|| {
            let from = self.robot.laser_pose(self.discs[robot].pose);
            let zero = self.scan(robot, from);
            let mut scan = self.discs[robot].sensors.laser.measure(&self.exact);
            for beam in zero {
                // A custom sensor may return fewer ranges.
                if let Some(range) = scan.ranges.get_mut(beam) {
                    *range = 0.0;
                }
            }
            scan
        });
        let FlatWorld { rays, grounds, .. } = &*self.world;
        let disc = &self.discs[robot];
        Observation {
            time,
            odometry: disc.measured,
            scan,
            water: due.then(|| water::seen(grounds, rays, &self.robot, disc.pose)),
            bumped: disc.touching,
            battery: (self.robot.battery - time).max(0.0),
        }
    }

    fn advance(&mut self, commands: &[Command]) {
        for robot in 0..self.discs.len() {
            if self.discs[robot].condition == Condition::Operational {
                let command = commands.get(robot).copied().unwrap_or(Command::STOP);
                self.move_disc(robot, command);
            } else {
                self.discs[robot].measured = Increment::default();
            }
        }
        if let Some(moving) = &mut self.moving {
            let radius = self.robot.circumscribed_radius;
            let robots = self.discs.iter().map(|disc| scenario::Robot {
                position: disc.pose.position,
                velocity: unit_vector(disc.pose.heading) * disc.speed,
                radius,
            });
            moving.step(&robots.collect::<Vec<_>>());
        }
        self.ticks += 1;
    }

    fn pose(&self, robot: usize) -> Pose {
        self.discs[robot].pose
    }

    fn condition(&self, robot: usize) -> Condition {
        self.discs[robot].condition
    }

    fn collisions(&self, robot: usize) -> u32 {
        self.discs[robot].collisions
    }

    fn person_collisions(&self, robot: usize) -> u32 {
        self.discs[robot].person_collisions
    }

    fn scenario(&self) -> Option<&ScenarioState> {
        self.moving.as_ref().map(|moving| moving.state())
    }

    fn command_door(&mut self, door: usize, command: DoorCommand) -> Result<(), SpecError> {
        match &mut self.moving {
            Some(moving) => moving.state_mut().command_door(door, command),
            None => Err(SpecError::new("door", door, "in a trial with a scenario that has doors")),
        }
    }
}

/// Moves a value by at most `change` towards another.
fn toward(value: f64, wanted: f64, change: f64) -> f64 {
    value + (wanted - value).clamp(-change, change)
}

#[cfg(test)]
mod height_tests;
#[cfg(test)]
mod tests;
