//! Particles sorted for the search of neighbours, with one support radius for all or with radii of their
//! own.

use crate::error::RunError;
use crate::model::Model;
use sph_neighbors::{CellList, ClusterList, Clusters, Grid, LevelList, PairReach};

/// Edge of a search cell in reaches. Smaller cells have fewer candidates in more rows; measured best
/// from a half to one.
const CELL: f64 = 0.67;

/// A wall has at least so much of the support radius that fluid of its size would have. Not all of it:
/// elements are made a little larger than the particles beside them in places, and these shall not notice.
const OF_WALLS: f64 = 0.75;

/// How neighbours are searched in a run.
#[derive(Debug, Clone)]
pub struct Search<'a, const D: usize> {
    model: &'a Model<D>,
    /// Cells of the search; the coarsest where radii vary.
    pub grid: Grid<D>,
}

impl<'a, const D: usize> Search<'a, D> {
    /// The search of a run.
    ///
    /// # Errors
    ///
    /// When the domain is too large for cells of this size.
    pub fn new(model: &'a Model<D>) -> Result<Self, RunError> {
        // Levels halve their cells until these are smaller than a radius.
        let cell = if model.grading.is_some() { 0.5 } else { CELL };
        let grid = Grid::new(model.domain.0, cell * model.reach())?.periodic(model.periods)?;
        Ok(Self { model, grid })
    }

    /// The largest distance at which two particles are on each other's lists, m.
    pub fn reach(&self) -> f64 {
        self.model.reach()
    }

    /// Support radii and skin of particles of these masses (kg), m; none where all are the same.
    pub fn reaches(&self, masses: impl Iterator<Item = f64>) -> Option<Vec<f64>> {
        self.model.grading?;
        Some(masses.map(|mass| self.model.radius_of(mass) + self.model.skin).collect())
    }

    /// Halves of the support radii of elements of walls of these volumes (m^D) over the largest; nothing
    /// where all are the same.
    pub fn halves_of_volumes(&self, volumes: &[f64]) -> Vec<f64> {
        let half = |ratio: f64| 0.5 * ratio;
        self.ratios_of_volumes(volumes).into_iter().flatten().map(half).collect()
    }

    /// [`reaches`](Self::reaches) of elements of walls of these volumes (m^D).
    pub fn reaches_of_volumes(&self, volumes: &[f64]) -> Option<Vec<f64>> {
        let Model { support_radius, skin, .. } = self.model;
        let reach = |ratio: f64| support_radius * ratio + skin;
        Some(self.ratios_of_volumes(volumes)?.map(reach).collect())
    }

    /// Support radii of elements of walls of these volumes (m^D) over the largest.
    fn ratios_of_volumes(&self, volumes: &[f64]) -> Option<impl Iterator<Item = f64>> {
        let (grading, density) = (self.model.grading?, self.model.equation_of_state.density0());
        Some(volumes.iter().map(move |volume| OF_WALLS * grading.ratio::<D>(density * volume)))
    }
}

/// Sorted particles.
#[derive(Debug, Clone)]
pub enum Sorted<const D: usize> {
    /// By cell, then by id.
    Cells(CellList<D>),
    /// By level of their reach first.
    Levels(LevelList<D>),
}

/// Who looks for neighbours.
#[derive(Debug, Clone, Copy)]
pub struct Seekers<'a, const D: usize> {
    /// Which of them are close together.
    pub clusters: &'a Clusters,
    /// Where they are, m.
    pub position: &'a [[f64; D]],
    /// How far each of them reaches, m; none where all reach equally far.
    pub reaches: Option<&'a [f64]>,
}

impl<const D: usize> Sorted<D> {
    /// Sorts particles that reach as far as `reaches` say; where these are none, all reach equally far.
    ///
    /// # Errors
    ///
    /// When a reach is too large for a periodic domain.
    pub fn new(
        search: &Search<'_, D>,
        position: &[[f64; D]],
        reaches: Option<&[f64]>,
        ids: &[u64],
    ) -> Result<Self, RunError> {
        Ok(match reaches {
            None => Self::Cells(CellList::build(&search.grid, position, ids)),
            Some(reaches) => Self::Levels(LevelList::build(&search.grid, position, reaches, ids)?),
        })
    }

    /// Like [`new`](Self::new), in the memory of this one.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn renew(
        &mut self,
        search: &Search<'_, D>,
        position: &[[f64; D]],
        reaches: Option<&[f64]>,
        ids: &[u64],
    ) -> Result<(), RunError> {
        match (&mut *self, reaches) {
            (Self::Cells(cells), None) => cells.rebuild(&search.grid, position, ids),
            (Self::Levels(levels), Some(reaches)) => {
                levels.rebuild(&search.grid, position, reaches, ids)?;
            }
            _ => *self = Self::new(search, position, reaches, ids)?,
        }
        Ok(())
    }

    /// Indices of the particles in canonical order.
    pub fn order(&self) -> Vec<u32> {
        match self {
            Self::Cells(cells) => cells.order().to_vec(),
            Self::Levels(levels) => levels.order().collect(),
        }
    }

    /// Finds the particles that the seekers, who are these particles themselves, have near them.
    pub fn find_each_other(
        &self,
        list: &mut ClusterList,
        search: &Search<'_, D>,
        seekers: &Seekers<'_, D>,
    ) {
        self.find(list, search, seekers, true, PairReach::Mean);
    }

    /// Finds the particles within the reach of others, or of their own if that is larger.
    pub fn find_for(
        &self,
        list: &mut ClusterList,
        search: &Search<'_, D>,
        seekers: &Seekers<'_, D>,
    ) {
        self.find(list, search, seekers, false, PairReach::Max);
    }

    fn find(
        &self,
        list: &mut ClusterList,
        search: &Search<'_, D>,
        seekers: &Seekers<'_, D>,
        own: bool,
        rule: PairReach,
    ) {
        let Seekers { clusters, position, reaches } = *seekers;
        match self {
            Self::Cells(cells) => list.rebuild(clusters, cells, position, own, search.reach()),
            Self::Levels(levels) => {
                let reaches = reaches.unwrap_or(&[]);
                list.rebuild_with_radii(clusters, levels, position, reaches, own, rule);
            }
        }
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Cells(cells) => cells.bytes(),
            Self::Levels(levels) => levels.bytes(),
        }
    }
}
