//! The colours of trials.

use bevy::prelude::*;
use bevy_envgen::visuals::color;
use envgen::palette;

/// A resource with the colours of trials.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct TrialPalette {
    /// The background of the map, where nothing is known. It also suits the clear colour of cameras.
    pub unknown: Color,
    /// Free cells of the map.
    pub free: Color,
    /// Occupied cells of the map.
    pub occupied: Color,
    /// The true poses and paths of the robots.
    pub truth: Color,
    /// Robots with their scans and paths. The colours repeat if there are more robots than colours.
    pub robots: Vec<Color>,
}

impl Default for TrialPalette {
    fn default() -> Self {
        TrialPalette {
            unknown: color(palette::map::VIEW_UNKNOWN),
            free: color(palette::map::VIEW_FREE),
            occupied: color(palette::map::VIEW_OCCUPIED),
            truth: color(palette::GREEN),
            robots: vec![color(palette::VERMILION), color(palette::BLUE)],
        }
    }
}

impl TrialPalette {
    /// Returns the colour of a robot, by its index from 0.
    pub fn robot(&self, robot: usize) -> Color {
        let color = self.robots.get(robot % self.robots.len().max(1));
        color.copied().unwrap_or(self.occupied)
    }
}
