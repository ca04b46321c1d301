//! A drawing of the robot of a trial: the field of view of its laser to scale, and its body with sizes in
//! metres.

use std::f32::consts::TAU;

use bevy_egui::egui::{
    Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2,
    pos2, vec2,
};
use envgen::palette;
use mapping_trial::backend::TICK;
use mapping_trial::lidar::LaserProfile;
use mapping_trial::names::Named;
use mapping_trial::robot::{Footprint, Robot};
use mapping_trial::trial::TrialSettings;

use super::colors::PAGE;

/// The points between the drawings and the edges.
const MARGIN: f32 = 24.0;
/// The points between drawings.
const GAP: f32 = 32.0;
/// The fraction of the height that the two views of the body take.
const BODY_SHARE: f32 = 0.4;
/// The points to the left and right of a view of the body, and above and below it, for its dimensions.
const DIMENSIONS: [Vec2; 2] = [vec2(68.0, 8.0), vec2(44.0, 36.0)];
/// The length in points of the longest segment of an arc.
const ARC_STEP: f32 = 4.0;

const INK: Color32 = Color32::from_gray(40);
const FAINT: Color32 = Color32::from_gray(120);
const BODY: Color32 = {
    let [red, green, blue] = palette::VERMILION.0;
    Color32::from_rgb(red, green, blue)
};
/// The area that the laser sees, in a lighter tone of the colour of the body.
const BEAMS: Color32 = Color32::from_rgb(0xfb, 0xe9, 0xda);

/// Draws the robot of a trial into all of the remaining space: the range and the field of view of the laser
/// with the robot in it, to scale; the robot from above and from the side with its sizes in metres; and its
/// sensors and speeds.
///
/// ```
/// use bevy_mapping_trial::ui::{egui, robot_preview};
/// use mapping_trial::trial::TrialSettings;
///
/// let context = egui::Context::default();
/// context.run_ui(egui::RawInput::default(), |ui| {
///     robot_preview(ui, "Pioneer 3-AT", &TrialSettings::default());
/// }).drop_without_applying_deltas();
/// ```
pub fn robot_preview(ui: &mut Ui, name: &str, settings: &TrialSettings) {
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    let painter = ui.painter_at(area);
    painter.rect_filled(area, 0.0, PAGE);
    if settings.validate().is_err() {
        return;
    }
    let mut inside = area.shrink(MARGIN);
    let laser = settings.laser.name().unwrap_or("custom");
    let count = if settings.robots == 1 { "" } else { "s, which share one map" };
    let title = format!("{name}, laser {laser}");
    let title = text(&painter, inside.min, Align2::LEFT_TOP, &title, 20.0, INK);
    let robots = format!("{} robot{count}", settings.robots);
    let below = title.left_bottom() + vec2(0.0, 2.0);
    let robots = text(&painter, below, Align2::LEFT_TOP, &robots, 14.0, FAINT);
    inside.min.y = robots.bottom() + 12.0;

    let split = inside.bottom() - BODY_SHARE * inside.height();
    let sight = Rect::from_min_max(inside.min, pos2(inside.right(), split - 0.5 * GAP));
    let bodies = Rect::from_min_max(pos2(inside.left(), split + 0.5 * GAP), inside.max);
    draw_sight(&painter, sight, &settings.body, &settings.laser);
    draw_bodies(&painter, bodies, settings);
}

/// Converts metres to points on the screen. Forward is up, and x is ahead and y to the left of the robot.
struct Plan {
    /// The position of the robot's centre on the screen.
    centre: Pos2,
    /// The number of points per metre.
    scale: f32,
}

impl Plan {
    fn at(&self, ahead: f32, left: f32) -> Pos2 {
        self.centre - self.scale * vec2(left, ahead)
    }
}

