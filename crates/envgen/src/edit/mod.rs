//! Manual changes of worlds, with undo and redo, and audits of the changed worlds.
//!
//! - [`Document`]: an indoor plan or any other world that is being edited. A plan remains a plan: see
//!   [`PlanEditor`](crate::indoor::PlanEditor).
//! - [`WorldEditor`]: changes of the parts of any world.
//! - [`Audit`]: which of a world's promises still hold, and which places cannot be reached; [`predict`]: how
//!   difficult the world is.

mod audit;
mod document;
mod target;
mod world_editor;

pub use audit::{Audit, predict};
pub use document::{Change, Document, DocumentError, Target};
pub use target::WorldTarget;
pub use world_editor::{NewPart, WorldEdit, WorldEditError, WorldEditor};
