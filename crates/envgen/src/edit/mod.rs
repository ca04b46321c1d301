//! Changing worlds by hand, with undo and redo, and what an editor shows of them.
//!
//! - [`Document`]: an indoor plan or any other world that is being edited. A plan stays a plan: see
//!   [`PlanEditor`](crate::indoor::PlanEditor).
//! - [`WorldEditor`]: the parts of any world.
//! - [`Audit`]: what still holds of a world's promises, and which places cannot be reached; [`predict`]: how
//!   difficult the world is.

mod audit;
mod document;
mod target;
mod world_editor;

pub use audit::{Audit, predict};
pub use document::{Change, Document, DocumentError, Target};
pub use target::WorldTarget;
pub use world_editor::{NewPart, WorldEdit, WorldEditError, WorldEditor};
