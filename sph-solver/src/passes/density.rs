use crate::block::Block;
use crate::energy::open_books;
use crate::lio::{Effects, Extremes, Pass};
use crate::model::Model;
use crate::passes::{Surroundings, add};
use crate::records::{Encoder, QUANTITY, Record, WEIGHT, motion, record};
use crate::scheme::Scheme;
use crate::spray::{is_inside, is_spray};
use crate::terms::{DensityRate, shift};
use bytemuck::Pod;
use sph_kernels::Real;
use sph_neighbors::Clusters;

/// Denser than this multiple of ρ0 a flow is no longer weakly compressible.
pub const DENSEST: f64 = 2.0;

/// Density at the new positions; leaves the pressure in the new records.
#[derive(Debug)]
pub struct DensityPass<'a, const D: usize, S> {
    /// Neighbours.
    pub around: Surroundings<'a, D, S>,
    /// What is summed over them.
    pub scheme: &'a Scheme<D, S>,
    /// Writes records.
    pub encoder: Encoder<D, S>,
    /// Constants.
    pub model: &'a Model<D>,
    /// Step from the old density to the new one, s.
    pub dt: f64,
}

impl<const D: usize, S: Real + Pod> DensityPass<'_, D, S> {
    /// The density at the new positions as the rate gives it, and as it becomes (kg/m³).
    #[inline]
    pub(super) fn next_density(&self, density: f64, rate: &DensityRate) -> [f64; 2] {
        let density0 = self.model.equation_of_state.density0();
        let moved = density + self.dt * rate.rate;
        [moved, if is_spray(rate) && moved < density0 { density0 } else { moved }]
    }
}

impl<const D: usize, S: Real + Pod> Pass<D, S> for DensityPass<'_, D, S> {
    type Rate = DensityRate;
    /// Pressure, weight, density deviation.
    type Message = [S; 3];

    fn clusters(&self) -> &Clusters {
        self.around.near_fluid.clusters()
    }

    fn flux(&self, old: &[Record<S>], block: &mut Block<'_, D, S, DensityRate>) -> Effects {
        let mut books = open_books(self.model, self.scheme);
        let mut of_walls = vec![DensityRate::default(); books.as_ref().map_or(0, |_| block.len())];
        self.around.sum_fluid(&*self.scheme.density, old, block);
        if let Some(sum) = &self.scheme.wall_normals {
            self.around.flatness(&**sum, old, block);
        }
        if let Some(sum) = &self.scheme.wall_density {
            let (targets, rates) = block.targets();
            self.around.of_walls(
                &**sum,
                old,
                &targets,
                |_| true,
                |_, own| {
                    add(rates, own);
                    // Empty without a budget.
                    add(&mut of_walls, own);
                },
            );
        }
        if let (Some(accounts), Some(taken)) = (&self.scheme.accounts, &mut books) {
            self.book(accounts, &of_walls, old, block, taken);
        }
        if let Some(sum) = &self.scheme.shifting {
            self.around.crowding(&**sum, self.scheme.wall_shifting.as_deref(), old, block);
        }
        Effects { energy: books.map(Box::new), ..Effects::NONE }
    }

    fn update(&self, old: &[Record<S>], block: &mut Block<'_, D, S, DensityRate>) -> Extremes {
        let encoder = &self.encoder;
        let density0 = self.model.equation_of_state.density0();
        let mut fault = 0.0;
        let old = &old[block.first..][..block.len()];
        for (k, old) in old.iter().enumerate() {
            let rate = &block.rates[k];
            let [_, density] = self.next_density(block.density[k], rate);
            block.lowest_wall_pressure[k] =
                if is_inside(rate) { self.model.lowest_pressure } else { 0.0 };
            // Written so that NaN is a fault too.
            if !(density > 0.0 && density < DENSEST * density0) {
                fault = 1.0;
            }
            if let Some(crowding) = block.shift.get_mut(k) {
                let radius = self.model.radius_of(block.mass[k]);
                // Where there is no free surface, a gap is one that is to be closed.
                let filled = if self.model.closed { 1.0 } else { rate.fluid + rate.wall };
                *crowding = shift(crowding, filled, radius);
            }
            block.density[k] = density;
            block.new[k] = record(
                motion(old),
                S::from_f64(self.model.pressure(density)),
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
