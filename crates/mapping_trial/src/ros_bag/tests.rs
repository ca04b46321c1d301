use envgen::geometry::Pose;
use envgen::hallway::HallwaySpec;
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec};
use glam::DVec2;

use super::mcap::tests::{Found, read};
use super::*;
use crate::flat::FlatSimulator;
use crate::slam::SlamKind;
use crate::trial::{TrialBuilder, TrialSettings};

fn world() -> World {
    HallwaySpec { segments: 6, ..Default::default() }.generate(Seed(7)).unwrap().to_world()
}

fn settings(robots: u32) -> TrialSettings {
    TrialSettings { time_limit: 65.0, robots, slam: SlamKind::PoseGraph, ..Default::default() }
}

/// A trial with what its bag holds.
struct Recorded {
    trial: Trial<FlatSimulator>,
    bytes: Vec<u8>,
    bag: Bag,
}

/// The bag of a trial that `run` builds and drives.
fn record(run: impl FnOnce(&World, TrialParts) -> Trial<FlatSimulator>) -> Recorded {
    let world = world();
    let recorder = BagRecorder::new(Vec::new());
    let trial = run(&world, recorder.watch(TrialParts::default()));
    let report = trial.report(&world, &trial.reference(&world).unwrap()).unwrap();
    let (bytes, bag) = recorder.finish(&trial, &world, &report).unwrap();
    Recorded { trial, bytes, bag }
}

fn trial(robots: u32) -> Recorded {
    record(|world, parts| {
        let mut trial =
            TrialBuilder::new(world, settings(robots)).parts(parts).build_flat().unwrap();
        while trial.step() {}
        trial
    })
}

/// Checks that the last map of a bag is that of its trial.
fn assert_last_map(found: &[Found], trial: &Trial<FlatSimulator>) {
    let maps = of(found, "/map");
    let mut reader = Reader::new(maps[maps.len() - 1]);
    let (time, frame) = reader.header();
    assert_eq!((reader.time(), frame.as_str()), (time, "map"));
    let expected = trial.autonomy().slam().map().to_ros_map().unwrap();
    assert_eq!(reader.f32(), 0.05);
    let (cols, rows) = (reader.u32() as usize, reader.u32() as usize);
    assert_eq!((cols, rows), (expected.cols, expected.rows()));
    assert!(near(reader.pose().0, expected.origin));
    assert_eq!(reader.u32() as usize, cols * rows);
    for cell in &expected.cells {
        use envgen::export::ros_map::RosCell;
        let found = i8::from_le_bytes(reader.take(1));
        let expected = match cell {
            RosCell::Unknown => -1,
            RosCell::Free => 0,
            RosCell::Occupied => 100,
        };
        assert_eq!(found, expected);
    }
    reader.end();
}

/// The last tick is one of a map, which the first robot's part draws before the others have seen anything in it.
#[test]
fn the_last_map_is_that_of_all_robots() {
    for robots in [1, 2, 3] {
        let recorded = record(|world, parts| {
            let settings = TrialSettings { time_limit: 60.0, ..settings(robots) };
            let mut trial = TrialBuilder::new(world, settings).parts(parts).build_flat().unwrap();
            while trial.step() {}
            trial
        });
        assert_last_map(&read(&recorded.bytes).messages, &recorded.trial);
    }
}

#[test]
fn twenty_minutes_fit_into_8_mb() {
    for seed in [Seed(2), Seed(3)] {
        let spec = IndoorSpec { width: 16, height: 16, ..Default::default() };
        let world = spec.generate(seed).unwrap().to_world();
        let recorder = BagRecorder::new(Vec::new());
        let settings = TrialSettings { seed, ..Default::default() };
        let parts = recorder.watch(TrialParts::default());
        let mut trial = TrialBuilder::new(&world, settings).parts(parts).build_flat().unwrap();
        while trial.step() {}
        assert_eq!(trial.time(), 1200.0);
        let report = trial.report(&world, &trial.reference(&world).unwrap()).unwrap();
        let bytes = recorder.finish(&trial, &world, &report).unwrap().0;
        assert!(bytes.len() < 8_000_000, "seed {seed}: {} bytes", bytes.len());
        // A map every minute, the last one at the end.
        let found = read(&bytes).messages;
        let minutes: Vec<u64> =
            of(&found, "/map").iter().map(|map| map.time / 60_000_000_000).collect();
        assert_eq!(minutes, (0..=20).collect::<Vec<_>>());
    }
}

/// Reads the fields of a message.
struct Reader<'a>(&'a [u8], usize);

impl<'a> Reader<'a> {
    fn new(found: &'a Found) -> Self {
        assert_eq!(found.data[..4], [0, 1, 0, 0]);
        Reader(&found.data[4..], 0)
    }

