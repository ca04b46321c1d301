//! The panel with the feedback form.

use bevy_egui::egui::{ComboBox, ScrollArea, Slider, TextEdit, Ui};
use mapping_trial::feedback::{Connection, Experience, Feedback, Rating, Session, questions};
use thiserror::Error;

use super::widgets::{error, row};

/// The ratings in the order of the form.
const RATINGS: [&str; 3] = [questions::DIFFICULTY, questions::MAPPING, questions::GETTING_AROUND];

/// The open questions in the order of the form.
const OPEN: [&str; 5] = [
    questions::CONTRIBUTED,
    questions::DIFFICULT_ROOMS,
    questions::EASY_ROOMS,
    questions::PATTERNS,
    questions::OTHER,
];

/// An error for a required rating that is missing.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("not answered yet: {question}")]
pub struct Unanswered {
    /// The question.
    pub question: &'static str,
}

/// A form with the questions of Zwennes (2011), appendix B, and two further questions, that is being filled
/// in. The open questions may stay empty. Ratings have no default, because a person must give them.
#[derive(Clone, Debug, PartialEq)]
pub struct FeedbackForm {
    /// The name of the operator.
    pub name: String,
    /// The experience as an operator.
    pub experience: Experience,
    /// The trial that the form is about.
    pub session: Session,
    /// The ratings from 0 to 10: overall difficulty, mapping, navigation.
    pub ratings: [Option<f64>; 3],
    /// The answers to the open questions, in the order of the form.
    pub answers: [String; 5],
    /// Whether the operator has already tried to hand in the form.
    is_tried: bool,
}

impl FeedbackForm {
    /// Creates an empty form for a session.
    pub fn new(session: Session) -> Self {
        FeedbackForm {
            name: String::new(),
            experience: Experience::default(),
            session,
            ratings: [None; 3],
            answers: Default::default(),
            is_tried: false,
        }
    }

    /// Returns the answers of the form.
    ///
    /// # Errors
    /// Returns an error with the first missing rating.
    pub fn fill(&self) -> Result<Feedback, Unanswered> {
        let [contributed, difficult_rooms, easy_rooms, patterns, other] =
            self.answers.clone().map(|answer| answer.trim().to_owned());
        Ok(Feedback {
            name: self.name.trim().to_owned(),
            experience: self.experience,
            session: self.session.clone(),
            difficulty: self.rating(0)?,
            mapping: self.rating(1)?,
            getting_around: self.rating(2)?,
            contributed,
            difficult_rooms,
            easy_rooms,
            patterns,
            other,
        })
    }

    fn rating(&self, i: usize) -> Result<Rating, Unanswered> {
        let value = self.ratings[i].and_then(|value| Rating::try_from(value).ok());
        value.ok_or(Unanswered { question: RATINGS[i] })
    }

    /// Draws the form in a scroll area of at most `height` points. Returns the answers when the form is
    /// handed in.
    pub fn show(&mut self, ui: &mut Ui, height: f32) -> Option<Feedback> {
        let mut filled = None;
        ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
            self.about(ui);
            ui.separator();
            for (i, question) in RATINGS.into_iter().enumerate() {
                ui.label(question);
                if i == 0 {
                    ui.weak(questions::DIFFICULTY_0);
                    ui.weak(questions::DIFFICULTY_10);
                }
                rate(ui, &mut self.ratings[i]);
                ui.add_space(4.0);
            }
            ui.separator();
            for (question, answer) in OPEN.into_iter().zip(&mut self.answers) {
                ui.label(question);
                let edit = TextEdit::multiline(answer).desired_rows(2);
                ui.add(edit.desired_width(f32::INFINITY));
            }
        });
        ui.separator();
        let missing = (0..RATINGS.len()).find_map(|i| self.rating(i).err());
        if let Some(missing) = missing.filter(|_| self.is_tried) {
            error(ui, &missing.to_string());
        }
        if ui.button("Hand in").clicked() {
            filled = self.fill().ok();
            self.is_tried = true;
        }
        filled
    }

    fn about(&mut self, ui: &mut Ui) {
        let wide = |text| TextEdit::singleline(text).desired_width(f32::INFINITY);
        row(ui, "name", questions::NAME, |ui| {
            ui.add(wide(&mut self.name));
        });
        row(ui, "experience", questions::EXPERIENCE, |ui| {
            let shown = self.experience.to_string();
            ComboBox::from_id_salt("experience").width(170.0).selected_text(shown).show_ui(
                ui,
                |ui| {
                    for &choice in Experience::ALL {
                        ui.selectable_value(&mut self.experience, choice, choice.to_string());
                    }
                },
            );
        });
        row(ui, "environment", questions::ENVIRONMENT, |ui| {
            ui.add(wide(&mut self.session.environment));
        });
        row(ui, "software", questions::SOFTWARE, |ui| {
            ui.add(wide(&mut self.session.software));
        });
        row(ui, "connection", questions::CONNECTION, |ui| {
            let shown = self.session.connection.to_string();
            ComboBox::from_id_salt("connection").width(170.0).selected_text(shown).show_ui(
                ui,
                |ui| {
                    for &choice in Connection::ALL {
                        ui.selectable_value(
                            &mut self.session.connection,
                            choice,
                            choice.to_string(),
                        );
                    }
                },
            );
        });
        row(ui, "robots", questions::ROBOTS, |ui| {
            ui.add(wide(&mut self.session.robots));
        });
    }
}

/// Draws a rating, which is `None` until it is given.
fn rate(ui: &mut Ui, rating: &mut Option<f64>) {
    ui.horizontal(|ui| {
        let mut value = rating.unwrap_or(5.0);
        ui.spacing_mut().slider_width = 240.0;
        let slider = Slider::new(&mut value, 0.0..=10.0).step_by(0.5).show_value(false);
        let response = ui.add(slider);
        // A click on the middle also counts as an answer.
        if response.changed() || response.clicked() || response.drag_stopped() {
            *rating = Some(value);
        }
        match rating {
            Some(value) => ui.strong(value.to_string()),
            None => ui.weak("not answered"),
        };
    });
}
