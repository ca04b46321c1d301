//! The panels of the window.

use bevy::prelude::*;
use bevy_envgen::debug::DebugLayers;
use bevy_envgen::prelude::*;
use bevy_mapping_trial::debug::TrialDebugLayers;
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::ui::bevy_egui::EguiContexts;
use bevy_mapping_trial::ui::{TrialStatus, comparison, egui, robot_preview, scores};
use bevy_mapping_trial::view::TrialView;
use egui::{Align2, CentralPanel, ComboBox, Panel, RichText, ScrollArea, Ui, UiBuilder};
use mapping_trial::names::Named;
use mapping_trial::policy::PolicyKind;

use crate::compare::Comparison;
use crate::session::{Phase, Session};

/// Width of the panel at the left, in points.
pub(crate) const WIDTH: f32 = 360.0;

/// Window height in points at which texts have their normal size.
const PLAIN_HEIGHT: f32 = 800.0;

/// Returns the size of a point for a window of this height, since texts grow with the window.
pub(crate) fn zoom(window_height: f32) -> f32 {
    (window_height / PLAIN_HEIGHT).clamp(1.0, 2.5)
}

/// Sets texts that are readable on the dark panels, even in sunlight. It does nothing after the first
/// call.
fn dress(context: &egui::Context) {
    let text = Some(egui::Color32::from_gray(222));
    if context.global_style().visuals.override_text_color != text {
        context.all_styles_mut(|style| {
            style.visuals.override_text_color = text;
            style.visuals.weak_text_color = Some(egui::Color32::from_gray(165));
            style.spacing.item_spacing.y = 5.0;
        });
    }
}

/// Draws the panels and carries out the person's actions.
pub(crate) fn panels(
    mut contexts: EguiContexts,
    window: Single<&Window>,
    mut session: ResMut<Session>,
    mut trials: Query<(&mut MappingTrial, &mut TrialView, &GroundTruth)>,
    worlds: Query<&GroundTruth>,
    mut layers: (ResMut<DebugLayers>, ResMut<TrialDebugLayers>),
    mut commands: Commands,
) -> Result {
    let context = contexts.ctx_mut()?;
    context.set_zoom_factor(zoom(window.height()));
    dress(context);
    let area =
        UiBuilder::new().layer_id(egui::LayerId::background()).max_rect(context.viewport_rect());
    let mut screen = Ui::new(context.clone(), "screen".into(), area);
    let session = &mut *session;
    let mut trial = trials.get_mut(session.world).ok();
    let choosing = matches!(session.phase, Phase::Setup | Phase::Spawning);
    Panel::left("panel").exact_size(WIDTH).resizable(false).show(&mut screen, |ui| {
        match (session.phase, &mut trial) {
            (Phase::Running, Some((holder, view, truth))) => {
                ui.heading("Trial");
                let Some(trial) = holder.trial() else {
                    ui.spinner();
                    return;
                };
                let mut status = TrialStatus::of(trial, session.driven);
                status.paused = session.paused;
                status.training = session.setup.training;
                if let Some(action) = status.show(ui) {
                    session.act(action, holder, view, truth, &mut commands);
                }
                let name =
                    if session.camera_is_large { "Map large (C)" } else { "Camera large (C)" };
                if session.has_cameras && ui.button(name).clicked() {
                    session.camera_is_large = !session.camera_is_large;
                }
                if session.setup.training {
                    ui.separator();
                    debug_layers(ui, &mut layers.0, &mut layers.1);
                }
            }
            (Phase::Form, _) => {
                ui.heading("The trial is over");
                ui.label("Please fill in the form. The scores come after it.");
            }
            (Phase::Done, Some((trial, _, truth))) => done(ui, session, trial, truth),
            _ => setup(ui, session, worlds.get(session.world).ok(), &mut commands),
        }
        if !session.message.is_empty() && !choosing {
            ui.separator();
            ui.label(&session.message);
        }
    });
    if choosing {
        CentralPanel::no_frame().show(&mut screen, |ui| preview(ui, session));
    }
    windows(context, session);
    Ok(())
}

