//! Who runs: this process alone, or the processes that `mpirun` has started.

use crate::error::RunError;
#[cfg(feature = "mpi")]
use sph_decomp::{Communicator, Mpi};

/// The processes of a run.
pub enum World {
    /// This process alone.
    Process,
    /// The processes of an MPI job.
    #[cfg(feature = "mpi")]
    Mpi(Mpi),
}

/// Variables that launchers set to the number of processes.
const SIZE_VARIABLES: [&str; 4] =
    ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "PMIX_SIZE"];

fn processes() -> Option<usize> {
    SIZE_VARIABLES.iter().find_map(|name| std::env::var(name).ok()?.parse().ok())
}

impl World {
    /// Joins the MPI job that this process was started in, if it was. Call it once, early.
    pub fn start() -> Result<Self, RunError> {
        match processes() {
            None => Ok(Self::Process),
            #[cfg(feature = "mpi")]
            Some(_) => Ok(Self::Mpi(Mpi::start()?)),
            #[cfg(not(feature = "mpi"))]
            Some(0 | 1) => Ok(Self::Process),
            #[cfg(not(feature = "mpi"))]
            Some(processes) => Err(RunError::WithoutMpi { processes }),
        }
    }

    /// The result of something that every process does for itself, such as reading the scene. When
    /// only some processes fail, those end the job with their message. Collective.
    pub fn agree<T>(&self, result: Result<T, RunError>) -> Result<T, RunError> {
        match self {
            Self::Process => result,
            #[cfg(feature = "mpi")]
            Self::Mpi(mpi) => {
                let mut failed = [u64::from(result.is_err())];
                mpi.sum_u64(&mut failed)?;
                match result {
                    Err(error) if failed[0] < mpi.size() as u64 => mpi.abort(&error.to_string()),
                    Ok(_) if failed[0] > 0 => {
                        // The others are about to end the job; going on would only confuse.
                        mpi.all_gather(&[])?;
                        Err(RunError::Ranks("another process could not begin".into()))
                    }
                    result => result,
                }
            }
        }
    }

    /// Work that one process does for all, such as locking the folder of the results; the others get
    /// `None`. All of them fail when it fails. Collective.
    pub fn once<T>(
        &self,
        work: impl FnOnce() -> Result<T, RunError>,
    ) -> Result<Option<T>, RunError> {
        match self {
            Self::Process => work().map(Some),
            #[cfg(feature = "mpi")]
            Self::Mpi(mpi) => {
                let mine = (mpi.rank() == 0).then(work).transpose();
                let mut failed = [u64::from(mine.is_err())];
                mpi.sum_u64(&mut failed)?;
                match mine {
                    Ok(_) if failed[0] > 0 => Err(RunError::FirstRank),
                    result => result,
                }
            }
        }
    }

    /// Whether this process speaks for the run: writes files and messages.
    pub fn speaks(&self) -> bool {
        match self {
            Self::Process => true,
            #[cfg(feature = "mpi")]
            Self::Mpi(mpi) => mpi.rank() == 0,
        }
    }

    /// Number of MPI processes.
    pub fn size(&self) -> usize {
        match self {
            Self::Process => 1,
            #[cfg(feature = "mpi")]
            Self::Mpi(mpi) => mpi.size(),
        }
    }
}
