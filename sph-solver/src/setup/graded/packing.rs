//! Packing: particles move until sums over neighbours are even.
//!
//! Source: Colagrossi, Bouscasse, Antuono & Marrone (2012), "Particle packing algorithm for SPH schemes",
//! Comput. Phys. Commun. 183: particles follow −Σ ∇W V over the fluid and all that surrounds it, which
//! vanishes where neighbours lie evenly. Here with a spacing that varies from place to place, which a
//! particle takes on as it moves.

use super::super::{Geometry, overlap};
use super::GradedFluid;
use super::seeds::Seeds;
use crate::grading::root;
use crate::scene::{ErrorKind, Scene, SceneError};
use crate::space::{offset, wrapped};
use crate::terms::{WallPair, WallPush, WallStretch};
use rayon::prelude::*;
use sph_geometry::{SpacingField, WallElements};
use sph_kernels::{Kernel, WendlandC2};
use sph_neighbors::{Grid, GridError, LevelList, NeighborList, PairReach};

/// How often particles move at most.
const MOVES: usize = 320;

/// They stop when s |Σ ∇W V| is smaller than this in the mean square. Under gravity a particle is set in
/// motion by what is left times the pressure, which is largest at the floor …
const EVEN: f64 = 3e-4;

/// … and without gravity there is no pressure at the start.
const EVEN_ENOUGH: f64 = 2e-3;

/// A particle moves by this times −s² Σ ∇W V, s its spacing …
const RATE: f64 = 0.3;

/// … and by this share of its last move again: the heavy ball of Polyak (1964), USSR Comput. Math. Math.
/// Phys. 4, which needs a fraction of the moves.
const MEMORY: f64 = 0.92;

/// The most that it moves at a time, in spacings.
const FARTHEST: f64 = 0.2;

/// Lists reach this much farther than the support, so that they last some moves.
const SLACK: f64 = 1.2;

/// Moves between two lists.
const LIFE: usize = 8;

/// Packs the seeds that are not fixed, between those that are and the elements of what is no fluid.
///
/// # Errors
///
/// When the domain is too large for the search of neighbours.
pub fn packed<const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    field: &SpacingField<D>,
    seeds: Seeds<D>,
    around: &WallElements<D>,
) -> Result<GradedFluid<D>, SceneError> {
    let even = if scene.gravity::<D>() == [0.0; D] { EVEN_ENOUGH } else { EVEN };
    let pack = || {
        let mut packing = Packing::new(scene, geometry, field, seeds, around)?;
        for turn in 0..MOVES {
            if turn % LIFE == 0 {
                packing.find_neighbours()?;
            }
            if packing.advance() <= even * even {
                break;
            }
        }
        Ok(packing.finish())
    };
    pack().map_err(|error: GridError| {
        let kind = ErrorKind::Invalid {
            what: format!("particles of this spacing cannot be packed: {error}"),
            help: "give a smaller [domain] or a larger numerics.spacing".into(),
        };
        scene.error(scene.numerics.spacing.place, kind)
    })
}

/// Particles that are being packed.
struct Packing<'a, const D: usize> {
    geometry: &'a Geometry<D>,
    field: &'a SpacingField<D>,
    periods: [Option<f64>; D],
    /// Support radius in spacings.
    supports: f64,
    grid: Grid<D>,
    position: Vec<[f64; D]>,
    spacing: Vec<f64>,
    /// Where the regions end in them.
    ends: Vec<usize>,
    /// Those that move, and what they fill, m^D.
    loose: Vec<u32>,
    loose_volume: f64,
    /// Their last moves, m.
    moves: Vec<[f64; D]>,
    /// Fluid and elements of what is no fluid near each of them.
    near: NeighborList,
    beside: NeighborList,
    around: &'a WallElements<D>,
    elements: LevelList<D>,
}

