//! A partition that sees space slightly askew.

use super::{Orb, Partition};

/// A partition of sheared space: its cuts are slightly tilted planes.
///
/// Particles on a lattice lie in layers, and a cut along an axis can only fall between two of them:
/// 17 layers are never halved, and a block of 10 × 17 × 15 particles is divided 6 % unevenly. A
/// plane that is tilted by a degree passes through one layer at a time and can be put anywhere in
/// it. It is hardly larger than a straight one, so that the overlap zone stays the same.
///
/// Build the inner partition from [`Askew::view`] of the positions:
///
/// ```
/// use sph_decomp::{Askew, Communicator, Orb, Partition, PartitionError, ThreadRanks};
///
/// let counts = ThreadRanks::run(2, |comm| {
///     // Rank 0 holds 3 layers of 100 particles.
///     let positions: Vec<[f64; 2]> = match comm.rank() {
///         0 => (0..300).map(|i| [f64::from(i % 3), 0.01 * f64::from(i / 3)]).collect(),
///         _ => vec![],
///     };
///     let partition = Askew::new(Orb::build(&comm, &Askew::view(&positions), &[])?);
///     let owners = partition.owners(&positions);
///     Ok::<_, PartitionError>([0, 1].map(|rank| owners.iter().filter(|&&o| o == rank).count()))
/// });
/// assert_eq!(counts?[0], [150, 150]);
/// # Ok::<_, sph_decomp::RanksError<PartitionError>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Askew<P>(P);

/// Shear towards the next axis. Fifty spacings across, a cut rises by less than one.
const NEXT: f64 = 1.0 / 64.0;
/// Shear towards each further axis, relative to the one before: rows of a layer come one by one.
const FURTHER: f64 = 1.0 / 64.0;

impl Askew<()> {
    /// Positions as the inner partition sees them.
    pub fn view<const D: usize>(positions: &[[f64; D]]) -> Vec<[f64; D]> {
        positions.iter().map(shear).collect()
    }
}

impl<P> Askew<P> {
    /// A partition that was built from sheared positions.
    pub fn new(inner: P) -> Self {
        Self(inner)
    }
}

impl<const D: usize> Askew<Orb<D>> {
    /// As [`Orb::within`]; ranks may be visited that are farther by a fiftieth of the reach.
    pub fn within(&self, x: &[f64; D], reach: f64, visit: impl FnMut(usize)) {
        // No distance grows by more in sheared space: the rows and the columns of the shear sum to
        // less than this, which bounds its norm.
        let stretch = 1.0 + NEXT * (1.0 + 2.0 * FURTHER);
        self.0.within(&shear(x), reach * stretch, visit);
    }
}

impl<const D: usize, P: Partition<D>> Partition<D> for Askew<P> {
    fn owner(&self, x: &[f64; D]) -> usize {
        self.0.owner(&shear(x))
    }
}

/// Where the inner partition sees a point.
pub(crate) fn shear<const D: usize>(x: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|axis| {
        let (mut sum, mut factor) = (x[axis], NEXT);
        for step in 1..D {
            sum += factor * x[(axis + step) % D];
            factor *= FURTHER;
        }
        sum
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Communicator, Orb, PartitionError, ThreadRanks};

    #[test]
    fn odd_layers_are_divided_evenly_into_compact_parts() {
        let lattice: Vec<[f64; 3]> = (0..17 * 17 * 15)
            .map(|i| [f64::from(i % 17), f64::from(i / 17 % 17), f64::from(i / 289)])
            .collect();
        let owners = ThreadRanks::run(8, |comm| {
            let mine = if comm.rank() == 0 { &lattice[..] } else { &[] };
            let orb = Orb::build(&comm, &Askew::view(mine), &[])?;
            Ok::<_, PartitionError>(Askew::new(orb).owners(&lattice))
        });
        let owners = owners.unwrap().swap_remove(0);
        for rank in 0..8 {
            let mine = (0..lattice.len()).filter(|&i| owners[i] == rank);
            let (mut low, mut high, mut count) = ([f64::MAX; 3], [f64::MIN; 3], 0);
            for i in mine {
                low = std::array::from_fn(|axis| low[axis].min(lattice[i][axis]));
                high = std::array::from_fn(|axis| high[axis].max(lattice[i][axis]));
                count += 1;
            }
            assert!((540..=543).contains(&count), "rank {rank} has {count}");
            // An eighth has 8 or 9 layers each way; a cut through a layer adds one.
            assert!((0..3).all(|axis| high[axis] - low[axis] <= 9.0), "{low:?} {high:?}");
        }
    }
}
