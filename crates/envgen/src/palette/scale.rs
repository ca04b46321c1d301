//! The colours of difficulties and of landscape classes.

use super::hue::{INK, PAGE};
use super::srgb::Srgb;

const DIFFICULTIES: [Srgb; 6] = [
    Srgb::hex(0xff_fb_dc),
    Srgb::hex(0xff_e8_97),
    Srgb::hex(0xfe_bf_5a),
    Srgb::hex(0xf7_8a_48),
    Srgb::hex(0xdc_4f_3c),
    Srgb::hex(0x9c_22_42),
];

/// Returns the colour of a difficulty from 0 to 10, which is darker for greater difficulties. Values outside are
/// clamped.
///
/// ```
/// use envgen::palette;
///
/// assert!(palette::difficulty(0.0).lightness() > palette::difficulty(10.0).lightness());
/// assert_eq!(palette::difficulty(12.0), palette::difficulty(10.0));
/// ```
pub fn difficulty(difficulty: f64) -> Srgb {
    let at = (difficulty.clamp(0.0, 10.0) / 10.0) * (DIFFICULTIES.len() - 1) as f64;
    let i = (at as usize).min(DIFFICULTIES.len() - 2);
    DIFFICULTIES[i].mix(DIFFICULTIES[i + 1], at - i as f64)
}

/// The number of classes whose colours are chosen to be distinguishable.
pub const CLASSES: u16 = 9;

const CLASS_HUES: [Srgb; CLASSES as usize] = [
    Srgb::hex(0x77_aa_dd),
    Srgb::hex(0xee_dd_88),
    Srgb::hex(0x44_bb_99),
    Srgb::hex(0xee_88_66),
    Srgb::hex(0xbb_cc_33),
    Srgb::hex(0xff_aa_bb),
    Srgb::hex(0x99_dd_ff),
    Srgb::hex(0xaa_aa_00),
    Srgb::hex(0xcc_cc_cc),
];

/// Returns the colour of a landscape class, counted from 1. The colours of the first [`CLASSES`] classes are chosen
/// to be distinguishable; later ones are mixtures of these with their second neighbours and with the ink.
pub fn class(class: u16) -> Srgb {
    let index = usize::from(class.saturating_sub(1));
    let (i, round) = (index % CLASS_HUES.len(), index / CLASS_HUES.len());
    let next = CLASS_HUES[(i + 2) % CLASS_HUES.len()];
    let color = match round {
        0 => CLASS_HUES[i],
        _ => CLASS_HUES[i].mix(next, 0.15 * (round % 4) as f64).mix(INK, 0.22 * (round % 3) as f64),
    };
    color.mix(PAGE, 0.15)
}

/// Returns the colour of one of `classes` ordered landscape classes, counted from 1: from dark blue over green to
/// yellow, after matplotlib's viridis (CC0). Lightness rises with the class. The colour of 0, no data, is black.
pub fn ordered_class(class: u16, classes: u16) -> Srgb {
    const VIRIDIS: [Srgb; 9] = [
        Srgb([68, 1, 84]),
        Srgb([71, 44, 122]),
        Srgb([59, 81, 139]),
        Srgb([44, 113, 142]),
        Srgb([33, 144, 141]),
        Srgb([39, 173, 129]),
        Srgb([92, 200, 99]),
        Srgb([170, 220, 50]),
        Srgb([253, 231, 37]),
    ];
    if class == 0 {
        return Srgb([0; 3]);
    }
    let share = f64::from(class - 1) / f64::from(classes.max(2) - 1);
    let at = share.min(1.0) * 8.0;
    let low = at.floor().min(7.0);
    VIRIDIS[low as usize].mix(VIRIDIS[low as usize + 1], at - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difficulties_darken_throughout() {
        let lightness: Vec<_> =
            (0..=100).map(|d| difficulty(f64::from(d) / 10.0).lightness()).collect();
        assert!(lightness.windows(2).all(|pair| pair[0] > pair[1]), "{lightness:?}");
        assert_eq!(difficulty(-3.0), difficulty(0.0));
        assert_eq!(difficulty(99.0), difficulty(10.0));
    }

    #[test]
    fn the_first_classes_differ() {
        let distance =
            |a: Srgb, b: Srgb| -> u32 { (0..3).map(|i| u32::from(a.0[i].abs_diff(b.0[i]))).sum() };
        for a in 1..=CLASSES {
            for b in 1..a {
                assert!(distance(class(a), class(b)) > 50, "{a} and {b}");
            }
        }
        for number in 10..=27 {
            assert_ne!(class(number), class(number - CLASSES), "{number}");
        }
    }

    #[test]
    fn ordered_classes_differ() {
        let colours: std::collections::BTreeSet<_> =
            (0..=60).map(|class| ordered_class(class, 60)).collect();
        assert_eq!(colours.len(), 61);
        assert_eq!(ordered_class(1, 1), ordered_class(1, 60));
    }
}
