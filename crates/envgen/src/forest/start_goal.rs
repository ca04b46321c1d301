//! The preferred start and goal of a forest, and the clearings around them.

use glam::DVec2;

use super::spec::ForestSpec;
use crate::world::Tree;

/// The distance of start and goal from the west and east border, in metres, in a wide forest.
const FROM_BORDER: f64 = 2.0;

/// Returns the preferred start and goal: the middles of the west and of the east side.
pub(super) fn wished(spec: &ForestSpec) -> [DVec2; 2] {
    let inset = FROM_BORDER.max(spec.robot_radius).min(0.25 * spec.width);
    let y = 0.5 * spec.height;
    [DVec2::new(inset, y), DVec2::new(spec.width - inset, y)]
}

/// Removes the trees that extend into the clearings, and counts them.
pub(super) fn clear(spec: &ForestSpec, mut trees: Vec<Tree>) -> (Vec<Tree>, u64) {
    if spec.clearing <= 0.0 {
        return (trees, 0);
    }
    let before = trees.len();
    let middles = wished(spec);
    trees.retain(|tree| {
        middles.iter().all(|middle| middle.distance(tree.center) >= spec.clearing + tree.radius)
    });
    let cleared = (before - trees.len()) as u64;
    (trees, cleared)
}
