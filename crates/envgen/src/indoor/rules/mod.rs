//! The rules that fill the grid, one file per rule, in the order in which they run.

pub(super) mod access;
pub(super) mod cycles;
pub(super) mod doorways;
pub(super) mod hallways;
pub(super) mod l_system;
pub(super) mod open_areas;
pub(super) mod rooms;
