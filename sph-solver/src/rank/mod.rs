//! The particles of one rank in the layout that the passes work on.

mod across;
pub(crate) mod costs;
mod first;
mod rebuild;
mod traveller;
mod walls;

pub(crate) use first::first_of_all;
pub use rebuild::Gone;

use crate::block::FluidColumns;
use crate::groups::GroupView;
use crate::passes::{DENSEST, Surroundings};
use crate::records::{Encoder, Record, record};
use crate::scheme::Scheme;
use crate::search::Sorted;
use crate::space::PairScale;
use crate::state::State;
use crate::terms::{Acceleration, DensityRate, SlopeSum};
use crate::walls::{WallElements, WallSet};
use bytemuck::Pod;
use sph_decomp::{Askew, Halo, HaloPlan, Orb, Parts};
use sph_kernels::Real;
use sph_neighbors::ClusterList;

/// The particles of a rank.
///
/// Owned particles are columns of [`State`]. Records hold `[local | inner | outer]` of the fluid,
/// twice because a pass reads one copy and writes the other, and once all elements of walls, owned or
/// not, that the fluid of this rank can see.
#[derive(Debug, Clone, Default)]
pub struct Rank<const D: usize, S: Real> {
    /// Owned fluid particles.
    pub state: State<D>,
    /// Owned elements of walls.
    pub elements: WallElements<D>,
    /// Layout of the fluid.
    pub fluid: Parts,
    /// Layout of the elements of walls.
    pub solid: Parts,
    /// Fluid neighbours of the owned fluid particles.
    pub near_fluid: ClusterList,
    /// Those of them that a thin solid keeps from being seen.
    pub across: ClusterList,
    /// Walls that the fluid of this rank can see, with their elements near it.
    pub walls: Vec<WallSet<D, S>>,
    /// Lowest pressure that a wall has towards each owned fluid particle, Pa: the density pass says.
    lowest_wall_pressure: Vec<f64>,
    /// How much the walls around each owned fluid particle count as one plane: the density pass says.
    flatness: Vec<f64>,
    /// Velocity by which each owned fluid particle is shifted, as a share of the largest speed; nothing if
    /// none is.
    shift: Vec<[f64; D]>,
    /// ∇R of each owned fluid particle over the largest support radius, 1/m; nothing where all are the
    /// same.
    radius_slope: Vec<[f64; D]>,
    /// Results of the force sweep.
    pub(crate) force_rate: Vec<Acceleration<D>>,
    /// Results of the density sweep.
    density_rate: Vec<DensityRate>,
    /// Records with density deviations.
    deviation: Vec<Record<S>>,
    /// Records with pressures.
    pressure: Vec<Record<S>>,
    /// Halves of the support radii of the fluid over the largest; none where all are the same.
    halves: Option<Vec<S>>,
    /// Whether the walls are where the fluid of this rank can see them.
    settled: bool,
    /// Where the fluid is, outer particles included.
    sorted: Option<Sorted<D>>,
    /// Lanes that were pairs, of all that were computed, when the fluid was last sorted.
    compactness: f64,
    plan: HaloPlan,
    density_halo: Halo<[S; 3]>,
    force_halo: Halo<[S; 6]>,
    partition: Option<Askew<Orb<D>>>,
}

/// Steeper slopes of support radii are those of single particles among others of another size.
const STEEPEST: f64 = 0.4;

/// The record of particle `i`, with its density deviation.
fn record_of<const D: usize, S: Real>(
    encoder: &Encoder<D, S>,
    density0: f64,
    state: &State<D>,
    i: usize,
) -> Record<S> {
    let weight = encoder.weight(state.mass[i] / state.density[i]);
    let deviation = S::from_f64(state.density[i] - density0);
    record(encoder.motion(&state.position[i], &state.velocity[i]), deviation, weight)
}

/// What a pass needs of a rank, borrowed apart.
pub struct Passing<'a, const D: usize, S> {
    /// Fluid neighbours.
    pub near_fluid: &'a ClusterList,
    /// Those of them that a thin solid hides.
    pub across: &'a ClusterList,
    /// Walls.
    pub walls: &'a [WallSet<D, S>],
    /// Halves of the support radii of the fluid over the largest; none where all are the same.
    pub halves: Option<&'a [S]>,
    /// Layout of the fluid.
    pub parts: Parts,
    /// Who sends what.
    pub plan: &'a HaloPlan,
    /// Columns of the owned fluid.
    pub columns: FluidColumns<'a, D>,
    /// Records with density deviations.
    pub deviation: &'a mut [Record<S>],
    /// Records with pressures.
    pub pressure: &'a mut [Record<S>],
    /// Results of the density pass.
    pub density_rate: &'a mut [DensityRate],
    /// Results of the force pass.
    pub force_rate: &'a mut [Acceleration<D>],
    /// Buffers of the density pass.
    pub density_halo: &'a mut Halo<[S; 3]>,
    /// Buffers of the force pass.
    pub force_halo: &'a mut Halo<[S; 6]>,
}