/// Draws the field of view to scale, with circles at round ranges, and the robot in it.
fn draw_sight(painter: &Painter, area: Rect, robot: &Robot, laser: &LaserProfile) {
    let (range, half) = (laser.max_range as f32, 0.5 * laser.field_of_view as f32);
    let mount = robot.laser_mount;
    let (heading, from) =
        (mount.heading as f32, vec2(robot.laser_offset as f32, mount.left as f32));
    // The area that must be visible, in metres from the robot's centre: the arc, the laser and the robot.
    let radius = robot.circumscribed_radius as f32;
    let mut needed = Rect::from_center_size(Pos2::ZERO, Vec2::splat(2.0 * radius));
    needed.extend_with(from.to_pos2());
    for step in 0..=64 {
        let angle = heading - half + 2.0 * half * step as f32 / 64.0;
        needed.extend_with((from + range * Vec2::angled(angle)).to_pos2());
    }
    // On the screen, x is to the left and y upwards. The texts are beside the arc.
    let size = vec2(needed.height(), needed.width());
    let room = area.shrink2(vec2(64.0, 18.0));
    let scale = (room.size() / size).min_elem();
    let middle = needed.center();
    let plan = Plan { centre: room.center() + scale * vec2(middle.y, middle.x), scale };
    let laser_at = plan.at(from.x, from.y);
    let toward = |angle: f32, radius: f32| {
        let direction = Vec2::angled(heading + angle);
        laser_at - scale * radius * vec2(direction.y, direction.x)
    };

    // A fan of triangles is used, since fields of view of more than 180 degrees are not convex.
    let steps = ((2.0 * half * range * scale / ARC_STEP) as usize).clamp(8, 720);
    let angle = |step: usize| -half + 2.0 * half * step as f32 / steps as f32;
    let mut fan = Mesh::default();
    fan.colored_vertex(laser_at, BEAMS);
    for step in 0..=steps {
        fan.colored_vertex(toward(angle(step), range), BEAMS);
        if step > 0 {
            fan.add_triangle(0, step as u32, step as u32 + 1);
        }
    }
    painter.add(fan);
    let arc = |radius: f32| (0..=steps).map(|step| toward(angle(step), radius)).collect::<Vec<_>>();
    let spacing = round_step(range);
    for ring in 1.. {
        let radius = spacing * ring as f32;
        if radius > range - 0.25 * spacing {
            break;
        }
        painter.line(arc(radius), Stroke::new(1.0, Color32::from_black_alpha(40)));
        let place = toward(0.0, radius);
        text(painter, place, Align2::CENTER_CENTER, &metres(radius), 12.0, FAINT);
    }
    let mut outline = arc(range);
    if half < 0.5 * TAU - 1e-3 {
        outline.insert(0, laser_at);
        outline.push(laser_at);
    }
    painter.line(outline, Stroke::new(1.5, BODY));
    let degrees = laser.field_of_view.to_degrees();
    let label = format!("range {}, field of view {degrees:.0} degrees", metres(range));
    let above = toward(0.0, range) - vec2(0.0, 4.0);
    text(painter, above, Align2::CENTER_BOTTOM, &label, 14.0, INK);
    draw_body(painter, &plan, robot);
}

/// Draws the body from above.
fn draw_body(painter: &Painter, plan: &Plan, robot: &Robot) {
    let (half_length, half_width) = (0.5 * robot.length as f32, 0.5 * robot.width as f32);
    let stroke = Stroke::new(1.0, INK);
    match robot.footprint {
        Footprint::Box => {
            let corners = [
                plan.at(half_length, half_width),
                plan.at(half_length, -half_width),
                plan.at(-half_length, -half_width),
                plan.at(-half_length, half_width),
            ];
            painter.add(Shape::convex_polygon(corners.to_vec(), BODY, stroke));
        }
        Footprint::Disc => {
            let radius = plan.scale * robot.circumscribed_radius as f32;
            painter.circle(plan.at(0.0, 0.0), radius, BODY, stroke);
        }
    }
    let head = [
        plan.at(0.85 * half_length, 0.0),
        plan.at(0.1 * half_length, -0.6 * half_width),
        plan.at(0.1 * half_length, 0.6 * half_width),
    ];
    painter.add(Shape::convex_polygon(head.to_vec(), INK, Stroke::NONE));
}

