use crate::block::Block;
use crate::lio::{Extremes, Pass};
use crate::model::Model;
use crate::passes::Surroundings;
use crate::records::{QUANTITY, Record, WEIGHT, record};
use crate::sweep::sweep;
use crate::terms::{Acceleration, PairTerm, Pressure};
use bytemuck::Pod;
use sph_kernels::{Kernel, Real};
use std::marker::PhantomData;

/// Forces, the kicks on both sides of them and the drift to the next positions.
#[derive(Debug)]
pub struct ForcePass<'a, const D: usize, S, F, W, K> {
    /// Neighbours and their terms.
    pub around: Surroundings<'a, S, F, W>,
    /// Constants.
    pub model: &'a Model<D>,
    /// Step that ends here, s.
    pub dt_before: f64,
    /// Step that begins here, s.
    pub dt: f64,
    /// Kernel.
    pub kernel: PhantomData<K>,
}

/// `v + dt (a + g)`: one kick, used for every half step so that all of them round alike.
#[inline]
pub fn kicked<const D: usize>(v: [f64; D], dt: f64, a: [f64; D], g: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| v[k] + dt * (a[k] + g[k]))
}

impl<const D: usize, S, F, W, K> Pass<D, S> for ForcePass<'_, D, S, F, W, K>
where
    S: Real + Pod,
    F: PairTerm<D, Pressure>,
    W: PairTerm<D, Pressure>,
    K: Kernel,
{
    type Rate = Acceleration<D>;
    /// Place and motion.
    type Message = [S; 6];

    fn flux(
        &self,
        first: usize,
        old: &[Record<S>],
        density: &[f64],
        rates: &mut [Acceleration<D>],
    ) {
        let sources = self.around.sources(old);
        let clusters = self.around.near_fluid.clusters();
        let scale = self.model.scale::<K>();
        sweep::<D, Pressure, K, S, _>(clusters, first, old, density, scale, &sources, rates);
    }

    fn update(&self, old: &[Record<S>], block: &mut Block<'_, D, S, Acceleration<D>>) -> Extremes {
        let mut extremes = Extremes::NONE;
        let (gravity, encoder) = (self.model.gravity, self.model.encoder::<K>());
        let density0 = self.model.equation_of_state.density0();
        let limit2 = self.model.speed_limit().powi(2);
        let old = &old[block.first..][..block.len()];
        for (k, old) in old.iter().enumerate() {
            let Acceleration(a) = block.rates[k];
            let now = kicked(block.velocity[k], 0.5 * self.dt_before, a, gravity);
            let velocity = kicked(now, 0.5 * self.dt, a, gravity);
            let position: [f64; D] =
                std::array::from_fn(|d| block.position[k][d] + self.dt * velocity[d]);
            let speed2 = square(velocity);
            let acceleration2 = square::<D>(std::array::from_fn(|d| a[d] + gravity[d]));
            // Written so that NaN is a fault too: `max` alone would drop it.
            let fault = f64::from(!(speed2 <= limit2 && acceleration2 < f64::MAX));
            let ways = Extremes::ways(&velocity);
            extremes = extremes.max(Extremes { speed2, acceleration2, fault, velocity: ways });
            block.velocity[k] = velocity;
            block.position[k] = position;
            block.new[k] = record(
                encoder.motion(&position, &velocity),
                S::from_f64(block.density[k] - density0),
                old[WEIGHT],
            );
        }
        extremes
    }

    fn message(&self, new: &Record<S>, _: f64) -> [S; 6] {
        crate::records::motion(new)
    }

    fn receive(&self, message: &[S; 6], _: &mut Record<S>, new: &mut Record<S>) {
        *new = record(*message, new[QUANTITY], new[WEIGHT]);
    }
}

fn square<const D: usize>(v: [f64; D]) -> f64 {
    v.iter().map(|c| c * c).sum()
}
