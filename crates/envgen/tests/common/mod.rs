//! Worlds put together by hand, which hold every kind of part.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use envgen::certificate::Claim;
use envgen::geometry::{Pose, Rect, Shape, unit_vector};
use envgen::glam::DVec2;
use envgen::world::{
    ClassRaster, Contents, Doorway, Obstacle, ObstacleKind, RoadPoint, RoadStrip, Room, Surface,
    SurfaceKind, Tree, Wall, WallKind,
};
use envgen::{Provenance, Seed, World};
use serde_json::json;

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Shape {
    Shape::from_rect(Rect::new(v(x0, y0), v(x1, y1)))
}

pub(crate) fn empty(width: f64, height: f64) -> World {
    let source =
        json!({ "made": "by hand", "list": [1, 2.5, -3, null, true], "deep": { "a": {} } });
    World::new(Provenance::other("manual", source), Rect::new(DVec2::ZERO, v(width, height)))
}

/// Rooms with doorways along a corridor, every kind of obstacle and surface.
pub(crate) fn indoor() -> World {
    let mut world = empty(24.0, 14.0);
    let names = ["lobby", "kitchen", "workshop", "laboratory", "store", "office", "archive", "gym"];
    for (i, name) in names.into_iter().enumerate() {
        let (column, upper) = (i % 4, i < 4);
        let x = 6.0 * column as f64;
        let (y0, y1) = if upper { (8.0, 14.0) } else { (0.0, 6.0) };
        world.rooms.push(Room {
            name: name.to_owned(),
            shape: rect(x, y0, x + 6.0, y1),
            difficulty: Some(10.0 * i as f64 / 7.0),
            lit: i % 3 != 2,
            contents: Contents::AsDesigned,
            height: None,
        });
        let edge = if upper { 8.0 } else { 6.0 };
        let (a, b) = (x + 2.4, x + 3.6);
        let wall =
            |from: f64, to: f64| Wall::new(WallKind::Wall, rect(from, edge - 0.1, to, edge + 0.1));
        world.walls.extend([wall(x, a), wall(b, x + 6.0)]);
        let opening = rect(a, edge - 0.1, b, edge + 0.1);
        world.doorways.push(Doorway::new(opening, i % 4 != 3, [Some(i as u32), None]));
        if column > 0 {
            let shape = rect(x - 0.1, y0, x + 0.1, y1);
            world.walls.push(Wall::new(WallKind::Partition, shape));
        }
    }
    for (x0, y0, x1, y1) in [(0.0, 0.0, 24.0, 0.2), (0.0, 13.8, 24.0, 14.0), (0.0, 0.0, 0.2, 14.0)]
    {
        world.walls.push(Wall::new(WallKind::Wall, rect(x0, y0, x1, y1)));
    }
    world.walls.push(Wall::new(WallKind::EndCap, rect(23.8, 0.0, 24.0, 14.0)));
    world.walls.push(Wall::new(WallKind::Alcove, rect(11.0, 7.7, 13.0, 7.9)));
    let thin = Shape::Segment { a: v(16.0, 6.6), b: v(17.5, 7.2) };
    world.walls.push(Wall::new(WallKind::Kerb, thin));

    let obstacle = |kind, shape| Obstacle::new(kind, shape);
    let crate_box =
        |x, y, heading| Shape::Box { center: v(x, y), half_size: v(0.5, 0.35), heading };
    world.obstacles = vec![
        obstacle(ObstacleKind::Crate, crate_box(1.2, 12.8, 0.0)),
        obstacle(ObstacleKind::Crate, crate_box(4.8, 9.4, 0.6)),
        obstacle(ObstacleKind::Crate, crate_box(13.4, 12.8, -0.3)),
        obstacle(ObstacleKind::Other, Shape::Disc { center: v(8.2, 4.6), radius: 0.45 }),
        obstacle(ObstacleKind::Other, Shape::Disc { center: v(9.9, 1.3), radius: 0.6 }),
        obstacle(
            ObstacleKind::Other,
            Shape::Polygon {
                vertices: vec![v(20.0, 9.0), v(22.4, 9.2), v(22.0, 10.2), v(20.6, 10.0)],
            },
        ),
        obstacle(ObstacleKind::DoorPost, rect(6.2, 6.1, 6.45, 6.6)),
        obstacle(ObstacleKind::DoorPost, rect(6.2, 7.4, 6.45, 7.9)),
    ];
    let surface =
        |kind, shape, speed| Surface { speed, odometry_noise: 2.0, ..Surface::new(kind, shape) };
    world.surfaces = vec![
        surface(SurfaceKind::Uneven, rect(2.0, 6.2, 5.0, 7.8), 0.7),
        surface(SurfaceKind::Debris, rect(8.0, 6.2, 10.5, 7.8), 0.5),
        surface(SurfaceKind::Water, Shape::Disc { center: v(14.5, 6.9), radius: 0.7 }, 0.0),
        surface(SurfaceKind::Debris, rect(8.6, 2.0, 11.4, 3.4), 0.5),
        surface(SurfaceKind::Stairs, rect(18.5, 6.2, 22.0, 7.8), 0.3),
    ];
    world.start = Some(Pose::new(1.0, 7.0, 0.0));
    world.goal = Some(Pose::new(21.0, 11.5, FRAC_PI_2));
    world.certificate = vec![
        Claim::Connected { radius: 0.25 },
        Claim::CrossesWestEast {
            area: world.bounds,
            radius: 0.5,
            crosses: true,
            predicted: Some(true),
        },
        Claim::TreeDistance { distance: 1.25, torus: None },
    ];
    world
}

