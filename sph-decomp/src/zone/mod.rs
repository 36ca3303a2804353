//! The overlap zone: which particles other ranks need.
//!
//! The zone is *piecewise*: its width follows the reach of the particles nearby, never the largest
//! reach of a rank. Each rank tiles the particles near another rank into small blocks with a tight
//! box and the farthest reach inside, and tells that rank its blocks. A particle is then sent to
//! rank *q* when for some block *b'* of *q*
//!
//! ```text
//! distance(x_i, box_b') < R(R_i, R_b')
//! ```
//!
//! where *R* is the rule for pairs ([`MeanReach`] or [`MaxReach`]). Because *R* grows with both its
//! arguments and no particle is nearer than its box,
//!
//! * the zone is complete: a particle that any particle of *q* can see is sent to *q*;
//! * a particle that is not sent to *q* sees nothing of *q*: particles that are sent to nobody
//!   have only owned neighbours, and can be computed before any message has arrived.

mod boxes;
mod reach;
mod tree;

pub use reach::{MaxReach, MeanReach, PairReach, Reach};

pub(crate) use boxes::{Aabb, Period};
pub(crate) use tree::{Block, BlockTree, tile};
use tree::{from_bytes, to_bytes};

use crate::{CommError, Communicator, HaloPlan};

/// How a zone is built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZoneOptions<const D: usize> {
    /// Particles per block. Small blocks fit tightly, so that fewer particles are sent needlessly,
    /// but their summaries make longer messages at a rebuild. With 1 the zone is exact.
    pub block: usize,
    /// Lengths of the periodic axes, `None` for others. Distances are then to the nearest image;
    /// positions must lie within one period of each other, and the reach of a pair below half a
    /// period.
    pub period: [Option<f64>; D],
}

impl<const D: usize> Default for ZoneOptions<D> {
    fn default() -> Self {
        Self { block: 4, period: [None; D] }
    }
}

/// Why a zone cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ZoneError {
    /// A coordinate is NaN or infinite.
    #[error("particle {particle} (index on this rank) is at {value} on axis {axis}")]
    Position {
        /// Index of the particle on this rank.
        particle: usize,
        /// The axis.
        axis: usize,
        /// The coordinate.
        value: f64,
    },
    /// A reach is negative, NaN or infinite.
    #[error(
        "particle {particle} (index on this rank) reaches {value}; a reach must be finite and not negative"
    )]
    Reach {
        /// Index of the particle on this rank.
        particle: usize,
        /// Its reach.
        value: f64,
    },
    /// Not one reach per particle.
    #[error("there are {reaches} reaches for {particles} particles")]
    Length {
        /// Number of reaches.
        reaches: usize,
        /// Number of particles.
        particles: usize,
    },
    /// A block of no particles was asked for, or a period is not positive.
    #[error("zone option `{option}` is {value}; it must be positive and finite")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
    },
    /// The ranks could not exchange their blocks.
    #[error(transparent)]
    Comm(#[from] CommError),
}

/// The overlap zone of a rank.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Zone {
    sends: Vec<(usize, Vec<u32>)>,
    /// Bytes of block summaries that this rank sent to build the zone.
    pub summary_bytes: u64,
}

impl Zone {
    /// For each neighbouring rank the owned particles that it needs, ascending.
    pub fn sends(&self) -> &[(usize, Vec<u32>)] {
        &self.sends
    }

    /// The plan of the exchange. Collective.
    pub fn into_plan<C: Communicator>(self, comm: &C) -> Result<HaloPlan, CommError> {
        HaloPlan::new(comm, self.sends)
    }

    /// Finds the particles that other ranks need. Collective.
    ///
    /// `reach` must include the skin if the zone is to be used for several steps, and `rule` names
    /// how the reaches of a pair combine. All ranks give the same rule and options.
    ///
    /// ```
    /// use sph_decomp::{Communicator, MaxReach, Reach, ThreadRanks, Zone, ZoneOptions};
    ///
    /// // Particles at 0, 1, 2, … on a line, ten per rank, each seeing up to 2.5 to both sides.
    /// let inner = ThreadRanks::run(2, |comm| {
    ///     let first = 10 * comm.rank();
    ///     let positions: Vec<[f64; 1]> = (first..first + 10).map(|i| [i as f64]).collect();
    ///     let options = ZoneOptions { block: 1, ..Default::default() };
    ///     let zone = Zone::build(&comm, &positions, Reach::Uniform(2.5), MaxReach, &options)?;
    ///     Ok::<_, sph_decomp::ZoneError>(zone.sends().to_vec())
    /// });
    /// assert_eq!(inner, Ok(vec![vec![(1, vec![8, 9])], vec![(0, vec![0, 1])]]));
    /// ```
    pub fn build<const D: usize, R: PairReach, C: Communicator>(
        comm: &C,
        positions: &[[f64; D]],
        reach: Reach<'_>,
        rule: R,
        options: &ZoneOptions<D>,
    ) -> Result<Self, ZoneError> {
        check(positions, reach, options)?;
        if comm.size() == 1 {
            return Ok(Self::default());
        }
        Builder { positions, reach, _rule: rule, options }.build(comm)
    }
}

