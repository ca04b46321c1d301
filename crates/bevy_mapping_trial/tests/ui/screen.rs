//! Draws panels without a window, reads what they show, and clicks on them.

use bevy_mapping_trial::ui::egui::epaint::{ClippedShape, Shape};
use bevy_mapping_trial::ui::egui::{
    CentralPanel, Color32, Context, Event, FullOutput, Key, Modifiers, PointerButton, Pos2,
    RawInput, Rect, Ui, Vec2,
};

/// The texts that are shown in a frame.
pub(crate) struct Shown {
    texts: Vec<Text>,
}

/// A text with its position, the area to which it is clipped, and its colour.
struct Text {
    text: String,
    at: Rect,
    clip: Rect,
    color: Color32,
}

impl Shown {
    fn of(output: &FullOutput) -> Self {
        let mut texts = Vec::new();
        for ClippedShape { clip_rect, shape } in &output.shapes {
            collect(shape, *clip_rect, &mut texts);
        }
        Shown { texts }
    }

    /// Returns whether a text is shown, even if it is wrapped to several lines.
    pub(crate) fn has(&self, text: &str) -> bool {
        self.texts.iter().any(|shown| shown.text.contains(text))
    }

    /// Returns the texts that are clipped at the left or right.
    pub(crate) fn clipped(&self) -> Vec<String> {
        let cut = |Text { at, clip, .. }: &&Text| {
            at.right() > clip.right() + 1.0 || at.left() < clip.left() - 1.0
        };
        self.texts.iter().filter(cut).map(|shown| shown.text.clone()).collect()
    }

    /// Returns the texts that are clipped at any side.
    pub(crate) fn cut(&self) -> Vec<String> {
        let cut = |shown: &&Text| !shown.clip.expand(1.0).contains_rect(shown.at);
        self.texts.iter().filter(cut).map(|shown| shown.text.clone()).collect()
    }

    /// Returns the pairs of texts that partly cover each other.
    pub(crate) fn overlapping(&self) -> Vec<(String, String)> {
        let mut pairs = Vec::new();
        for (i, shown) in self.texts.iter().enumerate() {
            for other in &self.texts[..i] {
                if shown.at.shrink(2.0).intersects(other.at.shrink(2.0)) {
                    pairs.push((other.text.clone(), shown.text.clone()));
                }
            }
        }
        pairs
    }

    /// Returns the colour of a text.
    pub(crate) fn colour_of(&self, text: &str) -> Color32 {
        let found = self.texts.iter().find(|shown| shown.text == text);
        found.unwrap_or_else(|| panic!("`{text}` is shown")).color
    }

    fn places_of(&self, text: &str) -> Vec<Pos2> {
        let found = self.texts.iter().filter(|shown| shown.text == text);
        found.map(|shown| shown.at.center()).collect()
    }

    fn place_of(&self, text: &str) -> Pos2 {
        *self.places_of(text).first().unwrap_or_else(|| panic!("`{text}` is shown"))
    }
}

fn collect(shape: &Shape, clip: Rect, texts: &mut Vec<Text>) {
    match shape {
        Shape::Text(text) => {
            let at = text.galley.rect.translate(text.pos.to_vec2());
            // A section may have a colour of its own, which replaces that of the whole text.
            let of_section = text.galley.job.sections.first().map(|section| section.format.color);
            let own = of_section.filter(|color| *color != Color32::PLACEHOLDER);
            let color = text.override_text_color.or(own).unwrap_or(text.fallback_color);
            texts.push(Text { text: text.galley.job.text.to_string(), at, clip, color });
        }
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, texts)),
        _ => {}
    }
}

/// A panel of a given size, which remembers the clicks.
pub(crate) struct Screen {
    context: Context,
    size: Vec2,
}

impl Screen {
    pub(crate) fn new(size: Vec2) -> Self {
        let context = Context::default();
        // Without animations, a group that is opened is open in the next frame.
        context.all_styles_mut(|style| style.animation_time = 0.0);
        Screen { context, size }
    }

    fn frame(&self, events: Vec<Event>, mut show: impl FnMut(&mut Ui)) -> Shown {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, self.size));
        let input = RawInput { screen_rect, events, ..Default::default() };
        let output = self.context.run_ui(input, |ui| {
            CentralPanel::default().show(ui, |ui| show(ui));
        });
        let shown = Shown::of(&output);
        output.drop_without_applying_deltas();
        shown
    }

    /// Returns what a panel shows, after a first frame in which it measures itself.
    pub(crate) fn show(&self, mut show: impl FnMut(&mut Ui)) -> Shown {
        self.frame(Vec::new(), &mut show);
        self.frame(Vec::new(), show)
    }

    /// Returns the action of a panel for a click on a text.
    pub(crate) fn click<T>(
        &self,
        text: &str,
        mut show: impl FnMut(&mut Ui) -> Option<T>,
    ) -> Option<T> {
        let at = self.show(|ui| drop(show(ui))).place_of(text);
        self.click_at(at, show)
    }

    fn click_at<T>(&self, at: Pos2, mut show: impl FnMut(&mut Ui) -> Option<T>) -> Option<T> {
        let mut said = None;
        let button = |pressed| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        for events in [vec![Event::PointerMoved(at)], vec![button(true)], vec![button(false)]] {
            self.frame(events, |ui| said = said.take().or(show(ui)));
        }
        said
    }

    /// Clicks on an editable text, and replaces it by another one.
    pub(crate) fn retype<T>(
        &self,
        text: &str,
        typed: &str,
        mut show: impl FnMut(&mut Ui) -> Option<T>,
    ) -> Option<T> {
        self.click(text, &mut show);
        let all = Event::Key {
            key: Key::A,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::COMMAND,
        };
        let mut said = None;
        for event in [all, Event::Text(typed.to_owned())] {
            self.frame(vec![event], |ui| said = said.take().or(show(ui)));
        }
        said
    }

    /// Clicks on the last of several equal texts.
    pub(crate) fn click_last<T>(&self, text: &str, mut show: impl FnMut(&mut Ui) -> Option<T>) {
        let at = self.show(|ui| drop(show(ui))).places_of(text).last().copied();
        self.click_at(at.unwrap_or_else(|| panic!("`{text}` is shown")), show);
    }

    /// Returns what a panel shows while the pointer is over a text.
    pub(crate) fn hover(&self, text: &str, mut show: impl FnMut(&mut Ui)) -> Shown {
        self.context.all_styles_mut(|style| style.interaction.tooltip_delay = 0.0);
        let at = self.show(&mut show).place_of(text);
        self.frame(vec![Event::PointerMoved(at)], &mut show);
        self.show(show)
    }
}

/// Returns what a panel of a given size shows, after a first frame in which it measures itself.
pub(crate) fn show_in(size: Vec2, show: impl FnMut(&mut Ui)) -> Shown {
    Screen::new(size).show(show)
}

/// Returns the action of a panel for a click on a text.
pub(crate) fn click<T>(
    size: Vec2,
    text: &str,
    show: impl FnMut(&mut Ui) -> Option<T>,
) -> Option<T> {
    Screen::new(size).click(text, show)
}