/// Trees of many sizes around a start and a goal.
pub(crate) fn forest(count: u64, side: f64) -> World {
    let mut world = empty(side, side);
    let mut stream = Seed(5).stream("pictures/forest", 0);
    let (start, goal) = (v(0.05 * side, 0.05 * side), v(0.95 * side, 0.95 * side));
    while (world.trees.len() as u64) < count {
        let radius = stream.between(0.08, 0.45);
        let at = || radius + (side - 2.0 * radius);
        let center = v(stream.between(radius, at()), stream.between(radius, at()));
        let clear = |p: DVec2| p.distance(center) > radius + 1.0;
        let inside = center.x + radius <= side && center.y + radius <= side;
        if inside && clear(start) && clear(goal) {
            world.trees.push(Tree::new(center, radius));
        }
    }
    world.start = Some(Pose { position: start, heading: 0.7 });
    world.goal = Some(Pose { position: goal, heading: 0.0 });
    world
}

/// A winding road of two lanes with kerbs' trees beside it, and a ring of one lane.
pub(crate) fn road() -> World {
    let mut points = Vec::new();
    let (mut position, mut heading) = (v(12.0, 20.0), 0.0);
    let pieces =
        [(40.0, 0.0), (30.0, 0.05), (25.0, -0.07), (35.0, 0.0), (40.0, -0.03), (45.0, 0.02)];
    for (length, curvature) in pieces {
        for _ in 0..(length as usize) {
            points.push(RoadPoint { pose: Pose { position, heading }, curvature });
            position += unit_vector(heading + 0.5 * curvature);
            heading += curvature;
        }
    }
    let around = Rect::around(points.iter().map(|point| point.pose.position)).unwrap().grown(12.0);
    let mut world = empty(1.0, 1.0);
    world.bounds = around;
    world.start = points.first().map(|point| point.pose);
    world.goal = points.last().map(|point| point.pose);
    world.road_strips.push(RoadStrip {
        centreline: points,
        pieces: Vec::new(),
        width: 7.0,
        lanes: 2,
        closed: false,
    });
    let center = v(around.max.x - 28.0, around.min.y + 24.0);
    let ring = (0..60).map(|i| f64::from(i) * TAU / 60.0).map(|angle| RoadPoint {
        pose: Pose { position: center + unit_vector(angle) * 14.0, heading: angle + FRAC_PI_2 },
        curvature: 1.0 / 14.0,
    });
    world.road_strips.push(RoadStrip {
        centreline: ring.collect(),
        width: 3.5,
        lanes: 1,
        closed: true,
        pieces: Vec::new(),
    });
    for i in 0..8 {
        let angle = f64::from(i) * PI / 4.0;
        let shape = Shape::Box {
            center: center + unit_vector(angle) * 10.0,
            half_size: v(0.3, 2.0),
            heading: angle,
        };
        world.walls.push(Wall::new(WallKind::Kerb, shape));
    }
    world
}

/// Patches of classes in a raster, with a pond on it and a corner without data.
pub(crate) fn landscape() -> World {
    let (rows, cols, cell) = (48_u32, 72_u32, 0.5);
    let mut world = empty(f64::from(cols) * cell, f64::from(rows) * cell);
    let mut stream = Seed(9).stream("pictures/landscape", 0);
    let seeds: Vec<_> = (0..40)
        .map(|_| {
            let at = v(stream.between(0.0, cols.into()), stream.between(0.0, rows.into()));
            (at, 1 + stream.below(6) as u16)
        })
        .collect();
    let class = |row: u32, col: u32| {
        let at = v(col.into(), row.into());
        if row + col < 10 {
            return 0;
        }
        let nearest = seeds
            .iter()
            .min_by(|a, b| a.0.distance_squared(at).total_cmp(&b.0.distance_squared(at)));
        nearest.unwrap().1
    };
    let cells = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
    let cells = cells.map(|(row, col)| class(row, col)).collect();
    world.raster =
        Some(ClassRaster { rows, cols, cell, origin: DVec2::ZERO, cells, speeds: Vec::new() });
    let shape = Shape::Disc { center: v(20.0, 9.0), radius: 2.5 };
    let pond = Surface { speed: 0.0, ..Surface::new(SurfaceKind::Water, shape) };
    let shape = rect(28.0, 16.0, 33.0, 20.0);
    let field = Surface::new(SurfaceKind::Class(8), shape);
    world.surfaces = vec![pond, field];
    world.start = Some(Pose::new(4.0, 4.0, 1.0));
    world.goal = Some(Pose::new(32.0, 12.0, 0.0));
    world
}

/// Every list filled.
pub(crate) fn everything() -> World {
    let mut world = indoor();
    let moved = |world: &mut World, from: World| {
        world.bounds = world.bounds.union(from.bounds);
        world.trees.extend(from.trees);
        world.road_strips.extend(from.road_strips);
        world.raster = from.raster.or(world.raster.take());
        world.walls.extend(from.walls);
        world.surfaces.extend(from.surfaces);
    };
    moved(&mut world, road());
    moved(&mut world, landscape());
    world.trees.push(Tree::new(v(23.5, 7.0), 0.2));
    world
}
