//! What can end a run.

use sph_decomp::{CommError, MigrateError, PartitionError, ZoneError};

/// An error of a run. The same on all ranks, unless a rank itself failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Numbers have left the range of weakly compressible flow.
    #[error(
        "the run diverged in step {step} at t = {time:.6} s: particle {id} at {position:?} has a \
         velocity, density or acceleration that is not a usable number. Try a smaller \
         numerics.cfl, a larger numerics.sound_speed or more numerics.artificial_viscosity; the \
         last checkpoint is intact"
    )]
    Diverged {
        /// Global id of the first such particle.
        id: u64,
        /// Where it is, m.
        position: Vec<f64>,
        /// Step.
        step: u64,
        /// Time, s.
        time: f64,
    },
    /// A particle has left the domain and the scene says to stop then.
    #[error(
        "particle {id} left the domain {lower:?} .. {upper:?} at {position:?}, t = {time:.6} s. \
         Check that the solids are closed and thick enough, enlarge [domain], or set \
         numerics.on_lost = \"remove\" to take such particles out and count them"
    )]
    Left {
        /// Global id of the first such particle.
        id: u64,
        /// Where it is, m.
        position: Vec<f64>,
        /// Time, s.
        time: f64,
        /// Lower corner of the domain, m.
        lower: Vec<f64>,
        /// Upper corner of the domain, m.
        upper: Vec<f64>,
    },
    /// The time step has become too short to go on.
    #[error(
        "the time step fell to {dt:e} s in step {step} at t = {time:.6} s, far below the acoustic \
         limit: some particle feels an enormous force. Check for overlapping regions or solids \
         near it; the last checkpoint is intact"
    )]
    StepCollapsed {
        /// Step.
        step: u64,
        /// Time, s.
        time: f64,
        /// The step asked for, s.
        dt: f64,
    },
    /// A checkpoint belongs to another scene.
    #[error(
        "{} was written by a run of another scene or with other --set values, and cannot be \
         continued. Give the scene and values of that run, or another --out folder",
        path.display()
    )]
    OtherScene {
        /// The checkpoint.
        path: std::path::PathBuf,
    },
    /// The threads of a rank could not be started.
    #[error("threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A message does not fit the columns of a rank.
    #[error(transparent)]
    Columns(#[from] sph_decomp::ColumnError),
    /// Communication failed.
    #[error(transparent)]
    Comm(#[from] CommError),
    /// The partition could not be made.
    #[error(transparent)]
    Partition(#[from] PartitionError),
    /// Particles could not be sent to their owners.
    #[error(transparent)]
    Migrate(#[from] MigrateError),
    /// The overlap zone could not be built.
    #[error(transparent)]
    Zone(#[from] ZoneError),
    /// The cell grid cannot be laid out.
    #[error(transparent)]
    Grid(#[from] sph_neighbors::GridError),
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] sph_io::IoError),
}
