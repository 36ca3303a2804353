//! What is searched: one reach for all pairs, or a reach from the radii of each pair.

use super::compress::LANES;
use super::query::{Group, Query, margin};
use super::search::Search;
use crate::{CellList, Grid, LevelList};
use std::ops::Range;
use wide::f32x8;

/// How the reach of a pair follows from the radii of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PairReach {
    /// The mean of both radii.
    Mean,
    /// The larger radius.
    Max,
    /// The radius of the target alone: for sources that have none of their own, such as the elements
    /// of a wall. Pairs are then not symmetric.
    Target,
}

impl PairReach {
    /// Reach of a pair of a target of radius `a` and a source of radius `b`.
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Mean => 0.5 * (a + b),
            Self::Max => a.max(b),
            Self::Target => a,
        }
    }
}

/// How the candidates of targets are found and tested.
pub trait Plan<const D: usize>: Sync {
    /// A group of targets.
    type Group;

    /// Where the candidates of a group are kept.
    type Memory;

    /// The group that starts `targets`, the first of which has the number `first`, with its length;
    /// none for a target that has no place.
    fn group(&self, first: usize, targets: &[[f64; D]]) -> (usize, Option<Self::Group>);

    /// Finds the candidates of a group, in place of those of the last one.
    fn collect(&self, group: &Self::Group, memory: &mut Self::Memory);

    /// Drops candidates that no target of the group can reach.
    fn cull(&self, group: &Self::Group, memory: &mut Self::Memory);

    /// Number of candidates.
    fn candidates(memory: &Self::Memory) -> usize;

    /// Appends the neighbours of target number `t` of the group, but for `own`.
    fn test(
        &self,
        group: &Self::Group,
        t: usize,
        target: &[f64; D],
        memory: &mut Self::Memory,
        own: u32,
        found: &mut Vec<u32>,
    );
}

/// One reach for all pairs.
#[derive(Debug)]
pub struct Uniform<'a, const D: usize> {
    pub cells: &'a CellList<D>,
    pub query: Query,
}

impl<const D: usize> Plan<D> for Uniform<'_, D> {
    type Group = Group<D>;
    type Memory = Search;

    fn group(&self, _: usize, targets: &[[f64; D]]) -> (usize, Option<Group<D>>) {
        let Query { group_cells, drop, .. } = self.query;
        Group::first(self.cells.grid(), group_cells, drop, targets, |_| true)
    }

    fn collect(&self, group: &Group<D>, search: &mut Search) {
        search.clear::<D>();
        search.collect(self.cells, group, self.query.reach, self.query.drop, None, |_| None);
    }

    fn cull(&self, group: &Group<D>, search: &mut Search) {
        let threshold = f32x8::splat(self.query.threshold);
        search.cull(group, self.query.drop, |_, _| threshold);
    }

    fn candidates(search: &Search) -> usize {
        search.candidates()
    }

    fn test(
        &self,
        group: &Group<D>,
        _: usize,
        target: &[f64; D],
        search: &mut Search,
        own: u32,
        found: &mut Vec<u32>,
    ) {
        let threshold = f32x8::splat(self.query.threshold);
        let target = self.cells.grid().fixed(target);
        search.test(group, &target, self.query.drop, |_, _| threshold, own, found);
    }
}

/// A reach from the radii of each pair.
#[derive(Debug)]
pub struct Variable<'a, const D: usize> {
    levels: &'a LevelList<D>,
    /// Radii of the targets.
    radii: &'a [f64],
    rule: PairReach,
}

/// Radius in units, with a margin for the rounding of coordinates and of the test.
pub fn radius_in_units<const D: usize>(grid: &Grid<D>, radius: f64) -> f32 {
    (radius * grid.units_per_length() + margin::<D>() + 2.0) as f32
}

impl<'a, const D: usize> Variable<'a, D> {
    /// # Panics
    ///
    /// When the radius of a target is negative, not a number, or too large for the grid.
    pub fn new(levels: &'a LevelList<D>, radii: &'a [f64], rule: PairReach) -> Self {
        if let Some(error) = radii.iter().find_map(|&r| levels.grid().check_radius(r).err()) {
            panic!("{error}");
        }
        Self { levels, radii, rule }
    }
}

