//! The search in k-d trees: one query per tree for a group of targets, then a test of each pair.

use super::plan::{PairReach, Plan};
use crate::TreeList;
use crate::trees::{Tree, TreeLevel, coordinates_of, is_inside};
use std::array::from_fn;
use std::ops::Range;
use wide::f64x4;

/// Lanes of a test.
const LANES: usize = 4;

/// Targets of a group are in a box of this edge, relative to the radius of the first. A larger box
/// takes fewer queries and more tests; between a quarter and one the cost is about the same.
const BOX: f64 = 0.5;

/// Candidates of a group, in canonical order.
#[derive(Debug, Clone, Default)]
pub struct Near {
    /// Places in canonical order.
    places: Vec<u32>,
    /// Coordinates by axis, and radii, in whole blocks.
    coordinates: Vec<Vec<f64>>,
    radii: Vec<f64>,
    /// Candidates with the image of the targets that they are near to.
    images: Vec<(Range<usize>, usize)>,
}

/// The search in the trees of a [`TreeList`].
#[derive(Debug)]
pub struct Trees<'a, const D: usize> {
    trees: &'a TreeList<D>,
    /// Radii of the targets.
    radii: &'a [f64],
    rule: PairReach,
}

/// Targets that are close together.
#[derive(Debug)]
pub struct Group<const D: usize> {
    centre: [f64; D],
    /// Distance of the farthest target from the centre.
    size: f64,
    /// Largest radius.
    radius: f64,
}

impl<'a, const D: usize> Trees<'a, D> {
    /// # Panics
    ///
    /// When the radius of a target is negative, not a number, or too large for the grid.
    pub fn new(trees: &'a TreeList<D>, radii: &'a [f64], rule: PairReach) -> Self {
        if let Some(error) = radii.iter().find_map(|&r| trees.grid().check_radius(r).err()) {
            panic!("{error}");
        }
        Self { trees, radii, rule }
    }

    /// What is added to coordinates of targets for their image with this number: digits 0, 1, 2 mean
    /// no shift, up, down, as in the other searches.
    fn shift(&self, image: usize) -> [f64; D] {
        let periods = self.trees.grid().periods();
        from_fn(|axis| match (periods[axis], image / 3_usize.pow(axis as u32) % 3) {
            (Some(period), 1) => period,
            (Some(period), 2) => -period,
            _ => 0.0,
        })
    }

    /// Whether an image with this number exists.
    fn is_image(&self, image: usize) -> bool {
        let periods = self.trees.grid().periods();
        (0..D).all(|axis| image / 3_usize.pow(axis as u32) % 3 == 0 || periods[axis].is_some())
    }

    /// Adds the candidates of a level, near an image of a group.
    fn collect_level(&self, group: &Group<D>, level: &TreeLevel<D>, image: usize, near: &mut Near) {
        let shift = self.shift(image);
        let centre = from_fn(|axis| group.centre[axis] + shift[axis]);
        let reach = self.rule.of(group.radius, level.largest_radius) + group.size;
        let slack = Tree::slack(&centre, reach);
        let most = reach + slack;
        if (0..D).any(|a| centre[a] + most < level.low[a] || centre[a] - most > level.high[a]) {
            return;
        }
        let first = near.places.len();
        level.tree.for_each_within(&centre, most, |item, distance2| {
            let place = level.first + item;
            let radius = self.trees.radii()[place as usize];
            let reach = self.rule.of(group.radius, radius) + group.size + slack;
            if distance2 <= reach * reach {
                near.places.push(place);
            }
        });
        near.places[first..].sort_unstable();
        let last = near.places.len();
        match near.images.last_mut() {
            Some((range, number)) if *number == image => range.end = last,
            _ if first < last => near.images.push((first..last, image)),
            _ => {}
        }
    }
}