impl<'a, const D: usize> Packing<'a, D> {
    fn new(
        scene: &Scene,
        geometry: &'a Geometry<D>,
        field: &'a SpacingField<D>,
        seeds: Seeds<D>,
        around: &'a WallElements<D>,
    ) -> Result<Self, GridError> {
        let Seeds { position, fixed, ends, loose_volume } = seeds;
        let loose: Vec<u32> = (0..position.len() as u32).filter(|&i| !fixed[i as usize]).collect();
        let supports = *scene.numerics.support;
        let domain = &geometry.domain;
        let periodic = scene.periodic_axes::<D>();
        let periods = std::array::from_fn(|k| periodic[k].then(|| domain.max[k] - domain.min[k]));
        let reach = SLACK * supports * field.coarsest();
        let grid = Grid::new(domain.min, 0.5 * reach)?.periodic(periods)?;
        let ids: Vec<u64> = (0..around.positions.len() as u64).collect();
        let radii: Vec<f64> = around.volumes.iter().map(|v| supports * root::<D>(*v)).collect();
        Ok(Self {
            geometry,
            field,
            periods,
            supports,
            grid,
            spacing: position.iter().map(|x| field.at(x)).collect(),
            position,
            ends,
            moves: vec![[0.0; D]; loose.len()],
            loose,
            loose_volume,
            near: NeighborList::default(),
            beside: NeighborList::default(),
            around,
            elements: LevelList::build(&grid, &around.positions, &radii, &ids)?,
        })
    }

    fn find_neighbours(&mut self) -> Result<(), GridError> {
        let Self { position, spacing, loose, elements, .. } = self;
        let radii: Vec<f64> = spacing.iter().map(|s| SLACK * self.supports * s).collect();
        let ids: Vec<u64> = (0..position.len() as u64).collect();
        let levels = LevelList::build(&self.grid, position, &radii, &ids)?;
        let targets: Vec<[f64; D]> = loose.iter().map(|&i| position[i as usize]).collect();
        let reaches: Vec<f64> = loose.iter().map(|&i| radii[i as usize]).collect();
        let (near, beside) = (&mut self.near, &mut self.beside);
        near.rebuild_with_radii(&levels, &targets, &reaches, |t| loose[t], PairReach::Mean, 1);
        let nobody = |_| u32::MAX;
        beside.rebuild_with_radii(elements, &targets, &reaches, nobody, PairReach::Target, 1);
        Ok(())
    }

    /// Moves every loose particle once; returns the mean of (s |Σ ∇W V|)² before.
    fn advance(&mut self) -> f64 {
        let count = self.loose.len();
        let sums: Vec<[f64; D]> =
            (0..count).into_par_iter().with_min_len(256).map(|t| self.sum(t)).collect();
        let mut left = 0.0;
        for (t, sum) in sums.iter().enumerate() {
            let i = self.loose[t] as usize;
            let own = self.spacing[i];
            left += own * own * square(sum);
            let factor = RATE * own * own;
            let mut step: [f64; D] =
                std::array::from_fn(|k| MEMORY * self.moves[t][k] - factor * sum[k]);
            let (length, most) = (square(&step).sqrt(), FARTHEST * own);
            if length > most {
                step = step.map(|c| c * (most / length));
            }
            let moved = std::array::from_fn(|k| self.position[i][k] + step[k]);
            let moved = wrapped(moved, &self.geometry.domain.min, &self.periods);
            if self.is_fluid(&moved) {
                self.position[i] = moved;
                self.spacing[i] = self.field.at(&moved);
                self.moves[t] = step;
            } else {
                self.moves[t] = [0.0; D];
            }
        }
        left / count.max(1) as f64
    }

