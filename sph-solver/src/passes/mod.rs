//! The two passes of a step: density first, then forces.
//!
//! Kick–drift–kick with the density in the middle (the leapfrog form of Verlet; Antuono et al.
//! (2010) use it with δ-SPH in higher order, Adami, Hu & Adams (2012), eq. 21–25, in this one):
//!
//! ```text
//! v^{n+½} = v^n + dt_n/2 a^n
//! x^{n+1} = x^n + dt_n v^{n+½}
//! ρ^{n+1} = ρ^n + dt_n dρ/dt(x^{n+1}, v^{n+½}, ρ^n)          density pass
//! a^{n+1} = a(x^{n+1}, v^{n+½}, ρ^{n+1})                     force pass
//! v^{n+1} = v^{n+½} + dt_n/2 a^{n+1}
//! ```
//!
//! The last kick of a step, the first kick of the next one and its drift are one update, at the end
//! of the force pass. Between steps a run therefore holds `x^{n+1}`, `v^{n+½}`, `ρ^n` and `dt_n`.

mod density;
mod force;

pub use density::{DENSEST, DensityPass};
pub use force::{ForcePass, kicked};

use crate::block::Block;
use crate::groups::{GroupSum, GroupView};
use crate::records::Record;
use crate::space::PairScale;
use crate::sweep::Beside;
use crate::terms::{DensityRate, Rate, VectorSum};
use crate::walls::WallSet;
use sph_neighbors::ClusterList;

/// What surrounds the fluid particles of a rank.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a, const D: usize, S> {
    /// Fluid neighbours of every owned fluid particle.
    pub near_fluid: &'a ClusterList,
    /// Walls. They do not change during a pass.
    pub walls: &'a [WallSet<D, S>],
    /// Scale of the pairs.
    pub scale: &'a PairScale<D>,
}

impl<const D: usize, S> Surroundings<'_, D, S> {
    /// Sets the rates of a block to the sum over its fluid neighbours, whose records are in `old`.
    fn sum_fluid<R: Rate>(
        &self,
        sum: &dyn GroupSum<D, S, R>,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, R>,
    ) {
        let list = self.near_fluid;
        let view = GroupView { targets: old, sources: old, list, scale: self.scale, beside: None };
        if !sum.sum(view, block.first, block.density, block.rates) {
            block.rates.fill(R::default());
        }
    }

    /// Sets the shifts of a block to the sums of how crowded fluid and walls are.
    fn crowding(
        &self,
        fluid: &dyn GroupSum<D, S, VectorSum<D>>,
        wall: Option<&dyn GroupSum<D, S, VectorSum<D>>>,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, DensityRate>,
    ) {
        let mut sums = vec![VectorSum::default(); block.len()];
        let mut own = sums.clone();
        let list = self.near_fluid;
        let view = GroupView { targets: old, sources: old, list, scale: self.scale, beside: None };
        fluid.sum(view, block.first, block.density, &mut sums);
        for set in self.walls {
            let Some(wall) = wall else { break };
            let beside = Beside {
                lowest_pressure: block.lowest_wall_pressure,
                pressure_gradient: block.pressure_gradient,
            };
            let view = GroupView {
                targets: old,
                sources: &set.records,
                list: &set.near,
                scale: self.scale,
                beside: Some(beside),
            };
            if wall.sum(view, block.first, block.density, &mut own) {
                sums.iter_mut().zip(&own).for_each(|(sum, own)| *sum += *own);
            }
        }
        for (shift, VectorSum(sum)) in block.shift.iter_mut().zip(sums) {
            *shift = sum;
        }
    }

    /// Adds the sums over the elements of each wall to the rates of a block. `part` is shown what each
    /// wall contributed.
    fn add_walls<R: Rate>(
        &self,
        sum: &dyn GroupSum<D, S, R>,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, R>,
        mut part: impl FnMut(&WallSet<D, S>, &Block<'_, D, S, R>, &[R]),
    ) {
        let mut own = Vec::new();
        for wall in self.walls {
            own.resize(block.len(), R::default());
            let list = &wall.near;
            let beside = Beside {
                lowest_pressure: block.lowest_wall_pressure,
                pressure_gradient: block.pressure_gradient,
            };
            let view = GroupView {
                targets: old,
                sources: &wall.records,
                list,
                scale: self.scale,
                beside: Some(beside),
            };
            if !sum.sum(view, block.first, block.density, &mut own) {
                continue;
            }
            for (rate, own) in block.rates.iter_mut().zip(&own) {
                *rate += *own;
            }
            part(wall, block, &own);
        }
    }
}