/// A group of targets with its largest radius, in units.
#[derive(Debug)]
pub struct GroupWithRadius<const D: usize> {
    group: Group<D>,
    radius: f32,
}

impl<const D: usize> Plan<D> for Variable<'_, D> {
    type Group = GroupWithRadius<D>;
    type Memory = Search;

    fn group(&self, first: usize, targets: &[[f64; D]]) -> (usize, Option<Self::Group>) {
        let grid = self.levels.grid();
        let radii = &self.radii[first..first + targets.len()];
        let grid_of_level = grid.finer(grid.level(radii[0]));
        // Radii of the level, or nearly so: their targets share candidates.
        let range = grid_of_level.cell_size()..=2.0 * grid_of_level.cell_size();
        let fits = |k: usize| range.contains(&radii[k]);
        // Of about a radius together.
        let width = if radii[0] < 1.5 * grid_of_level.cell_size() { 1 } else { 2 };
        let (length, group) = Group::first(&grid_of_level, width, 0, targets, fits);
        let radius = radii[..length].iter().copied().fold(0.0, f64::max);
        let radius = radius_in_units(grid, radius);
        (length, group.map(|group| GroupWithRadius { group, radius }))
    }

    fn collect(&self, group: &Self::Group, search: &mut Search) {
        search.clear::<D>();
        for level in self.levels.levels() {
            let reach = |radius: f32| self.rule.of(f64::from(group.radius), f64::from(radius));
            let closer = |cells: Range<usize>| {
                let cells = level.largest_in_cell[cells].iter();
                // Unlike f32::max this is one instruction.
                Some(reach(cells.fold(0.0, |max, &r| if r > max { r } else { max })))
            };
            let largest = reach(level.largest_radius);
            search.collect(&level.cells, &group.group, largest, 0, Some(&level.radii), closer);
        }
    }

    fn cull(&self, group: &Self::Group, search: &mut Search) {
        match self.rule {
            PairReach::Mean => search.cull(&group.group, 0, mean(group.radius)),
            PairReach::Max => search.cull(&group.group, 0, max(group.radius)),
            PairReach::Target => search.cull(&group.group, 0, mine(group.radius)),
        }
    }

    fn candidates(search: &Search) -> usize {
        search.candidates()
    }

    fn test(
        &self,
        group: &Self::Group,
        t: usize,
        target: &[f64; D],
        search: &mut Search,
        own: u32,
        found: &mut Vec<u32>,
    ) {
        let grid = self.levels.grid();
        let (target, group) = (grid.fixed(target), &group.group);
        let radius = radius_in_units(grid, self.radii[t]);
        match self.rule {
            PairReach::Mean => search.test(group, &target, 0, mean(radius), own, found),
            PairReach::Max => search.test(group, &target, 0, max(radius), own, found),
            PairReach::Target => search.test(group, &target, 0, mine(radius), own, found),
        }
    }
}

/// Squares of the mean of a radius and those of a block of candidates.
fn mean(mine: f32) -> impl Fn(&[[f32; LANES]], usize) -> f32x8 {
    let mine = f32x8::splat(mine);
    move |radii, block| {
        let reach = (mine + f32x8::from(radii[block])) * f32x8::HALF;
        reach * reach
    }
}

/// Squares of the larger of a radius and those of a block of candidates.
fn max(mine: f32) -> impl Fn(&[[f32; LANES]], usize) -> f32x8 {
    let mine = f32x8::splat(mine);
    move |radii, block| {
        let reach = mine.fast_max(f32x8::from(radii[block]));
        reach * reach
    }
}

/// The square of a radius, whatever those of a block of candidates.
fn mine(mine: f32) -> impl Fn(&[[f32; LANES]], usize) -> f32x8 {
    let mine = f32x8::splat(mine);
    move |_, _| mine * mine
}
