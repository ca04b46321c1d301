//! Roads: surface, edges and lane markings.

use std::collections::BTreeMap;

use glam::DVec2;
use svg::node::element::{self, Group};

use super::path::PathData;
use super::shapes::stroked;
use super::view::View;
use crate::curve::Path;
use crate::palette;
use crate::world::World;

/// The greatest deviation in px of the edges of a road from their exact curves.
const TOLERANCE: f64 = 0.1;

/// The least distance in px between points of a line.
const NEAR: f64 = 0.5;

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
        let centre = widths
            .entry((width * 10.0).round().max(10.0) as u32)
            .or_insert_with(|| PathData::new(1));
        let path = strip.path();
        let stations = stations(&path, strip.width, view.scale);
        let add = |offset: f64, data: &mut PathData| {
            let line = strip.line_at(&path, offset, &stations);
            add_line(line.into_iter().map(|p| view.px(p)), strip.closed, data);
        };
        add(0.0, centre);
        let lane = width / f64::from(strip.lanes);
        if width >= 8.0 {
            let edge = 0.5 * strip.width - 1.8 / view.scale;
            add(edge, &mut markings);
            add(-edge, &mut markings);
        }
        if lane >= 4.0 && strip.lanes <= 16 {
            for i in 1..strip.lanes {
                let offset = (f64::from(i) / f64::from(strip.lanes) - 0.5) * strip.width;
                add(offset, &mut dashes);
            }
        }
    }
    let round = |path: element::Path| path.set("stroke-linejoin", "round");
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

/// Returns the distances along a road at which it is drawn: near enough to each other that its edges look curved, and
/// none that cannot be distinguished.
fn stations(path: &Path<'_>, width: f64, scale: f64) -> Vec<f64> {
    let tolerance = (TOLERANCE / scale).max(f64::MIN_POSITIVE);
    let mut stations = path.stations(0.5 * width, tolerance);
    stations.dedup_by(|next, kept| (*next - *kept) * scale < NEAR);
    if let Some(last) = stations.last_mut() {
        *last = path.length();
    }
    stations
}

/// Adds a line through points in px. Those that are too near to each other to be distinguished are left out.
fn add_line(points: impl ExactSizeIterator<Item = DVec2>, closed: bool, data: &mut PathData) {
    let last = points.len() - 1;
    let mut previous: Option<DVec2> = None;
    for (i, at) in points.enumerate() {
        match previous {
            None => data.move_to(at),
            Some(previous) if i < last && at.distance(previous) < NEAR => continue,
            Some(_) => data.line_to(at),
        }
        previous = Some(at);
    }
    if closed {
        data.close();
    }
}
