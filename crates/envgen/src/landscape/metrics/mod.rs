//! The metrics of landscape ecology, for any raster of classes.
//!
//! Definitions: K. `McGarigal`, S. A. Cushman and E. Ene, FRAGSTATS v4, and M. H. K. Hesselbarth and others,
//! landscapemetrics, Ecography 42, 2019, <https://doi.org/10.1111/ecog.04617>; the entropies of adjacency: J.
//! Nowosad and T. F. Stepinski, Information theory as a consistent framework for quantification and classification
//! of landscape patterns, Landscape Ecology 34, 2019, <https://doi.org/10.1007/s10980-019-00830-x>. No-data cells
//! belong to no class. A side beside such a cell is border, like a side at the raster's end.
//!
//! - [`RasterReport`]: all metrics, of the landscape and of each class.
//! - [`Adjacency`]: how often cells of two classes are neighbours.
//! - [`patches`]: connected cells of one class.

mod adjacency;
mod landscape;
mod patches;
mod report;
mod sides;

pub use adjacency::{Adjacency, ClassSides, Entropies};
pub use landscape::LandscapeMetrics;
pub(super) use landscape::measure;
pub use patches::{Neighbourhood, Patch, patches};
pub(crate) use report::check;
pub use report::{Border, ClassReport, PatchReport, RasterError, RasterReport};
