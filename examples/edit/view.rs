//! The view: which part of the world the window shows, and from where. It shows the plan from above, or
//! the tilted world, as seen from far away in a sloping direction. In both, each point of the floor
//! corresponds to one point of the window.

use std::f64::consts::FRAC_PI_4;

use bevy::camera::{ScalingMode, Viewport};
use bevy::prelude::*;
use bevy_mapping_trial::ui::egui;
use envgen::geometry::{Rect as WorldRect, unit_vector};
use envgen::glam::{DVec2, DVec3};

/// Metres per point, from the nearest to the farthest zoom.
const ZOOM: (f64, f64) = (1e-3, 1e3);

/// Fraction of the canvas that a whole world fills.
const FILLED: f64 = 0.92;

/// Direction of the tilted view, along the floor and down: 53 degrees.
const ALONG: f64 = 0.6;
const DOWN: f64 = 0.8;

/// Angle between the directions from which the tilted view can show the world.
const TURN: f64 = FRAC_PI_4;

/// Distance in metres above everything at which the tilted view begins.
const ABOVE: f64 = 1.0;

/// The part of the world that the window's canvas shows.
pub(crate) struct View {
    /// Point of the floor in the middle of the canvas.
    center: DVec2,
    /// Whether the world is seen tilted; otherwise it is seen from above.
    tilted: bool,
    /// Number of steps by which the tilted view is turned counter-clockwise.
    turns: i32,
    /// Height above the floor, in metres, at which the tilted view begins.
    ceiling: f64,
    /// Metres of the world per point of the canvas.
    scale: f64,
    /// The canvas in points of the window, y down.
    canvas: egui::Rect,
    /// Pixels per point.
    density: f32,
    /// An area to be shown as a whole, as soon as the canvas is known.
    fit: Option<WorldRect>,
    /// Point of the world at the origin of the app, near which single precision is exact enough.
    origin: DVec2,
}

