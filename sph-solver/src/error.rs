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
         numerics.cfl, a larger numerics.sound_speed or more numerics.artificial_viscosity; \
         checkpoints written before are intact"
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
    /// Some force was too large to be squared, for one step.
    #[error(
        "a force overflowed in step {step} at t = {time:.6} s. Try a smaller numerics.cfl or a larger \
         numerics.sound_speed"
    )]
    Overflow {
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
         near it; checkpoints written before are intact"
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
         continued: {}. Give the scene and values of that run, or another --out folder",
        path.display(),
        differences.join("; ")
    )]
    OtherScene {
        /// The checkpoint.
        path: std::path::PathBuf,
        /// What differs.
        differences: Vec<String>,
    },
    /// Started by `mpirun`, but built without MPI.
    #[error(
        "this program was started as {processes} processes but was built without MPI: every one of \
         them would run the whole scene. Build it with `cargo build --release --features mpi`, or \
         start it once with --ranks {processes}"
    )]
    WithoutMpi {
        /// Number of processes.
        processes: usize,
    },
    /// More ranks than particles.
    #[error("{ranks} ranks cannot share {particles} particles: use fewer ranks or a finer spacing")]
    TooManyRanks {
        /// Number of ranks.
        ranks: usize,
        /// Number of particles.
        particles: usize,
    },
    /// The scene cannot be turned into particles.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneError),
    /// Ranks that are threads failed to start or panicked.
    #[error("{0}")]
    Ranks(String),
    /// Ranks would continue from different states.
    #[error(
        "the ranks see different checkpoints in {}: the folder must be the same on all machines",
        path.display()
    )]
    DifferentCheckpoints {
        /// The folder.
        path: std::path::PathBuf,
    },
    /// The checkpoint is already beyond the end.
    #[error(
        "the checkpoint is at t = {time} s, which is not before the end of the run at {end} s: give a \
         later --end-time"
    )]
    NothingLeft {
        /// Time of the checkpoint, s.
        time: f64,
        /// End of the run, s.
        end: f64,
    },
    /// Ranks are asked for twice.
    #[error(
        "--ranks is for ranks as threads; under mpirun the ranks are the processes: leave it out"
    )]
    RanksUnderMpi,
    /// The folder holds the results of another run.
    #[error(
        "{} holds {count} file(s) of an earlier run, {example} among them. {} --overwrite replaces \
         them by a new run, and --out gives another folder",
        path.display(),
        if *resumable {
            "--resume goes on from their last checkpoint,"
        } else {
            "They hold no checkpoint for --resume to go on from;"
        }
    )]
    ResultsThere {
        /// The folder.
        path: std::path::PathBuf,
        /// Name of one of the files.
        example: String,
        /// How many there are.
        count: usize,
        /// Whether a checkpoint is among them.
        resumable: bool,
    },
    /// Another run writes into the folder.
    #[error(
        "another run is writing into {}: wait until it has ended, or give another folder with --out",
        path.display()
    )]
    FolderInUse {
        /// The folder.
        path: std::path::PathBuf,
    },
    /// The first rank has failed for all, and says why.
    #[error("rank 0 could not begin")]
    FirstRank,
    /// The run was asked to end before its time, and has written a checkpoint.
    #[error(
        "the run was ended {reason} in step {step} at t = {time:.6} s; --resume goes on from {}",
        checkpoint.display()
    )]
    Stopped {
        /// Who asked.
        reason: crate::run::StopReason,
        /// Step.
        step: u64,
        /// Time, s.
        time: f64,
        /// The checkpoint.
        checkpoint: std::path::PathBuf,
    },
    /// There is no checkpoint to continue from.
    #[error(
        "there is no checkpoint in {} to resume from. Run without --resume, and with \
         --checkpoint-every T to write some",
        path.display()
    )]
    NothingToResume {
        /// The folder.
        path: std::path::PathBuf,
    },
    /// A checkpoint holds other moving solids than the scene.
    #[error(
        "the checkpoint in {} holds other moving solids than the scene: which solids move cannot change \
         when a run goes on",
        path.display()
    )]
    OtherBodies {
        /// The folder.
        path: std::path::PathBuf,
    },
    /// Signals cannot be waited for.
    #[error("the system does not let this program handle signals: {0}")]
    Signals(std::io::Error),
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
    /// The folder for the files, or a file in it, could not be made, read or removed.
    #[error("{} cannot be used for results: {source}. Give another folder with --out", path.display())]
    Folder {
        /// The folder.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] sph_io::IoError),
}

impl RunError {
    /// Whether every rank has met this same error, so that all of them can end in good order.
    pub fn is_on_all_ranks(&self) -> bool {
        matches!(
            self,
            Self::Diverged { .. }
                | Self::Overflow { .. }
                | Self::DifferentCheckpoints { .. }
                | Self::Left { .. }
                | Self::StepCollapsed { .. }
                | Self::TooManyRanks { .. }
                | Self::Scene(_)
                | Self::OtherScene { .. }
                | Self::OtherBodies { .. }
                | Self::NothingToResume { .. }
                | Self::NothingLeft { .. }
                | Self::RanksUnderMpi
                | Self::FirstRank
                | Self::Stopped { .. }
                | Self::Comm(CommError::DifferentBuild { .. })
        )
    }

    /// Whether the scene or the command line is at fault rather than the run.
    pub fn is_bad_input(&self) -> bool {
        matches!(
            self,
            Self::Scene(_)
                | Self::TooManyRanks { .. }
                | Self::WithoutMpi { .. }
                | Self::OtherScene { .. }
                | Self::OtherBodies { .. }
                | Self::NothingToResume { .. }
                | Self::NothingLeft { .. }
                | Self::RanksUnderMpi
                | Self::ResultsThere { .. }
                | Self::FolderInUse { .. }
                | Self::FirstRank
                | Self::Folder { .. }
        )
    }
}
