//! Which cells begin as particles.

use sph_geometry::CellTree;

/// Particles before they are packed.
#[derive(Debug, Default)]
pub struct Seeds<const D: usize> {
    /// Positions, m.
    pub position: Vec<[f64; D]>,
    /// Whether they are points of a lattice and stay where they are.
    pub fixed: Vec<bool>,
    /// Volume of the cells that are not kept as they are, m^D: what the particles that are not fixed fill.
    pub loose_volume: f64,
}

/// A spacing up to this share larger than the edge of a cell makes no difference.
const SAME: f64 = 1e-6;

/// Keeps so many of the cells with their middles at `position` as the spacing there asks for. `ends` are
/// where regions end in them, and are kept up to date.
///
/// Cells come in an order in which neighbours mostly follow each other. Each is worth (edge/spacing)^D of
/// a particle, and one is kept whenever a whole particle has come together.
pub fn thinned<const D: usize>(
    tree: &CellTree<'_, D>,
    position: &[[f64; D]],
    ends: &mut [usize],
) -> Seeds<D> {
    let mut seeds = Seeds::default();
    let mut collected = 0.5;
    let mut start = 0;
    for end in ends {
        for x in &position[start..*end] {
            let cell = tree.cell_at(x);
            let fixed = cell.spacing <= cell.edge * (1.0 + SAME);
            if !fixed {
                seeds.loose_volume += cell.edge.powi(D as i32);
                collected += (cell.edge / cell.spacing).powi(D as i32);
            }
            if fixed || collected >= 1.0 {
                collected -= if fixed { 0.0 } else { 1.0 };
                seeds.position.push(*x);
                seeds.fixed.push(fixed);
            }
        }
        start = *end;
        *end = seeds.position.len();
    }
    seeds
}
