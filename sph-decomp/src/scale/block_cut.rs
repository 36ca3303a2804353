//! Where the blocks of a lattice are cut among ranks.
//!
//! A cut of a run is a slightly tilted plane, see [`Askew`](crate::Askew): it passes through one layer
//! of lattice points, and through one row of it, at a time. On the lattice that is an order of the
//! points: by their index along the axis of the cut, then along the next axis, then along the one
//! after. A cut is a point, and all points before it in this order are on the low side.

use super::blocks::{BlockClass, LatticeBlock};
use crate::partition::{HEAVY_SHARE, shear};
use crate::zone::Aabb;

/// Appends the blocks of each rank, in rank order.
pub(super) fn divide<const D: usize>(
    blocks: Vec<LatticeBlock<D>>,
    classes: &[BlockClass],
    ranks: usize,
    owned: &mut Vec<Vec<LatticeBlock<D>>>,
) {
    if ranks == 1 {
        owned.push(blocks);
        return;
    }
    let below = ranks / 2;
    let first = longest_side(&blocks, classes);
    let axes: [usize; D] = std::array::from_fn(|step| (first + step) % D);
    let at = cut(&blocks, classes, &axes, below as f64 / ranks as f64);
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for block in blocks {
        part(block, &axes, &at, &mut low, &mut high);
    }
    divide(low, classes, below, owned);
    divide(high, classes, ranks - below, owned);
}

/// The axis across which blocks are cut: that of the longest side in sheared space. As for
/// particles, what is light does not decide.
fn longest_side<const D: usize>(blocks: &[LatticeBlock<D>], classes: &[BlockClass]) -> usize {
    let most = classes.iter().map(|class| class.cost).fold(0.0, f64::max);
    let bounds = |least: f64| {
        let mut bounds = Aabb::EMPTY;
        for block in blocks.iter().filter(|block| classes[usize::from(block.class)].cost >= least) {
            // A shear keeps the order of the corners.
            bounds.add(&shear(&block.first.map(f64::from)));
            bounds.add(&shear(&block.end.map(|end| f64::from(end - 1))));
        }
        bounds
    };
    let heavy = bounds(HEAVY_SHARE * most);
    let bounds = if heavy.is_empty() { bounds(0.0) } else { heavy };
    let side = |axis: usize| bounds.high[axis] - bounds.low[axis];
    (1..D).fold(0, |best, axis| if side(axis) > side(best) { axis } else { best })
}

/// The point before which as nearly as possible this share of the cost lies.
fn cut<const D: usize>(
    blocks: &[LatticeBlock<D>],
    classes: &[BlockClass],
    axes: &[usize; D],
    share: f64,
) -> [i32; D] {
    let mut at = [0; D];
    let mut missing = None;
    let mut within = blocks.to_vec();
    for (step, &axis) in axes.iter().enumerate() {
        let Some(layers) = Layers::new(&within, classes, axis) else { return at };
        let target = missing.unwrap_or_else(|| share * layers.costs.iter().sum::<f64>());
        let (layer, left, inside) = layers.find(target);
        at[axis] = layer;
        missing = Some(left);
        if step + 1 == D {
            // Of two equally good cuts the higher one, as for particles.
            at[axis] += i32::from(left >= (inside - left) * (1.0 - 1e-12));
            break;
        }
        within = within
            .iter()
            .filter_map(|block| block.split(axis, layer)[1]?.split(axis, layer + 1)[0])
            .collect();
    }
    at
}

/// The cost of each layer across an axis.
struct Layers {
    first: i32,
    costs: Vec<f64>,
}

impl Layers {
    fn new<const D: usize>(
        blocks: &[LatticeBlock<D>],
        classes: &[BlockClass],
        axis: usize,
    ) -> Option<Self> {
        let first = blocks.iter().map(|block| block.first[axis]).min()?;
        let end = blocks.iter().map(|block| block.end[axis]).max()?;
        // From the changes where blocks begin and end.
        let mut costs = vec![0.0; (end - first) as usize + 1];
        for block in blocks {
            let class = &classes[usize::from(block.class)];
            let thickness = f64::from(block.end[axis] - block.first[axis]);
            let cost = block.points() / thickness * class.density * class.cost;
            costs[(block.first[axis] - first) as usize] += cost;
            costs[(block.end[axis] - first) as usize] -= cost;
        }
        let mut sum = 0.0;
        for cost in &mut costs {
            sum += *cost;
            *cost = sum;
        }
        // Sums of differences leave crumbs where there is nothing.
        let crumb = 1e-9 * costs.iter().copied().fold(0.0, f64::max);
        costs.iter_mut().filter(|cost| **cost <= crumb).for_each(|cost| *cost = 0.0);
        Some(Self { first, costs })
    }

    /// The layer into which a cut falls that shall have `target` below it, what of the target is left
    /// for that layer, and the cost of it all.
    fn find(&self, target: f64) -> (i32, f64, f64) {
        let mut below = 0.0;
        let mut best = (0, 0.0, 0.0);
        for (layer, &cost) in self.costs.iter().enumerate().filter(|(_, cost)| **cost > 0.0) {
            if below <= target * (1.0 + 1e-12) {
                best = (layer, below, cost);
            }
            below += cost;
        }
        let (layer, below, inside) = best;
        (self.first + layer as i32, (target - below).max(0.0), inside)
    }
}

