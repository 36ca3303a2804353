//! The layout of particles that are really there.

use super::error::ScaleError;
use super::load::{Layout, Link, RankLoad};
use super::near::near_ranks;
use crate::zone::{Aabb, Block, BlockTree, MaxReach, check, tile};
use crate::{Askew, Orb, Reach, ZoneOptions};
use std::ops::Range;

/// What is known of a particle besides its place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// Whether it is computed in passes; otherwise it is only read.
    pub active: bool,
    /// By how much the partition weighs it.
    pub cost: f32,
    /// Active: entries of its neighbour lists. Passive: active particles that see it.
    pub pairs: f32,
}

impl Layout {
    /// Divides particles among `ranks` and counts what each would hold and send.
    ///
    /// The cuts are those of [`Orb::build`] seen [`Askew`], and the zone is that of [`Zone::build`] of the
    /// active particles with the same `reach` (skin included) and options, so the counts are those of a
    /// run. Passive particles are counted where they are near such blocks of active ones as these.
    /// `positions` and `points` are sorted by rank on return, active particles first; a further call
    /// for another number of ranks takes them as they are. Needs about 100 bytes per particle in three
    /// dimensions besides these two.
    ///
    /// ```
    /// use sph_decomp::ZoneOptions;
    /// use sph_decomp::scale::{Layout, Point, ScaleError};
    ///
    /// // Particles at 0, 1, … 29 that see up to 2.5 to both sides.
    /// let mut positions: Vec<[f64; 1]> = (0..30).map(|i| [f64::from(i)]).collect();
    /// let mut points = vec![Point { active: true, cost: 1.0, pairs: 4.0 }; 30];
    /// let layout =
    ///     Layout::of_points(3, &mut positions, &mut points, 2.5, &ZoneOptions::default())?;
    /// let middle = layout.ranks[1];
    /// assert_eq!((middle.local, middle.inner, middle.outer), (6.0, 4.0, 4.0));
    /// # Ok::<(), ScaleError>(())
    /// ```
    ///
    /// [`Zone::build`]: crate::Zone::build
    ///
    /// # Errors
    ///
    /// When there are more ranks than particles, and as [`Orb::divide`] and
    /// [`Zone::build`](crate::Zone::build).
    pub fn of_points<const D: usize>(
        ranks: usize,
        positions: &mut [[f64; D]],
        points: &mut [Point],
        reach: f64,
        options: &ZoneOptions<D>,
    ) -> Result<Self, ScaleError> {
        if ranks > positions.len() {
            let particles = positions.len() as u64;
            return Err(ScaleError::TooManyRanks { ranks, particles });
        }
        check(positions, Reach::Uniform(reach), options)?;
        let (mut order, starts) = divide(ranks, positions, points)?;
        let mut passive = Vec::with_capacity(ranks);
        for rank in starts.windows(2) {
            let mine = &mut order[rank[0]..rank[1]];
            mine.sort_unstable_by_key(|&i| (!points[i as usize].active, i));
            let active = mine.partition_point(|&i| points[i as usize].active);
            passive.push(rank[0] + active);
        }
        permute(positions, &order);
        permute(points, &order);
        drop(order);
        let count = Count { positions, points, starts: &starts, passive: &passive, reach, options };
        Ok(count.layout())
    }
}

/// The particles in rank order, and where each rank begins.
fn divide<const D: usize>(
    ranks: usize,
    positions: &[[f64; D]],
    points: &[Point],
) -> Result<(Vec<u32>, Vec<usize>), ScaleError> {
    let mut sheared = Askew::view(positions);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    let cost = |&i: &u32| f64::from(points[i as usize].cost);
    let (_, starts) = Orb::divide(ranks, &mut sheared, &mut order, cost)?;
    Ok((order, starts))
}

fn permute<T: Copy>(values: &mut [T], order: &[u32]) {
    let sorted: Vec<T> = order.iter().map(|&i| values[i as usize]).collect();
    values.copy_from_slice(&sorted);
}

/// Particles sorted by rank, active ones first.
struct Count<'a, const D: usize> {
    positions: &'a [[f64; D]],
    points: &'a [Point],
    starts: &'a [usize],
    /// The first passive particle of each rank, or the end of its particles.
    passive: &'a [usize],
    reach: f64,
    options: &'a ZoneOptions<D>,
}

/// The boxes of what a rank owns.
struct Wholes<const D: usize> {
    active: Block<D>,
    passive: Block<D>,
}

