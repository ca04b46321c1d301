//! A preview of the world that settings describe, which is generated and drawn in the background.

use std::sync::Arc;

use bevy_egui::egui::{
    Align2, Color32, ColorImage, FontId, Rect, Sense, Spinner, TextureHandle, TextureOptions, Ui,
    Vec2,
};
use envgen::picture::{self, PictureOptions, Pixels};
use envgen::scenario::{Scenario, ScenarioSpec};
use envgen::{Seed, SettingsError, World, WorldSpec};

use super::background::Background;
use super::colors::{ERROR, PAGE};

/// The points between the picture and the edges.
const MARGIN: f32 = 16.0;

/// The opacity of white over a picture that is about to be replaced.
const OUTDATED: u8 = 120;

/// A preview of the world that settings describe, which is generated in a background task and drawn in a
/// panel.
///
/// Only the last request counts. Nothing blocks: while a world is generated, the previous picture is shown
/// under a spinner.
///
/// ```
/// use bevy_mapping_trial::ui::{SpecForm, WorldPreview};
/// use envgen::{Seed, WorldKind};
///
/// let mut form = SpecForm::new(&WorldKind::Hallway.default_spec(), Seed(3));
/// let mut preview = WorldPreview::new(form.request());
/// form.set("segments", "7");
/// preview.request(form.request());
/// // An app calls it in every frame.
/// while preview.is_pending() {
///     preview.advance();
/// }
/// let world = preview.world().expect("an allowed spec");
/// assert_eq!(world.provenance.seed, Some(Seed(3)));
///
/// form.set("segments", "0");
/// preview.request(form.request());
/// assert!(preview.world().is_none());
/// assert_eq!(preview.error(), Some("`segments` must be a whole number from 1 to 1000000, got 0"));
/// ```
pub struct WorldPreview {
    wanted: Wanted,
    worlds: Background<(WorldSpec, Seed), Result<Arc<World>, String>>,
    pictures: Background<Drawing, Result<Drawn, String>>,
    /// The picture that is shown.
    texture: Option<(Drawing, TextureHandle)>,
}

/// The request.
#[derive(Debug)]
enum Wanted {
    /// A world that already exists.
    World(Arc<World>),
    /// The world of a spec.
    Spec(Box<(WorldSpec, Seed)>),
    /// Settings that are invalid.
    Refused(String),
}

/// Everything that a picture depends on.
#[derive(Clone, Debug)]
struct Drawing {
    world: Arc<World>,
    scenario: Option<(ScenarioSpec, Seed)>,
    /// The width and the height in points.
    size: [u32; 2],
    pixels_per_point: f32,
}

impl PartialEq for Drawing {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.world, &other.world)
            && self.scenario == other.scenario
            && self.size == other.size
            && self.pixels_per_point == other.pixels_per_point
    }
}

/// A picture.
#[derive(Debug)]
struct Drawn {
    pixels: Pixels,
    /// The reason why the picture is without the scenario, if it is.
    problem: Option<String>,
}

impl WorldPreview {
    /// Creates the preview of a spec and a seed, or of the error of the settings.
    pub fn new(request: Result<(WorldSpec, Seed), SettingsError>) -> Self {
        Self::of(match request {
            Ok(request) => Wanted::Spec(Box::new(request)),
            Err(error) => Wanted::Refused(error.to_string()),
        })
    }

    /// Creates the preview of a world that already exists, such as one from a file.
    pub fn given(world: Arc<World>) -> Self {
        Self::of(Wanted::World(world))
    }

    fn of(wanted: Wanted) -> Self {
        let (worlds, pictures) = (Background::default(), Background::default());
        WorldPreview { wanted, worlds, pictures, texture: None }
    }

    /// Requests another world, in place of the previous request.
    pub fn request(&mut self, request: Result<(WorldSpec, Seed), SettingsError>) {
        self.wanted = Self::new(request).wanted;
    }

    /// Takes a world that is ready, and starts to generate the last requested one. Must be called in every
    /// frame.
    pub fn advance(&mut self) {
        let Wanted::Spec(wanted) = &self.wanted else { return };
        self.worlds.advance(Some(&**wanted), |(spec, seed)| {
            let blueprint = spec.generate(*seed).map_err(|error| error.to_string())?;
            Ok(Arc::new(blueprint.to_world()))
        });
    }

    /// Returns whether the last requested world is not ready yet.
    pub fn is_pending(&self) -> bool {
        matches!(&self.wanted, Wanted::Spec(wanted) if self.worlds.of(wanted).is_none())
    }

    /// Returns the last requested world, once it is ready.
    pub fn world(&self) -> Option<&Arc<World>> {
        match &self.wanted {
            Wanted::World(world) => Some(world),
            Wanted::Spec(wanted) => self.worlds.of(wanted)?.as_ref().ok(),
            Wanted::Refused(_) => None,
        }
    }

