//! What is searched: one reach for all pairs, or a reach from the radii of each pair.

use super::compress::LANES;
use super::query::{Group, Query, margin};
use super::search::Search;
use crate::{CellList, Grid, LevelList};
use wide::f32x8;

/// How the reach of a pair follows from the radii of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PairReach {
    /// The mean of both radii.
    Mean,
    /// The larger radius.
    Max,
}

impl PairReach {
    /// Reach of a pair.
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Mean => 0.5 * (a + b),
            Self::Max => a.max(b),
        }
    }
}

/// How the candidates of targets are found and tested.
pub trait Plan<const D: usize>: Sync {
    /// A group of targets.
    type Group;

    /// The group that starts `targets`, the first of which has the number `first`, with its length;
    /// none for a target that has no place.
    fn group(&self, first: usize, targets: &[[f64; D]]) -> (usize, Option<Self::Group>);

    /// Adds the candidates of a group.
    fn collect(&self, group: &Self::Group, search: &mut Search);

    /// Appends the neighbours of target number `t` of the group, but for `own`.
    fn test(
        &self,
        group: &Self::Group,
        t: usize,
        target: &[f64; D],
        search: &mut Search,
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

    fn group(&self, _: usize, targets: &[[f64; D]]) -> (usize, Option<Group<D>>) {
        Group::first(self.cells.grid(), self.query.group_cells, self.query.drop, targets)
    }

    fn collect(&self, group: &Group<D>, search: &mut Search) {
        search.collect(self.cells, group, self.query.reach, self.query.drop, None);
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

/// Targets of a group are in this many cells of their level along x: of about a radius together.
const GROUP_CELLS: i64 = 2;

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

    fn group(&self, first: usize, targets: &[[f64; D]]) -> (usize, Option<Self::Group>) {
        let grid = self.levels.grid();
        let radii = &self.radii[first..first + targets.len()];
        let level = grid.level(radii[0]);
        let same = radii.iter().take_while(|&&radius| grid.level(radius) == level).count();
        let (length, group) = Group::first(&grid.finer(level), GROUP_CELLS, 0, &targets[..same]);
        let radius = radii[..length].iter().copied().fold(0.0, f64::max);
        let radius = radius_in_units(grid, radius);
        (length, group.map(|group| GroupWithRadius { group, radius }))
    }

    fn collect(&self, group: &Self::Group, search: &mut Search) {
        for level in self.levels.levels() {
            let reach = self.rule.of(f64::from(group.radius), f64::from(level.largest_radius));
            search.collect(&level.cells, &group.group, reach, 0, Some(&level.radii));
        }
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
        let mine = f32x8::splat(radius_in_units(grid, self.radii[t]));
        match self.rule {
            PairReach::Mean => {
                let mean = |radii: &[[f32; LANES]], block: usize| {
                    let reach = (mine + f32x8::from(radii[block])) * f32x8::HALF;
                    reach * reach
                };
                search.test(group, &target, 0, mean, own, found);
            }
            PairReach::Max => {
                let max = |radii: &[[f32; LANES]], block: usize| {
                    let reach = mine.fast_max(f32x8::from(radii[block]));
                    reach * reach
                };
                search.test(group, &target, 0, max, own, found);
            }
        }
    }
}
