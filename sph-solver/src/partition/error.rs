//! What can go wrong besides the scene.

use crate::error::RunError;
use crate::scene::SceneError;
use sph_decomp::CommError;
use sph_decomp::scale::ScaleError;
use std::path::PathBuf;

/// Why a scene cannot be studied on many ranks.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The ranks, rates or network make no sense.
    #[error(transparent)]
    Scale(#[from] ScaleError),
    /// A network is neither known by name nor a readable file.
    #[error(
        "the network {} cannot be read: {source}. Give {}, or a TOML file with latency, overhead, \
         gap, node_bandwidth and ranks_per_node",
        path.display(),
        sph_decomp::scale::Network::NAMES.join(", ")
    )]
    NetworkFile {
        /// What was asked for.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A network file does not say what it should.
    #[error("{}: {reason}", path.display())]
    NetworkFormat {
        /// The file.
        path: PathBuf,
        /// What is wrong and where.
        reason: String,
    },
    /// The run that measures the rates failed.
    #[error("the rates could not be measured: {0}. Give them by --pair-rate and --pack-rate")]
    Measurement(#[from] RunError),
    /// The messages that measure the pack rate could not be laid out.
    #[error("the pack rate could not be measured: {0}. Give it by --pack-rate")]
    Packing(#[from] CommError),
}
