#![forbid(unsafe_code)]
#![doc = include_str!("../README.md")]

mod atomic;
mod checkpoint;
mod column;
mod error;
mod frame;
mod pvd;
mod series;
mod table;
mod vtu;
mod vtu_check;
mod vtu_read;

pub use atomic::{remove_stale_temporaries, write_atomically, write_text_atomically};
pub use checkpoint::{
    Attribute, Attributes, Checkpoint, CheckpointFile, CheckpointInfo, FORMAT_VERSION,
    LatestCheckpoint, checkpoint_name, latest_checkpoint, prune_checkpoints, read_checkpoint,
    remove_checkpoints, write_checkpoint,
};
pub use column::{Column, Element, Number, Scalar, Values};
pub use error::IoError;
pub use frame::{Compression, ParticleFrame};
pub use pvd::{PvdEntry, PvdIndex};
pub use series::SnapshotSeries;
pub use table::{Table, TableWriter, read_table};
pub use vtu::write_vtu;
pub use vtu_read::{Snapshot, SnapshotColumn, read_vtu};