    /// Σ ∇W V of a loose particle over the fluid and what surrounds it, 1/m.
    fn sum(&self, t: usize) -> [f64; D] {
        let i = self.loose[t] as usize;
        let (x, own) = (&self.position[i], self.spacing[i]);
        let mut sum = [0.0; D];
        for &j in self.near.neighbors(t) {
            let j = j as usize;
            let other = self.spacing[j];
            let radius = 0.5 * self.supports * (own + other);
            let r = self.offset(x, &self.position[j]);
            let distance2 = square(&r);
            if distance2 < radius * radius {
                let factor = gradient::<D>(radius, distance2.sqrt()) * volume_of::<D>(other);
                (0..D).for_each(|k| sum[k] += factor * r[k]);
            }
        }
        let walls = self.beside.neighbors(t);
        if walls.is_empty() {
            return sum;
        }
        // What a wall does in a run: it pushes and leans as there.
        let slope = self.slope(x, own);
        let stretch = Some(WallStretch {
            ratio: 1.0,
            inverse: 1.0,
            lean: slope.map(|slope| -0.5 * slope / own),
        });
        let radius = self.supports * own;
        let mut push = WallPush::<D, f64>::zero();
        for &w in walls {
            let w = w as usize;
            let offset = self.offset(x, &self.around.positions[w]);
            let distance2 = square(&offset);
            if distance2 >= radius * radius {
                continue;
            }
            let pair = WallPair {
                offset,
                distance2,
                normal: self.around.normals[w],
                depth: self.around.depths[w],
                weight: gradient::<D>(radius, distance2.sqrt()) * self.around.volumes[w],
                squeezed: None,
                unit: 1.0,
                per_unit: 1.0,
                stretch,
            };
            push.add(1.0, 0.0, &pair);
        }
        let push = push.felt(1.0);
        std::array::from_fn(|k| sum[k] + push[k])
    }

    /// `x − y`, to the nearest image.
    #[inline]
    fn offset(&self, x: &[f64; D], y: &[f64; D]) -> [f64; D] {
        if self.periods == [None; D] {
            std::array::from_fn(|k| x[k] - y[k])
        } else {
            offset(x, y, &self.periods)
        }
    }

    /// The slope of the spacing at a place where it is `spacing` (m).
    fn slope(&self, x: &[f64; D], spacing: f64) -> [f64; D] {
        let step = 0.5 * spacing;
        std::array::from_fn(|k| {
            let at = |way: f64| {
                let mut y = *x;
                y[k] += way * step;
                self.field.at(&y)
            };
            (at(1.0) - at(-1.0)) / (2.0 * step)
        })
    }

    fn is_fluid(&self, x: &[f64; D]) -> bool {
        self.geometry.domain.contains(x)
            && self.geometry.regions.iter().any(|region| region.contains(x))
            && overlap::is_free(&self.geometry.solids, x)
    }

    fn finish(self) -> GradedFluid<D> {
        let Self { position, spacing, ends, loose, loose_volume, .. } = self;
        let mut volume: Vec<f64> = spacing.iter().map(|s| volume_of::<D>(*s)).collect();
        // The water that is there, not a little more or less.
        let packed: f64 = loose.iter().map(|&i| volume[i as usize]).sum();
        for &i in &loose {
            volume[i as usize] *= loose_volume / packed;
        }
        GradedFluid { position, volume, ends }
    }
}

/// F with ∇W = F r at a distance (m) in a support of this radius (m).
#[inline]
fn gradient<const D: usize>(radius: f64, distance: f64) -> f64 {
    let inverse = 1.0 / radius;
    let square = inverse * inverse;
    let factor = if D == 2 { square * square } else { square * square * inverse };
    WendlandC2::norm(D) * factor * WendlandC2::slope(distance * inverse)
}

/// Volume of a particle of this spacing (m), m^D.
#[inline]
fn volume_of<const D: usize>(spacing: f64) -> f64 {
    if D == 2 { spacing * spacing } else { spacing * spacing * spacing }
}

#[inline]
fn square<const D: usize>(r: &[f64; D]) -> f64 {
    r.iter().map(|c| c * c).sum()
}
