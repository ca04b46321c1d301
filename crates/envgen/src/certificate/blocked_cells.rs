//! The cells of a raster that no robot can enter.

use std::cmp::Ordering;

use glam::DVec2;

use crate::geometry::Shape;
use crate::landscape::{metrics, outlines};
use crate::surface_index::ground_raster;
use crate::world::World;

/// Returns the outlines of the cells of a world's raster that cannot be passed, without those that are obstacles as
/// well, as all are in landscapes that nobody has edited.
pub(super) fn blocked_cells(world: &World) -> Vec<Shape> {
    let raster = ground_raster(world).filter(|raster| metrics::check(raster).is_ok());
    let Some(raster) = raster else { return Vec::new() };
    let blocked = outlines(raster, |class| u16::from(raster.speed_of(class) <= 0.0));
    let mut obstacles: Vec<&Shape> =
        world.obstacles.iter().map(|obstacle| &obstacle.shape).collect();
    obstacles.sort_by(|a, b| in_order(a, b));
    let is_obstacle = |cells: &Shape| {
        let from = obstacles.partition_point(|shape| in_order(shape, cells).is_lt());
        let alike = obstacles[from..].iter().take_while(|shape| in_order(shape, cells).is_eq());
        alike.into_iter().any(|&shape| shape == cells)
    };
    blocked.into_iter().map(|(_, cells)| cells).filter(|cells| !is_obstacle(cells)).collect()
}

/// Orders polygons by their first corners, which differ between the outlines of a raster. Other shapes come before.
fn in_order(a: &Shape, b: &Shape) -> Ordering {
    let [a, b] = [a, b].map(|shape| match shape {
        Shape::Polygon { vertices } => vertices.first().copied(),
        _ => None,
    });
    let order = |a: DVec2, b: DVec2| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
    match (a, b) {
        (Some(a), Some(b)) => order(a, b),
        _ => a.is_some().cmp(&b.is_some()),
    }
}
