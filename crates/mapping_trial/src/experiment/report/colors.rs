//! The colours of the figures and of the page: those of the palette.

use envgen::palette::{self, Srgb};

/// Colours of D, M and N.
pub(crate) const MEASURED: [Srgb; 3] = [palette::BLUE, palette::VERMILION, palette::GREEN];

/// Colour of what the paper states.
pub(super) const STATED: Srgb = palette::PURPLE;

/// Colour of text and axes.
pub(super) const INK: Srgb = palette::INK;

/// Colour of text and lines of less weight.
pub(super) const SOFT: Srgb = palette::QUIET_INK;

/// Colour of the lines of tables and of the figures' grids.
pub(super) const LINE: Srgb = palette::GRID;

/// The variables of `report.css`.
pub(super) fn variables() -> String {
    let [d, m, n] = MEASURED;
    let named = [
        ("ink", INK),
        ("soft", SOFT),
        ("line", LINE),
        ("paper", palette::PAGE),
        ("wash", palette::PLAN),
        ("d", d),
        ("m", m),
        ("n", n),
        ("p", STATED),
    ];
    let list: String = named.iter().map(|(name, color)| format!("--{name}:{color};")).collect();
    format!(":root{{{list}}}\n")
}
