#![doc = include_str!("../README.md")]
//!
//! The larger programs of the project and their tests, which are in the folders `examples` and `tests`.

/// The doctests of the guide's chapter on Bevy.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide/bevy.md")]
struct Bevy;

/// The doctests of the guide's chapter on maps of a requested difficulty.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide/calibrated.md")]
struct Calibrated;

/// The doctests of the guide's chapter on forests.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide/forests.md")]
struct Forests;

/// The doctests of the guide's chapter on doors, people and smoke.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide/moving.md")]
struct Moving;

/// The doctests of the guide's chapter on trials.
#[cfg(doctest)]
#[doc = include_str!("../docs/guide/trials.md")]
struct Trials;