    /// Returns the reason why there is no world for the last request.
    pub fn error(&self) -> Option<&str> {
        match &self.wanted {
            Wanted::World(_) => None,
            Wanted::Spec(wanted) => self.worlds.of(wanted)?.as_ref().err().map(String::as_str),
            Wanted::Refused(error) => Some(error),
        }
    }

    /// Draws the world and its scenario into all of the remaining space. Until the picture of the last
    /// request is ready, it shows the previous picture under a spinner.
    pub fn show(&mut self, ui: &mut Ui, scenario: Option<(&ScenarioSpec, Seed)>) {
        let area = ui.available_rect_before_wrap();
        ui.allocate_rect(area, Sense::hover());
        let painter = ui.painter_at(area);
        painter.rect_filled(area, 0.0, PAGE);
        let inside = area.shrink(MARGIN);
        let wanted = self.world().map(|world| Drawing {
            world: Arc::clone(world),
            scenario: scenario.map(|(spec, seed)| (spec.clone(), seed)),
            size: [inside.width().max(0.0) as u32, inside.height().max(0.0) as u32],
            pixels_per_point: ui.pixels_per_point(),
        });
        self.pictures.advance(wanted.as_ref(), draw);
        if let Some((drawing, Ok(drawn))) = self.pictures.last()
            && self.texture.as_ref().is_none_or(|(shown, _)| shown != drawing)
        {
            let Pixels { width, height, rgb } = &drawn.pixels;
            let image = ColorImage::from_rgb([*width as usize, *height as usize], rgb);
            let texture = ui.ctx().load_texture("world", image, TextureOptions::LINEAR);
            self.texture = Some((drawing.clone(), texture));
        }
        if let Some((drawing, texture)) = &self.texture {
            // Pictures of another size are scaled down to fit.
            let size = texture.size_vec2() / drawing.pixels_per_point;
            let scale = (inside.size() / size).min_elem().min(1.0);
            let place = Align2::CENTER_CENTER.align_size_within_rect(scale * size, inside);
            let whole = Rect::from_min_max(Vec2::ZERO.to_pos2(), Vec2::splat(1.0).to_pos2());
            painter.image(texture.id(), place, whole, Color32::WHITE);
        }
        let ready = wanted.as_ref().and_then(|wanted| self.pictures.of(wanted));
        let problem = match (ready, self.error()) {
            (_, Some(error)) => Some(error),
            (Some(Err(error)), None) => Some(error.as_str()),
            (Some(Ok(drawn)), None) => drawn.problem.as_deref(),
            (None, None) => {
                painter.rect_filled(area, 0.0, Color32::from_white_alpha(OUTDATED));
                let side = Rect::from_center_size(area.center(), Vec2::splat(48.0));
                ui.put(side, Spinner::new().size(48.0).color(Color32::from_gray(60)));
                None
            }
        };
        if let Some(problem) = problem {
            let width = inside.width().min(560.0);
            let color = Color32::from_rgb(140, 20, 0);
            let text = painter.layout(problem.to_owned(), FontId::proportional(15.0), color, width);
            let place = Align2::CENTER_TOP.align_size_within_rect(text.size(), inside);
            painter.rect_filled(place.expand(8.0), 4.0, ERROR.lerp_to_gamma(Color32::WHITE, 0.6));
            painter.galley(place.min, text, color);
        }
    }
}

/// Draws a world as large as it fits, with its scenario if that is possible.
fn draw(drawing: &Drawing) -> Result<Drawn, String> {
    let [width, height] = drawing.size;
    let scenario = drawing
        .scenario
        .as_ref()
        .filter(|(spec, _)| !spec.is_still())
        .map(|(spec, seed)| Scenario::new(&drawing.world, spec, *seed));
    let (scenario, problem) = match scenario.transpose() {
        Ok(scenario) => (scenario, None),
        Err(error) => (None, Some(error.to_string())),
    };
    let [narrowest, widest] = picture::WIDTHS;
    let [lowest, highest] = picture::HEIGHTS;
    let mut options = PictureOptions {
        width: width.clamp(narrowest, widest),
        height: height.clamp(lowest, highest),
        pixel_ratio: f64::from(drawing.pixels_per_point).clamp(0.5, 4.0),
        margin: 0,
        scenario,
        ..PictureOptions::default()
    };
    let draw = |options: &PictureOptions| {
        picture::pixels(&drawing.world, options).map_err(|error| error.to_string())
    };
    let mut pixels = draw(&options)?;
    // The title and the legend are added to the height.
    let total = (f64::from(pixels.height) / options.pixel_ratio) as u32;
    if total > height && height > lowest {
        options.height = options.height.saturating_sub(total - height).max(lowest);
        pixels = draw(&options)?;
    }
    Ok(Drawn { pixels, problem })
}
