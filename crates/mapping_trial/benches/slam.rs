//! The cost of SLAM, in parts, against simple methods for the same.

#[path = "../tests/trials/drive.rs"]
mod drive;

use bench_ratio::{Times, at_most, contest, faster, seconds};
use drive::{Drive, frame, rect};
use envgen::Seed;
use envgen::geometry::{Pose, unit_vector};
use envgen::glam::{DVec2, Vec2};
use mapping_trial::lidar::LaserProfile;
use mapping_trial::map::{CellIndex, HIT, MISS, OccupancyMap, RESOLUTION};
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::robot::Robot;
use mapping_trial::slam::SlamKind;
use mapping_trial::slam::likelihood::LikelihoodField;
use mapping_trial::slam::matcher::{FINE_ANGLE, Matcher, Window};
use mapping_trial::slam::scan_insertion::ScanInserter;
use mapping_trial::slam::sweep::{Sweep, Sweeper};

/// A building of 60 x 60 m with corridors around 25 blocks, and a path of about 710 m through it.
fn building() -> (Vec<envgen::geometry::Rect>, Vec<DVec2>) {
    let mut walls = frame(0.0, 0.0, 60.0, 60.0);
    for i in 0..25 {
        let (x, y) = (2.0 + 11.6 * f64::from(i % 5), 2.0 + 11.6 * f64::from(i / 5));
        walls.push(rect(x, y, x + 9.6, y + 9.6));
    }
    let mut way = Vec::new();
    for k in 0..6 {
        let x = 1.0 + 11.6 * f64::from(k);
        let ends = if k % 2 == 0 { [1.0, 59.0] } else { [59.0, 1.0] };
        way.extend(ends.map(|y| DVec2::new(x, y)));
    }
    for k in (0..4).rev() {
        let y = 1.0 + 11.6 * f64::from(k);
        let ends = if k % 2 == 0 { [1.0, 59.0] } else { [59.0, 1.0] };
        way.extend(ends.map(|x| DVec2::new(x, y)));
    }
    (walls, way)
}

fn main() {
    let (walls, way) = building();
    let world = drive::world_of(&walls);
    let long = LaserProfile { max_range: 20.0, ..LaserProfile::LMS200_MM };
    for (name, laser) in [("8 m", LaserProfile::LMS200_MM), ("20 m", long)] {
        let drive = Drive::new(&world, &way, &laser);
        let recording = drive.record(&OdometryProfile::SKID, 1);
        let simulated = recording.steps.len() as f64 * mapping_trial::backend::TICK;
        let wheels = times(|| recording.replay(SlamKind::DeadReckoning));
        let kinds = [(SlamKind::ScanToMap, 2400.0, 30.0), (SlamKind::PoseGraph, 500.0, 80.0)];
        for (kind, limit, most) in kinds {
            let ours = times(|| recording.replay(kind));
            let what = format!("{kind:?}, {name}, against the time it simulates");
            faster(&what, ours.iter().map(|&time| (time, simulated)).collect::<Times>(), limit);
            let sides: Times = ours.into_iter().zip(wheels.iter().copied()).collect();
            at_most(&format!("{kind:?}, {name}, against drawing alone"), sides, most);
        }
        let scan = recording.steps[0].scan.as_ref().expect("the first step has a scan");
        let sweep = Sweeper::new(&Robot::default(), &laser).sweep(scan);
        let near = Window::around(Pose::new(0.06, -0.04, 0.01), 0.045, 0.025);
        matching(&format!("matching a scan of {name}"), &[1, 4], near, &sweep.echoes);
        // As for closed loops, in a smaller area: every place of 4 m takes seconds.
        let far = Window { reach: 1.0, heading_reach: 20.0_f64.to_radians(), ..near };
        matching(&format!("an old place of {name}"), &[1, 4, 16], far, &sweep.echoes);
        drawing(name, &sweep);
    }
}

/// Seconds of five calls.
fn times<T>(mut work: impl FnMut() -> T) -> Vec<f64> {
    (0..5).map(|_| seconds(&mut work)).collect()
}

/// Branch and bound against a look at each place of the same lattice.
fn matching(name: &str, blocks: &[i32], window: Window, echoes: &[Vec2]) {
    let mut field = LikelihoodField::new(blocks);
    field.cover(DVec2::ZERO, 25.0);
    for p in echoes {
        field.stamp(p.as_dvec2());
    }
    let mut matcher = Matcher::new();
    let sides = contest(
        || matcher.find_coarse(&field, echoes, window),
        || {
            let cells = (window.reach / RESOLUTION).ceil() as i32;
            let turns = (window.heading_reach / (8.0 * FINE_ANGLE)).ceil() as i32;
            let mut best = (f64::NEG_INFINITY, Pose::default());
            for turn in -turns..=turns {
                let axis = unit_vector(window.centre.heading + 8.0 * f64::from(turn) * FINE_ANGLE);
                for y in -cells..=cells {
                    for x in -cells..=cells {
                        let shift = DVec2::new(f64::from(x), f64::from(y)) * RESOLUTION;
                        let base = window.centre.position + shift;
                        let likelihood =
                            |p: &Vec2| f64::from(field.at(base + axis.rotate(p.as_dvec2())));
                        let score: f64 = echoes.iter().map(likelihood).sum();
                        if score > best.0 {
                            best = (score, Pose { position: base, heading: f64::from(turn) });
                        }
                    }
                }
            }
            best
        },
    );
    faster(&format!("{name}, against every place"), sides, 8.0);
}

/// Marks and tiles against Bresenham's line for each ray, cell by cell, each cell once.
fn drawing(name: &str, sweep: &Sweep) {
    let mut draws = Seed(1).stream("poses", 0);
    let poses: Vec<Pose> = (0..50)
        .map(|_| {
            Pose::new(draws.between(0.0, 9.0), draws.between(0.0, 9.0), draws.between(-3.0, 3.0))
        })
        .collect();
    let (mut painter, mut map, mut plain) =
        (ScanInserter::new(), OccupancyMap::new(), OccupancyMap::new());
    let laser = Pose::default();
    let sides = contest(
        || poses.iter().for_each(|&pose| painter.draw(&mut map, pose, laser, sweep)),
        || poses.iter().for_each(|&pose| bresenham(&mut plain, pose, sweep)),
    );
    faster(&format!("drawing a scan of {name}, against Bresenham"), sides, 5.0);
}

fn bresenham(map: &mut OccupancyMap, pose: Pose, sweep: &Sweep) {
    let on_map = pose.local_to_world();
    let cell = |p: &Vec2| CellIndex::of(on_map(p.as_dvec2()));
    let mut hits: Vec<CellIndex> = sweep.echoes.iter().map(cell).collect();
    hits.sort_unstable();
    hits.dedup();
    let mut misses = Vec::new();
    let start = CellIndex::of(pose.position);
    for end in sweep.echoes.iter().chain(&sweep.clear).map(cell) {
        let (dx, dy) = ((end.col - start.col).abs(), -(end.row - start.row).abs());
        let (sx, sy) = ((end.col - start.col).signum(), (end.row - start.row).signum());
        let (mut at, mut error) = (start, dx + dy);
        while at != end {
            misses.push(at);
            let twice = 2 * error;
            if twice >= dy {
                error += dy;
                at.col += sx;
            }
            if twice <= dx {
                error += dx;
                at.row += sy;
            }
        }
    }
    misses.sort_unstable();
    misses.dedup();
    misses.retain(|miss| hits.binary_search(miss).is_err());
    hits.into_iter().for_each(|hit| map.add(hit, HIT));
    misses.into_iter().for_each(|miss| map.add(miss, -MISS));
}
