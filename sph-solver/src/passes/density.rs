use crate::block::Block;
use crate::lio::{Extremes, Pass};
use crate::model::Model;
use crate::passes::Surroundings;
use crate::records::{QUANTITY, Record, WEIGHT, motion, record};
use crate::sweep::sweep;
use crate::terms::{Deviation, PairTerm};
use bytemuck::Pod;
use sph_kernels::{Kernel, Real};
use std::marker::PhantomData;

/// Denser than this multiple of ρ0 a flow is no longer weakly compressible.
pub const DENSEST: f64 = 2.0;

/// Density at the new positions; leaves the pressure in the new records.
#[derive(Debug)]
pub struct DensityPass<'a, const D: usize, S, F, W, K> {
    /// Neighbours and their terms.
    pub around: Surroundings<'a, S, F, W>,
    /// Constants.
    pub model: &'a Model<D>,
    /// Step from the old density to the new one, s.
    pub dt: f64,
    /// Kernel.
    pub kernel: PhantomData<K>,
}

impl<const D: usize, S, F, W, K> Pass<D, S> for DensityPass<'_, D, S, F, W, K>
where
    S: Real + Pod,
    F: PairTerm<D, Deviation>,
    W: PairTerm<D, Deviation>,
    K: Kernel,
{
    type Rate = f64;
    /// Pressure, weight, density deviation.
    type Message = [S; 3];

    fn flux(&self, first: usize, old: &[Record<S>], density: &[f64], rates: &mut [f64]) {
        let sources = self.around.sources(old);
        let clusters = self.around.near_fluid.clusters();
        let scale = self.model.scale::<K>();
        sweep::<D, Deviation, K, S, _>(clusters, first, old, density, scale, &sources, rates);
    }

    fn update(&self, old: &[Record<S>], block: &mut Block<'_, D, S, f64>) -> Extremes {
        let (eos, encoder) = (&self.model.equation_of_state, self.model.encoder::<K>());
        let density0 = eos.density0();
        let mut fault = 0.0;
        let old = &old[block.first..][..block.len()];
        for (k, old) in old.iter().enumerate() {
            let mut density = block.density[k] + self.dt * block.rates[k];
            if block.spray[k] && density < density0 {
                density = density0;
            }
            // Written so that NaN is a fault too.
            if !(density > 0.0 && density < DENSEST * density0) {
                fault = 1.0;
            }
            block.density[k] = density;
            block.new[k] = record(
                motion(old),
                S::from_f64(eos.pressure(density)),
                encoder.weight(block.mass[k] / density),
            );
        }
        Extremes { fault, ..Extremes::NONE }
    }

    fn message(&self, new: &Record<S>, density: f64) -> [S; 3] {
        [new[QUANTITY], new[WEIGHT], S::from_f64(density - self.model.equation_of_state.density0())]
    }

    fn receive(&self, message: &[S; 3], old: &mut Record<S>, new: &mut Record<S>) {
        let [pressure, weight, deviation] = *message;
        *new = record(motion(old), pressure, weight);
        // The force pass moves outer particles but does not change their density, so that what the
        // next density pass needs of it is entered now.
        *old = record(motion(old), deviation, weight);
    }
}
