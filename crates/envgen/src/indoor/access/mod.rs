//! Access: the connections between the places of a plan.

mod graph;
mod hallways;
mod interiors;

pub use graph::{AccessGraph, Link, Place, PlaceKind};
#[cfg(test)]
pub(super) use hallways::HallwayShape;
pub(super) use hallways::hallway_shape;
pub(super) use interiors::Interiors;
