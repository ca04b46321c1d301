//! Goes to the nearest frontier.

use glam::DVec2;

use super::navigator::Navigator;
use super::{Decision, ExplorationPolicy, PolicyInput};

/// Goes to the nearest frontier.
#[derive(Debug)]
pub(super) struct Nearest(pub(super) Navigator);

impl ExplorationPolicy for Nearest {
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        self.0.explore(view, |planning| planning.nearest())
    }

    fn recoveries(&self, robot: usize) -> u32 {
        self.0.recoveries(robot)
    }

    fn path(&self, robot: usize) -> &[DVec2] {
        self.0.path(robot)
    }
}
