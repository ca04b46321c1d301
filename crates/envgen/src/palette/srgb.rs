//! Opaque colours.

use std::fmt;

/// An opaque sRGB colour: red, green and blue from 0 to 255. Its text form is `#rrggbb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Srgb(pub [u8; 3]);

impl Srgb {
    /// Creates a colour from a number such as `0xd5_5e_00`. The highest byte of the number is ignored.
    pub const fn hex(rgb: u32) -> Srgb {
        let [_, r, g, b] = rgb.to_be_bytes();
        Srgb([r, g, b])
    }

    /// Returns the colour between this one (share 0) and another one (share 1), interpolated channel by channel.
    ///
    /// ```
    /// use envgen::palette::Srgb;
    ///
    /// let (red, blue) = (Srgb([200, 0, 0]), Srgb([0, 0, 100]));
    /// assert_eq!(red.mix(blue, 0.25), Srgb([150, 0, 25]));
    /// assert_eq!(red.mix(blue, 1.0), blue);
    /// ```
    pub fn mix(self, other: Srgb, share: f64) -> Srgb {
        let mixed = |i: usize| {
            let (a, b) = (f64::from(self.0[i]), f64::from(other.0[i]));
            (a + (b - a) * share).round() as u8
        };
        Srgb([mixed(0), mixed(1), mixed(2)])
    }

    /// Returns red, green and blue in linear light from 0 to 1 (IEC 61966-2-1), as used by renderers.
    ///
    /// ```
    /// use envgen::palette::Srgb;
    ///
    /// let [red, green, blue] = Srgb([255, 188, 0]).linear();
    /// assert!(red == 1.0 && (green - 0.5).abs() < 0.003 && blue == 0.0);
    /// ```
    pub fn linear(self) -> [f32; 3] {
        self.0.map(|part| {
            let part = f64::from(part) / 255.0;
            let light = if part <= 0.040_45 {
                part / 12.92
            } else {
                libm::pow((part + 0.055) / 1.055, 2.4)
            };
            light as f32
        })
    }

    /// Returns the perceived lightness from 0 to 1 (the luma of ITU-R BT.601).
    pub fn lightness(self) -> f64 {
        let [r, g, b] = self.0.map(f64::from);
        (0.299 * r + 0.587 * g + 0.114 * b) / 255.0
    }
}

impl fmt::Display for Srgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}
