//! The overlap zone between ranks that own lattice blocks.

use super::blocks::{BlockClass, LatticeBlock};
use super::load::{Layout, Link, RankLoad};
use super::near::near_ranks;
use crate::zone::Aabb;

/// A lattice point is needed by some rank.
const INNER: u8 = 1;
/// A lattice point is needed by the rank that is being looked at.
const SENT: u8 = 2;

/// Relative widening of the reach, as the zone of particles has it.
const MARGIN: f64 = 1e-5;

/// Counts what each rank holds and sends; `reach` in lattice spacings.
pub(super) fn count<const D: usize>(
    owned: &[Vec<LatticeBlock<D>>],
    classes: &[BlockClass],
    reach: f64,
) -> Layout {
    let reach = reach * (1.0 + MARGIN);
    let wholes: Vec<Aabb<D>> = owned.iter().map(|blocks| whole(blocks)).collect();
    // Whoever has no active particle near needs nothing.
    let is_active = |block: &&LatticeBlock<D>| classes[usize::from(block.class)].active;
    let active: Vec<Vec<LatticeBlock<D>>> =
        owned.iter().map(|blocks| blocks.iter().filter(is_active).copied().collect()).collect();
    let needing: Vec<Aabb<D>> = active.iter().map(|blocks| whole(blocks)).collect();
    let mut neighbours = vec![Vec::new(); owned.len()];
    for (p, q) in near_ranks(&wholes, reach, &[None; D]) {
        neighbours[p as usize].push(q as usize);
        neighbours[q as usize].push(p as usize);
    }
    let mut loads = vec![RankLoad::default(); owned.len()];
    let mut links = Vec::new();
    for (p, blocks) in owned.iter().enumerate() {
        let mut marked = Marked::new(blocks, reach);
        for &q in neighbours[p].iter().filter(|&&q| !needing[q].is_empty()) {
            marked.mark(&wholes[p], &active[q], &needing[q]);
            let mut sent = 0.0;
            for (class, points) in marked.take_sent(classes.len()) {
                let class = &classes[class];
                let particles = points * class.density;
                if class.active {
                    sent += particles;
                } else {
                    loads[q].outer_passive += particles;
                    loads[q].repeated_pairs += particles * class.pairs;
                }
            }
            if sent > 0.0 {
                links.push(Link { from: p as u32, to: q as u32, elements: sent });
            }
        }
        marked.hold(classes, &mut loads[p]);
    }
    Layout::new(loads, links)
}

/// The box around the lattice points of a block.
fn sites<const D: usize>(block: &LatticeBlock<D>) -> Aabb<D> {
    Aabb { low: block.first.map(f64::from), high: block.end.map(|end| f64::from(end - 1)) }
}

fn whole<const D: usize>(blocks: &[LatticeBlock<D>]) -> Aabb<D> {
    let mut whole = Aabb::EMPTY;
    blocks.iter().for_each(|block| whole.merge(&sites(block)));
    whole
}

/// Longest edge of a tile, in points: marks are held and looked through only near other ranks.
const TILE: i32 = 8;

/// Cuts a block into tiles.
fn tiles<const D: usize>(block: &LatticeBlock<D>, tiles: &mut Vec<LatticeBlock<D>>) {
    let counts: [i32; D] =
        std::array::from_fn(|k| (block.end[k] - block.first[k] + TILE - 1) / TILE);
    for number in 0..counts.iter().map(|&count| count as usize).product() {
        let mut rest: usize = number;
        let mut tile = *block;
        for (k, &count) in counts.iter().enumerate() {
            let place = (rest % count as usize) as i32;
            rest /= count as usize;
            tile.first[k] = block.first[k] + place * TILE;
            tile.end[k] = block.end[k].min(tile.first[k] + TILE);
        }
        tiles.push(tile);
    }
}

/// The tiles of a rank and who needs their points. Tiles that nobody needs have no marks.
struct Marked<const D: usize> {
    tiles: Vec<LatticeBlock<D>>,
    marks: Vec<Vec<u8>>,
    /// Tiles with points that the rank in question needs.
    touched: Vec<usize>,
    reach: f64,
}

impl<const D: usize> Marked<D> {
    fn new(blocks: &[LatticeBlock<D>], reach: f64) -> Self {
        let mut all = Vec::with_capacity(blocks.len());
        blocks.iter().for_each(|block| tiles(block, &mut all));
        let marks = vec![Vec::new(); all.len()];
        Self { tiles: all, marks, touched: Vec::new(), reach }
    }

    /// Marks the points that a rank with active blocks `theirs` needs.
    fn mark(&mut self, mine: &Aabb<D>, theirs: &[LatticeBlock<D>], their_whole: &Aabb<D>) {
        let reach2 = self.reach * self.reach;
        let near = |a: &Aabb<D>, b: &Aabb<D>| a.distance_squared(b, &[None; D]) < reach2;
        let theirs: Vec<(&LatticeBlock<D>, Aabb<D>)> = theirs
            .iter()
            .map(|block| (block, sites(block)))
            .filter(|(_, bounds)| near(bounds, mine))
            .collect();
        for (place, (tile, marks)) in self.tiles.iter().zip(&mut self.marks).enumerate() {
            let bounds = sites(tile);
            if !near(&bounds, their_whole) {
                continue;
            }
            self.touched.push(place);
            for (other, _) in theirs.iter().filter(|(_, other)| near(&bounds, other)) {
                marks.resize(tile.points() as usize, 0);
                mark_near(tile, other, reach2, marks);
            }
        }
    }