pub(crate) fn check<const D: usize>(
    positions: &[[f64; D]],
    reach: Reach<'_>,
    options: &ZoneOptions<D>,
) -> Result<(), ZoneError> {
    for (particle, x) in positions.iter().enumerate() {
        if let Some(axis) = x.iter().position(|x| !x.is_finite()) {
            return Err(ZoneError::Position { particle, axis, value: x[axis] });
        }
    }
    let good = |reach: f64| reach.is_finite() && reach >= 0.0;
    match reach {
        Reach::Uniform(value) if !good(value) => {
            return Err(ZoneError::Reach { particle: 0, value });
        }
        Reach::PerParticle(all) if all.len() != positions.len() => {
            return Err(ZoneError::Length { reaches: all.len(), particles: positions.len() });
        }
        Reach::PerParticle(all) => {
            if let Some(particle) = all.iter().position(|&value| !good(value)) {
                return Err(ZoneError::Reach { particle, value: all[particle] });
            }
        }
        Reach::Uniform(_) => (),
    }
    if options.block == 0 {
        return Err(ZoneError::Option { option: "block", value: 0.0 });
    }
    match options.period.iter().flatten().find(|length| !(length.is_finite() && **length > 0.0)) {
        Some(&value) => Err(ZoneError::Option { option: "period", value }),
        None => Ok(()),
    }
}

struct Builder<'a, const D: usize, R> {
    positions: &'a [[f64; D]],
    reach: Reach<'a>,
    _rule: R,
    options: &'a ZoneOptions<D>,
}

/// Consecutive particles that are tested against a rank together. Sorted particles are near each
/// other, so most runs are far from the boundary and cost one test.
const RUN: usize = 64;

impl<const D: usize, R: PairReach> Builder<'_, D, R> {
    fn build<C: Communicator>(&self, comm: &C) -> Result<Zone, ZoneError> {
        let runs: Vec<Block<D>> =
            (0..self.positions.len()).step_by(RUN).map(|i| self.run(i)).collect();
        let whole = Block::merged(&runs);
        let ranks = self.whole_ranks(comm, &whole)?;
        let period = &self.options.period;
        let touching = |rank: usize, other: &Block<D>| {
            rank != comm.rank() && !other.bounds.is_empty() && other.touches::<R>(&whole, period)
        };
        let mut summaries = Vec::new();
        let mut candidates = Vec::new();
        for (rank, other) in ranks.iter().enumerate().filter(|(rank, other)| touching(*rank, other))
        {
            let mut near = self.near(&runs, other);
            let mut blocks = Vec::new();
            tile(
                &mut near,
                self.positions,
                |i| self.reach.of(i as usize),
                self.options.block,
                &mut blocks,
            );
            summaries.push((rank, to_bytes(&blocks)));
            near.sort_unstable();
            candidates.push((rank, near));
        }
        let summary_bytes = summaries.iter().map(|(_, bytes)| bytes.len() as u64).sum();
        let mut sends = Vec::new();
        for (rank, bytes) in comm.exchange_some(summaries)? {
            let blocks = from_bytes(&bytes).ok_or_else(|| {
                let expected = 8 * (2 * D + 1);
                CommError::WrongLength { rank, got: bytes.len(), expected }
            })?;
            let tree = BlockTree::new(blocks);
            // A rank that is near this one is near it from both sides.
            let Some((_, near)) = candidates.iter_mut().find(|(other, _)| *other == rank) else {
                continue;
            };
            near.retain(|&i| tree.touches::<R>(&self.point(i as usize), period));
            if !near.is_empty() {
                sends.push((rank, std::mem::take(near)));
            }
        }
        Ok(Zone { sends, summary_bytes })
    }

    fn point(&self, particle: usize) -> Block<D> {
        Block::point(&self.positions[particle], self.reach.of(particle))
    }

    fn run(&self, start: usize) -> Block<D> {
        let end = (start + RUN).min(self.positions.len());
        let mut run = Block::EMPTY;
        (start..end).for_each(|i| run.merge(&self.point(i)));
        run
    }

    /// The box and farthest reach of every rank.
    fn whole_ranks<C: Communicator>(
        &self,
        comm: &C,
        mine: &Block<D>,
    ) -> Result<Vec<Block<D>>, CommError> {
        let mut ranks = Vec::new();
        for (rank, bytes) in comm.all_gather(&to_bytes(&[*mine]))?.into_iter().enumerate() {
            match from_bytes(&bytes).as_deref() {
                Some(&[whole]) => ranks.push(whole),
                _ => {
                    let expected = 8 * (2 * D + 1);
                    return Err(CommError::WrongLength { rank, got: bytes.len(), expected });
                }
            }
        }
        Ok(ranks)
    }

    /// Particles that may see something of a rank with this box and reach.
    fn near(&self, runs: &[Block<D>], other: &Block<D>) -> Vec<u32> {
        let period = &self.options.period;
        let mut near = Vec::new();
        for (start, run) in (0..).step_by(RUN).zip(runs) {
            if run.touches::<R>(other, period) {
                let end = (start + RUN).min(self.positions.len());
                let touching = (start..end).filter(|&i| self.point(i).touches::<R>(other, period));
                near.extend(touching.map(|i| i as u32));
            }
        }
        near
    }
}
