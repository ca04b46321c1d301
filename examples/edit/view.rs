//! What part of the plan the window shows.

use bevy::camera::{ScalingMode, Viewport};
use bevy::prelude::*;
use bevy_mapping_trial::ui::egui;
use envgen::geometry::Rect as WorldRect;
use envgen::glam::DVec2;

use crate::session::Session;

/// Metres per point, from nearest to farthest.
const ZOOM: (f64, f64) = (1e-3, 1e3);

/// Share of the canvas that a whole world fills.
const FILLED: f64 = 0.92;

/// The part of the world in the window's canvas.
pub(crate) struct View {
    center: DVec2,
    /// Metres of the world per point of the canvas.
    scale: f64,
    /// The canvas in points of the window, y down.
    canvas: egui::Rect,
    /// Pixels per point.
    density: f32,
    /// What is to be shown whole, as soon as the canvas is known.
    fit: Option<WorldRect>,
    /// The point of the world at the origin of the app, near which single precision is exact enough.
    origin: DVec2,
}

impl View {
    /// A view of a whole area.
    pub(crate) fn of(area: WorldRect) -> Self {
        let center = area.center();
        View {
            center,
            scale: 0.05,
            canvas: egui::Rect::ZERO,
            density: 1.0,
            fit: Some(area),
            origin: center,
        }
    }

    /// Shows a whole area.
    pub(crate) fn fit(&mut self, area: WorldRect) {
        self.fit = Some(area);
    }

    /// Fits the view to a canvas, whose points are so many pixels wide.
    pub(crate) fn set_canvas(&mut self, canvas: egui::Rect, density: f32) {
        (self.canvas, self.density) = (canvas, density);
        let is_seen = canvas.width() > 1.0 && canvas.height() > 1.0;
        if let Some(area) = self.fit.take_if(|_| is_seen) {
            let size = area.size();
            let scale =
                (size.x / f64::from(canvas.width())).max(size.y / f64::from(canvas.height()));
            self.center = area.center();
            self.scale = (scale / FILLED).clamp(ZOOM.0, ZOOM.1);
        }
    }

    /// The canvas in points of the window.
    pub(crate) fn canvas(&self) -> egui::Rect {
        self.canvas
    }

    /// The point of the world at the origin of the app.
    pub(crate) fn origin(&self) -> DVec2 {
        self.origin
    }

    /// Metres of the world per point of the canvas.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// The point of the world at a point of the window.
    pub(crate) fn to_world(&self, p: egui::Pos2) -> DVec2 {
        let offset = p - self.canvas.center();
        self.center + DVec2::new(f64::from(offset.x), -f64::from(offset.y)) * self.scale
    }

    /// The point of the window at a point of the world.
    pub(crate) fn to_canvas(&self, p: DVec2) -> egui::Pos2 {
        let offset = (p - self.center) / self.scale;
        self.canvas.center() + egui::vec2(offset.x as f32, -offset.y as f32)
    }

    /// The area of the world in the canvas.
    pub(crate) fn area(&self) -> WorldRect {
        let corners = [self.canvas.left_bottom(), self.canvas.right_top()];
        let [min, max] = corners.map(|corner| self.to_world(corner));
        WorldRect::new(min, max)
    }

    /// Moves the world with the pointer.
    pub(crate) fn pan(&mut self, by: egui::Vec2) {
        self.center -= DVec2::new(f64::from(by.x), -f64::from(by.y)) * self.scale;
    }

    /// Shows less (factor below 1) or more around a point of the window, which stays where it is.
    pub(crate) fn zoom(&mut self, factor: f64, around: egui::Pos2) {
        let fixed = self.to_world(around);
        self.scale = (self.scale * factor).clamp(ZOOM.0, ZOOM.1);
        self.center += fixed - self.to_world(around);
    }
}

/// The camera that shows the world.
#[derive(Component)]
pub(crate) struct WorldCamera;

/// Moves the camera to what the view shows.
pub(crate) fn follow(
    session: Res<Session>,
    window: Single<&Window>,
    mut cameras: Query<(&mut Camera, &mut Projection, &mut Transform), With<WorldCamera>>,
) {
    let Ok((mut camera, mut projection, mut transform)) = cameras.single_mut() else { return };
    let dense = session.view.density;
    let view = &session.view;
    let pixels = |p: egui::Pos2| {
        UVec2::new((p.x * dense).round().max(0.0) as u32, (p.y * dense).round().max(0.0) as u32)
            .min(window.physical_size())
    };
    let (min, max) = (pixels(view.canvas.min), pixels(view.canvas.max));
    let size = max.saturating_sub(min);
    camera.is_active = size.min_element() > 0;
    if !camera.is_active {
        return;
    }
    camera.viewport = Some(Viewport { physical_position: min, physical_size: size, ..default() });
    transform.translation = (view.center - view.origin).as_vec2().extend(transform.translation.z);
    if let Projection::Orthographic(orthographic) = &mut *projection {
        let height = size.y as f32 / dense * view.scale as f32;
        orthographic.scaling_mode = ScalingMode::FixedVertical { viewport_height: height };
    }
}
