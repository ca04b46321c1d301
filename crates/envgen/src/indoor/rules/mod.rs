//! The rules that fill the grid, one file per rule.
//!
//! | in this order | rule, and the thesis's adaptation of it |
//! |---|---|
//! | `hallways`, or `l_system` | hallways a distance apart; first adaptation: the distance, in [`super::adaptation`] |
//! | `cycles` | fifth adaptation: fewer cycles |
//! | `rooms` | fourth adaptation: rooms by their difficulty |
//! | `open_areas` | second adaptation: what stays empty is open |
//! | `doorways` | third adaptation: doorways by probability |
//! | `access` | not in the thesis: every place can be reached |

pub(super) mod access;
pub(super) mod cycles;
pub(super) mod doorways;
pub(super) mod hallways;
pub(super) mod l_system;
pub(super) mod open_areas;
pub(super) mod rooms;