    /// Points that were marked since the last call, by class; from now on they are inner.
    fn take_sent(&mut self, classes: usize) -> impl Iterator<Item = (usize, f64)> + use<D> {
        let mut sent = vec![0_u64; classes];
        for place in self.touched.drain(..) {
            let sent = &mut sent[usize::from(self.tiles[place].class)];
            for mark in &mut self.marks[place] {
                *sent += u64::from(*mark >> 1);
                *mark = (*mark | *mark >> 1) & INNER;
            }
        }
        sent.into_iter().map(|points| points as f64).enumerate()
    }

    /// Notes what the rank owns.
    fn hold(&self, classes: &[BlockClass], load: &mut RankLoad) {
        for (block, marks) in self.tiles.iter().zip(&self.marks) {
            let class = &classes[usize::from(block.class)];
            let all = block.points() * class.density;
            load.cost += all * class.cost;
            if !class.active {
                load.passive += all;
                continue;
            }
            let inner = marks.iter().map(|&mark| u64::from(mark)).sum::<u64>() as f64;
            let inner = inner * class.density;
            load.inner += inner;
            load.inner_pairs += inner * class.pairs;
            load.local += all - inner;
            load.local_pairs += (all - inner) * class.pairs;
        }
    }
}

/// Marks the points of `block` that are nearer to the points of `other` than the reach. Points are
/// numbered with the first axis fastest.
fn mark_near<const D: usize>(
    block: &LatticeBlock<D>,
    other: &LatticeBlock<D>,
    reach2: f64,
    marks: &mut [u8],
) {
    let length = |axis: usize| (block.end[axis] - block.first[axis]) as usize;
    let rows: usize = (1..D).map(length).product();
    for row in 0..rows {
        let mut rest = row;
        let mut across = 0.0;
        for axis in 1..D {
            let index = block.first[axis] + (rest % length(axis)) as i32;
            rest /= length(axis);
            let gap = (other.first[axis] - index).max(index - (other.end[axis] - 1)).max(0);
            across += f64::from(gap) * f64::from(gap);
        }
        if across >= reach2 {
            continue;
        }
        // The largest whole number whose square is below what is left.
        let width = ((reach2 - across).sqrt().ceil() as i32 - 1).max(0);
        let first = (other.first[0] - width).max(block.first[0]) - block.first[0];
        let end = (other.end[0] + width).min(block.end[0]) - block.first[0];
        if first < end {
            let start = row * length(0);
            for mark in &mut marks[start + first as usize..start + end as usize] {
                *mark |= SENT;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ZoneOptions;
    use crate::scale::Point;
    use proptest::prelude::*;

    fn points_of(blocks: &[LatticeBlock<2>]) -> (Vec<[f64; 2]>, Vec<Point>) {
        let mut positions = Vec::new();
        let mut points = Vec::new();
        for block in blocks {
            for y in block.first[1]..block.end[1] {
                for x in block.first[0]..block.end[0] {
                    positions.push([f64::from(x), f64::from(y)]);
                    points.push(Point { active: block.class == 0, cost: 1.0, pairs: 3.0 });
                }
            }
        }
        (positions, points)
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 40, failure_persistence: None, ..Default::default()
        })]

        #[test]
        fn blocks_of_one_point_have_the_exact_zone(
            width in 4_i32..20, height in 4_i32..20, wall in 1_i32..4, ranks in 1_usize..9,
            reach in 1.1..4.9,
        ) {
            // Water above a floor, every point a block of its own.
            let whole = [
                LatticeBlock { first: [0, 0], end: [width, height], class: 0 },
                LatticeBlock { first: [-2, -wall], end: [width + 5, 0], class: 1 },
            ];
            let (mut positions, mut points) = points_of(&whole);
            let single = positions.iter().zip(&points).map(|(x, point)| {
                let first = x.map(|x| x as i32);
                let end = first.map(|x| x + 1);
                LatticeBlock { first, end, class: u16::from(!point.active) }
            });
            let water = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 3.0 };
            let classes = [water, BlockClass { active: false, ..water }];
            let blocks = Layout::of_blocks(ranks, single.collect(), &classes, reach).unwrap();
            let options = ZoneOptions { block: 1, ..Default::default() };
            let real =
                Layout::of_points(ranks, &mut positions, &mut points, reach, &options).unwrap();
            prop_assert_eq!(&blocks, &real);
            // Large blocks lose nothing on a lattice that they fill.
            let large = Layout::of_blocks(ranks, whole.to_vec(), &classes, reach).unwrap();
            let count = |layout: &Layout| layout.sum(|rank| rank.sent);
            prop_assert!((count(&large) - count(&real)).abs() <= 0.02 * count(&real) + 1.0);
        }
    }

    #[test]
    fn a_line_of_two_ranks() {
        let line = LatticeBlock { first: [0, 0], end: [20, 1], class: 0 };
        let class = BlockClass { active: true, density: 1.0, cost: 1.0, pairs: 6.0 };
        let layout = Layout::of_blocks(2, vec![line], &[class], 3.3).unwrap();
        for rank in &layout.ranks {
            assert_eq!((rank.local, rank.inner, rank.outer, rank.sent), (7.0, 3.0, 3.0, 3.0));
            assert_eq!((rank.messages_in, rank.messages_out), (1, 1));
            assert_eq!((rank.local_pairs, rank.inner_pairs), (42.0, 18.0));
        }
    }
}
