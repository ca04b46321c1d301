//! The position of the world in the picture.

use glam::DVec2;

use crate::geometry::{Rect, Shape};
use crate::world::World;

/// The transform from metres (y up) to pixels (y down).
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// The visible area of the world, in metres.
    pub(super) world: Rect,
    /// The position of the plan in the picture, in whole px.
    pub(super) plan: Rect,
    /// Pixels per metre.
    pub(super) scale: f64,
    /// The position of the lower left corner of `world`, in px.
    origin: DVec2,
}

impl View {
    /// Creates a view with a plan of at most `most` px, including borders of `border` px around the world, and of
    /// at least `least` px, with its upper left corner at `corner`. `None` if no finite scale is possible.
    pub(super) fn new(
        world: Rect,
        corner: DVec2,
        least: DVec2,
        most: DVec2,
        border: f64,
    ) -> Option<View> {
        // Halves, since the full size of the largest worlds is infinite.
        let half = world.max * 0.5 - world.min * 0.5;
        let room = (most - DVec2::splat(2.0 * border)).max(DVec2::ONE);
        let scale = (0.5 * room / half).min_element();
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let drawn = half * scale * 2.0;
        let size = (drawn + DVec2::splat(2.0 * border)).ceil().max(least).min(most);
        let plan = Rect::new(corner, corner + size);
        let gap = (size - drawn) * 0.5;
        let origin = DVec2::new(corner.x + gap.x, plan.max.y - gap.y);
        Some(View { world, plan, scale, origin })
    }

    /// Returns the position of a point of the world in px.
    pub(super) fn px(&self, p: DVec2) -> DVec2 {
        let offset = (p * 0.5 - self.world.min * 0.5) * self.scale * 2.0;
        DVec2::new(self.origin.x + offset.x, self.origin.y - offset.y)
    }

    /// Returns the outline of a box or polygon in px.
    pub(super) fn outline(&self, shape: &Shape) -> Vec<DVec2> {
        shape.corners().into_iter().map(|corner| self.px(corner)).collect()
    }

    /// Returns the rectangle in px of a rectangle in metres.
    pub(super) fn px_rect(&self, rect: Rect) -> Rect {
        let (a, b) = (self.px(rect.min), self.px(rect.max));
        Rect::new(a.min(b), a.max(b))
    }
}

/// Returns the area that a picture of a world shows: its bounds, the roads up to their edges, and the raster.
pub(super) fn extent(world: &World) -> Rect {
    let mut extent = world.bounds;
    for strip in &world.road_strips {
        extent = strip.bounds().map_or(extent, |bounds| extent.union(bounds));
    }
    if let Some(raster) = &world.raster {
        extent = extent.union(raster.frame().bounds());
    }
    let finite = extent.min.is_finite() && extent.max.is_finite();
    if finite { extent } else { world.bounds }
}

/// Returns the greatest number that is 1, 2 or 5 times a power of ten and not above `most`; `None` if no such
/// number exists.
pub(super) fn round_number(most: f64) -> Option<f64> {
    if !(most.is_finite() && most > 0.0) {
        return None;
    }
    let power = libm::pow(10.0, libm::floor(libm::log10(most)));
    // A power of ten may be off by an ulp, and log10 next to one by one.
    let found = [10.0, 5.0, 2.0, 1.0, 0.5].map(|digit| digit * power);
    found
        .into_iter()
        .find(|&number| number <= most * (1.0 + 1e-9))
        .filter(|number| number.is_normal())
}

/// Formats a length as text, such as `500 m`, `2 km` or `5 cm`.
pub(super) fn length(metres: f64) -> String {
    match metres {
        m if m >= 1e7 => format!("{} km", scientific(m / 1000.0)),
        m if m >= 1000.0 => format!("{} km", short(m / 1000.0)),
        m if m >= 1.0 => format!("{} m", short(m)),
        m if m >= 0.01 => format!("{} cm", short(m * 100.0)),
        m if m >= 0.001 => format!("{} mm", short(m * 1000.0)),
        m => format!("{} m", scientific(m)),
    }
}

/// Formats a number with three significant digits, without trailing zeros.
pub(super) fn short(number: f64) -> String {
    let decimals = match number.abs() {
        n if n >= 100.0 => 0,
        n if n >= 10.0 => 1,
        n if n >= 1.0 || n == 0.0 => 2,
        n if n >= 0.1 => 3,
        n if n >= 0.01 => 4,
        n if n >= 0.001 => 5,
        _ => return scientific(number),
    };
    let text = format!("{number:.decimals$}");
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}

fn scientific(number: f64) -> String {
    let text = format!("{number:.1e}");
    text.replace(".0e", "e").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn v(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn y_is_up_in_the_world_and_down_in_the_picture() {
        let world = Rect::new(v(-1.0, 5.0), v(1.0, 6.0));
        let view = View::new(world, v(10.0, 20.0), v(1.0, 1.0), v(220.0, 500.0), 10.0).unwrap();
        assert_eq!(view.scale, 100.0);
        assert_eq!(view.plan, Rect::new(v(10.0, 20.0), v(230.0, 140.0)));
        assert_eq!(view.px(world.min), v(20.0, 130.0));
        assert_eq!(view.px(world.max), v(220.0, 30.0));
    }

    #[test]
    fn small_worlds_stand_in_the_middle() {
        let world = Rect::new(v(0.0, 0.0), v(1.0, 100.0));
        let view = View::new(world, v(0.0, 0.0), v(50.0, 10.0), v(200.0, 200.0), 0.0).unwrap();
        assert_eq!(view.plan.max, v(50.0, 200.0));
        assert_eq!(view.px(v(0.5, 50.0)), v(25.0, 100.0));
    }

    #[test]
    fn round_numbers_read_well() {
        let cases = [(3.7, "2 m"), (1.0, "1 m"), (99.0, "50 m"), (4321.0, "2 km")];
        for (most, text) in cases {
            assert_eq!(length(round_number(most).unwrap()), text);
        }
        assert_eq!(length(round_number(0.06).unwrap()), "5 cm");
        assert_eq!(length(round_number(0.004).unwrap()), "2 mm");
        assert_eq!(length(round_number(3e20).unwrap()), "2e17 km");
        assert_eq!(length(round_number(3e-9).unwrap()), "2e−9 m");
        assert_eq!(round_number(0.0), None);
        assert_eq!(round_number(f64::NAN), None);
        assert_eq!(
            [12.345, -0.05, 250.0, 0.0, 1e-9].map(short),
            ["12.3", "−0.05", "250", "0", "1e−9"]
        );
    }

    proptest! {
        #[test]
        fn round_numbers_are_near_and_round(exponent in -300.0..300.0_f64) {
            let most = libm::pow(10.0, exponent);
            let round = round_number(most).unwrap();
            prop_assert!(round <= most * (1.0 + 1e-9) && round > most / 2.6);
            let first = format!("{round:.9e}");
            let is_round = ["1.000000000e", "2.000000000e", "5.000000000e"];
            prop_assert!(is_round.iter().any(|&start| first.starts_with(start)), "{}", first);
        }
    }
}
