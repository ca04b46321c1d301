//! Paths and rectangles with a colour.

use svg::node::element::{Path, Rectangle};

use super::path::PathData;
use crate::geometry::Rect;
use crate::palette::Srgb;

pub(super) fn rectangle(rect: Rect) -> Rectangle {
    let size = rect.size();
    Rectangle::new()
        .set("x", rect.min.x)
        .set("y", rect.min.y)
        .set("width", size.x)
        .set("height", size.y)
}

pub(super) fn stroked(path: PathData, color: Srgb, width: f64) -> Path {
    Path::new()
        .set("d", path.into_text())
        .set("fill", "none")
        .set("stroke", color.to_string())
        .set("stroke-width", (width * 100.0).round() / 100.0)
}

pub(super) fn filled(path: PathData, color: Srgb) -> Path {
    Path::new().set("d", path.into_text()).set("fill", color.to_string())
}
