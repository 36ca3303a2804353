//! Error against cost: `sph study`.
//!
//! A scene is run for every combination of some of its values ([`Plan`]), each run as a process of its
//! own ([`run_all`]). The scene's `[reference]` turns the tables of a run into one error
//! ([`Truth`]), and the runs of one scheme over several spacings become a [`Curve`]: errors, what they
//! cost in core-seconds, the observed order, and the cost at a given error. A finished run is not
//! repeated.

mod axis;
mod child;
mod cost;
mod curve;
mod error;
mod identity;
mod markdown;
mod measure;
mod norms;
mod order;
mod outcome;
mod pareto;
mod plan;
mod plot;
mod pool;
mod report;
mod text;
mod truth;

pub use axis::Axis;
pub use cost::{Cost, cost_at};
pub use curve::{Curve, Point};
pub use error::StudyError;
pub use markdown::markdown;
pub use measure::{Figure, figures};
pub use outcome::{Outcome, Record};
pub use plan::{Case, Plan, Request};
pub use plot::work_precision;
pub use pool::{Program, run_all};
pub use report::{Report, Row, write};
pub use text::summary;
pub use truth::Truth;
