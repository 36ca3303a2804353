//! Blocks of the lattice instead of particles, for fields that do not fit into memory.

use super::{Geometry, lattice_error, nothing, overlap, thickness, too_many, walls};
use crate::scene::{Scene, SceneError};
use sph_geometry::{Lattice, Shape, Solid};
use std::collections::HashSet;

/// What a block stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BlockKind {
    /// Fluid on every lattice point.
    Fluid,
    /// A layer of wall particles within reach of fluid at the start.
    WetWall,
    /// A layer of wall particles without fluid nearby at the start.
    DryWall,
}

/// Blocks of `side`^D lattice points that sample the shapes of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample<const D: usize> {
    /// Lattice points along an edge of a whole block.
    pub side: i32,
    /// First index, index after the last, and kind of each block.
    pub blocks: Vec<([i32; D], [i32; D], BlockKind)>,
    /// Wall particles per lattice point of a block of walls.
    pub wall_density: f64,
}

/// Blocks of fluid that are aimed at, so that shapes are resolved and the work stays seconds.
const BLOCKS: f64 = 4e5;

/// Layers of the lattice in the domain. More than this are a typing error, and would not fit 32 bits.
const MOST_LAYERS: f64 = 1e7;

impl<const D: usize> Sample<D> {
    /// Samples the shapes of a scene with about 400 000 blocks, or one per particle when there are
    /// fewer. A block is taken when its middle is in the shape, and cut at the box around the shape,
    /// so that boxes of fluid are sampled exactly.
    ///
    /// # Errors
    ///
    /// When there is no fluid, or walls cannot be placed.
    pub fn new(scene: &Scene, geometry: &Geometry<D>) -> Result<Self, SceneError> {
        let size = |shape: &Shape<D>| {
            let bounds = shape.bounding_box();
            (0..D).map(|k| (bounds.max[k] - bounds.min[k]).max(0.0)).product::<f64>()
        };
        let cells = geometry.regions.iter().map(size).sum::<f64>()
            / geometry.lattice.spacing().powi(D as i32);
        let side = (cells / BLOCKS).powf(1.0 / D as f64).ceil().max(1.0) as i32;
        Self::with_side(scene, geometry, side)
    }

    /// Samples with blocks of `side` points along an edge.
    ///
    /// # Errors
    ///
    /// As [`Sample::new`].
    pub fn with_side(scene: &Scene, geometry: &Geometry<D>, side: i32) -> Result<Self, SceneError> {
        let (_, fluid) = scene.fluid()?;
        let side = side.max(1);
        let whole = geometry.domain.union(&geometry.fluid_box);
        let sides: [f64; D] =
            std::array::from_fn(|k| (whole.max[k] - whole.min[k]) / geometry.lattice.spacing());
        if sides.iter().any(|side| *side > MOST_LAYERS) {
            let why = "10 million along an axis are the most that are looked at";
            return Err(too_many(scene, sides.iter().product(), why));
        }
        let mut sample = Self { side, blocks: Vec::new(), wall_density: 1.0 };
        for index in 0..geometry.regions.len() {
            sample.add_region(&geometry.lattice, &geometry.regions[..=index], &geometry.solids);
        }
        if sample.blocks.is_empty() {
            return Err(nothing(scene, fluid));
        }
        sample.add_walls(scene, geometry)?;
        Ok(sample)
    }

    /// Lattice points of fluid.
    pub fn fluid(&self) -> f64 {
        self.points(|kind| kind == BlockKind::Fluid)
    }

    /// Wall particles.
    pub fn walls(&self) -> f64 {
        self.points(|kind| kind != BlockKind::Fluid) * self.wall_density
    }

    fn points(&self, choose: impl Fn(BlockKind) -> bool) -> f64 {
        let chosen = self.blocks.iter().filter(|(_, _, kind)| choose(*kind));
        let points = |first: &[i32; D], end: &[i32; D]| {
            (0..D).map(|k| f64::from(end[k] - first[k])).product::<f64>()
        };
        chosen.map(|(first, end, _)| points(first, end)).sum()
    }

