//! The sweep: sums pair terms over the neighbours of every target, one target a lane.
//!
//! One function, [`sweep`], compiled for a dimension, a kernel, a scalar and a tuple of terms. The
//! targets of a cluster lie in the lanes; each source near the cluster is read once, as one record
//! that is broadcast to all lanes, and adds to every target. Sources beyond the support of a target
//! add zero to it, because the kernel's slope is zero there. So each target adds its neighbours one
//! after the other in canonical order, and its sums depend neither on threads, nor on ranks, nor on
//! the width of the lanes, nor on who shares its cluster.

use crate::records::{QUANTITY, Record, WEIGHT, velocity_word};
use crate::terms::{Pair, PairTerm, Quantity, Source, Target, dot, lanes};
use sph_kernels::{Kernel, Lanes, Real, Vectorized};
use sph_neighbors::{CLUSTER, ClusterList, Clusters};
use std::array::from_fn;
use std::marker::PhantomData;
use std::ops::Range;

/// Kernel and scale of the pairs.
#[derive(Debug, Clone, Copy)]
pub struct PairScale {
    /// Metres per unit of coordinate differences.
    pub unit: f64,
    /// Support radius R, m.
    pub support_radius: f64,
}

/// One group of neighbours: where their records are, who they are, what they contribute.
#[derive(Debug, Clone, Copy)]
pub struct Neighbors<'a, S, T> {
    /// Records that the list points into.
    pub records: &'a [Record<S>],
    /// A list per cluster of targets.
    pub list: &'a ClusterList,
    /// Terms of this group.
    pub terms: T,
}

/// Groups of neighbours: one, or a pair of groups whose contributions add up.
pub trait Sources<const D: usize, Q: Quantity, S: Real>: Sync {
    /// Adds the contributions to the targets of a cluster.
    fn add<K: Kernel, L: Lanes<Scalar = S>>(
        &self,
        cluster: usize,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale,
        sum: &mut Q::Sum<D, L>,
    );
}

impl<const D: usize, Q, S, A, B> Sources<D, Q, S> for (A, B)
where
    Q: Quantity,
    S: Real,
    A: Sources<D, Q, S>,
    B: Sources<D, Q, S>,
{
    #[inline(always)]
    fn add<K: Kernel, L: Lanes<Scalar = S>>(
        &self,
        cluster: usize,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale,
        sum: &mut Q::Sum<D, L>,
    ) {
        self.0.add::<K, L>(cluster, position, target, scale, sum);
        self.1.add::<K, L>(cluster, position, target, scale, sum);
    }
}

impl<const D: usize, Q, S, T> Sources<D, Q, S> for Neighbors<'_, S, T>
where
    Q: Quantity,
    S: Real,
    T: PairTerm<D, Q>,
{
    #[inline(always)]
    fn add<K: Kernel, L: Lanes<Scalar = S>>(
        &self,
        cluster: usize,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale,
        sum: &mut Q::Sum<D, L>,
    ) {
        if T::EMPTY {
            return;
        }
        let (unit, per_unit) = (lanes(scale.unit), lanes(1.0 / scale.unit));
        let to_q: L = lanes(scale.unit / scale.support_radius);
        // Copies, so that the constants of the terms are spread over the lanes once and not per pair.
        let Self { records, list, terms } = *self;
        for &j in list.sources(cluster) {
            let record = &records[j as usize];
            let offset: [L; D] =
                from_fn(|k| L::coordinate_difference(position[k], L::splat(record[k])));
            let distance2 = dot(&offset, &offset);
            let distance = distance2.sqrt();
            let weight = K::slope_shape(distance * to_q) * L::splat(record[WEIGHT]);
            let source = Source {
                quantity: L::splat(record[QUANTITY]),
                velocity: from_fn(|k| L::splat(record[velocity_word(k)])),
            };
            let pair = Pair { offset, distance2, distance, weight, unit, per_unit };
            Q::add(sum, terms.coefficient(target, &source, &pair), &pair);
        }
    }
}

/// Computes `rates[k]` for target `first + k`.
///
/// * `clusters`: those of the lists in `sources`. Most efficient when the range of targets begins
///   and ends with a cluster.
/// * `records`: records of the targets, indexed like the clusters.
/// * `density`: kg/m³ of the targets, in order.
/// * `sources`: groups of neighbours with their terms, usually `(fluid, walls)`. A group whose terms
///   are `()` leaves no instruction.
pub fn sweep<const D: usize, Q, K, S, N>(
    clusters: &Clusters,
    first: usize,
    records: &[Record<S>],
    density: &[f64],
    scale: PairScale,
    sources: &N,
    rates: &mut [Q::Rate<D>],
) where
    Q: Quantity,
    K: Kernel,
    S: Real,
    N: Sources<D, Q, S>,
{
    assert_eq!(density.len(), rates.len(), "one density per target");
    let kernel = PhantomData::<K>;
    S::dispatch(Chunk::<D, Q, K, S, N> {
        clusters,
        first,
        records,
        density,
        scale,
        sources,
        rates,
        kernel,
    });
}

struct Chunk<'a, const D: usize, Q: Quantity, K, S, N> {
    clusters: &'a Clusters,
    first: usize,
    records: &'a [Record<S>],
    density: &'a [f64],
    scale: PairScale,
    sources: &'a N,
    rates: &'a mut [Q::Rate<D>],
    kernel: PhantomData<K>,
}

impl<const D: usize, Q, K, S, N> Vectorized for Chunk<'_, D, Q, K, S, N>
where
    Q: Quantity,
    K: Kernel,
    S: Real,
    N: Sources<D, Q, S>,
{
    type Scalar = S;
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(mut self) {
        const { assert!(CLUSTER.is_multiple_of(L::LANES)) };
        let end = self.first + self.rates.len();
        for (cluster, targets) in self.clusters.within(self.first..end) {
            for start in targets.clone().step_by(L::LANES) {
                self.lanes::<L>(cluster, start..targets.end.min(start + L::LANES));
            }
        }
    }
}

impl<const D: usize, Q, K, S, N> Chunk<'_, D, Q, K, S, N>
where
    Q: Quantity,
    K: Kernel,
    S: Real,
    N: Sources<D, Q, S>,
{
    /// The rates of up to so many targets as there are lanes.
    #[inline(always)]
    fn lanes<L: Lanes<Scalar = S>>(&mut self, cluster: usize, targets: Range<usize>) {
        let count = targets.len();
        // Lanes without a target repeat the last one.
        let index: [u32; CLUSTER] = from_fn(|l| (targets.start + l.min(count - 1)) as u32);
        let words = L::gather(self.records, &index);
        let own = targets.start - self.first..targets.end - self.first;
        let density = &self.density[own.clone()];
        let of_lanes = |f: fn(f64) -> f64| -> L {
            let all: [S; CLUSTER] = from_fn(|l| S::from_f64(f(density[l.min(count - 1)])));
            L::load(&all)
        };
        let target = Target {
            velocity: from_fn(|k| words[velocity_word(k)]),
            quantity: words[QUANTITY],
            density: of_lanes(|density| density),
            inverse_density: of_lanes(|density| 1.0 / density),
        };
        let position: [L; D] = from_fn(|k| words[k]);
        let mut sum = Q::zero();
        self.sources.add::<K, L>(cluster, &position, &target, &self.scale, &mut sum);
        Q::rates(&sum, density, &mut self.rates[own]);
    }
}