    fn take<const N: usize>(&mut self, align: usize) -> [u8; N] {
        self.1 = self.1.next_multiple_of(align) + N;
        self.0[self.1 - N..self.1].try_into().unwrap()
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take(4))
    }

    fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take(4))
    }

    fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.take(8))
    }

    fn string(&mut self) -> String {
        let len = self.u32() as usize;
        self.1 += len;
        let text = &self.0[self.1 - len..self.1];
        assert_eq!(text.last(), Some(&0));
        String::from_utf8(text[..len - 1].to_vec()).unwrap()
    }

    /// Nanoseconds and the frame.
    fn header(&mut self) -> (u64, String) {
        (self.time(), self.string())
    }

    fn time(&mut self) -> u64 {
        u64::from(self.u32()) * 1_000_000_000 + u64::from(self.u32())
    }

    /// A pose in the plane, and its height.
    fn pose(&mut self) -> (Pose, f64) {
        let [x, y, z, qx, qy, qz, qw] = std::array::from_fn(|_| self.f64());
        assert_eq!([qx, qy], [0.0, 0.0]);
        (Pose { position: DVec2::new(x, y), heading: 2.0 * libm::atan2(qz, qw) }, z)
    }

    fn end(self) {
        assert_eq!(self.1, self.0.len());
    }
}

/// The only transform of a message: time, both frames, pose and height.
fn transform(found: &Found) -> (u64, String, String, Pose, f64) {
    let mut reader = Reader::new(found);
    assert_eq!(reader.u32(), 1);
    let ((time, frame), child) = (reader.header(), reader.string());
    let (pose, height) = reader.pose();
    reader.end();
    (time, frame, child, pose, height)
}

fn of<'a>(found: &'a [Found], topic: &str) -> Vec<&'a Found> {
    found.iter().filter(|found| found.topic == topic).collect()
}

fn near(a: Pose, b: Pose) -> bool {
    let between = a.between(b);
    between.position.length() < 1e-9 && between.heading.abs() < 1e-9
}

#[test]
fn each_message_is_what_the_trial_had() {
    let Recorded { trial, bytes, bag } = trial(1);
    let contents = read(&bytes);
    let found = contents.messages;
    assert!(trial.time() > 31.0, "{}", trial.time());
    let ticks = (trial.time() / 0.05).round() as u64;

    // The true poses are exact; the last estimates too, since SLAM does not change them later.
    let truths = of(&found, "/ground_truth");
    assert_eq!(truths.len() as u64, ticks / 4 + 1);
    for truth in &truths {
        let mut reader = Reader::new(truth);
        let (time, frame) = reader.header();
        assert_eq!((time, frame.as_str()), (truth.time, "map"));
        let tick = (time / 50_000_000) as usize;
        assert!(near(reader.pose().0, trial.trajectory(0).poses[tick]));
        reader.end();
    }
    let (tf, tf_map) = (of(&found, "/tf"), of(&found, "/tf_map"));
    assert_eq!((tf.len(), tf_map.len()), (truths.len(), truths.len()));
    let (time, frame, child, on_odom, height) = transform(tf[tf.len() - 1]);
    assert_eq!((frame.as_str(), child.as_str(), height), ("odom", "base_link", 0.0));
    assert_eq!(time, nanoseconds(trial.time()));
    let (_, frame, child, odom, _) = transform(tf_map[tf.len() - 1]);
    assert_eq!((frame.as_str(), child.as_str()), ("map", "odom"));
    assert!(near(odom.compose(on_odom), trial.autonomy().slam().estimate(0).pose));

    // The wheels start at the origin of their own frame.
    let (_, _, _, first, _) = transform(tf[0]);
    assert!(near(first, Pose::default()));
    let odometry = of(&found, "/odom");
    let mut reader = Reader::new(odometry[odometry.len() - 1]);
    assert_eq!(reader.header().1, "odom");
    assert_eq!(reader.string(), "base_link");
    assert!(near(reader.pose().0, on_odom));
    (0..36 + 6 + 36).for_each(|_| _ = reader.f64());
    reader.end();

    // The laser is where the robot's description says.
    let [mount] = of(&found, "/tf_static")[..] else { panic!("one message") };
    let (_, frame, child, pose, height) = transform(mount);
    let body = &trial.settings().body;
    assert_eq!((frame.as_str(), child.as_str()), ("base_link", "laser"));
    assert!(near(pose, Pose::new(body.laser_offset, 0.0, 0.0)) && height == 0.45);

    let scans = of(&found, "/scan");
    assert_eq!(scans.len() as u64, ticks / 4 + 1);
    let mut reader = Reader::new(scans[scans.len() - 1]);
    assert_eq!(reader.header().1, "laser");
    let [low, high, step, increment, period, least, most] = std::array::from_fn(|_| reader.f32());
    let half = std::f32::consts::FRAC_PI_2;
    assert!((low + half).abs() < 1e-6 && (high - half).abs() < 1e-6);
    assert!((low + 180.0 * step - high).abs() < 1e-4);
    assert_eq!([increment, period, least, most], [0.0, 0.2, 0.01, 8.19]);
    assert_eq!(reader.u32(), 181);
    for range in &trial.autonomy().scan(0).ranges {
        assert_eq!(reader.f32(), *range as f32);
    }
    assert_eq!(reader.u32(), 0);
    reader.end();

    // Maps at the start and at the end: the trial is shorter than the time between maps.
    let maps = of(&found, "/map");
    let times: Vec<u64> = maps.iter().map(|map| map.time / 1_000_000_000).collect();
    assert_eq!((times.len(), times[0]), (2, 0));
    assert_eq!(maps[maps.len() - 1].time, nanoseconds(trial.time()));
    assert_last_map(&found, &trial);

    // What the bag says of itself.
    assert_eq!(bag.messages(), found.len() as u64);
    for (topic, count) in bag.topics() {
        assert_eq!(of(&found, topic).len() as u64, count, "{topic}");
    }
    let names: Vec<&str> = contents.attachments.iter().map(|file| file.1.as_str()).collect();
    assert_eq!(names, ["report.json", "world.json", "spec.envgen.ron"]);
    for (_, name, data) in &contents.attachments {
        let text = std::str::from_utf8(data).unwrap();
        match name.as_str() {
            "world.json" => assert_eq!(World::from_json(text).unwrap(), world()),
            "spec.envgen.ron" => {
                let spec = WorldSpec::from_ron(text).unwrap();
                assert_eq!(spec.generate(Seed(7)).unwrap().to_world(), world());
            }
            _ => {
                let report: TrialReport = serde_json::from_str(text).unwrap();
                assert_eq!(report.log_digest, trial.log().digest().to_string());
                assert!(report.feedback.is_some());
            }
        }
    }
}

