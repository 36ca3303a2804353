//! The sweep: sums pair terms over the neighbours of every target, eight lanes at a time.
//!
//! One function, [`sweep`], compiled for a dimension, a kernel, a scalar and a tuple of terms. Sums
//! run in list order and a lane is a position in the list, so the result depends neither on threads
//! nor on ranks.

use crate::records::{QUANTITY, Record, VOLUME, velocity_word};
use crate::terms::{Pair, PairTerm, Quantity, Source, Sum, Target, lanes};
use sph_kernels::{Kernel, Lanes, Real, Vectorized};
use sph_neighbors::NeighborList;
use std::array::from_fn;
use std::marker::PhantomData;

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
    /// A list per target.
    pub list: &'a NeighborList,
    /// Terms of this group.
    pub terms: T,
}

/// Groups of neighbours: one, or a pair of groups whose contributions add up.
pub trait Sources<const D: usize, Q: Quantity, S: Real>: Sync {
    /// Adds the contributions to target `t`.
    fn add<K: Kernel, L: Lanes<Scalar = S>>(
        &self,
        t: usize,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale,
        sum: &mut Sum<D, L>,
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
        t: usize,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale,
        sum: &mut Sum<D, L>,
    ) {
        self.0.add::<K, L>(t, position, target, scale, sum);
        self.1.add::<K, L>(t, position, target, scale, sum);
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
        t: usize,
        position: &[L; D],
        target: &Target<D, L>,
        scale: &PairScale,
        sum: &mut Sum<D, L>,
    ) {
        if T::EMPTY {
            return;
        }
        let radius = scale.support_radius;
        let unit: L = lanes(scale.unit);
        let inverse_radius: L = lanes(1.0 / radius);
        // ∇W V = norm/R^(D+2) · w'(q)/q · r_ij · V, with R^D taken by the volume word.
        let norm: L = lanes(K::norm(D) / (radius * radius));
        for index in self.list.of(t).chunks_exact(L::LANES) {
            let words = L::gather(self.records, index);
            let offset: [L; D] =
                from_fn(|k| L::coordinate_difference(position[k], words[k]) * unit);
            let distance2 = crate::terms::dot(&offset, &offset);
            let distance = distance2.sqrt();
            let slope_volume = K::slope(distance * inverse_radius) * norm * words[VOLUME];
            let source = Source {
                quantity: words[QUANTITY],
                approach: from_fn(|k| target.velocity[k] - words[velocity_word(k)]),
            };
            let pair = Pair { offset, distance2, distance, slope_volume };
            self.terms.add(target, &source, &pair, sum);
        }
    }
}

/// Computes `rates[k]` for target `first + k`.
///
/// * `records`: records of the targets, indexed like the lists.
/// * `density`: kg/m³ of the targets, in order.
/// * `sources`: groups of neighbours with their terms, usually `(fluid, walls)`. A group whose terms
///   are `()` leaves no instruction.
pub fn sweep<const D: usize, Q, K, S, N>(
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
    S::dispatch(Chunk::<D, Q, K, S, N> { first, records, density, scale, sources, rates, kernel });
}

struct Chunk<'a, const D: usize, Q: Quantity, K, S, N> {
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
    fn run<L: Lanes<Scalar = S>>(self) {
        for ((t, rate), &density) in (self.first..).zip(self.rates).zip(self.density) {
            let me = &self.records[t];
            let position: [L; D] = from_fn(|k| L::splat(me[k]));
            let target = Target {
                velocity: from_fn(|k| L::splat(me[velocity_word(k)])),
                quantity: L::splat(me[QUANTITY]),
                density: lanes(density),
                inverse_density: lanes(1.0 / density),
            };
            let mut sum = Sum::zero();
            self.sources.add::<K, L>(t, &position, &target, &self.scale, &mut sum);
            *rate = Q::rate(
                sum.density.sum().to_f64(),
                from_fn(|k| sum.acceleration[k].sum().to_f64()),
            );
        }
    }
}
