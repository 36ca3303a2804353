//! The sweep: sums pair terms over the neighbours of every target, one target a lane.
//!
//! One function, [`sweep`], compiled for a dimension, a kernel, a scalar and the terms of one group
//! of pairs. The targets of a cluster lie in the lanes; each source near the cluster is read once,
//! as one record that is broadcast to all lanes, and adds to every target. Sources beyond the
//! support of a target add zero to it, because the kernel's slope is zero there. So each target adds
//! its neighbours one after the other in canonical order, and its sums depend neither on threads,
//! nor on ranks, nor on the width of the lanes, nor on who shares its cluster.

use crate::bodies::Frame;
use crate::model::ThinWall;
use crate::records::{QUANTITY, Record, WEIGHT, velocity_word};
use crate::space::{Metric, PairScale};
use crate::terms::{
    BesideWall, Pair, PairTerm, Quantity, Source, Stretch, Target, WallPair, WallStretch, WallTerm,
    difference, dot, lanes,
};
use sph_kernels::{Kernel, Lanes, Real, Vectorized};
use sph_neighbors::{CLUSTER, ClusterList};
use std::array::from_fn;
use std::marker::PhantomData;
use std::ops::Range;

/// Stands for a pressure without limit: what it pulls with is still finite.
const LOWEST: f64 = -1e30;

/// A group of pairs: who the sources of every target are and what a pair contributes.
pub trait Pairs<const D: usize, Q: Quantity, S: Real>: Copy + Sync {
    /// The sources of every cluster of targets.
    fn list(&self) -> &ClusterList;

    /// Adds the contributions to the targets of a cluster, which are the targets `own` of the sweep.
    fn add<K: Kernel, L: Lanes<Scalar = S>>(
        &self,
        cluster: usize,
        own: Range<usize>,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale<D>,
        sum: &mut Q::Sum<D, L>,
    );
}

/// Moving neighbours, as the fluid: their gradients lie along the line to them.
#[derive(Debug, Clone, Copy)]
pub struct Neighbors<'a, S, T, M> {
    /// Records that the list points into.
    pub records: &'a [Record<S>],
    /// A list per cluster of targets.
    pub list: &'a ClusterList,
    /// Terms of this group.
    pub terms: T,
    /// Halves of the support radii over the largest, of the targets of the sweep and of the records;
    /// empty where all are the same.
    pub halves: (&'a [S], &'a [S]),
    /// How coordinates are subtracted.
    pub metric: PhantomData<M>,
}

/// What wall terms are told of the targets of a sweep.
#[derive(Debug, Clone, Copy)]
pub struct Beside<'a, const D: usize> {
    /// Lowest pressure of a wall towards each target, Pa.
    pub lowest_pressure: &'a [f64],
    /// How much the walls around each target count as one plane, from 0 to 1.
    pub flatness: &'a [f64],
    /// ∇p/ρ at each target, m/s².
    pub pressure_gradient: &'a [[f64; D]],
    /// ∇R of each target over the largest support radius, 1/m; nothing where all are the same.
    pub radius_slope: &'a [[f64; D]],
    /// Position of each target, m.
    pub position: &'a [[f64; D]],
    /// How the wall moves; none for a wall at rest.
    pub frame: Option<&'a Frame<D>>,
    /// For a thin solid.
    pub thin: Option<ThinWall>,
}

/// Elements of a wall: their records hold the normal in the words of velocity and the depth below
/// the surface (m) in that of the quantity.
#[derive(Debug, Clone, Copy)]
pub struct WallNeighbors<'a, const D: usize, S, T, M> {
    /// Records that the list points into.
    pub records: &'a [Record<S>],
    /// A list per cluster of targets.
    pub list: &'a ClusterList,
    /// Term of this group.
    pub term: T,
    /// The targets.
    pub beside: Beside<'a, D>,
    /// Halves of the support radii over the largest, of the targets of the sweep and of the elements;
    /// empty where all are the same. A pair has the larger of both: a wall that is coarser than the fluid
    /// beside it must not have gaps.
    pub halves: (&'a [S], &'a [S]),
    /// How coordinates are subtracted.
    pub metric: PhantomData<M>,
}

