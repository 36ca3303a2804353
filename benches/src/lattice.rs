//! A jittered lattice: the disordered but even arrangement that particles of a fluid settle into.

use sph_neighbors::{CellList, ColumnOrder, Grid};

/// Pseudo-random numbers, the same in every run (Marsaglia 2003, xorshift).
#[derive(Debug, Clone)]
pub struct Noise(u64);

impl Default for Noise {
    fn default() -> Self {
        Self(0x2545_f491_4f6c_dd1d)
    }
}

impl Noise {
    /// The next number in `-1..1`.
    pub fn symmetric(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A cube of particles that are off their lattice points by up to a fifth of the spacing.
#[derive(Debug, Clone)]
pub struct Lattice {
    /// Distance of lattice points, m.
    pub spacing: f64,
    /// Positions, m.
    pub positions: Vec<[f64; 3]>,
    /// Global ids.
    pub ids: Vec<u64>,
}

impl Lattice {
    /// A cube of about `count` particles with a spacing of 1 cm, line after line along x.
    pub fn cube(count: usize) -> Self {
        let spacing = 0.01;
        let edge = (count as f64).cbrt().round() as usize;
        let mut noise = Noise::default();
        let mut place = |n: usize| (n as f64 + 0.5 + 0.2 * noise.symmetric()) * spacing;
        let positions: Vec<_> = (0..edge.pow(3))
            .map(|i| [place(i % edge), place(i / edge % edge), place(i / edge / edge)])
            .collect();
        Self { spacing, ids: (0..positions.len() as u64).collect(), positions }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// The same particles in the order in which the solver stores them. Its columns are not aligned
    /// with the lattice, which would make clusters more compact than those of a flow.
    #[must_use]
    pub fn in_columns(self) -> Self {
        let order = ColumnOrder::new([0.37 * self.spacing; 3], self.spacing);
        let order = order.expect("a positive spacing");
        let mut sorted: Vec<u32> = (0..self.len() as u32).collect();
        sorted.sort_by_cached_key(|&i| (order.key(&self.positions[i as usize]), i));
        Self {
            spacing: self.spacing,
            positions: sorted.iter().map(|&i| self.positions[i as usize]).collect(),
            ids: sorted.iter().map(|&i| self.ids[i as usize]).collect(),
        }
    }

    /// The same particles sorted by cell and id, with that grid.
    ///
    /// # Panics
    /// If `cell_size` is not positive.
    #[must_use]
    pub fn sorted(self, cell_size: f64) -> (Self, Grid<3>) {
        let grid = Grid::new([0.0; 3], cell_size).expect("a positive cell size");
        let cells = CellList::build(&grid, &self.positions, &self.ids);
        let order = cells.order();
        let sorted = Self {
            spacing: self.spacing,
            positions: order.iter().map(|&i| self.positions[i as usize]).collect(),
            ids: order.iter().map(|&i| self.ids[i as usize]).collect(),
        };
        (sorted, grid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sorted_lattice_holds_the_same_particles_in_canonical_order() {
        let (lattice, grid) = Lattice::cube(1000).sorted(0.03);
        let cells = CellList::build(&grid, &lattice.positions, &lattice.ids);
        assert!(cells.order().iter().enumerate().all(|(place, &i)| place == i as usize));
        let mut ids = lattice.ids;
        ids.sort_unstable();
        assert_eq!(ids, (0..1000).collect::<Vec<u64>>());
    }
}
