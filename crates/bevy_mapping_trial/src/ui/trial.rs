//! The panel for a running trial.

use bevy_egui::egui::{Grid, ProgressBar, Ui};
use mapping_trial::backend::RobotBackend;
use mapping_trial::trial::Trial;

/// What an operator sees of a running trial. It does not include the intended difficulty of the world, so
/// that ratings are blind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialStatus {
    /// The simulated seconds since the start.
    pub time: f64,
    /// The simulated seconds after which the trial ends.
    pub time_limit: f64,
    /// The remaining operating time of the battery in seconds.
    pub battery: f64,
    /// The operating time of a full battery in seconds.
    pub full_battery: f64,
    /// The distance that the driven robot has travelled, in metres.
    pub distance: f64,
    /// The number of collisions of the driven robot.
    pub collisions: u32,
    /// The index of the driven robot, counted from 0.
    pub driven: usize,
    /// The number of robots.
    pub robots: usize,
    /// Whether an exploration policy drives.
    pub program: bool,
    /// Whether the trial is paused.
    pub paused: bool,
    /// Whether the true world and the true poses are shown.
    pub training: bool,
    /// The reason why the robot has ended its trial, or `None` while it drives.
    pub end: Option<&'static str>,
}

/// A request of the user during a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialAction {
    /// Pause or resume time.
    Pause,
    /// Start the same trial again.
    Reset,
    /// End the trial now.
    Stop,
    /// Show or hide the true world and the true poses.
    Training,
    /// Drive the next robot.
    NextRobot,
}

impl TrialStatus {
    /// Creates the status of a trial in which `driven` is the driven robot.
    pub fn of<B: RobotBackend>(trial: &Trial<B>, driven: usize) -> Self {
        let settings = trial.settings();
        let driven = driven.min(trial.robots().saturating_sub(1));
        TrialStatus {
            time: trial.time(),
            time_limit: settings.time_limit,
            battery: (settings.body.battery - trial.time()).max(0.0),
            full_battery: settings.body.battery,
            distance: trial.trajectory(driven).distance,
            collisions: trial.bodies().collisions(driven),
            driven,
            robots: trial.robots(),
            program: settings.policy.is_some(),
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
            ui.label("collisions");
            ui.label(self.collisions.to_string());
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
            let pause = if self.paused { "Resume (P)" } else { "Pause (P)" };
            let training = if self.training { "Hide the truth (T)" } else { "Training view (T)" };
            for (text, wanted, help) in [
                (pause, TrialAction::Pause, "also with Esc"),
                ("Reset (R)", TrialAction::Reset, "starts the same trial again"),
                ("Stop (End)", TrialAction::Stop, "ends the trial now; form and scores follow"),
                (training, TrialAction::Training, "for training: shows the true world"),
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

/// Formats a time as minutes and seconds.
fn clock(seconds: f64) -> String {
    let seconds = seconds.max(0.0) as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}
