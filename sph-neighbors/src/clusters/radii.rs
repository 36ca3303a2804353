//! The search with a reach of its own for each pair, level by level.

use super::fill::{Chunk, Scratch, sort_and_dedup};
use super::{CLUSTER, Clusters};
use crate::LevelList;
use crate::levels::Level;
use crate::list::{Group, PairReach, radius_in_units};
use std::array::from_fn;
use std::ops::Range;

/// What is searched, and for whom.
#[derive(Debug)]
pub struct Task<'a, const D: usize> {
    pub levels: &'a LevelList<D>,
    pub clusters: &'a Clusters,
    pub targets: &'a [[f64; D]],
    pub radii: &'a [f64],
    pub own: bool,
    pub rule: PairReach,
}

/// Targets that are close together, in units of the grid relative to the base of their group.
#[derive(Debug)]
struct Targets<const D: usize> {
    group: Group<D>,
    /// By axis; far away for lanes without a target.
    places: [[f32; CLUSTER]; D],
    radii: [f32; CLUSTER],
    /// The largest of them.
    radius: f32,
}

impl<const D: usize> Task<'_, D> {
    /// Fills the lists of the clusters `some`.
    pub fn fill(&self, chunk: &mut Chunk, scratch: &mut Scratch, some: Range<usize>) {
        let entries = &mut scratch.entries;
        chunk.begin(self.clusters.targets_of(some.start).start);
        entries.clear();
        for cluster in some {
            chunk.starts.push(entries.len() as u32);
            let own = self.clusters.targets_of(cluster);
            let count = own.len();
            let groups = self.groups(own);
            let mut counts = [0; CLUSTER];
            for level in self.levels.levels() {
                let start = entries.len();
                let mut passes = 0;
                for targets in &groups {
                    let (tests, images) = self.find(targets, level, &mut counts, entries);
                    chunk.tests += tests;
                    passes += images;
                }
                if passes > 1 {
                    sort_and_dedup(entries, start);
                }
                let order = level.cells.order();
                entries[start..].iter_mut().for_each(|place| *place = order[*place as usize]);
            }
            chunk.count_targets(&counts[..count], self.own);
        }
        chunk.end(entries);
    }

    /// The targets of a cluster, those together that are close together. Those that the grid cannot
    /// place are in none.
    fn groups(&self, own: Range<usize>) -> Vec<Targets<D>> {
        let grid = self.levels.grid();
        let mut groups: Vec<Targets<D>> = Vec::with_capacity(1);
        for (lane, t) in own.enumerate() {
            let Some(fixed) = grid.place(&self.targets[t]) else { continue };
            let radius = radius_in_units(grid, self.radii[t]);
            let fits = |group: &&mut Targets<D>| {
                let wide = |a: usize| {
                    let (low, high) = (group.group.low[a], group.group.high[a]);
                    high.max(fixed[a]) - low.min(fixed[a])
                };
                // A longer box has many sources near it that no target can reach.
                let longest = group.radius.min(radius) as i64;
                (0..D).all(|a| wide(a) <= longest)
            };
            match groups.last_mut().filter(fits) {
                Some(group) => group.add(lane, fixed, radius),
                None => groups.push(Targets::of_one(lane, fixed, radius)),
            }
        }
        groups
    }

    /// Appends the places of the sources of a level within reach of any target to `found`, ascending
    /// for each image of the targets. Adds to `counts` how many each target reaches. Returns how many
    /// sources were tested against the targets and how many images of these had any nearby.
    fn find(
        &self,
        targets: &Targets<D>,
        level: &Level<D>,
        counts: &mut [u32; CLUSTER],
        found: &mut Vec<u32>,
    ) -> (u64, usize) {
        let of = |a: f32, b: f32| self.rule.of(f64::from(a), f64::from(b));
        let reach = of(targets.radius, level.largest_radius);
        let columns: [&[i32]; D] = from_fn(|axis| level.cells.coordinates(axis));
        let (mut tests, mut images) = (0, 0);
        targets.group.for_each_image(&level.cells, reach, |image| {
            let before = tests;
            let base = image.base.map(|q| q as i32);
            let corner = |q: &[i64; D]| from_fn(|a| (q[a] - image.base[a]) as f32);
            let (low, high): ([f32; D], [f32; D]) = (corner(&image.low), corner(&image.high));
            image.for_each_row_across(&level.cells, reach, |row, across| {
                let cells = image.part_of_row(&level.cells, row, reach * reach - across);
                for place in level.cells.places(cells) {
                    let radius = level.radii[place];
                    let x: [f32; D] = from_fn(|a| columns[a][place].wrapping_sub(base[a]) as f32);
                    let mut distance2 = 0.0;
                    for axis in 0..D {
                        let d = (low[axis] - x[axis]).max(x[axis] - high[axis]).max(0.0);
                        distance2 += d * d;
                    }
                    let most = of(targets.radius, radius) as f32;
                    if distance2 >= most * most {
                        continue;
                    }
                    tests += 1;
                    if targets.test(&x, radius, self.rule, counts) {
                        found.push(place as u32);
                    }
                }
            });
            images += usize::from(tests > before);
        });
        (tests, images)
    }
}

impl<const D: usize> Targets<D> {
    fn of_one(lane: usize, fixed: [i64; D], radius: f32) -> Self {
        let group = Group { low: fixed, high: fixed, base: fixed };
        let far = [[f32::INFINITY; CLUSTER]; D];
        let mut targets = Self { group, places: far, radii: [0.0; CLUSTER], radius: 0.0 };
        targets.add(lane, fixed, radius);
        targets
    }

    fn add(&mut self, lane: usize, fixed: [i64; D], radius: f32) {
        let Group { low, high, base } = &mut self.group;
        for axis in 0..D {
            low[axis] = low[axis].min(fixed[axis]);
            high[axis] = high[axis].max(fixed[axis]);
            self.places[axis][lane] = (fixed[axis] - base[axis]) as f32;
        }
        self.radii[lane] = radius;
        self.radius = self.radius.max(radius);
    }

    /// Whether any target reaches a source; counts it for those that do.
    #[inline(always)]
    fn test(
        &self,
        x: &[f32; D],
        radius: f32,
        rule: PairReach,
        counts: &mut [u32; CLUSTER],
    ) -> bool {
        let mut distance2 = [0.0_f32; CLUSTER];
        for (targets, x) in self.places.iter().zip(x) {
            for (distance2, target) in distance2.iter_mut().zip(targets) {
                let d = target - x;
                *distance2 += d * d;
            }
        }
        let mut any = false;
        for lane in 0..CLUSTER {
            let reach = match rule {
                PairReach::Mean => 0.5 * (self.radii[lane] + radius),
                PairReach::Max => self.radii[lane].max(radius),
                PairReach::Target => self.radii[lane],
            };
            let hit = distance2[lane] < reach * reach;
            counts[lane] += u32::from(hit);
            any |= hit;
        }
        any
    }
}