    /// Adds the blocks of the last of `regions` that are in none of the earlier ones and in no solid.
    fn add_region(&mut self, lattice: &Lattice<D>, regions: &[Shape<D>], solids: &[Solid<D>]) {
        let Some((region, earlier)) = regions.split_last() else { return };
        let solids: Vec<Solid<D>> =
            solids.iter().filter(|solid| overlap::may_meet(solid, region)).cloned().collect();
        let bounds = region.bounding_box();
        let (origin, spacing) = (lattice.origin(), lattice.spacing());
        // Points on the surface are not inside, as for particles.
        let place = |x: f64, axis: usize| (x - origin[axis]) / spacing - 0.5;
        let first: [i32; D] =
            std::array::from_fn(|k| (place(bounds.min[k], k) + 1e-6).ceil() as i32);
        let end: [i32; D] =
            std::array::from_fn(|k| (place(bounds.max[k], k) - 1e-6).floor() as i32 + 1);
        let low = first.map(|i| i.div_euclid(self.side));
        let high: [i32; D] = std::array::from_fn(|k| (end[k] - 1).div_euclid(self.side) + 1);
        for cell in cells(low, high) {
            let from: [i32; D] = std::array::from_fn(|k| (cell[k] * self.side).max(first[k]));
            let to: [i32; D] = std::array::from_fn(|k| ((cell[k] + 1) * self.side).min(end[k]));
            let middle =
                std::array::from_fn(|k| origin[k] + 0.5 * f64::from(from[k] + to[k]) * spacing);
            let taken = || {
                earlier.iter().any(|shape| shape.contains(&middle))
                    || !overlap::is_free(&solids, &middle)
            };
            if (0..D).all(|k| from[k] < to[k]) && region.contains(&middle) && !taken() {
                self.blocks.push((from, to, BlockKind::Fluid));
            }
        }
    }

    /// Adds walls: whole layers of blocks, with as many particles as the thin layer really has.
    fn add_walls(&mut self, scene: &Scene, geometry: &Geometry<D>) -> Result<(), SceneError> {
        let fine = &geometry.lattice;
        let coarse = Lattice::new(fine.origin(), fine.spacing() * f64::from(self.side))
            .map_err(|error| lattice_error(scene, scene.numerics.spacing.place, &error))?;
        // Depths of the layers of particles are ½, 1½, … spacings.
        let layers = (*scene.numerics.support - 0.5 - 1e-6).ceil().max(1.0);
        let thick = (layers / f64::from(self.side)).ceil();
        self.wall_density = layers / (thick * f64::from(self.side));
        let support =
            if self.side == 1 { Geometry::<D>::support(scene) } else { thick * coarse.spacing() };
        let walls = if self.side == 1 {
            let Geometry { solids, domain, .. } = geometry;
            let thin = thickness::thin_solids(scene, solids, &coarse, domain, support);
            walls::find_walls(scene, solids, &thin, &coarse, domain, support)?.positions
        } else {
            // Blocks cannot be cut: a block is wall when its middle is.
            walls::find_cells(scene, &geometry.solids, &coarse, &geometry.domain, support)?
        };
        let block = |x: &[f64; D]| -> [i32; D] {
            std::array::from_fn(|k| {
                ((x[k] - coarse.origin()[k]) / coarse.spacing() - 0.5).round() as i32
            })
        };
        let wet: HashSet<[i32; D]> = self
            .blocks
            .iter()
            .map(|(first, _, _)| first.map(|i| i.div_euclid(self.side)))
            .collect();
        let reach = (Geometry::<D>::reach(scene) / coarse.spacing()).ceil() as i32;
        for x in &walls {
            let cell = block(x);
            let around = cells(cell.map(|i| i - reach), cell.map(|i| i + reach + 1));
            let kind = if around.into_iter().any(|cell| wet.contains(&cell)) {
                BlockKind::WetWall
            } else {
                BlockKind::DryWall
            };
            self.blocks.push((
                cell.map(|i| i * self.side),
                cell.map(|i| (i + 1) * self.side),
                kind,
            ));
        }
        Ok(())
    }
}

/// All indices from `low` to before `high`, the first axis fastest.
fn cells<const D: usize>(low: [i32; D], high: [i32; D]) -> impl Iterator<Item = [i32; D]> {
    let sides: [usize; D] = std::array::from_fn(|k| (high[k] - low[k]).max(0) as usize);
    (0..sides.iter().product()).map(move |number: usize| {
        let mut rest = number;
        std::array::from_fn(|k| {
            let place = rest % sides[k];
            rest /= sides[k];
            low[k] + place as i32
        })
    })
}