/// The choice of a world and the settings of a trial.
fn setup(
    ui: &mut Ui,
    session: &mut Session,
    spawned: Option<&GroundTruth>,
    commands: &mut Commands,
) {
    Panel::bottom("begin").show(ui, |ui| {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            let is_allowed = session.preview.error().is_none() && session.has_seed();
            let possible = session.phase == Phase::Setup && is_allowed;
            let begin = egui::Button::new(RichText::new("Begin (Enter)").strong());
            if ui.add_enabled(possible, begin).clicked() {
                session.begin(spawned, commands);
            }
            if session.preview.is_pending() || session.phase == Phase::Spawning {
                ui.spinner();
                ui.label(if session.begins || session.phase == Phase::Spawning {
                    "the trial begins when the world is ready"
                } else {
                    "the world is being generated"
                });
            } else if session.preview.world().is_some() {
                ui.weak("the world is ready");
            }
        });
        if let Some(action) = session.spec.show_file(ui) {
            session.edit(action);
        }
        for text in [session.preview.error(), Some(&session.message)].into_iter().flatten() {
            if !text.is_empty() {
                ui.label(text);
            }
        }
    });
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        if let Some(action) = session.setup.show(ui, &mut session.spec) {
            session.edit(action);
        }
    });
}

/// The preview of the settings: in training the world, otherwise the robot, since the driver must not
/// know the world.
fn preview(ui: &mut Ui, session: &mut Session) {
    if !session.setup.training {
        return robot_preview(ui, &session.robot, &session.setup.settings);
    }
    let seed = session.preview.world().map_or(session.spec.seed(), |world| session.seed_in(world));
    let scenario = session.setup.scenario.request().ok();
    if let Some(world) = session.preview.world().cloned() {
        session.note_shown(&world);
    }
    session.preview.show(ui, scenario.as_ref().map(|spec| (spec, seed)));
}

/// Switches for lines over the world, for training.
fn debug_layers(
    ui: &mut Ui,
    world: &mut ResMut<DebugLayers>,
    trial: &mut ResMut<TrialDebugLayers>,
) {
    let (mut of_world, mut of_trial) = (**world, **trial);
    ui.label("Lines over the world");
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut of_world.colliders, "colliders");
        ui.checkbox(&mut of_trial.rays, "rays");
        ui.checkbox(&mut of_trial.frontiers, "frontiers");
        ui.checkbox(&mut of_trial.plan, "plan");
        ui.checkbox(&mut of_world.rooms, "rooms");
        ui.checkbox(&mut of_world.scenario, "people's paths");
    });
    world.set_if_neq(of_world);
    trial.set_if_neq(of_trial);
}

/// The choices after a trial.
fn done(ui: &mut Ui, session: &mut Session, trial: &MappingTrial, truth: &GroundTruth) {
    ui.heading("The trial is over");
    if ui.button("Another trial").clicked() {
        session.phase = Phase::Setup;
    }
    ui.separator();
    ui.label(
        "The session replayed from its log, and a program on the same map with the same seeds:",
    );
    ui.horizontal(|ui| {
        let shown = session.rival.name().unwrap_or_default();
        ComboBox::from_id_salt("rival").selected_text(shown).show_ui(ui, |ui| {
            for (name, kind) in PolicyKind::NAMES {
                ui.selectable_value(&mut session.rival, *kind, *name);
            }
        });
        match session.comparison {
            Some(Comparison::Running(_)) => {
                ui.spinner();
                ui.label("the trials are running");
            }
            _ if ui.button("Compare").clicked() => session.compare(trial, truth),
            _ => {}
        }
    });
    match &session.comparison {
        Some(Comparison::Done(Ok(compared))) => {
            let runs = [("session", &compared.replayed), (compared.name, &compared.program)];
            ScrollArea::vertical().show(ui, |ui| {
                comparison(ui, &runs);
                ui.weak(if compared.same {
                    "Replayed from its log, the session is identical to the last bit."
                } else {
                    "Replayed from its log, the session is NOT identical."
                });
            });
        }
        Some(Comparison::Done(Err(error))) => {
            ui.label(error);
        }
        _ => {}
    }
}

/// The windows of the form and the scores, beside the panel.
fn windows(context: &egui::Context, session: &mut Session) {
    let screen = context.viewport_rect();
    let middle = egui::vec2(0.5 * WIDTH, 0.0);
    let window = |title| {
        let window = egui::Window::new(title).anchor(Align2::CENTER_CENTER, middle);
        window.collapsible(false).resizable(false)
    };
    match session.phase {
        Phase::Form => {
            let Some(form) = &mut session.form else { return };
            let height = (screen.height() - 150.0).max(200.0);
            let filled =
                window("Robot Mapping Feedback Form").default_width(520.0).show(context, |ui| {
                    let filled = form.show(ui, height);
                    (filled, ui.button("Skip the form").clicked())
                });
            match filled.and_then(|shown| shown.inner) {
                Some((Some(feedback), _)) => session.hand_in(feedback),
                Some((None, true)) => session.skip_form(),
                _ => {}
            }
        }
        Phase::Done => {
            if let Some(report) = &session.report {
                window("Scores").show(context, |ui| scores(ui, report));
            }
        }
        _ => {}
    }
}
