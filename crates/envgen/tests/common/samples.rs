//! A world of every kind, and the files of it.

use envgen::export::{Format, Job};
use envgen::geometry::{Rect, Shape};
use envgen::glam::DVec2;
use envgen::world::{Extent, Obstacle, ObstacleKind};
use envgen::{Provenance, Seed, World, WorldKind};
use serde_json::Value;

/// The default world of every kind; the landscape is small, and slow in places.
pub(crate) fn worlds() -> Vec<World> {
    let worlds = WorldKind::ALL.iter().map(|kind| {
        let mut spec = kind.default_spec();
        if *kind == WorldKind::Landscape {
            for (name, value) in
                [("rows", "12"), ("cols", "12"), ("classes", "3"), ("entropy", "1")]
            {
                spec.set(name, value).unwrap();
            }
            spec.set("speeds", "0,1,0.5").unwrap();
        }
        let mut world = spec.generate(Seed(5)).unwrap().to_world();
        if world.victims.is_empty() {
            world.victims.extend(world.goal);
        }
        world
    });
    worlds.collect()
}

/// The names of a world's start, goal and victims in files.
pub(crate) fn place_names(world: &World) -> Vec<String> {
    let victims = (0..world.victims.len()).map(|i| format!("victim_{i}"));
    ["start", "goal"].map(str::to_owned).into_iter().chain(victims).collect()
}

/// A world in the format of a file's ending.
pub(crate) fn write(world: &World, ending: &str) -> Vec<u8> {
    let format = Format::from_path(format!("world.{ending}").as_ref()).unwrap();
    let mut file = Vec::new();
    format.write(&Job::new(world), &mut file).unwrap();
    file
}

/// A world of one obstacle with these corners.
pub(crate) fn with_polygon(corners: &[(f64, f64)]) -> World {
    let bounds = Rect::new(DVec2::ZERO, DVec2::splat(10.0));
    let mut world = World::new(Provenance::other("a \"yard\" & <more>", Value::Null), bounds);
    let vertices = corners.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
    let height = Extent::new(0.5, 2.0).ok();
    let shape = Shape::Polygon { vertices };
    world.obstacles.push(Obstacle { height, ..Obstacle::new(ObstacleKind::Other, shape) });
    world
}