impl<const D: usize> Plan<D> for Trees<'_, D> {
    type Group = Group<D>;
    type Memory = Near;

    fn group(&self, first: usize, targets: &[[f64; D]]) -> (usize, Option<Group<D>>) {
        let grid = self.trees.grid();
        if !is_inside(&targets[0]) {
            return (1, None);
        }
        let radii = &self.radii[first..first + targets.len()];
        let similar = 0.5 * radii[0]..=2.0 * radii[0];
        let mut low = coordinates_of(grid, &targets[0]);
        let (mut high, mut length) = (low, 1);
        for (x, radius) in targets.iter().zip(radii).skip(1) {
            let x = coordinates_of(grid, x);
            let wider: [_; D] = from_fn(|axis| (low[axis].min(x[axis]), high[axis].max(x[axis])));
            let fits = wider.iter().all(|(low, high)| high - low <= BOX * radii[0]);
            if !(fits && similar.contains(radius)) {
                break;
            }
            (low, high) = (wider.map(|w| w.0), wider.map(|w| w.1));
            length += 1;
        }
        let centre: [f64; D] = from_fn(|axis| low[axis] + 0.5 * (high[axis] - low[axis]));
        let corner = (0..D).map(|a| (high[a] - centre[a]).max(centre[a] - low[a]).powi(2));
        let size = corner.sum::<f64>().sqrt();
        let radius = radii[..length].iter().copied().fold(0.0, f64::max);
        (length, Some(Group { centre, size, radius }))
    }

    fn collect(&self, group: &Group<D>, near: &mut Near) {
        near.places.clear();
        near.images.clear();
        let images = 3_usize.pow(D as u32);
        for level in self.trees.levels() {
            for image in (0..images).filter(|&image| self.is_image(image)) {
                self.collect_level(group, level, image, near);
            }
        }
        near.gather(self.trees);
    }

    /// Candidates are near the group from the start.
    fn cull(&self, _: &Group<D>, _: &mut Near) {}

    fn candidates(near: &Near) -> usize {
        near.places.len()
    }

    fn test(
        &self,
        _: &Group<D>,
        t: usize,
        target: &[f64; D],
        near: &mut Near,
        own: u32,
        found: &mut Vec<u32>,
    ) {
        let target = coordinates_of(self.trees.grid(), target).map(f64x4::splat);
        let mine = f64x4::splat(self.radii[t]);
        let order = self.trees.order();
        for (range, image) in &near.images {
            let shift = self.shift(*image).map(f64x4::splat);
            for block in range.start / LANES..range.end.div_ceil(LANES) {
                let mut distance2 = f64x4::ZERO;
                for axis in 0..D {
                    // In this order both particles of a pair find the same distance.
                    let x = f64x4::from(near.coordinates[axis].as_chunks().0[block]);
                    let d = (target[axis] - x) + shift[axis];
                    distance2 += d * d;
                }
                let theirs = f64x4::from(near.radii.as_chunks().0[block]);
                let reach = match self.rule {
                    PairReach::Mean => (mine + theirs) * f64x4::HALF,
                    PairReach::Max => mine.fast_max(theirs),
                };
                let hits = distance2.simd_lt(reach * reach).to_bitmask();
                for lane in 0..LANES {
                    let number = block * LANES + lane;
                    if hits >> lane & 1 == 1 && range.contains(&number) {
                        let source = order[near.places[number] as usize];
                        if source != own {
                            found.push(source);
                        }
                    }
                }
            }
        }
    }
}

impl Near {
    /// Copies what the tests need.
    fn gather<const D: usize>(&mut self, trees: &TreeList<D>) {
        let room = self.places.len().next_multiple_of(LANES);
        self.coordinates.resize_with(D, Vec::new);
        for (axis, column) in self.coordinates.iter_mut().enumerate() {
            column.clear();
            column.extend(self.places.iter().map(|&p| trees.coordinates()[p as usize][axis]));
            column.resize(room, f64::INFINITY);
        }
        self.radii.clear();
        self.radii.extend(self.places.iter().map(|&p| trees.radii()[p as usize]));
        self.radii.resize(room, 0.0);
    }
}
