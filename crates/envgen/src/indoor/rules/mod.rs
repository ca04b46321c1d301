//! The rules that fill the grid, one file per rule.
//!
//! | order of the rules | rule, and the thesis's adaptation of it |
//! |---|---|
//! | `hallways`, or `l_system` | hallways at a distance; first adaptation: that distance, in [`super::adaptation`] |
//! | `cycles` | fifth adaptation: fewer cycles |
//! | `rooms` | fourth adaptation: rooms by their difficulty |
//! | `open_areas` | second adaptation: cells that remain empty become open area |
//! | `doorways` | third adaptation: doorways by probability |
//! | `access` | not in the thesis: every place can be reached |

pub(super) mod access;
pub(super) mod cycles;
pub(super) mod doorways;
pub(super) mod hallways;
pub(super) mod l_system;
pub(super) mod open_areas;
pub(super) mod rooms;
