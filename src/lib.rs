#![doc = include_str!("../README.md")]
//!
//! Examples and headless integration tests of `envgen`: see the folders `examples` and `tests`.