impl<'a, const D: usize, S> Passing<'a, D, S> {
    /// The surroundings of the fluid.
    pub fn surroundings(&self, scale: &'a PairScale<D>) -> Surroundings<'a, D, S> {
        let Self { near_fluid, across, walls, halves, .. } = *self;
        Surroundings { near_fluid, across, walls, scale, halves }
    }
}

impl<const D: usize, S: Real + Pod> Rank<D, S> {
    /// Holds fluid and walls; nothing is built yet.
    pub fn new(state: State<D>, elements: WallElements<D>) -> Self {
        Self { state, elements, ..Self::default() }
    }

    /// Makes room for what a scheme keeps per particle beyond its state.
    pub fn make_room(&mut self, shifts: bool) {
        self.shift.resize(if shifts { self.fluid.owned() } else { 0 }, [0.0; D]);
    }

    /// Finds how support radii grow from place to place, if a scheme asks for it. Lists last no longer
    /// than the answer holds.
    pub fn find_slopes(&mut self, scheme: &Scheme<D, S>, scale: &PairScale<D>) {
        let (Some(sum), Some(halves)) = (&scheme.radius_slope, &self.halves) else { return };
        let owned = self.fluid.owned();
        let mut sums = vec![SlopeSum::default(); owned];
        let view = GroupView {
            targets: &self.deviation,
            sources: &self.deviation,
            list: &self.near_fluid,
            scale,
            halves: Some((halves, halves)),
            beside: None,
        };
        sum.sum(view, 0, &self.state.density, &mut sums);
        let most = STEEPEST / scale.support_radius;
        let slope = |sum: SlopeSum<D>| {
            let slope = sum.gradient().unwrap_or([0.0; D]);
            let length = slope.iter().map(|c| c * c).sum::<f64>().sqrt();
            if length > most { slope.map(|c| c * (most / length)) } else { slope }
        };
        self.radius_slope.clear();
        self.radius_slope.extend(sums.into_iter().map(slope));
    }

    /// Pairs of the owned fluid particles with fluid and walls.
    pub fn pairs(&self) -> u64 {
        self.near_fluid.pairs() + self.walls.iter().map(|wall| wall.near.pairs()).sum::<u64>()
    }

    /// Everything that a pass needs.
    pub fn passing(&mut self) -> Passing<'_, D, S> {
        let n = self.fluid.owned();
        Passing {
            near_fluid: &self.near_fluid,
            across: &self.across,
            walls: &self.walls,
            halves: self.halves.as_deref(),
            parts: self.fluid,
            plan: &self.plan,
            columns: FluidColumns {
                position: &mut self.state.position[..n],
                velocity: &mut self.state.velocity[..n],
                density: &mut self.state.density[..n],
                mass: &self.state.mass[..n],
                pressure_gradient: &mut self.state.pressure_gradient[..n],
                lowest_wall_pressure: &mut self.lowest_wall_pressure,
                flatness: &mut self.flatness,
                shift: &mut self.shift,
                radius_slope: &self.radius_slope,
            },
            deviation: &mut self.deviation,
            pressure: &mut self.pressure,
            density_rate: &mut self.density_rate,
            force_rate: &mut self.force_rate,
            density_halo: &mut self.density_halo,
            force_halo: &mut self.force_halo,
        }
    }

    /// The owned fluid particle with the lowest id whose numbers are out of range, if any.
    pub fn faulty(&self, speed_limit: f64, density0: f64) -> Option<(u64, [f64; D])> {
        let fits = |v: &[f64; D]| v.iter().map(|c| c * c).sum::<f64>() <= speed_limit * speed_limit;
        let sound = |k: &usize| {
            let state = &self.state;
            let Acceleration(a) = &self.force_rate[*k];
            let density = state.density[*k];
            fits(&state.velocity[*k])
                && a.iter().all(|c| c.is_finite())
                && density > 0.0
                && density < DENSEST * density0
        };
        (0..self.fluid.owned())
            .filter(|k| !sound(k))
            .map(|k| (self.state.id[k], self.state.position[k]))
            .min_by_key(|(id, _)| *id)
    }

    /// Bytes of particle data and lists on this rank.
    pub fn bytes(&self) -> usize {
        let record = size_of::<Record<S>>();
        let column = 3 * size_of::<[f64; D]>() + 3 * 8;
        self.state.len() * column
            + self.elements.bytes()
            + (self.deviation.len() + self.pressure.len()) * record
            + self.shift.len() * size_of::<[f64; D]>()
            + self.force_rate.len() * (size_of::<[f64; D]>() + size_of::<DensityRate>() + 16)
            + self.near_fluid.bytes()
            + self.sorted.as_ref().map_or(0, Sorted::bytes)
            + self.halves.as_ref().map_or(0, |halves| size_of_val(&halves[..]))
            + self.across.bytes()
            + self.walls.iter().map(WallSet::bytes).sum::<usize>()
    }
}
