//! The moving elements of a world: doors with their swing, the routes of people, and smoke.

use glam::DVec2;
use svg::node::element::Group;

use super::error::PictureError;
use super::path::PathData;
use super::shapes::{filled, stroked};
use super::style;
use super::view::View;
use crate::geometry::{Shape, unit_vector};
use crate::palette;
use crate::scenario::{PERSON_RADIUS, Scenario, ScenarioState};
use crate::world::World;

/// The time in seconds for which routes are drawn, from the beginning.
pub(super) const ROUTE_TIME: u32 = 60;

/// Number of points of a route per second.
const POINTS: u32 = 4;

/// Number of pieces in which the swing of a leaf is drawn.
const SWING: u32 = 8;

/// The extinction coefficient, in 1/m, of smoke that is drawn half transparent.
const HALF: f64 = 1.0;

/// Draws everything that moves, from the lowest layer up.
pub(super) fn draw(
    world: &World,
    scenario: &Scenario,
    view: &View,
) -> Result<Vec<Group>, PictureError> {
    let mut state = ScenarioState::new(world, scenario)?;
    let mut groups = vec![smoke(&state, scenario, view), doors(&state, view)];
    groups.push(people(&mut state, view)?);
    Ok(groups)
}

/// Draws areas of smoke, which are less transparent the denser the smoke is.
fn smoke(state: &ScenarioState, scenario: &Scenario, view: &View) -> Group {
    let mut group = Group::new().set("id", "smoke");
    for (i, source) in (0..).zip(&scenario.smoke) {
        let mut area = PathData::new(1);
        for shape in state.smoke_shapes(source.region.place(i)) {
            match shape {
                Shape::Disc { center, radius } => {
                    area.circle(view.px(center), radius * view.scale);
                }
                shape => area.polygon(view.outline(&shape)),
            }
        }
        let opacity = source.extinction / (source.extinction + HALF);
        let opacity = (100.0 * opacity.clamp(0.15, 0.8)).round() / 100.0;
        group = group.add(filled(area, style::SMOKE.fill).set("fill-opacity", opacity));
    }
    group
}

/// Draws the leaves of closed doors, and the paths of their tips to the open position.
fn doors(state: &ScenarioState, view: &View) -> Group {
    let [mut leaves, mut swings] = [PathData::new(1), PathData::new(1)];
    for door in 0..state.doors().len() {
        let closed: Vec<_> = state.leaves_at(door, 0.0).collect();
        for (i, leaf) in closed.iter().enumerate() {
            leaves.line(view.px(leaf.hinge), view.px(leaf.tip));
            let tips = (0..=SWING).filter_map(|k| {
                state.leaves_at(door, f64::from(k) / f64::from(SWING)).nth(i).map(|leaf| leaf.tip)
            });
            let tips: Vec<DVec2> = tips.collect();
            // Where a sliding leaf is gone in its wall, nothing swings.
            if tips.len() == SWING as usize + 1 {
                let ends = tips.into_iter().chain([leaf.hinge]);
                swings.polyline(ends.map(|p| view.px(p)));
            }
        }
    }
    Group::new()
        .set("id", "doors")
        .add(stroked(swings, style::LEAF.edge, 0.8).set("stroke-dasharray", "3 2"))
        .add(stroked(leaves, style::LEAF.fill, 2.4))
}

/// Draws people at their first positions, and their routes from there.
fn people(state: &mut ScenarioState, view: &View) -> Result<Group, PictureError> {
    let radius = (PERSON_RADIUS * view.scale).max(2.5);
    let [mut routes, mut bodies, mut looks] =
        [PathData::new(1), PathData::new(1), PathData::new(1)];
    let mut points: Vec<Vec<DVec2>> = state.people().iter().map(|p| vec![p.position]).collect();
    for person in state.people() {
        let at = view.px(person.position);
        bodies.circle(at, radius);
        let facing = DVec2::new(person.facing.x, -person.facing.y);
        looks.line(at, at + facing * 1.6 * radius);
    }
    if !points.is_empty() {
        for _ in 0..ROUTE_TIME * POINTS {
            state.step(1.0 / f64::from(POINTS), &[])?;
            for (route, person) in points.iter_mut().zip(state.people()) {
                if route.last() != Some(&person.position) {
                    route.push(person.position);
                }
            }
        }
    }
    for route in points.iter().filter(|route| route.len() > 1) {
        routes.polyline(route.iter().map(|&p| view.px(p)));
        let (end, before) = (route[route.len() - 1], route[route.len() - 2]);
        let tip = view.px(end);
        let along = (tip - view.px(before)).normalize_or_zero();
        for turn in [2.6, -2.6] {
            routes.line(tip, tip + along.rotate(unit_vector(turn)) * 6.0);
        }
    }
    let rim = stroked(routes.clone(), palette::PAGE, 3.0).set("stroke-opacity", 0.6);
    let routes = stroked(routes, style::PERSON.edge, 1.2);
    let bodies = filled(bodies, style::PERSON.fill)
        .set("stroke", style::PERSON.edge.to_string())
        .set("stroke-width", 1.0);
    let looks = stroked(looks, style::PERSON.edge, 1.2);
    let group = Group::new().set("id", "people").set("stroke-linejoin", "round");
    Ok(group.add(rim).add(routes).add(bodies).add(looks))
}