impl<const D: usize, Q, S, T, M> Pairs<D, Q, S> for Neighbors<'_, S, T, M>
where
    Q: Quantity,
    S: Real,
    T: PairTerm<D, Q>,
    M: Metric,
{
    fn list(&self) -> &ClusterList {
        self.list
    }

    #[inline(always)]
    fn add<K: Kernel, L: Lanes<Scalar = S>>(
        &self,
        cluster: usize,
        own: Range<usize>,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale<D>,
        sum: &mut Q::Sum<D, L>,
    ) {
        if T::EMPTY {
            return;
        }
        let (unit, per_unit) = (lanes(scale.unit), lanes(1.0 / scale.unit));
        let to_q: L = lanes(scale.unit / scale.support_radius);
        // Copies, so that the constants of the terms are spread over the lanes once and not per pair.
        let Self { records, list, terms, halves: (of_targets, halves), .. } = *self;
        let half = if M::GRADED { of_lanes(of_targets, &own) } else { L::zero() };
        for &j in list.sources(cluster) {
            let record = &records[j as usize];
            let offset: [L; D] =
                from_fn(|k| M::difference(position[k], L::splat(record[k]), scale, k));
            let distance2 = dot(&offset, &offset);
            let distance = distance2.sqrt();
            let (mut q, mut weight, mut stretch) =
                (distance * to_q, L::splat(record[WEIGHT]), None);
            if M::GRADED {
                let own = Stretch::of(half, L::splat(halves[j as usize]));
                (q, weight) = (q * own.inverse, weight * of_gradients::<D, L>(own.inverse));
                stretch = Some(own);
            }
            let weight = K::slope_shape(q) * weight;
            let source = Source {
                quantity: L::splat(record[QUANTITY]),
                velocity: from_fn(|k| L::splat(record[velocity_word(k)])),
            };
            let pair = Pair { offset, distance2, distance, weight, unit, per_unit, stretch };
            if T::CENTRAL {
                Q::add(sum, terms.coefficient(target, &source, &pair), &pair);
            }
            if T::SHEARS {
                let velocity = difference(&target.velocity, &source.velocity);
                Q::add_shear(sum, terms.shear(target, &source, &pair), &velocity, &pair);
            }
        }
    }
}

impl<const D: usize, Q, S, T, M> Pairs<D, Q, S> for WallNeighbors<'_, D, S, T, M>
where
    Q: Quantity,
    S: Real,
    T: WallTerm<D, Q>,
    M: Metric,
{
    fn list(&self) -> &ClusterList {
        self.list
    }

    #[inline(always)]
    fn add<K: Kernel, L: Lanes<Scalar = S>>(
        &self,
        cluster: usize,
        own: Range<usize>,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale<D>,
        sum: &mut Q::Sum<D, L>,
    ) {
        let (beside, (of_targets, _)) = (self.beside, self.halves);
        let half = if M::GRADED { of_lanes(of_targets, &own) } else { L::zero() };
        let Beside { lowest_pressure, flatness, pressure_gradient, position: places, .. } = beside;
        let radius_slope = beside.radius_slope;
        let (frame, thin) = (beside.frame, beside.thin);
        let last = own.end - 1;
        let of_own = |f: &dyn Fn(usize) -> f64| -> L {
            let all: [S; CLUSTER] = from_fn(|l| S::from_f64(f((own.start + l).min(last))));
            L::load(&all)
        };
        let mut beside = BesideWall {
            pressure_gradient: from_fn(|k| of_own(&|i| pressure_gradient[i][k])),
            lowest_pressure: of_own(&|i| lowest_pressure[i].max(LOWEST)),
            flatness: of_own(&|i| flatness[i]),
            spin: [L::zero(); 3],
        };
        // Terms see a wall at rest.
        let mut target = *target;
        if let Some(frame) = frame {
            beside.spin = frame.spin.map(lanes);
            let walls: [[f64; D]; CLUSTER] =
                from_fn(|l| frame.velocity_at(&places[(own.start + l).min(last)]));
            target.velocity =
                from_fn(|k| target.velocity[k] - of_own(&|i| walls[i - own.start][k]));
        }
        let mut lean = [L::zero(); D];
        if M::GRADED {
            // −½ ∇R/R, with the half of R.
            let per_radius = lanes::<L>(-0.25).div(half);
            lean = from_fn(|k| of_own(&|i| radius_slope[i][k]) * per_radius);
        }
        let seer = Seer { target, beside, half, lean };
        *sum = match thin {
            None => self.total::<K, L, Q>(cluster, position, &seer, scale, |_, _| (None, None)),
            Some(thin) => {
                let side = Side::new(thin);
                self.total::<K, L, Q>(cluster, position, &seer, scale, |over, depth| {
                    let height = over - depth;
                    (Some(side.share(height)), Some(side.squeezed(height)))
                })
            }
        };
    }
}