impl View {
    /// Creates a view of a whole area.
    pub(crate) fn of(area: WorldRect) -> Self {
        let center = area.center();
        View {
            center,
            tilted: false,
            turns: 0,
            ceiling: ABOVE,
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

    /// Fits the view to a canvas. `density` is the number of pixels per point.
    pub(crate) fn set_canvas(&mut self, canvas: egui::Rect, density: f32) {
        (self.canvas, self.density) = (canvas, density);
        let is_seen = canvas.width() > 1.0 && canvas.height() > 1.0;
        if let Some(area) = self.fit.take_if(|_| is_seen) {
            let half = 0.5 * area.size();
            let corners = [half, DVec2::new(half.x, -half.y)].map(|p| self.on_screen(p).abs());
            let size = 2.0 * corners[0].max(corners[1]);
            let scale =
                (size.x / f64::from(canvas.width())).max(size.y / f64::from(canvas.height()));
            self.center = area.center();
            self.scale = (scale / FILLED).clamp(ZOOM.0, ZOOM.1);
        }
    }

    /// Returns the canvas in points of the window.
    pub(crate) fn canvas(&self) -> egui::Rect {
        self.canvas
    }

    /// Returns the point of the world at the origin of the app.
    pub(crate) fn origin(&self) -> DVec2 {
        self.origin
    }

    /// Returns the metres of the world per point of the canvas.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns whether the world is seen tilted.
    pub(crate) fn is_tilted(&self) -> bool {
        self.tilted
    }

    /// Shows everything up to this height in metres.
    pub(crate) fn set_height(&mut self, height: f64) {
        self.ceiling = height.max(0.0) + ABOVE;
    }

    /// Switches between the plan and the tilted view, around the middle of the canvas.
    pub(crate) fn tilt(&mut self) {
        self.tilted = !self.tilted;
    }

    /// Turns the tilted view counter-clockwise by a number of steps, around the middle of the canvas.
    pub(crate) fn turn(&mut self, steps: i32) {
        if self.tilted {
            self.turns = (self.turns + steps).rem_euclid(8);
        }
    }

    /// The direction on the floor that is to the right of the canvas.
    fn right(&self) -> DVec2 {
        if self.tilted { unit_vector(f64::from(self.turns) * TURN) } else { DVec2::X }
    }

    /// The length in the canvas of one metre on the floor, in the direction away from the viewer.
    fn foreshortening(&self) -> f64 {
        if self.tilted { DOWN } else { 1.0 }
    }

    /// The unit vector in which the view looks, x and y in the plan, z up.
    fn direction(&self) -> DVec3 {
        let level = if self.tilted { ALONG } else { 0.0 };
        (self.right().perp() * level).extend(-self.foreshortening())
    }

    /// A vector of the floor as metres to the right and up in the canvas.
    fn on_screen(&self, by: DVec2) -> DVec2 {
        let right = self.right();
        DVec2::new(by.dot(right), by.dot(right.perp()) * self.foreshortening())
    }

    /// The vector of the floor for a vector of points to the right and down in the canvas.
    fn on_floor(&self, by: egui::Vec2) -> DVec2 {
        let by = DVec2::new(f64::from(by.x), -f64::from(by.y)) * self.scale;
        let right = self.right();
        right * by.x + right.perp() * (by.y / self.foreshortening())
    }

    /// Returns the point of the floor at a point of the window.
    pub(crate) fn to_world(&self, p: egui::Pos2) -> DVec2 {
        self.center + self.on_floor(p - self.canvas.center())
    }

    /// Returns the point of the window at a point of the floor.
    pub(crate) fn to_canvas(&self, p: DVec2) -> egui::Pos2 {
        let offset = self.on_screen(p - self.center) / self.scale;
        self.canvas.center() + egui::vec2(offset.x as f32, -offset.y as f32)
    }

    /// Returns the radii in points of a disc on the floor.
    pub(crate) fn radii(&self, radius: f64) -> egui::Vec2 {
        let radius = (radius / self.scale).max(3.0) as f32;
        egui::vec2(radius, radius * self.foreshortening() as f32)
    }

    /// Returns the ray that meets the floor at a point: its origin, which is above everything, and its
    /// direction, whose length is the distance to the floor.
    pub(crate) fn ray(&self, floor: DVec2) -> (DVec3, DVec3) {
        let direction = self.direction() * (self.ceiling / self.foreshortening());
        (floor.extend(0.0) - direction, direction)
    }

    /// Returns a rectangle of the world around the part of the floor that is in the canvas.
    pub(crate) fn area(&self) -> WorldRect {
        let canvas = self.canvas;
        let corners =
            [canvas.left_bottom(), canvas.right_bottom(), canvas.left_top(), canvas.right_top()];
        let corners = corners.map(|corner| self.to_world(corner));
        let [first, ..] = corners;
        let around = corners.iter().fold((first, first), |(a, b), &p| (a.min(p), b.max(p)));
        WorldRect::new(around.0, around.1)
    }

    /// Moves the world with the pointer.
    pub(crate) fn pan(&mut self, by: egui::Vec2) {
        self.center -= self.on_floor(by);
    }

    /// Zooms in (factor below 1) or out around a point of the window, which stays where it is.
    pub(crate) fn zoom(&mut self, factor: f64, around: egui::Pos2) {
        let fixed = self.to_world(around);
        self.scale = (self.scale * factor).clamp(ZOOM.0, ZOOM.1);
        self.center += fixed - self.to_world(around);
    }
}

/// A camera that shows the world.
#[derive(Component, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WorldCamera {
    Plan,
    Tilted,
}

/// What a view changes in a camera.
pub(crate) type Placed =
    (&'static WorldCamera, &'static mut Camera, &'static mut Projection, &'static mut Transform);

impl View {
    /// Moves the cameras of a window to what it shows, and activates one of them.
    pub(crate) fn place(&self, window: &Window, cameras: &mut Query<Placed>) {
        let dense = self.density;
        let pixels = |p: egui::Pos2| {
            UVec2::new((p.x * dense).round().max(0.0) as u32, (p.y * dense).round().max(0.0) as u32)
                .min(window.physical_size())
        };
        let (min, max) = (pixels(self.canvas.min), pixels(self.canvas.max));
        let size = max.saturating_sub(min);
        let height = f64::from(size.y) / f64::from(dense) * self.scale;
        let center = (self.center - self.origin).as_vec2().extend(0.0);
        for (kind, mut camera, mut projection, mut transform) in cameras {
            let is_active =
                size.min_element() > 0 && (*kind == WorldCamera::Tilted) == self.is_tilted();
            camera.is_active = is_active;
            if !is_active {
                continue;
            }
            camera.viewport =
                Some(Viewport { physical_position: min, physical_size: size, ..default() });
            let mut far = None;
            match kind {
                WorldCamera::Plan => {
                    transform.translation = center.with_z(transform.translation.z);
                }
                WorldCamera::Tilted => {
                    // The range is from the nearest point of the floor in the canvas to the farthest
                    // one, and what is above.
                    let away = (0.5 * height * ALONG + self.ceiling) / DOWN;
                    let direction = self.direction().as_vec3();
                    *transform = Transform::from_translation(center - direction * away as f32)
                        .looking_to(direction, Vec3::Z);
                    far = Some(2.0 * away as f32);
                }
            }
            if let Projection::Orthographic(orthographic) = &mut *projection {
                orthographic.scaling_mode =
                    ScalingMode::FixedVertical { viewport_height: height as f32 };
                orthographic.far = far.unwrap_or(orthographic.far);
            }
        }
    }
}
