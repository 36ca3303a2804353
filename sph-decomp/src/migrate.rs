//! Moves particles to the ranks that own them.

use crate::{ColumnError, Columns, CommError, Communicator};

/// What a migration did on this rank.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MigrationReport {
    /// Particles that stayed.
    pub kept: usize,
    /// Particles that left.
    pub sent: usize,
    /// Particles that came.
    pub received: usize,
    /// Bytes that left.
    pub bytes_sent: u64,
}

/// Why a migration failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MigrateError {
    /// Not one owner per particle.
    #[error("there are {owners} owners for {particles} particles")]
    Length {
        /// Length of the list of owners.
        owners: usize,
        /// Number of particles in the columns.
        particles: usize,
    },
    /// An owner that does not exist.
    #[error(
        "particle {particle} (index on this rank) belongs to rank {owner}, but there are only {ranks} ranks"
    )]
    NoSuchOwner {
        /// Index of the particle on this rank.
        particle: usize,
        /// Its owner.
        owner: u32,
        /// Number of ranks.
        ranks: usize,
    },
    /// A message does not fit the columns of this rank.
    #[error("particles from rank {rank}: {error}")]
    Columns {
        /// The sender.
        rank: usize,
        /// What does not fit.
        error: ColumnError,
    },
    /// The messages did not arrive.
    #[error(transparent)]
    Comm(#[from] CommError),
}

/// Sends every particle to its owner. Collective.
///
/// Afterwards the columns hold the particles that stayed, in their old order, then those that
/// came, by sending rank and in the order of the sender.
///
/// ```
/// use sph_decomp::{Communicator, MigrateError, ThreadRanks, migrate};
///
/// let ids = ThreadRanks::run(2, |comm| {
///     let mut ids = match comm.rank() {
///         0 => vec![10_u64, 11, 12],
///         _ => vec![20, 21],
///     };
///     let owners: Vec<u32> = ids.iter().map(|id| (id % 2) as u32).collect();
///     migrate(&comm, &owners, &mut ids)?;
///     Ok::<_, MigrateError>(ids)
/// });
/// assert_eq!(ids, Ok(vec![vec![10, 12, 20], vec![21, 11]]));
/// ```
pub fn migrate<C: Communicator>(
    comm: &C,
    owners: &[u32],
    columns: &mut impl Columns,
) -> Result<MigrationReport, MigrateError> {
    let (me, ranks) = (comm.rank(), comm.size());
    if columns.len() != owners.len() {
        return Err(MigrateError::Length { owners: owners.len(), particles: columns.len() });
    }
    if let Some(particle) = owners.iter().position(|&owner| owner as usize >= ranks) {
        let owner = owners[particle];
        return Err(MigrateError::NoSuchOwner { particle, owner, ranks });
    }
    let mut leaving: Vec<u32> = Vec::new();
    let mut staying: Vec<u32> = Vec::new();
    for (particle, &owner) in (0..).zip(owners) {
        if owner as usize == me { &mut staying } else { &mut leaving }.push(particle);
    }
    // Stable: the particles of a message keep their order.
    leaving.sort_by_key(|&particle| owners[particle as usize]);
    let mut report =
        MigrationReport { kept: staying.len(), sent: leaving.len(), ..Default::default() };
    let mut send = Vec::new();
    for group in leaving.chunk_by(|&a, &b| owners[a as usize] == owners[b as usize]) {
        let mut bytes = Vec::with_capacity(group.len() * columns.stride());
        columns.pack(group, &mut bytes);
        report.bytes_sent += bytes.len() as u64;
        send.push((owners[group[0] as usize] as usize, bytes));
    }
    let arrived = comm.exchange_some(send)?;
    if report.sent > 0 {
        columns.permute(&staying);
    }
    for (rank, bytes) in arrived {
        let count = columns.unpack(&bytes);
        report.received += count.map_err(|error| MigrateError::Columns { rank, error })?;
    }
    Ok(report)
}
