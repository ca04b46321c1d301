//! The basic hues, and the colours of pages.

use super::srgb::Srgb;

/// Blue, a basic hue. The basic hues are distinguishable also for people who are colour-blind.
pub const BLUE: Srgb = Srgb::hex(0x00_72_b2);
/// Vermilion, a basic hue.
pub const VERMILION: Srgb = Srgb::hex(0xd5_5e_00);
/// Bluish green, a basic hue.
pub const GREEN: Srgb = Srgb::hex(0x00_9e_73);
/// Reddish purple, a basic hue.
pub const PURPLE: Srgb = Srgb::hex(0xcc_79_a7);
/// Sky blue, a basic hue.
pub const SKY_BLUE: Srgb = Srgb::hex(0x56_b4_e9);
/// Orange, a basic hue.
pub const ORANGE: Srgb = Srgb::hex(0xe6_9f_00);

/// The colour of the start.
pub const START: Srgb = BLUE;
/// The colour of the goal.
pub const GOAL: Srgb = VERMILION;

/// The background of pictures and reports.
pub const PAGE: Srgb = Srgb::hex(0xff_ff_ff);
/// The background of a plan where the world has no part.
pub const PLAN: Srgb = Srgb::hex(0xfa_f9_f6);
/// The frame of a plan.
pub const FRAME: Srgb = Srgb::hex(0xb8_bb_c2);
/// The lines of a grid.
pub const GRID: Srgb = Srgb::hex(0xd9_d8_d3);
/// Text and axes.
pub const INK: Srgb = Srgb::hex(0x25_2a_31);
/// Secondary text.
pub const QUIET_INK: Srgb = Srgb::hex(0x6b_72_7c);
