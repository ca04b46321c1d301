use crate::screen::{click, show_in};
use bevy_mapping_trial::ui::*;
use mapping_trial::feedback::{Session, questions};
use mapping_trial::robot::Robot;

#[test]
fn a_form_is_handed_in_when_every_rating_is_given() {
    let mut form = FeedbackForm::new(Session::new("indoor, seed 3", 2, &Robot::default()));
    assert_eq!(form.fill(), Err(Unanswered { question: questions::DIFFICULTY }));
    let size = egui::vec2(480.0, 1200.0);
    assert_eq!(click(size, "Hand in", |ui| form.show(ui, 1000.0)), None);
    assert!(show_in(size, |ui| drop(form.show(ui, 1000.0))).has("not answered yet"));
    form.ratings = [Some(6.5), None, None];
    let shown = show_in(size, |ui| drop(form.show(ui, 1000.0)));
    assert!(shown.has(&Unanswered { question: questions::MAPPING }.to_string()));
    form.ratings = [Some(6.5), Some(7.0), Some(5.0)];
    assert!(!show_in(size, |ui| drop(form.show(ui, 1000.0))).has("not answered yet"));
    form.ratings = [Some(6.5), Some(7.0), None];
    assert_eq!(form.fill(), Err(Unanswered { question: questions::GETTING_AROUND }));
    form.ratings[2] = Some(5.0);
    form.answers[0] = " water\n".to_owned();
    let filled = click(size, "Hand in", |ui| form.show(ui, 1000.0)).expect("all is answered");
    assert_eq!(filled.difficulty.value(), 6.5);
    assert_eq!(filled.getting_around.value(), 5.0);
    assert_eq!(filled.contributed, "water");
    assert_eq!(filled.session.robots, "2x P3AT");
}

#[test]
fn every_question_is_asked() {
    let mut form = FeedbackForm::new(Session::new("map765", 1, &Robot::default()));
    let shown = show_in(egui::vec2(480.0, 1400.0), |ui| drop(form.show(ui, 1300.0)));
    let asked = [
        questions::DIFFICULTY,
        questions::MAPPING,
        questions::GETTING_AROUND,
        questions::CONTRIBUTED,
        questions::DIFFICULT_ROOMS,
        questions::EASY_ROOMS,
        questions::PATTERNS,
        questions::OTHER,
    ];
    for question in asked {
        assert!(shown.has(question), "{question}");
    }
    for text in [questions::DIFFICULTY_0, questions::DIFFICULTY_10, "map765", "1x P3AT"] {
        assert!(shown.has(text), "{text}");
    }
    assert_eq!(shown.clipped(), Vec::<String>::new());
}
