//! Walls at rest: exchanged, sorted and searchable once for as long as the partition lasts.

use super::Rank;
use crate::error::RunError;
use crate::model::Model;
use crate::records::Encoder;
use crate::search::Search;
use crate::team::Team;
use crate::walls::WallSet;
use bytemuck::Pod;
use sph_decomp::{Columns, Communicator, Parts};
use sph_kernels::Real;
use std::collections::BTreeMap;

impl<const D: usize, S: Real + Pod> Rank<D, S> {
    /// Gives every rank the walls that its fluid can see wherever in its piece of space it flows.
    /// Collective.
    pub(super) fn settle_walls(
        &mut self,
        comm: &dyn Communicator,
        team: &Team,
        model: &Model<D>,
        encoder: &Encoder<D, S>,
        search: &Search<'_, D>,
    ) -> Result<(), RunError> {
        let owned = self.elements.len();
        let mut all = self.elements.clone();
        let mut inner = 0;
        let mut letters: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        if let Some(partition) = &self.partition {
            // Wider by more than the rounding of the search.
            let limit = model.reach() * (1.0 + 1e-4);
            let shifts = images(&model.periods);
            for (i, x) in self.elements.position.iter().enumerate() {
                let mut ranks = Vec::new();
                for shift in &shifts {
                    let image = std::array::from_fn(|k| x[k] + shift[k]);
                    partition.within(&image, limit, |rank| ranks.push(rank));
                }
                ranks.retain(|&rank| rank != comm.rank());
                ranks.sort_unstable();
                ranks.dedup();
                inner += usize::from(!ranks.is_empty());
                for rank in ranks {
                    letters.entry(rank).or_default().push(i as u32);
                }
            }
            let pack = |(rank, some): (usize, Vec<u32>)| {
                let mut bytes = Vec::new();
                self.elements.columns().pack(&some, &mut bytes);
                (rank, bytes)
            };
            let letters = letters.into_iter().map(pack).collect();
            for (_, bytes) in comm.exchange_some(letters)? {
                all.columns().unpack(&bytes)?;
            }
        }
        self.solid = Parts { local: owned - inner, inner, outer: all.len() - owned };
        let thin = |number| model.thin(number);
        self.walls = team.install(|| WallSet::of_all(&all, search, encoder, thin))?;
        self.settled = true;
        Ok(())
    }
}

/// Shifts to all images of a point in the boxes around a periodic one, itself included.
fn images<const D: usize>(periods: &[Option<f64>; D]) -> Vec<[f64; D]> {
    let mut all = vec![[0.0; D]];
    for (axis, period) in periods.iter().enumerate() {
        let Some(period) = period else { continue };
        let moved = |sign: f64| {
            all.clone().into_iter().map(move |mut shift| {
                shift[axis] += sign * period;
                shift
            })
        };
        all = all.iter().copied().chain(moved(-1.0)).chain(moved(1.0)).collect();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_periodic_axis_has_three_images() {
        assert_eq!(images(&[None::<f64>; 2]), [[0.0, 0.0]]);
        assert_eq!(images(&[Some(2.0), None]), [[0.0, 0.0], [-2.0, 0.0], [2.0, 0.0]]);
        assert_eq!(images(&[Some(2.0), Some(1.0)]).len(), 9);
    }
}
