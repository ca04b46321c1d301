//! Panels without a window: what they show, and clicks on them.

use bevy_mapping_trial::ui::egui::epaint::{ClippedShape, Shape};
use bevy_mapping_trial::ui::egui::{
    CentralPanel, Context, Event, FullOutput, Modifiers, PointerButton, Pos2, RawInput, Rect, Ui,
    Vec2,
};

/// The texts of a frame: each with its place and the area that it is cut to.
pub(crate) struct Shown {
    texts: Vec<(String, Rect, Rect)>,
}

impl Shown {
    fn of(output: &FullOutput) -> Self {
        let mut texts = Vec::new();
        for ClippedShape { clip_rect, shape } in &output.shapes {
            collect(shape, *clip_rect, &mut texts);
        }
        Shown { texts }
    }

    /// Whether a text is among them, across the lines that it is wrapped to.
    pub(crate) fn has(&self, text: &str) -> bool {
        self.texts.iter().any(|(shown, ..)| shown.contains(text))
    }

    /// The texts that are cut at their left or right.
    pub(crate) fn clipped(&self) -> Vec<String> {
        let cut = |(_, at, clip): &&(String, Rect, Rect)| {
            at.right() > clip.right() + 1.0 || at.left() < clip.left() - 1.0
        };
        self.texts.iter().filter(cut).map(|(text, ..)| text.clone()).collect()
    }

    fn place_of(&self, text: &str) -> Pos2 {
        let found = self.texts.iter().find(|(shown, ..)| shown == text);
        found.unwrap_or_else(|| panic!("`{text}` is shown")).1.center()
    }
}

fn collect(shape: &Shape, clip: Rect, texts: &mut Vec<(String, Rect, Rect)>) {
    match shape {
        Shape::Text(text) => {
            let at = text.galley.rect.translate(text.pos.to_vec2());
            texts.push((text.galley.job.text.to_string(), at, clip));
        }
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, texts)),
        _ => {}
    }
}

fn frame(
    context: &Context,
    size: Vec2,
    events: Vec<Event>,
    mut show: impl FnMut(&mut Ui),
) -> Shown {
    let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, size));
    let input = RawInput { screen_rect, events, ..Default::default() };
    let output = context.run_ui(input, |ui| {
        CentralPanel::default().show(ui, |ui| show(ui));
    });
    let shown = Shown::of(&output);
    output.drop_without_applying_deltas();
    shown
}

/// What a panel of a size shows, once it has measured itself.
pub(crate) fn show_in(size: Vec2, mut show: impl FnMut(&mut Ui)) -> Shown {
    let context = Context::default();
    frame(&context, size, Vec::new(), &mut show);
    frame(&context, size, Vec::new(), show)
}

/// What a panel says to a click on a text.
pub(crate) fn click<T>(
    size: Vec2,
    text: &str,
    mut show: impl FnMut(&mut Ui) -> Option<T>,
) -> Option<T> {
    let context = Context::default();
    frame(&context, size, Vec::new(), |ui| drop(show(ui)));
    let at = frame(&context, size, Vec::new(), |ui| drop(show(ui))).place_of(text);
    let mut said = None;
    let button = |pressed| Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    for events in [vec![Event::PointerMoved(at)], vec![button(true)], vec![button(false)]] {
        frame(&context, size, events, |ui| said = said.take().or(show(ui)));
    }
    said
}
