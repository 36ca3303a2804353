//! The layout of particles that are really there.

use super::error::ScaleError;
use super::load::{Layout, Link, RankLoad};
use super::near::near_ranks;
use crate::zone::{Aabb, Block, BlockTree, MaxReach, check, tile};
use crate::{Orb, Reach, ZoneOptions};
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
    /// The cuts are those of [`Orb::build`] and the zone is that of [`Zone::build`] with the same
    /// `reach` (skin included) and options, so the counts are those of a run. `positions` and
    /// `points` are sorted by rank on return; a further call for another number of ranks takes them
    /// as they are. Needs about 80 bytes per particle in three dimensions besides these two.
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
        let cost = |point: &Point| f64::from(point.cost);
        let (_, starts) = Orb::divide(ranks, positions, points, cost)?;
        let count = Count { positions, points, starts: &starts, reach, options };
        Ok(count.layout())
    }
}

/// Particles sorted by rank.
struct Count<'a, const D: usize> {
    positions: &'a [[f64; D]],
    points: &'a [Point],
    starts: &'a [usize],
    reach: f64,
    options: &'a ZoneOptions<D>,
}

impl<const D: usize> Count<'_, D> {
    fn layout(&self) -> Layout {
        let ranks = self.starts.len() - 1;
        let boxes: Vec<Aabb<D>> =
            (0..ranks).map(|rank| Aabb::of(&self.positions[self.range(rank)])).collect();
        let mut loads = vec![RankLoad::default(); ranks];
        let mut links = Vec::new();
        let mut inner = vec![false; self.positions.len()];
        // The zone widens its reach by a hair; a little more here finds all pairs that it does.
        for (p, q) in near_ranks(&boxes, self.reach * 1.001, &self.options.period) {
            let (p, q) = (p as usize, q as usize);
            let wholes = [p, q].map(|rank| Block { bounds: boxes[rank], reach: self.reach });
            if !wholes[0].touches::<MaxReach>(&wholes[1], &self.options.period) {
                continue;
            }
            let near = [self.near(p, &wholes[1]), self.near(q, &wholes[0])];
            let trees = [self.blocks(near[0].clone()), self.blocks(near[1].clone())];
            for (from, to, near, tree) in [(p, q, &near[0], &trees[1]), (q, p, &near[1], &trees[0])]
            {
                links.extend(self.send(near, tree, (from, to), &mut loads, &mut inner));
            }
        }
        for (rank, load) in loads.iter_mut().enumerate() {
            for i in self.range(rank) {
                let point = &self.points[i];
                load.cost += f64::from(point.cost);
                let (count, pairs) = match (point.active, inner[i]) {
                    (true, false) => (&mut load.local, Some(&mut load.local_pairs)),
                    (true, true) => (&mut load.inner, Some(&mut load.inner_pairs)),
                    (false, _) => (&mut load.passive, None),
                };
                *count += 1.0;
                if let Some(pairs) = pairs {
                    *pairs += f64::from(point.pairs);
                }
            }
        }
        Layout::new(loads, links)
    }

    fn range(&self, rank: usize) -> Range<usize> {
        self.starts[rank]..self.starts[rank + 1]
    }

    fn point(&self, i: u32) -> Block<D> {
        Block::point(&self.positions[i as usize], self.reach)
    }

    /// Particles of a rank that may see something of a rank with this box.
    fn near(&self, rank: usize, other: &Block<D>) -> Vec<u32> {
        let Range { start, end } = self.range(rank);
        let touches = |i: &u32| self.point(*i).touches::<MaxReach>(other, &self.options.period);
        (start as u32..end as u32).filter(touches).collect()
    }

    /// The blocks that a rank tells another of.
    fn blocks(&self, mut near: Vec<u32>) -> BlockTree<D> {
        let mut blocks = Vec::new();
        tile(&mut near, self.positions, |_| self.reach, self.options.block, &mut blocks);
        BlockTree::new(blocks)
    }

    /// Counts what one rank sends to another; the link is that of a pass.
    fn send(
        &self,
        near: &[u32],
        theirs: &BlockTree<D>,
        (from, to): (usize, usize),
        loads: &mut [RankLoad],
        inner: &mut [bool],
    ) -> Option<Link> {
        let mut active = 0;
        for &i in near {
            if !theirs.touches::<MaxReach>(&self.point(i), &self.options.period) {
                continue;
            }
            let point = &self.points[i as usize];
            if point.active {
                inner[i as usize] = true;
                active += 1;
            } else {
                loads[to].outer_passive += 1.0;
                loads[to].repeated_pairs += f64::from(point.pairs);
            }
        }
        (active > 0).then(|| {
            let (from, to) = (from as u32, to as u32);
            Link { from, to, elements: f64::from(active) }
        })
    }
}
