//! What holds of the world, computed on another thread after every change.

use std::sync::Arc;

use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, futures_lite::future};
use envgen::edit::{Audit, Document};

/// The last audit, and the one that is being computed.
#[derive(Default)]
pub(crate) struct Auditing {
    /// The last one, which may be of an earlier state.
    pub(crate) last: Option<Audit>,
    /// The state that the last one is of.
    revision: u64,
    running: Option<(u64, Task<Audit>)>,
}

impl Auditing {
    /// Takes what is finished, and audits the present state next: states between the two are left out.
    pub(crate) fn poll(&mut self, document: &Document, revision: u64) {
        if let Some((of, task)) = &mut self.running {
            let Some(audit) = block_on(future::poll_once(task)) else { return };
            (self.last, self.revision) = (Some(audit), *of);
            self.running = None;
        }
        if self.revision != revision {
            let (world, promises) = (Arc::clone(document.world()), document.promises());
            let task =
                AsyncComputeTaskPool::get().spawn(async move { Audit::of(&world, &promises) });
            self.running = Some((revision, task));
        }
    }

    /// Whether the last one is not of the present state.
    pub(crate) fn is_running(&self) -> bool {
        self.running.is_some()
    }
}
