//! Seeded random worlds for robots.

pub mod certificate;
pub mod distribution;
mod error;
pub mod forest;
mod generate;
pub mod geometry;
pub mod hallway;
pub mod indoor;
mod provenance;
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
