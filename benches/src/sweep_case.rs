//! A sweep ready to run: records and lists of a jittered lattice of fluid without walls.

use crate::{Lattice, Noise};
use rayon::prelude::*;
use sph_kernels::{Real, WendlandC2};
use sph_neighbors::{CellList, ClusterList, Clusters, Grid};
use sph_solver::kernel_shape::KernelShape;
use sph_solver::records::{Encoder, Record, record};
use sph_solver::space::{Open, PairScale};
use sph_solver::sweep::{Neighbors, sweep};
use sph_solver::team::Team;
use sph_solver::terms::{
    Acceleration, ArtificialViscosity, DeltaContinuity, DensityRate, Deviation, PairTerm, Pressure,
    Quantity, SymmetricPressure,
};
use std::marker::PhantomData;

/// Density pass of δ-SPH.
pub type DensityTerms = DeltaContinuity<3>;
/// Force pass of δ-SPH with artificial viscosity.
pub type ForceTerms = (SymmetricPressure, ArtificialViscosity);

const DENSITY: f64 = 1000.0;
const SOUND_SPEED: f64 = 20.0;
/// Targets of a task, as many as the solver gives to one.
const GRAIN: usize = 256;

/// Terms of the density pass for a support radius.
pub fn density_terms(support_radius: f64) -> DensityTerms {
    let strength = 0.1 * 0.5 * support_radius * SOUND_SPEED;
    let gradient = -9.81 * DENSITY / (SOUND_SPEED * SOUND_SPEED);
    DeltaContinuity { strength, hydrostatic_gradient: [0.0, 0.0, gradient] }
}

/// Terms of the force pass for a support radius.
pub fn force_terms(support_radius: f64) -> ForceTerms {
    let h = 0.5 * support_radius;
    let strength = 0.02 * h * SOUND_SPEED * DENSITY;
    (SymmetricPressure, ArtificialViscosity { strength, softening: 0.01 * h * h })
}

/// Terms of the force pass of an inviscid scene: the viscosity is absent.
pub fn inviscid_force_terms() -> (SymmetricPressure, ()) {
    (SymmetricPressure, ())
}

/// Records and lists of a jittered lattice.
#[derive(Debug, Clone)]
pub struct SweepCase<S> {
    /// Scale of the pairs.
    pub scale: PairScale<3>,
    /// Records with density deviations.
    pub deviation: Vec<Record<S>>,
    /// Records with pressures.
    pub pressure: Vec<Record<S>>,
    /// Densities, kg/m³.
    pub density: Vec<f64>,
    /// Neighbours within support radius and skin.
    pub list: ClusterList,
    /// Number of list entries within the support radius.
    pub true_pairs: u64,
}

impl<S: Real> SweepCase<S> {
    /// About `count` particles; `support` in spacings, `skin` in support radii.
    ///
    /// # Panics
    /// If `support` is not positive.
    pub fn new(count: usize, support: f64, skin: f64) -> Self {
        let lattice = Lattice::cube(count);
        let radius = support * lattice.spacing;
        let reach = radius * (1.0 + skin);
        let lattice = lattice.in_columns();
        let grid = Grid::new([0.0; 3], reach).expect("a positive cell size");
        let cells = CellList::build(&grid, &lattice.positions, &lattice.ids);
        let mut list = ClusterList::default();
        let clusters = Clusters::new(lattice.len(), &[]);
        list.rebuild(&clusters, &cells, &lattice.positions, true, reach);
        let true_pairs = list.pairs_within(&lattice.positions, &lattice.positions, true, radius);
        let scale = PairScale::new(radius);
        let encoder = Encoder::<3, S>::new(&scale, &KernelShape::of::<WendlandC2>(3));
        let mut noise = Noise::default();
        let mut case = Self {
            scale,
            deviation: Vec::with_capacity(lattice.len()),
            pressure: Vec::with_capacity(lattice.len()),
            density: Vec::with_capacity(lattice.len()),
            list,
            true_pairs,
        };
        for x in &lattice.positions {
            let velocity: [f64; 3] = std::array::from_fn(|_| noise.symmetric());
            let deviation = noise.symmetric();
            let density = DENSITY + deviation;
            let weight = encoder.weight(lattice.spacing.powi(3) * DENSITY / density);
            let motion = encoder.motion(x, &velocity);
            let pressure = SOUND_SPEED * SOUND_SPEED * deviation;
            case.deviation.push(record(motion, S::from_f64(deviation), weight));
            case.pressure.push(record(motion, S::from_f64(pressure), weight));
            case.density.push(density);
        }
        case
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.density.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.density.is_empty()
    }

    /// Changes of density of all particles.
    pub fn density_rates<T: PairTerm<3, Deviation>>(&self, terms: T) -> Vec<DensityRate> {
        let mut rates = vec![DensityRate::default(); self.len()];
        self.density_sweep(terms, &mut rates, None);
        rates
    }

    /// [`density_rates`](Self::density_rates) into memory that is there, on the threads of a team
    /// or on this one.
    pub fn density_sweep<T: PairTerm<3, Deviation>>(
        &self,
        terms: T,
        rates: &mut [DensityRate],
        team: Option<&Team>,
    ) {
        self.sweep::<Deviation, T>(&self.deviation, terms, rates, team);
    }

    /// Accelerations of all particles.
    pub fn accelerations<T: PairTerm<3, Pressure>>(&self, terms: T) -> Vec<Acceleration<3>> {
        let mut rates = vec![Acceleration::default(); self.len()];
        self.force_sweep(terms, &mut rates, None);
        rates
    }

    /// [`accelerations`](Self::accelerations) into memory that is there, on the threads of a team
    /// or on this one.
    pub fn force_sweep<T: PairTerm<3, Pressure>>(
        &self,
        terms: T,
        rates: &mut [Acceleration<3>],
        team: Option<&Team>,
    ) {
        self.sweep::<Pressure, T>(&self.pressure, terms, rates, team);
    }

    fn sweep<Q: Quantity, T: PairTerm<3, Q>>(
        &self,
        records: &[Record<S>],
        terms: T,
        rates: &mut [Q::Rate<3>],
        team: Option<&Team>,
    ) {
        let metric = PhantomData::<Open>;
        let pairs = Neighbors { records, list: &self.list, terms, halves: (&[], &[]), metric };
        let task = |(k, (rates, density)): (usize, (&mut [Q::Rate<3>], &[f64]))| {
            let first = k * GRAIN;
            sweep::<3, Q, WendlandC2, S, _>(first, records, density, &self.scale, &pairs, rates);
        };
        match team {
            None => {
                rates.chunks_mut(GRAIN).zip(self.density.chunks(GRAIN)).enumerate().for_each(task);
            }
            Some(team) => {
                let tasks = rates.par_chunks_mut(GRAIN).zip(self.density.par_chunks(GRAIN));
                team.install(|| tasks.enumerate().for_each(task));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_precisions_agree() {
        let mixed = SweepCase::<f32>::new(1000, 2.63, 0.1);
        let double = SweepCase::<f64>::new(1000, 2.63, 0.1);
        assert_eq!(mixed.true_pairs, double.true_pairs);
        assert!(mixed.true_pairs < mixed.list.pairs());
        let radius = mixed.scale.support_radius;
        let a = mixed.accelerations(force_terms(radius));
        let b = double.accelerations(force_terms(radius));
        let largest = b.iter().map(|b| b.0[0].abs()).fold(0.0, f64::max);
        for (a, b) in a.iter().zip(&b) {
            assert!((a.0[0] - b.0[0]).abs() < 1e-5 * largest, "{a:?} {b:?}");
        }
    }
}
