//! The search in k-d trees: one query per tree for a group of targets, then a test of each pair.

use super::compress::{LANES, compress};
use super::plan::{PairReach, Plan};
use crate::TreeList;
use crate::trees::{Tree, TreeLevel, coordinates_of, is_inside};
use std::array::from_fn;
use std::ops::Range;
use wide::f64x4;

/// Blocks of candidates that are tested before their hits are read: their numbers fit 16 bits.
const WINDOW: usize = 4096;

/// Lanes of doubles.
const HALF: usize = LANES / 2;

/// Fills up blocks of candidates.
const NOBODY: u32 = u32::MAX;

/// Targets of a group are in a box of this edge, relative to the radius of the first. One and a half
/// measures about the same; with one half a search takes up to 2.6 times as long, since queries cost
/// more than tests.
const BOX: f64 = 1.0;

/// Candidates of a group, in canonical order, in whole blocks.
#[derive(Debug, Clone, Default)]
pub struct Near {
    /// Places in canonical order.
    places: Vec<u32>,
    /// Blocks of candidates, with the number of the image of the targets that they are near to.
    images: Vec<(Range<usize>, usize)>,
    /// Indices in the input of the trees.
    sources: Vec<u32>,
    tested: Tested,
}

/// What a test needs to know of candidates, and room for its hits.
#[derive(Debug, Clone, Default)]
struct Tested {
    /// Coordinates by axis.
    coordinates: Vec<Vec<f64>>,
    radii: Vec<f64>,
    /// Hits as numbers of candidates of a window.
    hits: Vec<u16>,
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
        from_fn(|axis| match (periods[axis], digit(image, axis)) {
            (Some(period), 1) => period,
            (Some(period), 2) => -period,
            _ => 0.0,
        })
    }

    /// Whether an image with this number exists.
    fn is_image(&self, image: usize) -> bool {
        let periods = self.trees.grid().periods();
        (0..D).all(|axis| digit(image, axis) == 0 || periods[axis].is_some())
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
        near.start(image);
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
        near.end();
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
        let target = coordinates_of(self.trees.grid(), target);
        for (blocks, image) in &near.images {
            let shift = self.shift(*image);
            for first in blocks.clone().step_by(WINDOW) {
                let window = first..blocks.end.min(first + WINDOW);
                let hits = match self.rule {
                    PairReach::Mean => {
                        let half = f64x4::splat(0.5);
                        let reach = |mine, theirs| (mine + theirs) * half;
                        near.tested.hits(window, &target, &shift, self.radii[t], reach)
                    }
                    PairReach::Max => {
                        let reach = f64x4::fast_max;
                        near.tested.hits(window, &target, &shift, self.radii[t], reach)
                    }
                    PairReach::Target => {
                        let reach = |mine, _| mine;
                        near.tested.hits(window, &target, &shift, self.radii[t], reach)
                    }
                };
                let sources = &near.sources[first * LANES..];
                let start = found.len();
                found.resize(start + hits.len(), 0);
                let room = &mut found[start..];
                let mut kept = 0;
                for &hit in hits {
                    let source = sources[usize::from(hit)];
                    room[kept] = source;
                    kept += usize::from(source != own);
                }
                found.truncate(start + kept);
            }
        }
    }
}

/// Digit of the number of an image that belongs to an axis.
fn digit(image: usize, axis: usize) -> usize {
    image / 3_usize.pow(axis as u32) % 3
}

impl Near {
    /// What follows are candidates near this image of the targets.
    fn start(&mut self, image: usize) {
        if self.images.last().is_none_or(|last| last.1 != image) {
            self.end();
            let block = self.places.len() / LANES;
            self.images.push((block..block, image));
        }
    }

    /// Ends the candidates near an image.
    fn end(&mut self) {
        self.places.resize(self.places.len().next_multiple_of(LANES), NOBODY);
        if let Some((blocks, _)) = self.images.last_mut() {
            blocks.end = self.places.len() / LANES;
        }
    }

    /// Copies what the tests need. Nobody hits the candidates that fill up a block.
    fn gather<const D: usize>(&mut self, trees: &TreeList<D>) {
        let Tested { coordinates, radii, hits } = &mut self.tested;
        let places = || self.places.iter().map(|&place| place as usize);
        coordinates.resize_with(D, Vec::new);
        for (axis, column) in coordinates.iter_mut().enumerate() {
            let along = |x: &[f64; D]| x[axis];
            column.clear();
            column
                .extend(places().map(|p| trees.coordinates().get(p).map_or(f64::INFINITY, along)));
        }
        radii.clear();
        radii.extend(places().map(|p| trees.radii().get(p).copied().unwrap_or(0.0)));
        self.sources.clear();
        self.sources.extend(places().map(|p| trees.order().get(p).copied().unwrap_or(0)));
        hits.resize(hits.len().max(WINDOW.min(self.places.len() / LANES) * LANES + LANES), 0);
    }
}

impl Tested {
    /// Numbers of the candidates in reach among some blocks, from the first of these on.
    ///
    /// `reach` is that of a pair, given both radii.
    #[inline(always)]
    fn hits<const D: usize>(
        &mut self,
        blocks: Range<usize>,
        target: &[f64; D],
        shift: &[f64; D],
        radius: f64,
        reach: impl Fn(f64x4, f64x4) -> f64x4,
    ) -> &[u16] {
        let columns: [&[[f64; HALF]]; D] =
            from_fn(|axis| &self.coordinates[axis].as_chunks().0[2 * blocks.start..2 * blocks.end]);
        let radii = &self.radii.as_chunks().0[2 * blocks.start..2 * blocks.end];
        let (target, shift) = (target.map(f64x4::splat), shift.map(f64x4::splat));
        let radius = f64x4::splat(radius);
        let pattern = |half: usize| {
            let mut distance2 = f64x4::ZERO;
            for axis in 0..D {
                // In this order both particles of a pair find the same distance.
                let d = (target[axis] - f64x4::from(columns[axis][half])) + shift[axis];
                distance2 += d * d;
            }
            let reach = reach(radius, f64x4::from(radii[half]));
            distance2.simd_lt(reach * reach).to_bitmask() as u8
        };
        let mut n = 0;
        for block in 0..blocks.len() {
            let Some(room) = self.hits[n..].first_chunk_mut() else {
                break;
            };
            let pattern = pattern(2 * block) | pattern(2 * block + 1) << HALF;
            n += compress(pattern, (block * LANES) as u16, room);
        }
        &self.hits[..n]
    }
}
