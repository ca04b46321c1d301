//! The title of a picture: kind and seed of the world, and the settings that differ from the defaults.

use glam::DVec2;
use svg::node::element::Group;

use super::options::PictureOptions;
use super::path::PathData;
use super::shapes::filled;
use super::text::{Align, Typesetter};
use super::view::{self, View};
use crate::palette;
use crate::world::{Claim, World};

const SIZE: f64 = 15.0;
/// Font size of the settings, and of the extent.
const SMALL_SIZE: f64 = 12.0;
/// Space between the parts of the row, in px.
const GAP: f64 = 12.0;

/// The text above a world.
#[derive(Debug)]
pub(super) struct Heading {
    /// Kind and seed, or the title from the options.
    pub(super) name: String,
    /// Settings that differ from the defaults.
    settings: String,
}

impl Heading {
    /// Creates a title without settings.
    pub(super) fn plain(name: String) -> Heading {
        Heading { name, settings: String::new() }
    }

    pub(super) fn new(world: &World, options: &PictureOptions) -> Heading {
        let made = &world.provenance;
        match &options.title {
            Some(title) => Heading::plain(title.clone()),
            None => {
                let mut settings = made.changed_settings();
                if let Some(difficulty) = difficulty(world) {
                    let comma = if settings.is_empty() { "" } else { ", " };
                    settings = format!("{difficulty}{comma}{settings}");
                }
                Heading { name: made.name(), settings }
            }
        }
    }

    /// Returns the whole text, without characters that XML cannot contain.
    pub(super) fn text(&self) -> String {
        let whole = match self.settings.as_str() {
            "" => self.name.clone(),
            settings => format!("{}: {settings}", self.name),
        };
        let printable = |c: &char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
        whole.chars().filter(printable).collect()
    }

    /// Draws the name, the settings and, if there is space, the size of the world at the right.
    pub(super) fn row(&self, view: &View, right: f64, typesetter: &Typesetter) -> Group {
        let (left, baseline) = (view.plan.min.x, view.plan.min.y - 9.0);
        let room = right - left;
        let [mut dark, mut quiet] = [PathData::new(2), PathData::new(2)];
        let name = typesetter.fitted(&self.name, SIZE, room).unwrap_or_default();
        typesetter.write(&mut dark, &name, DVec2::new(left, baseline), SIZE, Align::Left);
        let mut used = typesetter.width(&name, SIZE) + GAP;
        if !self.settings.is_empty()
            && let Some(text) = typesetter.fitted(&self.settings, SMALL_SIZE, room - used)
        {
            let at = DVec2::new(left + used, baseline);
            typesetter.write(&mut quiet, &text, at, SMALL_SIZE, Align::Left);
            used += typesetter.width(&text, SMALL_SIZE) + GAP;
        }
        let size = view.world.size();
        let extent = format!("{} × {}", view::length(size.x), view::length(size.y));
        if used + typesetter.width(&extent, SMALL_SIZE) <= room && size.is_finite() {
            let at = DVec2::new(right, baseline);
            typesetter.write(&mut quiet, &extent, at, SMALL_SIZE, Align::Right);
        }
        let mut group = Group::new().set("id", "title").add(filled(dark, palette::INK));
        if !quiet.is_empty() {
            group = group.add(filled(quiet, palette::QUIET_INK));
        }
        group
    }
}

/// Returns the difficulty of a world, if it is known: the measured one, otherwise the predicted one.
fn difficulty(world: &World) -> Option<String> {
    let predicted = world.certificate.iter().find_map(|claim| match claim {
        Claim::PredictedDifficulty { prediction } => Some(prediction.dials.difficulty),
        _ => None,
    });
    let (how, dial) = match &world.provenance.measured {
        Some(measured) => ("measured", measured.dials.difficulty),
        None => ("predicted", predicted?),
    };
    Some(format!("{how} difficulty {:.1} ± {:.1}", dial.value, dial.standard_error))
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::calibration::{Dials, Estimate, Prediction};
    use crate::geometry::Rect;
    use crate::provenance::{MeasuredDifficulty, Provenance};
    use crate::seed::Seed;

    #[test]
    fn the_difficulty_is_said_where_it_is_known() {
        let made = Provenance::other("manual", Value::Null);
        let mut world = World::new(made, Rect::new(DVec2::ZERO, DVec2::ONE));
        let dials = |value| {
            let dial = Estimate { value, standard_error: 0.7 };
            Dials { difficulty: dial, mapping: dial, navigation: dial }
        };
        let text = |world: &World| Heading::new(world, &PictureOptions::default()).text();
        let prediction = Prediction { calibration: 1, dials: dials(6.04), outside: 0.0 };
        world.certificate.push(Claim::PredictedDifficulty { prediction });
        assert_eq!(text(&world), "manual: predicted difficulty 6.0 ± 0.7");
        world.provenance.measured = Some(Box::new(MeasuredDifficulty {
            panel: "reference".to_owned(),
            panel_version: 1,
            dials: dials(5.5),
            trials: 12,
            noise_seed: Seed(0),
        }));
        assert_eq!(text(&world), "manual: measured difficulty 5.5 ± 0.7");
    }

    #[test]
    fn what_xml_cannot_hold_is_left_out() {
        let made = Provenance::other("manual", Value::Null);
        let world = World::new(made, Rect::new(DVec2::ZERO, DVec2::ONE));
        let heading = |title: &str| {
            let options = PictureOptions { title: Some(title.to_owned()), ..Default::default() };
            Heading::new(&world, &options).text()
        };
        assert_eq!(heading("a\u{0}b\u{ffff}c"), "abc");
        assert_eq!(heading("mine"), "mine");
        assert_eq!(Heading::new(&world, &PictureOptions::default()).text(), "manual");
    }
}
