//! Writes each tick of a trial to a bag.

use std::io::{self, Write};

use envgen::export::ros_map::RosCell;
use envgen::geometry::Pose;

use super::cdr::CdrWriter;
use super::error::BagError;
use super::mcap::{Attachment, ChannelId, McapWriter, SchemaId, Totals};
use super::message::{self, Grid, Header, Transform};
use super::metadata::{Publishing, Topic};
use super::schema::MessageType;
use crate::lidar::LaserProfile;
use crate::map::OccupancyMap;
use crate::odometry::Increment;
use crate::slam::motion::{advance, believable};
use crate::trial::{Moment, Setup};

/// Number of ticks between two messages of odometry if no scan comes between. Twice as many messages
/// would double their share of the bag, and scan matching only needs the odometry at the times of
/// scans.
const TICKS_A_MESSAGE: u64 = 4;

/// Time between two maps in nanoseconds.
const MAP_PERIOD: u64 = 60_000_000_000;

/// The frame of maps and true poses, which is that of the world.
const MAP_FRAME: &str = "map";

/// A trial that is being recorded.
pub(super) struct Recording<W> {
    out: McapWriter<W>,
    cdr: CdrWriter,
    topics: Vec<Topic>,
    laser: LaserProfile,
    clock: ChannelId,
    tf: ChannelId,
    tf_map: ChannelId,
    map: ChannelId,
    robots: Vec<Robot>,
    /// The time of the last clock; `None` before it.
    now: Option<u64>,
    /// The time and the revision of the last map; `None` before it.
    drawn: Option<(u64, u64)>,
}

/// Topics and frames of a robot, and its pose by its wheels.
struct Robot {
    scan: ChannelId,
    odometry: ChannelId,
    ground_truth: ChannelId,
    odom_frame: String,
    base_frame: String,
    laser_frame: String,
    odom: Pose,
    ticks: u64,
}

/// Adds topics to a file.
struct Topics<W> {
    out: McapWriter<W>,
    schemas: Vec<(MessageType, SchemaId)>,
    topics: Vec<Topic>,
}

impl<W: Write> Topics<W> {
    fn add(
        &mut self,
        name: String,
        of: MessageType,
        publishing: Publishing,
    ) -> io::Result<ChannelId> {
        let known = self.schemas.iter().find(|(known, _)| *known == of);
        let schema = match known {
            Some((_, schema)) => *schema,
            None => {
                let schema = self.out.schema(of.name(), "ros2msg", &of.text())?;
                self.schemas.push((of, schema));
                schema
            }
        };
        let qos = publishing.qos();
        let channel =
            self.out.channel(schema, &name, "cdr", &[("offered_qos_profiles", qos.as_str())])?;
        self.topics.push(Topic { name, of, publishing });
        Ok(channel)
    }
}

impl<W: Write> Recording<W> {
    /// Begins a file with the topics and the fixed transforms of a trial.
    pub(super) fn new(out: W, setup: &Setup<'_>) -> io::Result<Self> {
        let out = McapWriter::new(out, "ros2")?;
        let mut topics = Topics { out, schemas: Vec::new(), topics: Vec::new() };
        let mut shared = |name: &str, of, publishing| topics.add(name.to_owned(), of, publishing);
        let clock = shared("/clock", MessageType::Clock, Publishing::Stream)?;
        let tf = shared("/tf", MessageType::TfMessage, Publishing::Stream)?;
        let tf_static = shared("/tf_static", MessageType::TfMessage, Publishing::Latched)?;
        let tf_map = shared("/tf_map", MessageType::TfMessage, Publishing::Stream)?;
        let map = shared("/map", MessageType::OccupancyGrid, Publishing::Latched)?;
        let robots = (0..setup.starts.len())
            .map(|robot| Robot::new(robot, &mut topics))
            .collect::<io::Result<Vec<_>>>()?;

        let Topics { mut out, topics, .. } = topics;
        let (body, mut cdr) = (&setup.settings.body, CdrWriter::default());
        let lasers: Vec<Transform<'_>> = robots
            .iter()
            .map(|robot| Transform {
                header: Header { stamp: 0, frame: &robot.base_frame },
                child: &robot.laser_frame,
                pose: body.laser_pose(Pose::default()),
                height: body.laser_mount.height,
            })
            .collect();
        message::transforms(&mut cdr, &lasers);
        out.message(tf_static, 0, cdr.bytes())?;
        let laser = setup.settings.laser.clone();
        let (now, drawn) = (None, None);
        Ok(Recording { out, cdr, topics, laser, clock, tf, tf_map, map, robots, now, drawn })
    }

