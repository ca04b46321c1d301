//! Tests the panels without a window: what they show, how they react to clicks, and the results.

mod feedback;
mod manual_control;
mod preview;
mod scores;
mod screen;
mod setup;
mod spec;
mod trial;