#[test]
fn the_same_trial_gives_the_same_bytes_and_so_does_its_replay() {
    let first = trial(1);
    assert_eq!(trial(1).bytes, first.bytes);
    let log = first.trial.log();
    let again = record(|world, parts| {
        let build = |builder: TrialBuilder<'_>| builder.parts(parts).build_flat();
        let mut trial = log.replay_with(world, build).unwrap();
        log.run_through(&mut trial).unwrap();
        trial
    });
    assert_eq!(again.bytes, first.bytes);
}

#[test]
fn each_robot_has_topics_and_frames_of_its_own() {
    let Recorded { trial, bytes, .. } = trial(2);
    let found = read(&bytes).messages;
    for (topic, frame) in [("/scan", "laser"), ("/robot_2/scan", "robot_2/laser")] {
        let scans = of(&found, topic);
        assert!(scans.len() > 100);
        assert_eq!(Reader::new(scans[0]).header().1, frame);
    }
    let last = of(&found, "/robot_2/ground_truth");
    let mut reader = Reader::new(last[last.len() - 1]);
    let (time, _) = reader.header();
    let tick = (time / 50_000_000) as usize;
    assert!(near(reader.pose().0, trial.trajectory(1).poses[tick]));
    // One clock for both, and time never turns back.
    let clocks: Vec<u64> = of(&found, "/clock").iter().map(|clock| clock.time).collect();
    assert!(clocks.is_sorted_by(|a, b| a < b));
    assert!(found.is_sorted_by_key(|found| found.time));
}

#[test]
fn a_recorder_watches_exactly_one_trial() {
    let world = world();
    let build = |parts| TrialBuilder::new(&world, settings(1)).parts(parts).build_flat().unwrap();
    let trial = build(TrialParts::default());
    let report = trial.report(&world, &trial.reference(&world).unwrap()).unwrap();
    let finish = |recorder: BagRecorder<Vec<u8>>| recorder.finish(&trial, &world, &report);

    assert!(matches!(finish(BagRecorder::new(Vec::new())), Err(BagError::NoTrial)));
    let recorder = BagRecorder::new(Vec::new());
    let parts = recorder.watch(TrialParts::default());
    for parts in [parts.clone(), parts] {
        build(parts);
    }
    assert!(matches!(finish(recorder), Err(BagError::ManyTrials)));
}

#[test]
fn the_metadata_counts_what_is_in_the_file() {
    let Recorded { bag, .. } = trial(1);
    let text = bag.metadata("a \"b\".mcap");
    assert!(text.contains("relative_file_paths:\n    - \"a \\\"b\\\".mcap\"\n"), "{text}");
    assert!(text.contains(&format!("message_count: {}\n  topics", bag.messages())));
    assert!(text.contains("name: /tf_static"));
    let latched = text.matches("durability: 1\\n").count();
    assert_eq!(latched, 2, "{text}");
}