/// Draws the body from above and from the side, to the same scale, and the facts about the robot.
fn draw_bodies(painter: &Painter, area: Rect, settings: &TrialSettings) {
    let robot = &settings.body;
    let third = (area.width() - 2.0 * GAP) / 3.0;
    let column = |i: usize| {
        let left = area.left() + i as f32 * (third + GAP);
        Rect::from_min_size(pos2(left, area.top()), vec2(third, area.height()))
    };
    let (swing, length) = (2.0 * robot.circumscribed_radius as f32, robot.length as f32);
    let height = robot.height.max(robot.laser_mount.height) as f32;
    let view = |i: usize| {
        let [Vec2 { x: left, y: right }, Vec2 { x: above, y: below }] = DIMENSIONS;
        let Rect { min, max } = column(i);
        Rect::from_min_max(min + vec2(left, above), max - vec2(right, below))
    };
    let room = view(0).size();
    let scale = (room / vec2(swing.max(length), swing.max(height))).min_elem();
    if scale <= 0.0 {
        return;
    }
    caption(painter, column(0), "from above");
    draw_top(painter, view(0).center(), scale, robot);
    let laser = metres(robot.laser_mount.height as f32);
    caption(painter, column(1), &format!("from the side, laser at {laser}"));
    draw_side(painter, view(1), scale, robot);
    draw_facts(painter, column(2), settings);
}

/// Draws the body from above with its length, its width and the circle in which it turns.
fn draw_top(painter: &Painter, centre: Pos2, scale: f32, robot: &Robot) {
    let plan = Plan { centre, scale };
    let radius = scale * robot.circumscribed_radius as f32;
    let circle: Vec<Pos2> = (0..=90)
        .map(|step| plan.centre + radius * Vec2::angled(TAU * step as f32 / 90.0))
        .collect();
    painter.extend(Shape::dashed_line(&circle, Stroke::new(1.0, FAINT), 4.0, 4.0));
    draw_body(painter, &plan, robot);
    let laser = plan.at(robot.laser_offset as f32, robot.laser_mount.left as f32);
    painter.circle(laser, 5.0, PAGE, Stroke::new(1.5, INK));
    let half = 0.5 * scale * vec2(robot.width as f32, robot.length as f32);
    let outside = half.max(Vec2::splat(radius)) + Vec2::splat(10.0);
    let (left, below) = (plan.centre.x - outside.x, plan.centre.y + outside.y);
    let (top, bottom) = (plan.centre.y - half.y, plan.centre.y + half.y);
    dimension(painter, [pos2(left, top), pos2(left, bottom)], robot.length);
    let sides = [pos2(plan.centre.x - half.x, below), pos2(plan.centre.x + half.x, below)];
    dimension(painter, sides, robot.width);
    let turns = format!("turns in {}", metres(2.0 * robot.circumscribed_radius as f32));
    let above = plan.centre - vec2(0.0, radius + 4.0);
    text(painter, above, Align2::CENTER_BOTTOM, &turns, 12.0, FAINT);
}

