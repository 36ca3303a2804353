//! Solids at rest: sorted, exchanged and searchable once for as long as the partition lasts.

use super::traveller::{Traveller, arrive, depart};
use super::{Rank, record_of};
use crate::error::RunError;
use crate::model::Model;
use crate::records::Encoder;
use crate::state::State;
use bytemuck::Pod;
use sph_decomp::{CommError, Communicator, Parts};
use sph_kernels::Real;
use sph_neighbors::{CellList, Grid};
use std::collections::BTreeMap;

impl<const D: usize, S: Real + Pod> Rank<D, S> {
    /// Gives every rank the solids that its fluid can see wherever in its piece of space it flows,
    /// and writes their records, in canonical order. Collective.
    pub(super) fn settle_solids(
        &mut self,
        comm: &dyn Communicator,
        model: &Model<D>,
        encoder: &Encoder,
        grid: &Grid<D>,
    ) -> Result<(), RunError> {
        let others = self.solids_of_others(comm, model.reach())?;
        let mut all = self.solids.clone();
        others.iter().for_each(|solid| arrive(solid, &mut all));
        self.solid.outer = others.len();
        let mut cells = CellList::build(grid, &all.position, &all.id);
        // Neighbours in space shall be neighbours in memory.
        all.keep(cells.order());
        cells.rebuild(grid, &all.position, &all.id);
        self.wall_cells = Some(cells);
        let density0 = model.equation_of_state.density0();
        self.walls = (0..all.len()).map(|i| record_of(encoder, density0, &all, i)).collect();
        Ok(())
    }

    /// Sends the solids within `reach` of the pieces of space of other ranks there; returns those
    /// that came. Collective.
    fn solids_of_others(
        &mut self,
        comm: &dyn Communicator,
        reach: f64,
    ) -> Result<Vec<Traveller>, RunError> {
        let owned = self.solids.len();
        self.solid = Parts { local: owned, inner: 0, outer: 0 };
        let Some(partition) = &self.partition else { return Ok(Vec::new()) };
        // Wider by more than the rounding of the search.
        let limit = reach * (1.0 + 1e-4);
        let mut inner = 0;
        let mut letters: BTreeMap<usize, Vec<Traveller>> = BTreeMap::new();
        for (i, x) in self.solids.position.iter().enumerate() {
            let mut sent = false;
            partition.within(x, limit, |rank| {
                if rank != comm.rank() {
                    sent = true;
                    letters.entry(rank).or_default().push(depart(&self.solids, i));
                }
            });
            inner += usize::from(sent);
        }
        self.solid = Parts { local: owned - inner, inner, outer: 0 };
        let letters = letters
            .into_iter()
            .map(|(rank, letter)| (rank, bytemuck::cast_slice(&letter).to_vec()))
            .collect();
        let mut received = Vec::new();
        for (rank, bytes) in comm.exchange_some(letters)? {
            let (words, rest) = bytes.as_chunks::<{ size_of::<Traveller>() }>();
            if !rest.is_empty() {
                let (got, expected) = (bytes.len(), words.len() * size_of::<Traveller>());
                return Err(CommError::WrongLength { rank, got, expected }.into());
            }
            let solid = |words: &[u8; size_of::<Traveller>()]| -> Traveller {
                bytemuck::pod_read_unaligned(words)
            };
            received.extend(words.iter().map(solid));
        }
        Ok(received)
    }
}

/// Divides particles into fluid and solids.
pub(super) fn apart<const D: usize>(mut state: State<D>) -> (State<D>, State<D>) {
    let fluid = |&i: &u32| state.kind[i as usize] == crate::state::FLUID;
    let (fluid, solid): (Vec<u32>, Vec<u32>) = (0..state.len() as u32).partition(fluid);
    let mut solids = state.clone();
    solids.keep(&solid);
    state.keep(&fluid);
    (state, solids)
}
