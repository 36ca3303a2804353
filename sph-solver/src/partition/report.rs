//! What `sph partition` says about a scene.

use super::error::StudyError;
use super::field::{Costs, Field};
use super::network_file::NamedNetwork;
use crate::scene::Scene;
use serde::Serialize;
use sph_decomp::scale::{Layout, Prediction, RankLoad, Rates, Variant};

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Numbers of ranks.
    pub ranks: Vec<usize>,
    /// By what the partition weighs.
    pub costs: Costs,
    /// Whether to sample although all particles would fit.
    pub sample: bool,
    /// The network.
    pub network: NamedNetwork,
    /// What a core does.
    pub rates: Rates,
}

/// A scene on several numbers of ranks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartitionReport {
    /// Name of the scene.
    pub name: String,
    /// Number of space dimensions.
    pub dimension: usize,
    /// Initial particle distance, m.
    pub spacing: f64,
    /// Reach of lists and overlap zones, m.
    pub reach: f64,
    /// Fluid particles.
    pub fluid: u64,
    /// Wall particles.
    pub walls: u64,
    /// Lattice points along the edge of the blocks that stand for particles; absent when every
    /// particle was there.
    pub sampled_by_blocks_of: Option<i32>,
    /// By what the partition weighed.
    pub costs: Costs,
    /// The network.
    pub network: NamedNetwork,
    /// List entries that a core evaluates per second.
    pub pairs_per_second: f64,
    /// Message elements that a core packs per second.
    pub packs_per_second: f64,
    /// Share of rebuilds in the computing of one rank.
    pub rebuild_share: f64,
    /// Steps between two rebuilds.
    pub steps_per_rebuild: f64,
    /// One entry per number of ranks.
    pub partitions: Vec<Division>,
}

/// A number over all ranks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Smallest.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

/// The scene on one number of ranks. Counts of particles are of fluid particles.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Division {
    /// Number of ranks.
    pub ranks: usize,
    /// Owned particles.
    pub owned: Spread,
    /// Particles that no other rank needs.
    pub local: Spread,
    /// Particles that some other rank needs.
    pub inner: Spread,
    /// Particles of others that a rank needs.
    pub outer: Spread,
    /// Wall particles that a rank owns.
    pub walls: Spread,
    /// Ranks that a rank sends to in a pass.
    pub neighbours: Spread,
    /// Bytes that a rank sends in the density pass.
    pub density_pass_bytes: Spread,
    /// Bytes that a rank sends in the force pass.
    pub force_pass_bytes: Spread,
    /// Outer over owned particles of all ranks.
    pub halo_redundancy: f64,
    /// Largest over mean cost by which the partition weighs.
    pub imbalance: f64,
    /// Largest over mean number of pairs.
    pub pair_imbalance: f64,
    /// Messages travel behind local work, walls are computed once: what the program does.
    pub overlapped: Times,
    /// Messages are waited for.
    pub blocking: Times,
    /// Overlapped, but every rank repeats the walls within its reach.
    pub overlapped_repeating_walls: Times,
    /// Messages are waited for and walls repeated.
    pub blocking_repeating_walls: Times,
    /// Local, inner and outer particles of each rank.
    pub local_inner_outer: Vec<[u64; 3]>,
}

/// Predicted times of a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Times {
    /// Seconds of a step.
    pub step_seconds: f64,
    /// One-rank seconds over ranks times seconds.
    pub efficiency: f64,
    /// One-rank seconds over seconds.
    pub speedup: f64,
    /// Of these, seconds of waiting in passes on the slowest rank.
    pub exposed_seconds: f64,
    /// Seconds of packing, unpacking and message overhead on it.
    pub message_seconds: f64,
    /// Seconds of wall pairs that others compute too.
    pub repeated_seconds: f64,
    /// Seconds of communication for rebuilds.
    pub rebuild_message_seconds: f64,
}

impl PartitionReport {
    /// Divides the scene among each number of ranks.
    ///
    /// # Errors
    ///
    /// When the scene is wrong, the rates or the network make no sense, or there are more ranks than
    /// particles.
    pub fn new(scene: &Scene, study: &Study) -> Result<Self, StudyError> {
        study.rates.check()?;
        study.network.parameters().check()?;
        match scene.dimension() {
            2 => Self::of::<2>(scene, study),
            _ => Self::of::<3>(scene, study),
        }
    }

    fn of<const D: usize>(scene: &Scene, study: &Study) -> Result<Self, StudyError> {
        let mut field = Field::<D>::read(scene, study.costs, study.sample)?;
        let mut partitions = Vec::new();
        for &ranks in &study.ranks {
            partitions.push(Division::new(&field.layout(ranks)?, study));
        }
        Ok(Self {
            name: scene.name().into(),
            dimension: D,
            spacing: field.spacing,
            reach: field.reach,
            fluid: field.fluid.round() as u64,
            walls: field.walls.round() as u64,
            sampled_by_blocks_of: field.block_side,
            costs: study.costs,
            network: study.network.clone(),
            pairs_per_second: study.rates.pairs,
            packs_per_second: study.rates.packs,
            rebuild_share: study.rates.rebuilds.share,
            steps_per_rebuild: study.rates.rebuilds.steps,
            partitions,
        })
    }
}

impl Division {
    /// Counts and times of a layout.
    pub fn new(layout: &Layout, study: &Study) -> Self {
        let spread = |number: &dyn Fn(&RankLoad) -> f64| Spread {
            min: layout.min(number),
            mean: layout.sum(number) / layout.ranks.len() as f64,
            max: layout.max(number),
        };
        let bytes = |pass: usize| spread(&|rank| rank.sent * study.rates.element_bytes[pass]);
        let net = study.network.parameters();
        let times = |overlap: bool, repeats_walls: bool| {
            let variant = Variant { overlap, repeats_walls };
            Times::of(&Prediction::of(layout, &study.rates, &net, variant))
        };
        let whole = |rank: &RankLoad| {
            [rank.local, rank.inner, rank.outer].map(|count| count.round() as u64)
        };
        Self {
            ranks: layout.ranks.len(),
            owned: spread(&RankLoad::active),
            local: spread(&|rank| rank.local),
            inner: spread(&|rank| rank.inner),
            outer: spread(&|rank| rank.outer),
            walls: spread(&|rank| rank.passive),
            neighbours: spread(&|rank| f64::from(rank.messages_out)),
            density_pass_bytes: bytes(0),
            force_pass_bytes: bytes(1),
            halo_redundancy: layout.redundancy(),
            imbalance: layout.imbalance(|rank| rank.cost).ratio(),
            pair_imbalance: layout.imbalance(RankLoad::pairs).ratio(),
            overlapped: times(true, false),
            blocking: times(false, false),
            overlapped_repeating_walls: times(true, true),
            blocking_repeating_walls: times(false, true),
            local_inner_outer: layout.ranks.iter().map(whole).collect(),
        }
    }
}

impl Times {
    fn of(prediction: &Prediction) -> Self {
        Self {
            step_seconds: prediction.step,
            efficiency: prediction.efficiency(),
            speedup: prediction.speedup(),
            exposed_seconds: prediction.slowest.exposed,
            message_seconds: prediction.slowest.messages,
            repeated_seconds: prediction.slowest.repeated,
            rebuild_message_seconds: prediction.slowest.rebuild_messages,
        }
    }
}