impl<const D: usize, S, T, M> WallNeighbors<'_, D, S, T, M>
where
    S: Real,
    M: Metric,
{
    /// The sum over the elements near a cluster. `side` makes of the height of the targets over an element
    /// and its depth, both in m, which share of it they see and how much harder it pushes: nothing for
    /// walls that are not thin, and then nothing is computed.
    #[inline(always)]
    fn total<K: Kernel, L: Lanes<Scalar = S>, Q: Quantity>(
        &self,
        cluster: usize,
        position: &[L; D],
        seer: &Seer<D, L>,
        scale: &PairScale<D>,
        side: impl Fn(L, L) -> (Option<L>, Option<L>),
    ) -> Q::Sum<D, L>
    where
        T: WallTerm<D, Q>,
    {
        let (unit, per_unit) = (lanes(scale.unit), lanes(1.0 / scale.unit));
        let to_q: L = lanes(scale.unit / scale.support_radius);
        let Self { records, list, term, halves: (_, halves), .. } = *self;
        let Seer { target, beside, half, lean } = seer;
        let mut total = T::zero();
        for &j in list.sources(cluster) {
            let record = &records[j as usize];
            let offset: [L; D] =
                from_fn(|k| M::difference(position[k], L::splat(record[k]), scale, k));
            let normal: [L; D] = from_fn(|k| L::splat(record[velocity_word(k)]));
            let distance2 = dot(&offset, &offset);
            let distance = distance2.sqrt();
            let (mut q, mut weight, mut stretch) =
                (distance * to_q, L::splat(record[WEIGHT]), None);
            if M::GRADED {
                let half = half.max(L::splat(halves[j as usize]));
                let Stretch { ratio, inverse, .. } = Stretch::of(half, half);
                (q, weight) = (q * inverse, weight * of_gradients::<D, L>(inverse));
                stretch = Some(WallStretch { ratio, inverse, lean: *lean });
            }
            let weight = K::slope_shape(q) * weight;
            let depth = L::splat(record[QUANTITY]);
            let (share, squeezed) = side(dot(&offset, &normal) * unit, depth);
            let weight = share.map_or(weight, |share| weight * share);
            let pair = WallPair {
                offset,
                distance2,
                normal,
                depth,
                weight,
                squeezed,
                unit,
                per_unit,
                stretch,
            };
            term.add(target, beside, &pair, &mut total);
        }
        term.finish(target, beside, &total)
    }
}

/// Targets beside a wall.
#[derive(Debug, Clone, Copy)]
struct Seer<const D: usize, L> {
    target: Target<D, L>,
    beside: BesideWall<D, L>,
    /// Half of the support radius over the largest, where radii vary.
    half: L,
    /// −½ ∇R/R, 1/m, where radii vary.
    lean: [L; D],
}

/// What fluid belongs to a side of a thin solid: all that is in front of it or at most so far below its
/// surface, with a share that falls from one to zero over the second half of that way.
#[derive(Debug, Clone, Copy)]
struct Side<L> {
    below: L,
    per_half: L,
    per_first: L,
}

impl<L: Lanes> Side<L> {
    #[inline(always)]
    fn new(wall: ThinWall) -> Self {
        let ThinWall { below, spacing } = wall;
        Self { below: lanes(below), per_half: lanes(2.0 / below), per_first: lanes(2.0 / spacing) }
    }

    /// The share of a target at this height (m) over the surface.
    #[inline(always)]
    fn share(&self, height: L) -> L {
        ((height + self.below) * self.per_half).max(L::zero()).min(lanes(1.0))
    }

    /// max(0, 1 − z/(dp/2))² of a target at this height z.
    #[inline(always)]
    fn squeezed(&self, height: L) -> L {
        let closer = (lanes::<L>(1.0) - height * self.per_first).max(L::zero());
        closer * closer
    }
}

/// The values of the targets `own`, one a lane; lanes without a target repeat the last one.
#[inline(always)]
fn of_lanes<L: Lanes>(values: &[L::Scalar], own: &Range<usize>) -> L {
    let all: [L::Scalar; CLUSTER] = from_fn(|l| values[(own.start + l).min(own.end - 1)]);
    L::load(&all)
}

