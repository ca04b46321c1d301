//! The colours of panels.

use bevy_egui::egui::Color32;
use envgen::palette::{self, Srgb};

/// The colour of errors, which is readable on the panels of the dark theme.
pub(super) const ERROR: Color32 = Color32::from_rgb(255, 140, 110);

/// The background colour of drawings, which is that of pictures of worlds.
pub(super) const PAGE: Color32 = {
    let Srgb([red, green, blue]) = palette::PAGE;
    Color32::from_rgb(red, green, blue)
};