impl<const D: usize> Count<'_, D> {
    fn layout(&self) -> Layout {
        let ranks = self.starts.len() - 1;
        let whole = |range| Block { bounds: Aabb::of(&self.positions[range]), reach: self.reach };
        let wholes: Vec<Wholes<D>> = (0..ranks)
            .map(|rank| Wholes {
                active: whole(self.active(rank)),
                passive: whole(self.passive(rank)),
            })
            .collect();
        let both = |wholes: &Wholes<D>| {
            let mut bounds = wholes.active.bounds;
            bounds.merge(&wholes.passive.bounds);
            bounds
        };
        let boxes: Vec<Aabb<D>> = wholes.iter().map(both).collect();
        let mut loads = vec![RankLoad::default(); ranks];
        let mut links = Vec::new();
        let mut inner = vec![false; self.positions.len()];
        // The zone widens its reach by a hair; a little more here finds all pairs that it does.
        for (p, q) in near_ranks(&boxes, self.reach * 1.001, &self.options.period) {
            let (p, q) = (p as usize, q as usize);
            if self.meet(&wholes[p].active, &wholes[q].active) {
                let near = [(p, q), (q, p)]
                    .map(|(one, other)| self.near(self.active(one), &wholes[other].active));
                let trees = [0, 1].map(|one: usize| self.blocks(near[one].clone()));
                for (from, to, near, tree) in
                    [(p, q, &near[0], &trees[1]), (q, p, &near[1], &trees[0])]
                {
                    let sent = self.needed(near, tree);
                    sent.iter().for_each(|&i| inner[i as usize] = true);
                    if !sent.is_empty() {
                        let elements = sent.len() as f64;
                        links.push(Link { from: from as u32, to: to as u32, elements });
                    }
                }
            }
            for (from, to) in [(p, q), (q, p)] {
                if self.meet(&wholes[from].passive, &wholes[to].active) {
                    let near = self.near(self.passive(from), &wholes[to].active);
                    let theirs = self.blocks(self.near(self.active(to), &wholes[from].passive));
                    for i in self.needed(&near, &theirs) {
                        loads[to].outer_passive += 1.0;
                        loads[to].repeated_pairs += f64::from(self.points[i as usize].pairs);
                    }
                }
            }
        }
        for (rank, load) in loads.iter_mut().enumerate() {
            self.hold(rank, &inner, load);
        }
        Layout::new(loads, links)
    }

    /// Notes what a rank owns.
    fn hold(&self, rank: usize, inner: &[bool], load: &mut RankLoad) {
        for i in self.active(rank) {
            let (count, pairs) = match inner[i] {
                true => (&mut load.inner, &mut load.inner_pairs),
                false => (&mut load.local, &mut load.local_pairs),
            };
            *count += 1.0;
            *pairs += f64::from(self.points[i].pairs);
        }
        load.passive = self.passive(rank).len() as f64;
        let all = self.starts[rank]..self.starts[rank + 1];
        load.cost = self.points[all].iter().map(|point| f64::from(point.cost)).sum();
    }

    fn active(&self, rank: usize) -> Range<usize> {
        self.starts[rank]..self.passive[rank]
    }

    fn passive(&self, rank: usize) -> Range<usize> {
        self.passive[rank]..self.starts[rank + 1]
    }

    fn meet(&self, one: &Block<D>, other: &Block<D>) -> bool {
        !one.bounds.is_empty()
            && !other.bounds.is_empty()
            && one.touches::<MaxReach>(other, &self.options.period)
    }

    fn point(&self, i: u32) -> Block<D> {
        Block::point(&self.positions[i as usize], self.reach)
    }

    /// Particles that may see something in this box.
    fn near(&self, range: Range<usize>, other: &Block<D>) -> Vec<u32> {
        let touches = |i: &u32| self.point(*i).touches::<MaxReach>(other, &self.options.period);
        (range.start as u32..range.end as u32).filter(touches).collect()
    }

    /// The blocks that a rank tells another of.
    fn blocks(&self, mut near: Vec<u32>) -> BlockTree<D> {
        let mut blocks = Vec::new();
        tile(&mut near, self.positions, |_| self.reach, self.options.block, &mut blocks);
        BlockTree::new(blocks)
    }

    /// Those that whoever told of these blocks needs.
    fn needed(&self, near: &[u32], theirs: &BlockTree<D>) -> Vec<u32> {
        let touches = |i: &u32| theirs.touches::<MaxReach>(&self.point(*i), &self.options.period);
        near.iter().copied().filter(touches).collect()
    }
}
