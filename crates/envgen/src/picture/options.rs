//! The options of pictures.

use super::error::PictureError;
use crate::scenario::Scenario;

/// The least and the greatest width of a picture, in px.
pub const WIDTHS: [u32; 2] = [100, 16_384];

/// The least and the greatest height of the plan, in px.
pub const HEIGHTS: [u32; 2] = [50, 16_384];

/// The options of a picture of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// Greatest width of the picture in px, within [`WIDTHS`]. The picture is as large as the limits allow; high
    /// worlds give narrower pictures.
    pub width: u32,
    /// Greatest height of the world in the picture in px, within [`HEIGHTS`]. Title, legend and curvature profile
    /// are added to it.
    pub height: u32,
    /// Pixels of a PNG per px of the picture, from 0.1 to 10; use 2 for dense screens.
    pub pixel_ratio: f64,
    /// Blank margin on the four sides of the picture in px, at most 200.
    pub margin: u32,
    /// Title above the world; `None` for kind, seed and the settings that differ from the defaults; an empty text
    /// for no title.
    pub title: Option<String>,
    /// Whether a legend explains the colours.
    pub legend: bool,
    /// Whether the names of rooms are shown.
    pub names: bool,
    /// Whether a grid with a round number of metres is drawn below the world.
    pub grid: bool,
    /// Whether the curvature of roads over their length is drawn below the world.
    pub curvature_profile: bool,
    /// The moving elements of the world: doors with their swing, people with their routes of the first minute, and
    /// smoke.
    pub scenario: Option<Scenario>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        PictureOptions {
            width: 1000,
            height: 800,
            pixel_ratio: 1.0,
            margin: 16,
            title: None,
            legend: true,
            names: true,
            grid: false,
            curvature_profile: false,
            scenario: None,
        }
    }
}

impl PictureOptions {
    /// Checks the options against their limits.
    ///
    /// # Errors
    /// Names the first option that is not allowed.
    pub fn validate(&self) -> Result<(), PictureError> {
        let check = |option, value: f64, min: f64, max: f64| {
            let inside = value >= min && value <= max;
            if inside { Ok(()) } else { Err(PictureError::Option { option, value, min, max }) }
        };
        let [narrowest, widest] = WIDTHS.map(f64::from);
        check("width", self.width.into(), narrowest, widest)?;
        let [lowest, highest] = HEIGHTS.map(f64::from);
        check("height", self.height.into(), lowest, highest)?;
        check("margin", self.margin.into(), 0.0, 200.0)?;
        check("pixel_ratio", self.pixel_ratio, 0.1, 10.0)
    }
}
