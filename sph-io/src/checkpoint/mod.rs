//! The whole state of a run in one file, for restart and for viewers alike.
//!
//! | in the file | what |
//! |---|---|
//! | `/VTKHDF` | an unstructured grid of vertices that VTK and ParaView open |
//! | `/VTKHDF/Points` | positions, `f64`, n × 3 (z = 0 in two dimensions) |
//! | `/VTKHDF/PointData/NAME` | one dataset per column, `id` among them |
//! | `/sph` attributes | format version, dimension, time, step, the list of columns, and the caller's own |
//!
//! Every number is stored once: the columns that ParaView colours by are the ones a restart
//! reads. Datasets are global and keyed by `id`, so a file says nothing of who wrote it and any
//! number of processes reads it.

mod attributes;
mod container;
mod folder;
mod pure;
mod read;
mod schema;
mod state;
mod write;

pub use attributes::{Attribute, Attributes};
pub use folder::{
    LatestCheckpoint, checkpoint_name, latest_checkpoint, prune_checkpoints, remove_checkpoints,
};
pub use read::{CheckpointFile, CheckpointInfo, read_checkpoint};
pub use schema::FORMAT_VERSION;
pub use state::Checkpoint;
pub use write::write_checkpoint;
