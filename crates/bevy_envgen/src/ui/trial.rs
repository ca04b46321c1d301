//! The panel for a trial that runs.

use bevy_egui::egui::{Grid, ProgressBar, Ui};
use mapping_trial::backend::RobotBackend;
use mapping_trial::trial::Trial;

/// What a person sees of a trial while it runs. How difficult the world is meant to be is not among
/// it: a person rates blind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialStatus {
    /// Simulated seconds since the start.
    pub time: f64,
    /// Simulated seconds after which the trial ends.
    pub time_limit: f64,
    /// Seconds that the battery still lasts.
    pub battery: f64,
    /// Seconds that a full battery lasts.
    pub full_battery: f64,
    /// Way of the robot that is driven, in metres.
    pub distance: f64,
    /// How often that robot ran into something.
    pub hits: u32,
    /// The robot that is driven, from 0 on.
    pub driven: usize,
    /// Number of robots.
    pub robots: usize,
    /// Whether a program drives.
    pub program: bool,
    /// Whether time stands still.
    pub paused: bool,
    /// Whether the truth is shown.
    pub training: bool,
    /// Why the robot's part ended; `None` while it drives.
    pub end: Option<&'static str>,
}

/// What a person wants of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialAction {
    /// Time stops, or goes on.
    Pause,
    /// The same trial from its start.
    Reset,
    /// The trial ends here.
    Stop,
    /// The truth is shown, or hidden.
    Training,
    /// The next robot is driven.
    NextRobot,
}

impl TrialStatus {
    /// The status of a trial in which a person drives `driven`.
    pub fn of<B: RobotBackend>(trial: &Trial<B>, driven: usize) -> Self {
        let settings = trial.settings();
        let driven = driven.min(trial.robots().saturating_sub(1));
        TrialStatus {
            time: trial.time(),
            time_limit: settings.time_limit,
            battery: (settings.body.battery - trial.time()).max(0.0),
            full_battery: settings.body.battery,
            distance: trial.trajectory(driven).distance,
            hits: trial.bodies().hits(driven),
            driven,
            robots: trial.robots(),
            program: settings.operator.is_some(),
            paused: false,
            training: false,
            end: trial.end_of(driven).map(|end| end.reason.text()),
        }
    }

    /// Draws the panel.
    pub fn show(&self, ui: &mut Ui) -> Option<TrialAction> {
        let mut action = None;
        Grid::new("trial").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
            ui.label("clock");
            ui.strong(format!("{} of {}", clock(self.time), clock(self.time_limit)));
            ui.end_row();
            ui.label("battery");
            let share = (self.battery / self.full_battery.max(f64::MIN_POSITIVE)) as f32;
            let bar = ProgressBar::new(share).desired_width(120.0);
            ui.add(bar.text(format!("{:.0} %", 100.0 * share)));
            ui.end_row();
            ui.label("distance");
            ui.label(format!("{:.1} m", self.distance));
            ui.end_row();
            ui.label("hits");
            ui.label(self.hits.to_string());
            ui.end_row();
            ui.label("robot");
            let driver = if self.program { "a program drives" } else { "you drive" };
            let text = match self.end {
                Some(end) => end.to_owned(),
                None if self.paused => "paused".to_owned(),
                None => driver.to_owned(),
            };
            ui.label(format!("{} of {}, {text}", self.driven + 1, self.robots));
            ui.end_row();
        });
        ui.horizontal_wrapped(|ui| {
            let pause = if self.paused { "Go on (P)" } else { "Pause (P)" };
            let training = if self.training { "Hide the truth (T)" } else { "Training view (T)" };
            for (text, wanted, help) in [
                (pause, TrialAction::Pause, "Esc does it too"),
                ("Reset (R)", TrialAction::Reset, "the same trial from its start"),
                ("Stop (End)", TrialAction::Stop, "ends the trial here: form and scores follow"),
                (training, TrialAction::Training, "for training: it shows what is to be found"),
            ] {
                if ui.button(text).on_hover_text(help).clicked() {
                    action = Some(wanted);
                }
            }
            if self.robots > 1 && ui.button("Next robot (Tab)").clicked() {
                action = Some(TrialAction::NextRobot);
            }
        });
        ui.weak("WASD, arrows or a gamepad drive; + and - zoom");
        action
    }
}

/// Minutes and seconds.
fn clock(seconds: f64) -> String {
    let seconds = seconds.max(0.0) as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}
