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

mod accounts;
mod density;
mod force;

pub use density::{DENSEST, DensityPass};
pub use force::{ForcePass, kicked, square};

use crate::block::{Block, Targets};
use crate::groups::{GroupSum, GroupView};
use crate::records::Record;
use crate::space::PairScale;
use crate::sweep::Beside;
use crate::terms::{Rate, VectorSum, flatness};
use crate::walls::WallSet;
use sph_neighbors::ClusterList;

/// What surrounds the fluid particles of a rank.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a, const D: usize, S> {
    /// Fluid neighbours of every owned fluid particle.
    pub near_fluid: &'a ClusterList,
    /// Those of them that a thin solid keeps a particle from seeing.
    pub across: &'a ClusterList,
    /// Walls. They do not change during a pass.
    pub walls: &'a [WallSet<D, S>],
    /// Scale of the pairs.
    pub scale: &'a PairScale<D>,
    /// Halves of the support radii of the fluid over the largest; none where all are the same.
    pub halves: Option<&'a [S]>,
}

impl<const D: usize, S: sph_kernels::Real> Surroundings<'_, D, S> {
    /// Sets the rates of a block to the sum over its fluid neighbours, whose records are in `old`, without
    /// those that a thin solid hides.
    fn sum_fluid<R: Rate>(
        &self,
        sum: &dyn GroupSum<D, S, R>,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, R>,
    ) {
        let list = self.near_fluid;
        let (scale, halves) = (self.scale, self.halves.map(|all| (all, all)));
        let view = GroupView { targets: old, sources: old, list, scale, halves, beside: None };
        if !sum.sum(view, block.first, block.density, block.rates) {
            block.rates.fill(R::default());
        }
        self.take_hidden(sum, old, block.first, block.density, block.rates);
    }

    /// Takes the sum over the fluid neighbours that a thin solid hides from that over all of them.
    fn take_hidden<R: Rate>(
        &self,
        sum: &dyn GroupSum<D, S, R>,
        old: &[Record<S>],
        first: usize,
        density: &[f64],
        rates: &mut [R],
    ) {
        if self.across.is_empty() {
            return;
        }
        let (list, scale) = (self.across, self.scale);
        let halves = self.halves.map(|all| (all, all));
        let view = GroupView { targets: old, sources: old, list, scale, halves, beside: None };
        let mut hidden = vec![R::default(); rates.len()];
        if sum.sum(view, first, density, &mut hidden) {
            rates.iter_mut().zip(hidden).for_each(|(rate, hidden)| *rate -= hidden);
        }
    }

    /// Shows `part` each wall that a block is near, with its sum for every target of the block.
    /// Walls that `acts` says no to are left out.
    fn of_walls<R: Rate>(
        &self,
        sum: &dyn GroupSum<D, S, R>,
        old: &[Record<S>],
        targets: &Targets<'_, D>,
        acts: impl Fn(&WallSet<D, S>) -> bool,
        mut part: impl FnMut(&WallSet<D, S>, &[R]),
    ) {
        let mut own = Vec::new();
        for wall in self.walls.iter().filter(|wall| acts(wall)) {
            own.resize(targets.density.len(), R::default());
            let view = GroupView {
                targets: old,
                sources: &wall.records,
                list: &wall.near,
                scale: self.scale,
                halves: self.halves.map(|fluid| (fluid, &wall.halves[..])),
                beside: Some(Beside { frame: wall.frame(), thin: wall.thin, ..targets.beside }),
            };
            if sum.sum(view, targets.first, targets.density, &mut own) {
                part(wall, &own);
            }
        }
    }

    /// The sum over the fluid neighbours of every target of a block, apart from its rates.
    fn of_fluid<R: Rate, Q>(
        &self,
        sum: &dyn GroupSum<D, S, R>,
        old: &[Record<S>],
        block: &Block<'_, D, S, Q>,
    ) -> Vec<R> {
        let mut sums = vec![R::default(); block.len()];
        let list = self.near_fluid;
        let (scale, halves) = (self.scale, self.halves.map(|all| (all, all)));
        let view = GroupView { targets: old, sources: old, list, scale, halves, beside: None };
        sum.sum(view, block.first, block.density, &mut sums);
        self.take_hidden(sum, old, block.first, block.density, &mut sums);
        sums
    }

    /// Sets how much the walls around the particles of a block count as one plane. Where there is but one
    /// solid, its own sums tell.
    fn flatness<R>(
        &self,
        normals: &dyn GroupSum<D, S, VectorSum<D>>,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, R>,
    ) {
        block.flatness.fill(1.0);
        if self.walls.len() < 2 {
            return;
        }
        let first = block.first;
        let clusters = self.near_fluid.clusters().within(first..first + block.len());
        for (cluster, range) in clusters {
            let near = |wall: &&WallSet<D, S>| !wall.near.sources(cluster).is_empty();
            if self.walls.iter().filter(near).count() < 2 {
                continue;
            }
            let mut all: Vec<Vec<VectorSum<D>>> = Vec::new();
            let own = range.start - first..range.end - first;
            let targets = block.targets().0.part(own.clone());
            self.of_walls(normals, old, &targets, |_| true, |_, sums| all.push(sums.to_vec()));
            for (k, share) in block.flatness[own].iter_mut().enumerate() {
                *share = flatness(all.iter().map(|of_solid| of_solid[k]));
            }
        }
    }

    /// Sets the shifts of a block to the sums of how crowded fluid and walls are.
    fn crowding<R>(
        &self,
        fluid: &dyn GroupSum<D, S, VectorSum<D>>,
        wall: Option<&dyn GroupSum<D, S, VectorSum<D>>>,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, R>,
    ) {
        let mut sums = self.of_fluid(fluid, old, block);
        if let Some(wall) = wall {
            let (targets, _) = block.targets();
            self.of_walls(wall, old, &targets, |_| true, |_, own| add(&mut sums, own));
        }
        for (shift, VectorSum(sum)) in block.shift.iter_mut().zip(sums) {
            *shift = sum;
        }
    }
}

/// Adds what one group contributes.
fn add<R: Rate>(rates: &mut [R], group: &[R]) {
    for (rate, part) in rates.iter_mut().zip(group) {
        *rate += *part;
    }
}
