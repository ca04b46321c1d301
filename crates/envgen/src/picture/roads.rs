//! Roads: surface, edges and lane markings.

use std::collections::BTreeMap;

use svg::node::element::{Group, Path};

use super::path::PathData;
use super::shapes::stroked;
use super::view::View;
use crate::geometry::unit_vector;
use crate::palette;
use crate::world::{RoadStrip, World};

pub(super) fn draw(world: &World, view: &View) -> Option<Group> {
    if world.road_strips.is_empty() {
        return None;
    }
    // Widths in tenths of a pixel; strips of the same width are one path.
    let mut widths: BTreeMap<u32, PathData> = BTreeMap::new();
    let mut markings = PathData::new(1);
    let mut dashes = PathData::new(1);
    for strip in &world.road_strips {
        let width = strip.width * view.scale;
        let path = widths
            .entry((width * 10.0).round().max(10.0) as u32)
            .or_insert_with(|| PathData::new(1));
        lane_line(strip, 0.0, view, path);
        let lane = width / f64::from(strip.lanes);
        if width >= 8.0 {
            let edge = 0.5 * strip.width - 1.8 / view.scale;
            lane_line(strip, edge, view, &mut markings);
            lane_line(strip, -edge, view, &mut markings);
        }
        if lane >= 4.0 && strip.lanes <= 16 {
            for i in 1..strip.lanes {
                let offset = (f64::from(i) / f64::from(strip.lanes) - 0.5) * strip.width;
                lane_line(strip, offset, view, &mut dashes);
            }
        }
    }
    let round = |path: Path| path.set("stroke-linejoin", "round");
    let mut group = Group::new().set("id", "roads");
    for (tenths, path) in &widths {
        let width = f64::from(*tenths) / 10.0;
        let edge = if width >= 3.0 { 1.6 } else { 0.0 };
        group = group.add(round(stroked(path.clone(), palette::ROAD.edge, width + edge)));
    }
    for (tenths, path) in widths {
        group = group.add(round(stroked(path, palette::ROAD.fill, f64::from(tenths) / 10.0)));
    }
    if !markings.is_empty() {
        group =
            group.add(stroked(markings, palette::ROAD_MARKING, 0.8).set("stroke-opacity", 0.85));
    }
    if !dashes.is_empty() {
        // Lines of 3 m with gaps of 6 m, or the shortest that are visible.
        let dash = (3.0 * view.scale).clamp(4.0, 200.0);
        let path = stroked(dashes, palette::ROAD_MARKING, 1.1);
        group = group.add(path.set("stroke-dasharray", format!("{dash:.1} {:.1}", 1.5 * dash)));
    }
    Some(group)
}

/// Adds the line at `offset` metres to the left of a road's centreline. Points that are too near to each other to
/// be distinguished are left out.
fn lane_line(strip: &RoadStrip, offset: f64, view: &View, path: &mut PathData) {
    let last = strip.centreline.len() - 1;
    let mut previous = None;
    for (i, point) in strip.centreline.iter().enumerate() {
        let left = unit_vector(point.pose.heading).perp();
        let at = view.px(point.pose.position + left * offset);
        match previous {
            None => path.move_to(at),
            Some(previous) if i < last && at.distance_squared(previous) < 0.25 => continue,
            Some(_) => path.line_to(at),
        }
        previous = Some(at);
    }
    if strip.closed {
        path.close();
    }
}
