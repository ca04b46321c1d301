//! Builds the world of a landscape.

use super::blueprint::Landscape;
use super::outlines::outlines;
use super::region::ends;
use crate::generate::Spec;
use crate::geometry::Pose;
use crate::provenance::Provenance;
use crate::world::{
    Claim, ClassRaster, Extent, Obstacle, ObstacleKind, ROCK, Surface, SurfaceKind, World,
};

/// The greatest number of surfaces of a world. A landscape with more pieces lists no surfaces; its raster contains
/// the speed of every position in any case.
pub(super) const MAX_SURFACES: usize = 1 << 16;

pub(super) fn world(landscape: &Landscape) -> World {
    let raster = landscape.to_raster();
    let mut world = raster_world(raster, landscape.spec().provenance(landscape.seed()));
    let height = Extent::unless_usual(ROCK, landscape.spec().rock_height);
    world.obstacles.iter_mut().for_each(|rock| rock.height = height);
    if world.start.is_some() {
        world.certificate = vec![Claim::Connected { radius: 0.4 * landscape.spec().cell_size }];
    }
    world
}

/// Builds the world of a raster. It contains the raster itself; cells that cannot be passed, or are without data,
/// as obstacles; slower and faster classes as surfaces, unless there are more than 65 536 pieces of them; and start
/// and goal at the ends of the largest connected region.
pub(crate) fn raster_world(raster: ClassRaster, provenance: Provenance) -> World {
    let mut world = World::new(provenance, raster.frame().bounds());
    if raster.cells.iter().any(|&class| raster.speed_of(class) != 1.0) {
        let blocked = |class: u16| raster.speed_of(class) == 0.0;
        for outline in outlines(&raster, |class| u16::from(blocked(class))) {
            world.obstacles.push(Obstacle::new(ObstacleKind::Other, outline.1));
        }
        let changed =
            |class: u16| if raster.speed_of(class) == 1.0 || blocked(class) { 0 } else { class };
        let pieces = outlines(&raster, changed);
        if pieces.len() <= MAX_SURFACES {
            world.surfaces.extend(pieces.into_iter().map(|(class, shape)| Surface {
                speed: raster.speed_of(class),
                ..Surface::new(SurfaceKind::Class(class), shape)
            }));
        }
    }
    if let Some((start, goal)) = ends(&raster) {
        let heading = libm::atan2(goal.y - start.y, goal.x - start.x);
        world.start = Some(Pose { position: start, heading });
        world.goal = Some(Pose { position: goal, heading });
    }
    world.raster = Some(raster);
    world
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Blueprint;
    use crate::landscape::LandscapeSpec;
    use crate::seed::Seed;
    use glam::DVec2;
    use proptest::prelude::*;

    fn world_of(rows: u32, cols: u32, cells: Vec<u16>, speeds: Vec<f64>) -> World {
        let origin = DVec2::new(-3.0, 1.5);
        let raster = ClassRaster { rows, cols, cell: 0.5, origin, cells, speeds };
        raster_world(raster, Provenance::other("test", serde_json::Value::Null))
    }

    #[test]
    fn a_ring_falls_into_pieces_without_holes() {
        let cells = vec![2, 2, 2, 2, 1, 2, 2, 2, 2];
        let world = world_of(3, 3, cells, vec![0.0, 1.0, 0.0]);
        assert_eq!(world.check(), Ok(()));
        assert_eq!(world.obstacles.len(), 4);
        assert_eq!(world.start.map(|pose| pose.position), Some(DVec2::new(-2.25, 2.25)));
    }

    #[test]
    fn nothing_to_pass_leaves_no_start() {
        let world = world_of(1, 2, vec![1, 1], vec![0.0, 0.0]);
        assert_eq!((world.start, world.goal, world.obstacles.len()), (None, None, 1));
        assert_eq!(world.check(), Ok(()));
    }

    #[test]
    fn a_landscape_of_very_many_pieces_keeps_its_speeds_in_the_raster() {
        let spec = LandscapeSpec {
            rows: 600,
            cols: 600,
            classes: 2,
            entropy: 0.69,
            speeds: vec![0.5, 0.7],
            ..Default::default()
        };
        let world = spec.generate(Seed(1)).unwrap().to_world();
        assert!(world.surfaces.is_empty());
        assert!([0.5, 0.7].contains(&world.raster.unwrap().speed_at(DVec2::ONE).unwrap()));
    }

    proptest! {
        #[test]
        fn the_world_is_the_raster(rows in 1_u32..12, cols in 1_u32..12, seed: u64) {
            let mut stream = Seed(seed).stream("test", 0);
            let cells: Vec<u16> = (0..rows * cols).map(|_| stream.below(4) as u16).collect();
            let world = world_of(rows, cols, cells, vec![0.0, 1.0, 0.5, 0.0]);
            prop_assert_eq!(world.check(), Ok(()));
            let raster = world.raster.as_ref().unwrap();
            for r in 0..rows {
                for c in 0..cols {
                    let middle = DVec2::new(f64::from(c) + 0.5, f64::from(rows - r) - 0.5);
                    let p = raster.origin + middle * raster.cell;
                    let speed = raster.speed_at(p).unwrap();
                    let solids = world.obstacles.iter().filter(|o| o.shape.contains(p)).count();
                    let slow: Vec<f64> = world
                        .surfaces
                        .iter()
                        .filter(|s| s.shape.contains(p))
                        .map(|s| s.speed)
                        .collect();
                    prop_assert_eq!(solids, usize::from(speed == 0.0));
                    prop_assert_eq!(slow, if speed == 0.5 { vec![0.5] } else { vec![] });
                }
            }
        }
    }

    #[test]
    fn cells_without_data_are_solid() {
        let world = world_of(1, 3, vec![1, 0, 1], Vec::new());
        assert_eq!(world.obstacles.len(), 1);
        assert_eq!(world.raster.as_ref().unwrap().speed_at(DVec2::new(-2.25, 1.75)), Some(0.0));
        // Unless a speed says otherwise.
        assert!(world_of(1, 3, vec![1, 0, 1], vec![1.0]).obstacles.is_empty());
    }
}