/// Draws the body from the side on the ground, with its height and the plane of its laser.
fn draw_side(painter: &Painter, area: Rect, scale: f32, robot: &Robot) {
    let (length, height) = (scale * robot.length as f32, scale * robot.height as f32);
    let plane = scale * robot.laser_mount.height as f32;
    let ground = area.center().y + 0.5 * height.max(plane);
    let middle = area.center().x;
    painter.hline(area.left()..=area.right(), ground, Stroke::new(1.5, INK));
    let body = Rect::from_min_max(
        pos2(middle - 0.5 * length, ground - height),
        pos2(middle + 0.5 * length, ground),
    );
    painter.rect(body, 0.0, BODY, Stroke::new(1.0, INK), StrokeKind::Inside);
    let laser = pos2(middle + scale * robot.laser_offset as f32, ground - plane);
    let beam = [laser, pos2(area.right(), laser.y)];
    painter.extend(Shape::dashed_line(&beam, Stroke::new(1.5, BODY), 6.0, 4.0));
    painter.circle(laser, 5.0, PAGE, Stroke::new(1.5, INK));
    let left = body.left() - 10.0;
    dimension(painter, [pos2(left, body.top()), pos2(left, body.bottom())], robot.height);
}

/// Draws the facts about the robot's speeds and sensors.
fn draw_facts(painter: &Painter, area: Rect, settings: &TrialSettings) {
    let (robot, laser) = (&settings.body, &settings.laser);
    let scans = 1.0 / (TICK * f64::from(laser.ticks_a_scan));
    let facts = [
        ("speed", format!("{} m/s", robot.max_speed)),
        ("turning", format!("{:.0} degrees/s", robot.max_turn_rate.to_degrees())),
        ("battery", format!("{:.0} s", robot.battery)),
        ("laser", format!("{} beams, {scans} scans/s", laser.beams)),
        ("noise", format!("{} m", laser.sigma)),
        ("odometry", settings.odometry.name().unwrap_or("custom").to_owned()),
    ];
    let mut at = area.min;
    for (name, value) in facts {
        let name = text(painter, at, Align2::LEFT_TOP, name, 14.0, FAINT);
        let value_at = pos2(area.left() + 76.0, at.y);
        text(painter, value_at, Align2::LEFT_TOP, &value, 14.0, INK);
        at.y += name.height() + 6.0;
    }
}

fn caption(painter: &Painter, area: Rect, name: &str) {
    text(painter, area.min, Align2::LEFT_TOP, name, 14.0, FAINT);
}

/// Draws a line between two points with a length in metres beside it.
fn dimension(painter: &Painter, ends: [Pos2; 2], length: f64) {
    let stroke = Stroke::new(1.0, INK);
    let across = 4.0 * (ends[1] - ends[0]).normalized().rot90();
    painter.line_segment(ends, stroke);
    for end in ends {
        painter.line_segment([end - across, end + across], stroke);
    }
    let middle = ends[0].lerp(ends[1], 0.5);
    let upright = across.y.abs() < across.x.abs();
    let (at, align) = if upright {
        (middle - vec2(8.0, 0.0), Align2::RIGHT_CENTER)
    } else {
        (middle + vec2(0.0, 4.0), Align2::CENTER_TOP)
    };
    text(painter, at, align, &metres(length as f32), 14.0, INK);
}

fn text(painter: &Painter, at: Pos2, align: Align2, text: &str, size: f32, color: Color32) -> Rect {
    painter.text(at, align, text, FontId::proportional(size), color)
}

/// Formats a length without trailing zeros.
fn metres(length: f32) -> String {
    let text = format!("{length:.2}");
    format!("{} m", text.trim_end_matches('0').trim_end_matches('.'))
}

/// Returns the round distance that fits about four times into a range.
fn round_step(range: f32) -> f32 {
    let steps = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0];
    steps.into_iter().find(|step| range / step <= 5.0).unwrap_or(50.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_short() {
        for (length, text) in
            [(8.19, "8.19 m"), (20.0, "20 m"), (0.5, "0.5 m"), (0.497, "0.5 m"), (0.0, "0 m")]
        {
            assert_eq!(metres(length), text);
        }
    }

    #[test]
    fn rings_are_few() {
        for range in [0.1, 0.25, 1.0, 5.6, 8.19, 12.0, 20.0, 80.0, 200.0] {
            let count = range / round_step(range);
            assert!((1.0..=5.0).contains(&count), "{range}: {count}");
        }
    }
}