    /// Writes one tick of one robot.
    pub(super) fn add(&mut self, moment: &Moment<'_>) -> Result<(), BagError> {
        let stamp = nanoseconds(moment.seen.time);
        let Some(robot) = self.robots.get_mut(moment.robot) else { return Ok(()) };
        let motion = believable(moment.seen.odometry);
        robot.odom = advance(robot.odom, motion);
        robot.ticks += 1;
        let is_due = (robot.ticks - 1).is_multiple_of(TICKS_A_MESSAGE);
        if !is_due && moment.seen.scan.is_none() {
            return Ok(());
        }
        if self.now != Some(stamp) {
            self.now = Some(stamp);
            message::clock(&mut self.cdr, stamp);
            self.out.message(self.clock, stamp, self.cdr.bytes())?;
        }
        self.add_poses(moment, stamp, motion)?;
        if self.drawn.is_none_or(|(drawn, _)| stamp >= drawn + MAP_PERIOD) {
            self.add_map(stamp, moment.slam.map())?;
        }
        Ok(())
    }

    /// Writes the poses of a robot, and what its laser sees from there.
    fn add_poses(&mut self, moment: &Moment<'_>, stamp: u64, motion: Increment) -> io::Result<()> {
        let Recording { out, cdr, .. } = self;
        let robot = &self.robots[moment.robot];
        let on_map = Header { stamp, frame: MAP_FRAME };
        let on_odom = Header { stamp, frame: &robot.odom_frame };
        let at = |header, child, pose| Transform { header, child, pose, height: 0.0 };

        message::transforms(cdr, &[at(on_odom, robot.base_frame.as_str(), robot.odom)]);
        out.message(self.tf, stamp, cdr.bytes())?;
        message::odometry(cdr, on_odom, &robot.base_frame, robot.odom, motion);
        out.message(robot.odometry, stamp, cdr.bytes())?;
        let correction = moment.slam.estimate(moment.robot).pose.compose(robot.odom.inverse());
        message::transforms(cdr, &[at(on_map, &robot.odom_frame, correction)]);
        out.message(self.tf_map, stamp, cdr.bytes())?;
        message::pose_stamped(cdr, on_map, moment.pose);
        out.message(robot.ground_truth, stamp, cdr.bytes())?;
        if let Some(scan) = &moment.seen.scan {
            let header = Header { stamp, frame: &robot.laser_frame };
            message::scan(cdr, header, &self.laser, &scan.ranges);
            out.message(robot.scan, stamp, cdr.bytes())?;
        }
        Ok(())
    }

    /// Writes the map at a given time, unless it is already written. With several robots, others may
    /// have changed it since.
    pub(super) fn add_map(&mut self, stamp: u64, map: &OccupancyMap) -> Result<(), BagError> {
        let drawn = Some((stamp, map.revision()));
        if self.drawn == drawn {
            return Ok(());
        }
        self.drawn = drawn;
        let map = map.to_ros_map()?;
        let cells = map.cells.iter().map(|cell| match cell {
            RosCell::Unknown => -1,
            RosCell::Free => 0,
            RosCell::Occupied => 100,
        });
        let grid = Grid {
            resolution: map.resolution,
            cols: map.cols,
            rows: map.rows(),
            origin: map.origin.position,
            cells,
        };
        message::grid(&mut self.cdr, Header { stamp, frame: MAP_FRAME }, grid);
        Ok(self.out.message(self.map, stamp, self.cdr.bytes())?)
    }

    /// Adds a file.
    pub(super) fn attach(&mut self, stamp: u64, file: Attachment<'_>) -> io::Result<()> {
        self.out.attach(stamp, file)
    }

    /// Ends the file.
    pub(super) fn finish(self) -> io::Result<(W, Vec<Topic>, Totals)> {
        let (out, totals) = self.out.finish()?;
        Ok((out, self.topics, totals))
    }
}

impl Robot {
    /// The first robot has the plain names; further robots have a prefix.
    fn new<W: Write>(number: usize, topics: &mut Topics<W>) -> io::Result<Self> {
        let prefix = if number == 0 { String::new() } else { format!("robot_{}/", number + 1) };
        let mut add = |name, of| topics.add(format!("/{prefix}{name}"), of, Publishing::Stream);
        Ok(Robot {
            scan: add("scan", MessageType::LaserScan)?,
            odometry: add("odom", MessageType::Odometry)?,
            ground_truth: add("ground_truth", MessageType::PoseStamped)?,
            odom_frame: format!("{prefix}odom"),
            base_frame: format!("{prefix}base_link"),
            laser_frame: format!("{prefix}laser"),
            odom: Pose::default(),
            ticks: 0,
        })
    }
}

/// Converts simulated seconds to nanoseconds.
pub(super) fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}
