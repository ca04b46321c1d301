//! The blueprint of a hallway: the states that were drawn for it.

use serde::Serialize;

use super::layout::HallwayLayout;
use super::spec::HallwaySpec;
use super::state::State;
use crate::seed::Seed;

/// The states of a hallway, with the spec and seed from which they were drawn.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// let hallway = HallwaySpec { segments: 20, ..Default::default() }.generate(Seed(7))?;
/// let layout = hallway.layout();
/// // Each segment owns a cell of the lattice; the first one's middle is the origin.
/// assert_eq!((layout.cells().len(), layout.cells()[0].length()), (20, 0.0));
/// assert_eq!(hallway.to_world().start, Some(layout.start()));
/// # Ok::<(), envgen::SpecError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hallway {
    pub(super) states: Vec<State>,
    #[serde(skip)]
    pub(super) spec: HallwaySpec,
    #[serde(skip)]
    pub(super) seed: Seed,
}

impl Hallway {
    /// Returns the sequence of states, `segments` of them.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// Returns the spec.
    pub fn spec(&self) -> &HallwaySpec {
        &self.spec
    }

    /// Returns the seed with which the hallway was drawn.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    /// Computes the corridor in metres.
    pub fn layout(&self) -> HallwayLayout {
        HallwayLayout::new(&self.states, &self.spec)
    }
}
