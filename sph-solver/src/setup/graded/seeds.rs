//! Which cells begin as particles.

use sph_geometry::{Cell, CellTree};

/// Particles before they are packed.
#[derive(Debug, Default)]
pub struct Seeds<const D: usize> {
    /// Positions, m.
    pub position: Vec<[f64; D]>,
    /// Whether they are points of a lattice and stay where they are.
    pub fixed: Vec<bool>,
    /// Where the regions end in them.
    pub ends: Vec<usize>,
    /// Volume of the cells that are not kept as they are, m^D: what the particles that are not fixed fill.
    pub loose_volume: f64,
}

/// A spacing up to this share larger than the edge of a cell makes no difference.
const SAME: f64 = 1e-6;

/// Whether a cell has the spacing of its particles and so have those around it. Where spacings grow, one
/// of them is the edge of its cell by chance.
fn is_lattice<const D: usize>(tree: &CellTree<'_, D>, cell: &Cell<D>) -> bool {
    let most = cell.edge * (1.0 + SAME);
    let same = |k: usize, way: f64| {
        let mut x = cell.center;
        x[k] += way * cell.edge;
        let spacing = tree.field().at(&x);
        spacing <= most && spacing >= cell.edge * (1.0 - SAME)
    };
    cell.spacing <= most && (0..D).all(|k| same(k, 1.0) && same(k, -1.0))
}

/// Keeps so many of the cells with their middles at `position` as the spacing there asks for. `ends` are
/// where regions end in them.
///
/// Cells come in an order in which neighbours mostly follow each other. Each is worth (edge/spacing)^D of
/// a particle, and one is kept whenever a whole particle has come together.
pub fn thinned<const D: usize>(
    tree: &CellTree<'_, D>,
    position: &[[f64; D]],
    ends: &[usize],
) -> Seeds<D> {
    let mut seeds = Seeds::default();
    let mut collected = 0.5;
    let mut start = 0;
    for &end in ends {
        for x in &position[start..end] {
            let cell = tree.cell_at(x);
            let fixed = is_lattice(tree, &cell);
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
        start = end;
        seeds.ends.push(seeds.position.len());
    }
    seeds
}

#[cfg(test)]
mod tests {
    use super::*;
    use sph_geometry::{Aabb, Lattice, Refinement, Shape, SpacingField};

    /// The spacing grows away from a line, so that rows of cells have their edge for spacing by chance.
    #[test]
    fn as_many_are_kept_as_the_spacing_asks_for() {
        let target = Shape::cuboid([-9.0, -9.0], [9.0, 0.0]).unwrap();
        let one = Refinement { target, spacing: 0.02, within: 0.0, growth: 1.05 };
        let field = SpacingField::new(0.16, vec![one], [None; 2]);
        let lattice = Lattice::new([0.0; 2], 0.16).unwrap();
        let tree = CellTree::new(&lattice, &field).unwrap();
        let mut cells = Vec::new();
        let bounds = Aabb::new([0.0; 2], [3.2, 3.2]);
        tree.for_each(&bounds, |cell| {
            if bounds.contains(&cell.center) {
                cells.push(cell.center);
            }
        })
        .unwrap();
        let seeds = thinned(&tree, &cells, &[cells.len()]);
        let count = seeds.position.len();
        assert_eq!((seeds.fixed.len(), &seeds.ends[..]), (count, &[count][..]));
        // Slices of a coarse cell across the growth.
        for slice in 0..20 {
            let (low, high) = (0.16 * f64::from(slice), 0.16 * f64::from(slice + 1));
            let found = seeds.position.iter().filter(|x| low <= x[1] && x[1] < high).count() as f64;
            let strips = (0..1000).map(|n| low + (f64::from(n) + 0.5) * 1.6e-4);
            let expected: f64 = strips.map(|y| 3.2 * 1.6e-4 / field.at(&[1.0, y]).powi(2)).sum();
            assert!((found / expected - 1.0).abs() < 0.12, "{slice}: {found} {expected}");
        }
    }
}
