//! The panels without a window: what they show, what they say to clicks, and what comes of it.

mod feedback;
mod manual_control;
mod preview;
mod scores;
mod screen;
mod setup;
mod spec;
mod trial;
