//! Marks on the floor for the start, the goal and people to be found, and the lane markings of roads.

use std::collections::BTreeMap;

use bevy::prelude::*;
use envgen::glam::DVec2;
use envgen::world::RoadStrip;

use super::draft::Draft;
use super::finish::Finish;
use super::palette::Palette3d;
use crate::part::PartKind;

/// The height of marks above the floor in metres, which is above all other thin layers.
const HEIGHT: f32 = 0.03;

/// The lane markings of roads: height above the floor, width, length and gap in metres.
const LINE: (f32, f64, f64, f64) = (0.014, 0.12, 3.0, 4.5);

/// Adds the mark of a start, a goal or a person to be found.
pub(super) fn add(
    drafts: &mut BTreeMap<Finish, Draft>,
    kind: PartKind,
    at: &Transform,
    palette: &Palette3d,
) {
    let place = |p: Vec2| at.transform_point(p.extend(0.0)).truncate();
    let color = match kind {
        PartKind::Start => palette.start,
        PartKind::Goal => palette.goal,
        _ => {
            let body = Capsule3d::new(0.16, 1.0).mesh().build();
            let along = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
            let lying = |mesh: Mesh, x: f32, turn| {
                mesh.transformed_by(*at * Transform::from_xyz(x, 0.0, 0.16).with_rotation(turn))
            };
            let draft = drafts.entry(Finish::Plain).or_default();
            draft.add_mesh(&lying(body, -0.25, along), palette.victim);
            let head = Sphere::new(0.12).mesh().uv(16, 12);
            draft.add_mesh(&lying(head, 0.6, Quat::IDENTITY), palette.head);
            return;
        }
    };
    // An arrow in two halves, which are convex.
    let draft = drafts.entry(Finish::Mark).or_default();
    for side in [1.0, -1.0] {
        let mut half = [(0.4, 0.0), (-0.25, 0.25), (-0.12, 0.0)];
        if side < 0.0 {
            half.reverse();
        }
        let corners = half.map(|(x, y)| place(Vec2::new(x, side * y)));
        draft.add_flat(&corners, at.translation.z + HEIGHT, color);
    }
}

/// Adds the markings between the lanes of a road.
pub(super) fn add_lanes(draft: &mut Draft, strip: &RoadStrip, origin: DVec2, palette: &Palette3d) {
    let (height, width, length, gap) = LINE;
    let path = strip.path();
    let whole = path.length();
    for lane in 1..strip.lanes {
        let beside = strip.lane_width() * f64::from(lane) - 0.5 * strip.width;
        let mut at = 0.5 * gap;
        while at + length <= whole {
            // Straight pieces of one metre follow the curves of roads.
            for piece in 0..length as u32 {
                let [from, to] = [0.0, 1.0].map(|end| path.pose_at(at + f64::from(piece) + end));
                let corner = |pose: envgen::geometry::Pose, side: f64| {
                    let across = envgen::geometry::unit_vector(pose.heading).perp();
                    (pose.position + across * (beside + side * 0.5 * width) - origin).as_vec2()
                };
                let corners =
                    [corner(from, -1.0), corner(to, -1.0), corner(to, 1.0), corner(from, 1.0)];
                draft.add_flat(&corners, height, palette.marking);
            }
            at += length + gap;
        }
    }
}