impl<L: Lanes> Stretch<L> {
    /// Of a target and a source of which half the radii are this much of the largest.
    #[inline(always)]
    fn of(target: L, source: L) -> Self {
        let (ratio, half) = (target + source, source - target);
        Self { ratio, inverse: lanes::<L>(1.0).div(ratio), difference: half + half }
    }
}

/// What ∇W r^-1 of a pair is times that of the largest radius: (R/R_ij)^(D+2), from R/R_ij.
#[inline(always)]
fn of_gradients<const D: usize, L: Lanes>(inverse: L) -> L {
    let square = inverse * inverse;
    match D {
        1 => square * inverse,
        2 => square * square,
        _ => square * square * inverse,
    }
}

/// Computes `rates[k]` for target `first + k`. Returns whether any of them had a source at all; if
/// none had, `rates` are left alone.
///
/// * `records`: records of the targets, indexed as in the list.
/// * `density`: kg/m³ of the targets, in order.
///
/// The range of targets had better begin and end with a cluster.
pub fn sweep<const D: usize, Q, K, S, N>(
    first: usize,
    records: &[Record<S>],
    density: &[f64],
    scale: &PairScale<D>,
    pairs: &N,
    rates: &mut [Q::Rate<D>],
) -> bool
where
    Q: Quantity,
    K: Kernel,
    S: Real,
    N: Pairs<D, Q, S>,
{
    assert_eq!(density.len(), rates.len(), "one density per target");
    let list = pairs.list();
    let range = first..first + rates.len();
    if list.is_empty() || list.clusters().within(range).all(|(c, _)| list.sources(c).is_empty()) {
        return false;
    }
    let kernel = PhantomData::<K>;
    S::dispatch(Chunk::<D, Q, K, S, N> { first, records, density, scale, pairs, rates, kernel });
    true
}

struct Chunk<'a, const D: usize, Q: Quantity, K, S, N> {
    first: usize,
    records: &'a [Record<S>],
    density: &'a [f64],
    scale: &'a PairScale<D>,
    pairs: &'a N,
    rates: &'a mut [Q::Rate<D>],
    kernel: PhantomData<K>,
}

impl<const D: usize, Q, K, S, N> Vectorized for Chunk<'_, D, Q, K, S, N>
where
    Q: Quantity,
    K: Kernel,
    S: Real,
    N: Pairs<D, Q, S>,
{
    type Scalar = S;
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = S>>(mut self) {
        const { assert!(CLUSTER.is_multiple_of(L::LANES)) };
        let end = self.first + self.rates.len();
        for (cluster, targets) in self.pairs.list().clusters().within(self.first..end) {
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
    N: Pairs<D, Q, S>,
{
    /// The rates of up to so many targets as there are lanes.
    #[inline(always)]
    fn lanes<L: Lanes<Scalar = S>>(&mut self, cluster: usize, targets: Range<usize>) {
        let count = targets.len();
        let own = targets.start - self.first..targets.end - self.first;
        if self.pairs.list().sources(cluster).is_empty() {
            self.rates[own].fill(Q::Rate::default());
            return;
        }
        // Lanes without a target repeat the last one.
        let index: [u32; CLUSTER] = from_fn(|l| (targets.start + l.min(count - 1)) as u32);
        let words = L::gather(self.records, &index);
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
        let targets = own.clone();
        self.pairs.add::<K, L>(cluster, targets, &position, &target, self.scale, &mut sum);
        Q::rates(&sum, density, &mut self.rates[own]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_of_a_thin_solid_acts_down_to_its_middle() {
        let side = Side::<f64>::new(ThinWall { below: 0.02, spacing: 0.1 });
        assert_eq!(
            [0.3, 0.0, -0.01, -0.02, -0.5].map(|z| side.share(z)),
            [1.0, 1.0, 1.0, 0.0, 0.0]
        );
        assert!((side.share(-0.015) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn it_pushes_harder_from_half_a_spacing_on() {
        let side = Side::<f64>::new(ThinWall { below: 0.05, spacing: 0.1 });
        assert_eq!([0.2, 0.05, 0.0].map(|z| side.squeezed(z)), [0.0, 0.0, 1.0]);
        assert!((side.squeezed(-0.05) - 4.0).abs() < 1e-12);
    }
}
