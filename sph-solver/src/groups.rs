//! Sums over a group of pairs, with their types erased: compiled once for a kernel and the terms of
//! the group, called once per task.
//!
//! A pass adds up the groups that a scene has: the fluid, and every solid by itself. So groups cost
//! code by addition and not by multiplication, a group without a source nearby is skipped, and the
//! part of each solid is at hand as the load on it.

use crate::records::Record;
use crate::space::{Graded, Open, PairScale, Periodic};
use crate::sweep::{Beside, Neighbors, WallNeighbors, sweep};
use crate::terms::{PairTerm, Quantity, WallTerm};
use sph_kernels::{Kernel, Real};
use sph_neighbors::ClusterList;
use std::fmt;
use std::marker::PhantomData;

/// The records that a sum reads.
#[derive(Debug, Clone, Copy)]
pub struct GroupView<'a, const D: usize, S> {
    /// Records of the targets, indexed as in the list.
    pub targets: &'a [Record<S>],
    /// Records of the sources.
    pub sources: &'a [Record<S>],
    /// The sources of every cluster of targets.
    pub list: &'a ClusterList,
    /// Scale of the pairs.
    pub scale: &'a PairScale<D>,
    /// Halves of the support radii of the targets and of the sources over the largest, indexed as their
    /// records; none where all are the same.
    pub halves: Option<(&'a [S], &'a [S])>,
    /// What wall terms are told of the targets; sums over fluid have no use for it.
    pub beside: Option<Beside<'a, D>>,
}

/// The sum of the terms of one group over the sources of each target.
pub trait GroupSum<const D: usize, S, R>: Send + Sync {
    /// Computes `rates[k]` for target `first + k` of density `density[k]` (kg/m³). Returns whether
    /// any of them had a source; if none had, `rates` are left alone.
    fn sum(
        &self,
        view: GroupView<'_, D, S>,
        first: usize,
        density: &[f64],
        rates: &mut [R],
    ) -> bool;
}

/// A sum as a value.
pub type BoxedSum<const D: usize, S, R> = Box<dyn GroupSum<D, S, R>>;

impl<const D: usize, S, R> fmt::Debug for dyn GroupSum<D, S, R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("GroupSum")
    }
}

struct FluidSum<Q, K, T>(T, PhantomData<(Q, K)>);

struct WallSum<Q, K, T>(T, PhantomData<(Q, K)>);

/// The sum of pair terms over fluid neighbours.
pub fn fluid_sum<const D: usize, S, Q, K, T>(terms: T) -> BoxedSum<D, S, Q::Rate<D>>
where
    S: Real,
    Q: Quantity,
    K: Kernel,
    T: PairTerm<D, Q> + 'static,
{
    Box::new(FluidSum::<Q, K, T>(terms, PhantomData))
}

/// The sum of a wall term over the elements of a wall.
pub fn wall_sum<const D: usize, S, Q, K, T>(term: T) -> BoxedSum<D, S, Q::Rate<D>>
where
    S: Real,
    Q: Quantity,
    K: Kernel,
    T: WallTerm<D, Q> + 'static,
{
    Box::new(WallSum::<Q, K, T>(term, PhantomData))
}

impl<const D: usize, S, Q, K, T> GroupSum<D, S, Q::Rate<D>> for FluidSum<Q, K, T>
where
    S: Real,
    Q: Quantity,
    K: Kernel,
    T: PairTerm<D, Q>,
{
    fn sum(
        &self,
        view: GroupView<'_, D, S>,
        first: usize,
        density: &[f64],
        rates: &mut [Q::Rate<D>],
    ) -> bool {
        let GroupView { targets, sources: records, list, scale, halves, .. } = view;
        let (terms, none) = (self.0, (&[][..], &[][..]));
        if let Some((targets_halves, halves)) = halves {
            let (metric, halves) = (PhantomData::<Graded>, (&targets_halves[first..], halves));
            let pairs = Neighbors { records, list, terms, halves, metric };
            sweep::<D, Q, K, S, _>(first, targets, density, scale, &pairs, rates)
        } else if scale.is_periodic() {
            let metric = PhantomData::<Periodic>;
            let pairs = Neighbors { records, list, terms, halves: none, metric };
            sweep::<D, Q, K, S, _>(first, targets, density, scale, &pairs, rates)
        } else {
            let metric = PhantomData::<Open>;
            let pairs = Neighbors { records, list, terms, halves: none, metric };
            sweep::<D, Q, K, S, _>(first, targets, density, scale, &pairs, rates)
        }
    }
}

impl<const D: usize, S, Q, K, T> GroupSum<D, S, Q::Rate<D>> for WallSum<Q, K, T>
where
    S: Real,
    Q: Quantity,
    K: Kernel,
    T: WallTerm<D, Q>,
{
    fn sum(
        &self,
        view: GroupView<'_, D, S>,
        first: usize,
        density: &[f64],
        rates: &mut [Q::Rate<D>],
    ) -> bool {
        let GroupView { targets, sources: records, list, scale, halves, beside } = view;
        let Some(beside) = beside else { return false };
        let (term, none) = (self.0, (&[][..], &[][..]));
        if let Some((targets_halves, halves)) = halves {
            let (metric, halves) = (PhantomData::<Graded>, (&targets_halves[first..], halves));
            let pairs = WallNeighbors { records, list, term, beside, halves, metric };
            sweep::<D, Q, K, S, _>(first, targets, density, scale, &pairs, rates)
        } else if scale.is_periodic() {
            let metric = PhantomData::<Periodic>;
            let pairs = WallNeighbors { records, list, term, beside, halves: none, metric };
            sweep::<D, Q, K, S, _>(first, targets, density, scale, &pairs, rates)
        } else {
            let metric = PhantomData::<Open>;
            let pairs = WallNeighbors { records, list, term, beside, halves: none, metric };
            sweep::<D, Q, K, S, _>(first, targets, density, scale, &pairs, rates)
        }
    }
}
