//! The pictures of the robots' cameras beside the panel, and the frame of the small map.

use bevy::prelude::*;
use bevy_mapping_trial::ui::bevy_egui::EguiContexts;
use bevy_mapping_trial::ui::egui::{
    Align2, Color32, FontId, LayerId, Painter, Pos2, Rect as Area, Stroke, StrokeKind, TextureId,
    Vec2 as Size, pos2, vec2,
};
use bevy_mapping_trial::view::TrialPalette;

use crate::cameras;
use crate::panels::zoom;
use crate::robot_cameras::{ASPECT, RobotPictures};
use crate::session::{Phase, Session};

/// Width of a small picture as a fraction of the space beside the panel, and its distance from the
/// edges in points.
const SMALL: f32 = 0.26;
const MARGIN: f32 = 12.0;

/// Draws the pictures. That of the driven robot is large, around the small map, or small at the left;
/// those of the others are small at the right.
pub(crate) fn show(
    mut contexts: EguiContexts,
    window: Single<&Window>,
    session: Res<Session>,
    pictures: Option<Res<RobotPictures>>,
    palette: Res<TrialPalette>,
) -> Result {
    if session.phase != Phase::Running {
        return Ok(());
    }
    let painter = contexts.ctx_mut()?.layer_painter(LayerId::background());
    let scale = zoom(window.height()) * window.scale_factor();
    let in_points = |area: URect| {
        let corner = |p: UVec2| pos2(p.x as f32, p.y as f32) / scale;
        Area::from_min_max(corner(area.min), corner(area.max))
    };
    let beside = cameras::beside(&window);
    let map = in_points(cameras::minimap(window.physical_size(), beside));
    let beside = in_points(beside);
    if let Some(pictures) = pictures {
        let of = |robot: usize| Some((robot, pictures.texture(robot, &session)?));
        let small = vec2(SMALL * beside.width(), SMALL * beside.width() / ASPECT);
        let frame = |area: Area, (robot, texture): (usize, TextureId)| {
            paint(&painter, area, area, texture);
            let [red, green, blue, _] = palette.robot(robot).to_srgba().to_u8_array();
            let color = Color32::from_rgb(red, green, blue);
            painter.rect_stroke(area, 0.0, Stroke::new(2.0, color), StrokeKind::Outside);
            label(&painter, area, robot);
        };
        if let Some((robot, texture)) = of(session.driven) {
            if session.camera_is_large {
                for part in around(beside, map) {
                    paint(&painter, part, beside, texture);
                }
                label(&painter, beside, robot);
            } else {
                let at = beside.left_bottom() + vec2(MARGIN, -MARGIN - small.y);
                frame(Area::from_min_size(at, small), (robot, texture));
            }
        }
        let robots = session.setup.settings.robots as usize;
        let others = (0..robots).filter(|robot| *robot != session.driven).filter_map(of);
        let size = stacked(small, robots.saturating_sub(1), map.top() - beside.top() - MARGIN);
        let mut at = beside.right_top() + vec2(-MARGIN - size.x, MARGIN);
        for other in others {
            frame(Area::from_min_size(at, size), other);
            at.y += size.y + MARGIN;
        }
    }
    let stroke = Stroke::new(1.5, Color32::from_gray(40));
    painter.rect_stroke(map, 0.0, stroke, StrokeKind::Outside);
    Ok(())
}

/// Returns the size of each of a number of small pictures, which are scaled down where they would not fit above each
/// other in a height, each with its margin.
fn stacked(small: Size, number: usize, height: f32) -> Size {
    let each = height / number.max(1) as f32 - MARGIN;
    small * (each / small.y).clamp(0.0, 1.0)
}

/// Draws the part of a picture that lies in an area. The whole picture fills `whole` and is cut to its
/// shape.
fn paint(painter: &Painter, area: Area, whole: Area, texture: TextureId) {
    // The visible fraction of the picture.
    let shape = whole.width() / whole.height() / ASPECT;
    let seen = vec2(shape.min(1.0), (1.0 / shape).min(1.0));
    let place = |p: Pos2| {
        let share = (p - whole.min) / whole.size();
        (vec2(0.5, 0.5) + (share - vec2(0.5, 0.5)) * seen).to_pos2()
    };
    let part = Area::from_min_max(place(area.min), place(area.max));
    painter.image(texture, area, part, Color32::WHITE);
}

/// Returns what is left of an area around a hole in it.
fn around(area: Area, hole: Area) -> [Area; 4] {
    let part = |min: Pos2, max: Pos2| Area::from_min_max(min, max);
    [
        part(area.min, pos2(area.right(), hole.top())),
        part(pos2(area.left(), hole.bottom()), area.max),
        part(pos2(area.left(), hole.top()), hole.left_bottom()),
        part(hole.right_top(), pos2(area.right(), hole.bottom())),
    ]
}

/// Draws in the upper left corner of a picture to which robot it belongs.
fn label(painter: &Painter, area: Area, robot: usize) {
    let font = FontId::proportional(14.0);
    let text = painter.layout_no_wrap(format!("robot {}", robot + 1), font, Color32::WHITE);
    let place = Align2::LEFT_TOP.anchor_size(area.min + vec2(6.0, 4.0), text.size());
    painter.rect_filled(place.expand2(vec2(4.0, 1.0)), 2.0, Color32::from_black_alpha(140));
    painter.galley(place.min, text, Color32::WHITE);
}
