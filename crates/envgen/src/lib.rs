//! Seeded random worlds for robots.

pub mod certificate;
mod distance_transform;
pub mod distribution;
mod error;
pub mod export;
pub mod file;
pub mod forest;
mod generate;
pub mod geometry;
pub mod hallway;
pub mod import;
pub mod indoor;
mod lattice;
pub mod occupancy;
#[cfg(feature = "picture")]
pub mod picture;
mod provenance;
pub mod raycast;
mod seed;
pub mod settings;
mod spec;
pub mod world;

pub use error::{GenerateError, SpecError};
pub use generate::{Blueprint, Spec};
pub use provenance::Provenance;
pub use seed::{STREAM_ALGORITHM, Seed, Stream};
pub use spec::{Kind, SettingsError, WorldBlueprint, WorldMetrics, WorldSpec};
pub use world::World;

pub use glam;