/// Divides a block at a point into at most three boxes on each side.
fn part<const D: usize>(
    block: LatticeBlock<D>,
    axes: &[usize],
    at: &[i32; D],
    low: &mut Vec<LatticeBlock<D>>,
    high: &mut Vec<LatticeBlock<D>>,
) {
    let Some((&axis, further)) = axes.split_first() else { return high.push(block) };
    let [below, rest] = block.split(axis, at[axis]);
    let Some(rest) = rest else { return low.extend(below) };
    let [layer, above] = rest.split(axis, at[axis] + 1);
    let (mut before, mut after) = (Vec::new(), Vec::new());
    if let Some(layer) = layer {
        part(layer, further, at, &mut before, &mut after);
    }
    if before.is_empty() {
        low.extend(below);
        high.push(rest);
    } else if after.is_empty() {
        low.extend(block.split(axis, at[axis] + 1)[0]);
        high.extend(above);
    } else {
        low.extend(below);
        low.append(&mut before);
        high.append(&mut after);
        high.extend(above);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::Point;
    use crate::{Askew, Orb, Partition};

    const ANY: BlockClass = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 1.0 };

    #[test]
    fn blocks_are_cut_where_their_particles_are() {
        // An L of two costs, in blocks of several sizes.
        // Costs in whole powers of two, so that equally good cuts are equally good in integers too.
        let heavy = BlockClass { cost: 4.0, ..ANY };
        let blocks = vec![
            LatticeBlock { first: [0, 0, 0], end: [9, 13, 11], class: 0 },
            LatticeBlock { first: [9, 0, 0], end: [24, 5, 4], class: 1 },
            LatticeBlock { first: [9, 0, 4], end: [24, 5, 11], class: 0 },
        ];
        for ranks in [1, 2, 3, 5, 8, 13, 64] {
            let mut positions = Vec::new();
            let mut points = Vec::new();
            for block in &blocks {
                let class = [ANY, heavy][usize::from(block.class)];
                for z in block.first[2]..block.end[2] {
                    for y in block.first[1]..block.end[1] {
                        for x in block.first[0]..block.end[0] {
                            positions.push([x, y, z].map(f64::from));
                            let cost = class.cost as f32;
                            points.push(Point { active: true, cost, pairs: 1.0 });
                        }
                    }
                }
            }
            let cost = |point: &Point| f64::from(point.cost);
            let mut sheared = Askew::view(&positions);
            let (orb, _) = Orb::divide(ranks, &mut sheared, &mut points, cost).unwrap();
            let partition = Askew::new(orb);
            let mut owned = Vec::new();
            divide(blocks.clone(), &[ANY, heavy], ranks, &mut owned);
            assert_eq!(owned.len(), ranks);
            for (rank, blocks) in owned.iter().enumerate() {
                let points: f64 = { blocks.iter().map(LatticeBlock::points).sum::<f64>() };
                let theirs = positions.iter().filter(|x| partition.owner(x) == rank).count();
                assert_eq!(points, theirs as f64, "rank {rank} of {ranks}");
                for block in blocks {
                    for corner in [block.first, block.end.map(|end| end - 1)] {
                        assert_eq!(partition.owner(&corner.map(f64::from)), rank, "{corner:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn both_sides_have_their_share_to_within_a_particle() {
        // Lengths that no number of ranks divides, and costs of which neither divides the other.
        let heavy = BlockClass { cost: 7.0, ..ANY };
        let blocks = vec![
            LatticeBlock { first: [0, 0, 0], end: [17, 13, 11], class: 0 },
            LatticeBlock { first: [17, -3, 2], end: [29, 10, 9], class: 1 },
        ];
        let cost = |blocks: &[LatticeBlock<3>]| -> f64 {
            blocks.iter().map(|b| b.points() * [1.0, 7.0][usize::from(b.class)]).sum()
        };
        let whole = cost(&blocks);
        for ranks in [2, 3, 7, 16, 50] {
            let mut owned = Vec::new();
            divide(blocks.clone(), &[ANY, heavy], ranks, &mut owned);
            assert!((owned.iter().map(|one| cost(one)).sum::<f64>() - whole).abs() < 1e-6);
            for (rank, one) in owned.iter().enumerate() {
                // Each of the cuts above misses by half a particle, and passes half of it on.
                let miss = (cost(one) - whole / ranks as f64).abs();
                assert!(miss <= 7.0, "rank {rank} of {ranks} misses by {miss}");
            }
        }
    }

    #[test]
    fn a_cut_along_a_layer_breaks_no_block() {
        let cube = LatticeBlock { first: [0; 3], end: [10; 3], class: 0 };
        let mut owned = Vec::new();
        divide(vec![cube], &[ANY], 8, &mut owned);
        assert!(owned.iter().all(|blocks| blocks.len() == 1 && blocks[0].points() == 125.0));
        // Below and above a layer of which both sides have some, and the row in it that is cut.
        let (mut low, mut high) = (Vec::new(), Vec::new());
        part(cube, &[0, 1, 2], &[4, 5, 6], &mut low, &mut high);
        assert_eq!((low.len(), high.len()), (3, 3));
        let points =
            |blocks: &[LatticeBlock<3>]| blocks.iter().map(LatticeBlock::points).sum::<f64>();
        assert_eq!([points(&low), points(&high)], [456.0, 544.0]);
    }
}
