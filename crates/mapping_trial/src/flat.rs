//! The fast simulator.
