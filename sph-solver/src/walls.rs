//! Walls at rest, as the fluid sees them.
//!
//! A wall is made of *elements*: the material in each cell of the lattice below the surface of a solid,
//! with its volume, the normal of the surface and its depth below it. They fill the support of the
//! fluid beside the wall (see [`WallTerm`](crate::terms::WallTerm)). Elements travel when space is divided and rest in between. Every solid is a set of its own, so that
//! a particle far from a solid has nothing to do with it, and the sum over a set is the load on its
//! solid.

use crate::records::{Encoder, Record, record};
use sph_decomp::Columns;
use sph_geometry::{Domain, Lattice, LatticeError, Solid, wall_elements};
use sph_kernels::Real;
use sph_neighbors::{CellList, ClusterList, Grid};

/// Structure of arrays over the elements of all walls.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WallElements<const D: usize> {
    /// Global id, which no particle of the fluid has.
    pub id: Vec<u64>,
    /// Number of the solid in the scene.
    pub solid: Vec<u16>,
    /// Volume, m^D.
    pub volume: Vec<f64>,
    /// Depth below the surface, m.
    pub depth: Vec<f64>,
    /// Position, m.
    pub position: Vec<[f64; D]>,
    /// Unit vector out of the wall at the nearest point of its walls.
    pub normal: Vec<[f64; D]>,
}

impl<const D: usize> WallElements<D> {
    /// The elements of these solids on the lattice of the fluid, for a support radius (m): solid `k` of
    /// the slice is number `k`. Ids count from `first_id`.
    ///
    /// # Errors
    ///
    /// As [`wall_elements`].
    pub fn of_solids(
        solids: &[Solid<D>],
        lattice: &Lattice<D>,
        support_radius: f64,
        domain: &Domain<D>,
        first_id: u64,
    ) -> Result<Self, LatticeError> {
        let walls = wall_elements(solids, lattice, support_radius, domain)?;
        Ok(Self {
            id: (0..walls.positions.len()).map(|k| first_id + k as u64).collect(),
            solid: walls.solids.iter().map(|&solid| solid as u16).collect(),
            volume: walls.volumes,
            depth: walls.depths,
            position: walls.positions,
            normal: walls.normals,
        })
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// All columns, to sort, send and receive elements.
    pub fn columns(&mut self) -> impl Columns + '_ {
        (
            &mut self.id,
            &mut self.solid,
            &mut self.volume,
            &mut self.depth,
            &mut self.position,
            &mut self.normal,
        )
    }

    /// Keeps the elements named by `index`, in that order.
    pub fn keep(&mut self, index: &[u32]) {
        self.columns().permute(index);
    }

    /// The columns themselves, ids first.
    pub fn into_columns(self) -> WallColumns<D> {
        (self.id, self.solid, self.volume, self.depth, self.position, self.normal)
    }

    /// Back from [`into_columns`](Self::into_columns).
    pub fn from_columns(columns: WallColumns<D>) -> Self {
        let (id, solid, volume, depth, position, normal) = columns;
        Self { id, solid, volume, depth, position, normal }
    }

    /// Copies of the elements named by `index`.
    #[must_use]
    pub fn some(&self, index: &[u32]) -> Self {
        fn pick<T: Copy>(column: &[T], index: &[u32]) -> Vec<T> {
            index.iter().map(|&i| column[i as usize]).collect()
        }
        Self {
            id: pick(&self.id, index),
            solid: pick(&self.solid, index),
            volume: pick(&self.volume, index),
            depth: pick(&self.depth, index),
            position: pick(&self.position, index),
            normal: pick(&self.normal, index),
        }
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.len() * (2 * size_of::<[f64; D]>() + 8 + 8 + 8 + 2)
    }
}

/// Ids, solids, volumes, depths, positions, normals.
pub type WallColumns<const D: usize> =
    (Vec<u64>, Vec<u16>, Vec<f64>, Vec<f64>, Vec<[f64; D]>, Vec<[f64; D]>);

/// The elements of one solid that the fluid of a rank can see, and who of the fluid sees them.
#[derive(Debug, Clone)]
pub struct WallSet<const D: usize, S> {
    /// Number of the solid in the scene.
    pub solid: u16,
    /// Records in canonical order: place, normal, depth, weight.
    pub records: Vec<Record<S>>,
    /// Elements near every owned fluid particle.
    pub near: ClusterList,
    cells: CellList<D>,
}

impl<const D: usize, S: Real> WallSet<D, S> {
    /// Sets of elements, one per solid that has any, by number.
    pub fn of_all(
        elements: &WallElements<D>,
        grid: &Grid<D>,
        encoder: &Encoder<D, S>,
    ) -> Vec<Self> {
        let mut order: Vec<u32> = (0..elements.len() as u32).collect();
        order.sort_by_key(|&i| elements.solid[i as usize]);
        let same = |a: &u32, b: &u32| elements.solid[*a as usize] == elements.solid[*b as usize];
        let of_one = |some: &[u32]| {
            let mut own = elements.some(some);
            let mut cells = CellList::build(grid, &own.position, &own.id);
            // Neighbours in space shall be neighbours in memory.
            own.keep(cells.order());
            cells.rebuild(grid, &own.position, &own.id);
            let write = |i: usize| {
                let weight = encoder.weight(own.volume[i]);
                let motion = encoder.motion(&own.position[i], &own.normal[i]);
                record(motion, S::from_f64(own.depth[i]), weight)
            };
            Self {
                solid: own.solid[0],
                records: (0..own.len()).map(write).collect(),
                near: ClusterList::default(),
                cells,
            }
        };
        order.chunk_by(same).map(of_one).collect()
    }

    /// Where the elements are.
    pub fn cells(&self) -> &CellList<D> {
        &self.cells
    }

    /// Finds the elements near the targets of each cluster.
    pub fn find(&mut self, clusters: &sph_neighbors::Clusters, targets: &[[f64; D]], reach: f64) {
        self.near.rebuild(clusters, &self.cells, targets, false, reach);
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        self.records.len() * size_of::<Record<S>>() + self.near.bytes() + self.cells.bytes()
    }
}
