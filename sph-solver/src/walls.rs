//! Walls as the fluid sees them.
//!
//! A wall is made of *elements*: the material in each cell of the lattice below the surface of a solid,
//! with its volume, the normal of the surface and its depth below it. They fill the support of the
//! fluid beside the wall (see [`WallTerm`](crate::terms::WallTerm)). Elements travel when space is
//! divided and rest in between; those of a solid that moves are known to all ranks and move rigidly (see
//! [`bodies`](crate::bodies)). Every solid is a set of its own, so that a particle far from a solid has
//! nothing to do with it, and the sum over a set is the load on its solid.

use crate::bodies::Frame;
use crate::error::RunError;
use crate::model::ThinWall;
use crate::records::{Encoder, QUANTITY, Record, WEIGHT, record};
use crate::search::{Search, Seekers, Sorted};
use sph_decomp::Columns;
use sph_geometry::{Domain, Lattice, LatticeError, Solid, wall_elements};
use sph_kernels::Real;
use sph_neighbors::ClusterList;

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
        let solid = walls.solids.iter().map(|&solid| solid as u16).collect();
        Ok(Self { solid, ..Self::of_body(&walls, 0, first_id) })
    }

    /// The elements of one solid of this number, as [`sph_geometry::body_elements`] makes them.
    pub fn of_body(walls: &sph_geometry::WallElements<D>, solid: u16, first_id: u64) -> Self {
        let count = walls.positions.len();
        Self {
            id: (0..count as u64).map(|k| first_id + k).collect(),
            solid: vec![solid; count],
            volume: walls.volumes.clone(),
            depth: walls.depths.clone(),
            position: walls.positions.clone(),
            normal: walls.normals.clone(),
        }
    }

    /// Appends other elements.
    pub fn extend(&mut self, other: &Self) {
        self.id.extend_from_slice(&other.id);
        self.solid.extend_from_slice(&other.solid);
        self.volume.extend_from_slice(&other.volume);
        self.depth.extend_from_slice(&other.depth);
        self.position.extend_from_slice(&other.position);
        self.normal.extend_from_slice(&other.normal);
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

    /// Those that a picture shows: of a thin solid the uppermost layer, as the others lie beyond it.
    #[must_use]
    pub fn shown(mut self, thin: impl Fn(u16) -> Option<ThinWall>) -> Self {
        let is_shown = |i: &u32| {
            let i = *i as usize;
            thin(self.solid[i]).is_none_or(|thin| self.depth[i] < thin.spacing)
        };
        let index: Vec<u32> = (0..self.len() as u32).filter(is_shown).collect();
        if index.len() < self.len() {
            self.keep(&index);
        }
        self
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

    /// The point of the surface above every element of its uppermost layer, and the normal there. What
    /// fills the corner between two sides is no part of that layer.
    fn surface(&self, spacing: f64) -> Vec<Option<([f64; D], [f64; D])>> {
        let point = |i: usize| {
            let (x, n, depth) = (&self.position[i], &self.normal[i], self.depth[i]);
            let first = (depth - 0.5 * spacing).abs() < 1e-9 * spacing;
            first.then(|| (std::array::from_fn(|k| x[k] + depth * n[k]), *n))
        };
        (0..self.len()).map(point).collect()
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
    /// Halves of the support radii of the elements over the largest; empty where all are the same.
    pub halves: Vec<S>,
    /// Elements near every owned fluid particle.
    pub near: ClusterList,
    /// For a thin solid.
    pub thin: Option<ThinWall>,
    /// Pieces of the surface of a thin solid, one per record: point and normal; none for other elements.
    surface: Vec<Option<([f64; D], [f64; D])>>,
    sorted: Sorted<D>,
    motion: Option<Motion<D>>,
}

/// How a set moves.
#[derive(Debug, Clone)]
struct Motion<const D: usize> {
    frame: Frame<D>,
    /// Number among the elements of the body of each record.
    elements: Vec<u32>,
}

impl<const D: usize, S: Real> WallSet<D, S> {
    /// Sets of elements, one per solid that has any, by number.
    ///
    /// # Errors
    ///
    /// As [`Sorted::new`].
    pub fn of_all(
        elements: &WallElements<D>,
        search: &Search<'_, D>,
        encoder: &Encoder<D, S>,
        thin: impl Fn(u16) -> Option<ThinWall>,
    ) -> Result<Vec<Self>, RunError> {
        let mut order: Vec<u32> = (0..elements.len() as u32).collect();
        order.sort_by_key(|&i| elements.solid[i as usize]);
        let same = |a: &u32, b: &u32| elements.solid[*a as usize] == elements.solid[*b as usize];
        let of_one = |some: &[u32]| {
            let thin = thin(elements.solid[some[0] as usize]);
            Ok(Self::of_one(elements.some(some), search, encoder, thin)?.0)
        };
        order.chunk_by(same).map(of_one).collect()
    }

    /// The set of the elements of one solid that moves, of which `first` is the lowest id.
    ///
    /// # Errors
    ///
    /// As [`Sorted::new`].
    pub fn moving(
        elements: WallElements<D>,
        first: u64,
        frame: Frame<D>,
        search: &Search<'_, D>,
        encoder: &Encoder<D, S>,
        thin: Option<ThinWall>,
    ) -> Result<Self, RunError> {
        let (set, sorted) = Self::of_one(elements, search, encoder, thin)?;
        let elements = sorted.id.iter().map(|id| (id - first) as u32).collect();
        Ok(Self { motion: Some(Motion { frame, elements }), ..set })
    }

    /// The set of elements of one solid, and the elements in the order of its records.
    fn of_one(
        mut own: WallElements<D>,
        search: &Search<'_, D>,
        encoder: &Encoder<D, S>,
        thin: Option<ThinWall>,
    ) -> Result<(Self, WallElements<D>), RunError> {
        let reaches = search.reaches_of_volumes(&own.volume);
        let mut sorted = Sorted::new(search, &own.position, reaches.as_deref(), &own.id)?;
        // Neighbours in space shall be neighbours in memory.
        own.keep(&sorted.order());
        let reaches = search.reaches_of_volumes(&own.volume);
        sorted.renew(search, &own.position, reaches.as_deref(), &own.id)?;
        let write = |i: usize| {
            let weight = encoder.weight(own.volume[i]);
            let motion = encoder.motion(&own.position[i], &own.normal[i]);
            record(motion, S::from_f64(own.depth[i]), weight)
        };
        let set = Self {
            solid: own.solid.first().copied().unwrap_or(0),
            records: (0..own.len()).map(write).collect(),
            halves: search.halves_of_volumes(&own.volume).into_iter().map(S::from_f64).collect(),
            near: ClusterList::default(),
            surface: match thin {
                Some(ThinWall { spacing, .. }) => own.surface(spacing),
                None => Vec::new(),
            },
            thin,
            sorted,
            motion: None,
        };
        Ok((set, own))
    }

    /// The frame in which the set rests; none for one that rests anyway.
    pub fn frame(&self) -> Option<&Frame<D>> {
        self.motion.as_ref().map(|motion| &motion.frame)
    }

    /// Moves a set to where the places and normals of its elements are, which `element` tells by their
    /// numbers. A set at rest stays.
    pub fn place(
        &mut self,
        frame: Frame<D>,
        encoder: &Encoder<D, S>,
        element: impl Fn(usize) -> ([f64; D], [f64; D]),
    ) {
        let Some(motion) = &mut self.motion else { return };
        motion.frame = frame;
        for (place, index) in self.records.iter_mut().zip(&motion.elements) {
            let (position, normal) = element(*index as usize);
            *place = record(encoder.motion(&position, &normal), place[QUANTITY], place[WEIGHT]);
        }
    }

    /// The pieces of its surface near a cluster of targets, of a thin solid.
    pub fn surface_near(&self, cluster: usize) -> impl Iterator<Item = &([f64; D], [f64; D])> {
        let near = if self.thin.is_some() { self.near.sources(cluster) } else { &[] };
        near.iter().filter_map(|&element| self.surface[element as usize].as_ref())
    }

    /// Finds the elements near the targets of each cluster.
    pub fn find(&mut self, search: &Search<'_, D>, seekers: &Seekers<'_, D>) {
        self.sorted.find_for(&mut self.near, search, seekers);
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        let moving = self.motion.as_ref().map_or(0, |motion| 4 * motion.elements.len());
        self.records.len() * size_of::<Record<S>>()
            + self.halves.len() * size_of::<S>()
            + self.near.bytes()
            + self.sorted.bytes()
            + moving
    }
}
