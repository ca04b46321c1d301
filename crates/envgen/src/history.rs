//! Undo and redo.

/// The steps of an editor. Each is a list of reversible changes.
#[derive(Clone, Debug)]
pub(crate) struct History<C> {
    done: Vec<Vec<C>>,
    undone: Vec<Vec<C>>,
}

impl<C> Default for History<C> {
    fn default() -> Self {
        History { done: Vec::new(), undone: Vec::new() }
    }
}

impl<C> History<C> {
    /// Adds a step that was made. Steps that were undone before can no longer be redone.
    pub(crate) fn push(&mut self, step: Vec<C>) {
        self.done.push(step);
        self.undone.clear();
    }

    /// Whether there is a step to undo.
    pub(crate) fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// Whether there is a step to redo.
    pub(crate) fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Undoes the last step with `revert`; returns whether there was one.
    pub(crate) fn undo(&mut self, revert: impl FnOnce(&[C])) -> bool {
        let Some(step) = self.done.pop() else { return false };
        revert(&step);
        self.undone.push(step);
        true
    }

    /// Repeats the step that was undone last with `repeat`; returns whether there was one.
    pub(crate) fn redo(&mut self, repeat: impl FnOnce(&[C])) -> bool {
        let Some(step) = self.undone.pop() else { return false };
        repeat(&step);
        self.done.push(step);
        true
    }
}
