//! Packing: particles move until sums over neighbours are even.
//!
//! Source: Colagrossi, Bouscasse, Antuono & Marrone (2012), "Particle packing algorithm for SPH schemes",
//! Comput. Phys. Commun. 183: particles follow −Σ ∇W V over the fluid and all that surrounds it, which
//! vanishes where neighbours lie evenly. Here with a spacing that varies from place to place, which a
//! particle takes on as it moves.

use super::super::{Geometry, overlap};
use super::seeds::Seeds;
use crate::scene::{Scene, SceneError};
use crate::space::{offset, wrapped};
use crate::terms::{WallPair, WallPush, WallStretch};
use sph_geometry::{Aabb, SpacingField, WallElements};
use sph_kernels::{Kernel, WendlandC2};
use sph_neighbors::{Grid, LevelList, NeighborList, PairReach};

/// How often particles move at most.
const MOVES: usize = 320;

/// They stop when s |Σ ∇W V| is smaller than this in the mean square. Under gravity a particle is set in
/// motion by what is left times the pressure, which is largest at the floor …
const EVEN: f64 = 3e-4;

/// … and without gravity there is no pressure at the start.
const EVEN_ENOUGH: f64 = 2e-3;

/// A particle moves by this times −s² Σ ∇W V, s its spacing …
const RATE: f64 = 0.3;

/// … and by this share of its last move again (the heavy ball of Polyak 1964), which halves what is left
/// after so many moves, and halves it again.
const MEMORY: f64 = 0.92;

/// The most that it moves at a time, in spacings.
const FARTHEST: f64 = 0.2;

/// Lists reach this much farther than the support, so that they last some moves.
const SLACK: f64 = 1.2;

/// Moves between two lists.
const LIFE: usize = 8;

/// Particles that are packed.
#[derive(Debug)]
pub struct Packed<const D: usize> {
    /// Positions, m.
    pub position: Vec<[f64; D]>,
    /// Volumes, m^D.
    pub volume: Vec<f64>,
}

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
) -> Result<Packed<D>, SceneError> {
    let Seeds { mut position, fixed, loose_volume } = seeds;
    let loose: Vec<u32> = (0..position.len() as u32).filter(|&i| !fixed[i as usize]).collect();
    let supports = *scene.numerics.support;
    let mut spacing: Vec<f64> = position.iter().map(|x| field.at(x)).collect();
    let search = |error: sph_neighbors::GridError| {
        let kind = crate::scene::ErrorKind::Invalid {
            what: format!("particles of this spacing cannot be packed: {error}"),
            help: "give a smaller [domain] or a larger numerics.spacing".into(),
        };
        scene.error(scene.numerics.spacing.place, kind)
    };
    let domain = &geometry.domain;
    let periodic = scene.periodic_axes::<D>();
    let periods: [Option<f64>; D] =
        std::array::from_fn(|k| periodic[k].then(|| domain.max[k] - domain.min[k]));
    let reach = SLACK * supports * field.coarsest();
    let grid = Grid::new(domain.min, 0.5 * reach).and_then(|grid| grid.periodic(periods));
    let grid = grid.map_err(search)?;
    let place = Place { geometry, domain, periods };
    let norm = WendlandC2::norm(D);
    let gradient = |radius: f64, distance: f64| {
        let inverse = 1.0 / radius;
        let square = inverse * inverse;
        let factor = if D == 2 { square * square } else { square * square * inverse };
        norm * factor * WendlandC2::slope(distance * inverse)
    };
    let even = if scene.gravity::<D>() == [0.0; D] { EVEN_ENOUGH } else { EVEN };
    let elements = Elements::new(&grid, around, supports).map_err(search)?;
    let (mut near, mut beside) = (NeighborList::default(), NeighborList::default());
    let mut moves = vec![[0.0; D]; loose.len()];
    for turn in 0..MOVES {
        let targets: Vec<[f64; D]> = loose.iter().map(|&i| position[i as usize]).collect();
        if turn % LIFE == 0 {
            let radii: Vec<f64> = spacing.iter().map(|s| SLACK * supports * s).collect();
            let ids: Vec<u64> = (0..position.len() as u64).collect();
            let levels = LevelList::build(&grid, &position, &radii, &ids).map_err(search)?;
            let of_loose: Vec<f64> = loose.iter().map(|&i| radii[i as usize]).collect();
            let mean = PairReach::Mean;
            near.rebuild_with_radii(&levels, &targets, &of_loose, |t| loose[t], mean, 1);
            let target = PairReach::Target;
            beside.rebuild_with_radii(
                &elements.levels,
                &targets,
                &of_loose,
                |_| u32::MAX,
                target,
                1,
            );
        }
        let step = |t: usize| -> ([f64; D], f64) {
            let (x, own) = (&targets[t], spacing[loose[t] as usize]);
            let mut sum = [0.0; D];
            let mut add = |y: &[f64; D], radius: f64, volume: f64| {
                let r = place.offset(x, y);
                let distance2 = r.iter().map(|c| c * c).sum::<f64>();
                if distance2 < radius * radius {
                    let factor = gradient(radius, distance2.sqrt()) * volume;
                    (0..D).for_each(|k| sum[k] += factor * r[k]);
                }
            };
            for &j in near.neighbors(t) {
                let other = spacing[j as usize];
                let radius = 0.5 * supports * (own + other);
                add(&position[j as usize], radius, volume_of::<D>(other));
            }
            let walls = beside.neighbors(t);
            let slope = if walls.is_empty() { [0.0; D] } else { slope(field, x, own) };
            // What a wall does in a run: it pushes and leans as there.
            let mut push = WallPush::<D, f64>::zero();
            for &w in walls {
                let (w, radius) = (w as usize, supports * own);
                let offset = place.offset(x, &around.positions[w]);
                let distance2 = offset.iter().map(|c| c * c).sum::<f64>();
                if distance2 >= radius * radius {
                    continue;
                }
                let pair = WallPair {
                    offset,
                    distance2,
                    normal: around.normals[w],
                    depth: around.depths[w],
                    weight: gradient(radius, distance2.sqrt()) * around.volumes[w],
                    squeezed: None,
                    unit: 1.0,
                    per_unit: 1.0,
                    stretch: Some(WallStretch {
                        ratio: 1.0,
                        inverse: 1.0,
                        lean: slope.map(|slope| -0.5 * slope / own),
                    }),
                };
                push.add(1.0, 0.0, &pair);
            }
            let push = push.felt(1.0);
            (0..D).for_each(|k| sum[k] += push[k]);
            let factor = RATE * own * own;
            let step: [f64; D] = std::array::from_fn(|k| MEMORY * moves[t][k] - factor * sum[k]);
            let length = step.iter().map(|c| c * c).sum::<f64>().sqrt();
            let most = FARTHEST * own;
            let left = own * own * sum.iter().map(|c| c * c).sum::<f64>();
            (if length > most { step.map(|c| c * (most / length)) } else { step }, left)
        };
        use rayon::prelude::*;
        let steps: Vec<([f64; D], f64)> =
            (0..loose.len()).into_par_iter().with_min_len(256).map(step).collect();
        for (t, (&i, x)) in loose.iter().zip(&targets).enumerate() {
            let (step, _) = steps[t];
            let moved = std::array::from_fn(|k| x[k] + step[k]);
            let moved = wrapped(moved, &domain.min, &periods);
            if place.is_fluid(&moved) {
                position[i as usize] = moved;
                spacing[i as usize] = field.at(&moved);
                moves[t] = step;
            } else {
                moves[t] = [0.0; D];
            }
        }
        let left: f64 = steps.iter().map(|(_, left)| left).sum();
        if left <= even * even * steps.len() as f64 {
            break;
        }
    }
    let mut volume: Vec<f64> = spacing.iter().map(|s| volume_of::<D>(*s)).collect();
    // The water that is there, not a little more or less.
    let packed: f64 = loose.iter().map(|&i| volume[i as usize]).sum();
    for &i in &loose {
        volume[i as usize] *= loose_volume / packed;
    }
    Ok(Packed { position, volume })
}

/// Volume of a particle of this spacing (m), m^D.
#[inline]
fn volume_of<const D: usize>(spacing: f64) -> f64 {
    if D == 2 { spacing * spacing } else { spacing * spacing * spacing }
}

/// The slope of the spacing at a place where it is `spacing` (m).
fn slope<const D: usize>(field: &SpacingField<D>, x: &[f64; D], spacing: f64) -> [f64; D] {
    let step = 0.5 * spacing;
    std::array::from_fn(|k| {
        let at = |way: f64| {
            let mut y = *x;
            y[k] += way * step;
            field.at(&y)
        };
        (at(1.0) - at(-1.0)) / (2.0 * step)
    })
}

/// Elements of what is no fluid, ready for the search.
struct Elements<const D: usize> {
    levels: LevelList<D>,
}

impl<const D: usize> Elements<D> {
    fn new(
        grid: &Grid<D>,
        around: &WallElements<D>,
        supports: f64,
    ) -> Result<Self, sph_neighbors::GridError> {
        let ids: Vec<u64> = (0..around.positions.len() as u64).collect();
        let radius = |volume: &f64| supports * volume.powf(1.0 / D as f64);
        let radii: Vec<f64> = around.volumes.iter().map(radius).collect();
        Ok(Self { levels: LevelList::build(grid, &around.positions, &radii, &ids)? })
    }
}

/// Where fluid may be.
struct Place<'a, const D: usize> {
    geometry: &'a Geometry<D>,
    domain: &'a Aabb<D>,
    periods: [Option<f64>; D],
}

impl<const D: usize> Place<'_, D> {
    /// `x − y`, to the nearest image.
    #[inline]
    fn offset(&self, x: &[f64; D], y: &[f64; D]) -> [f64; D] {
        if self.periods == [None; D] {
            std::array::from_fn(|k| x[k] - y[k])
        } else {
            offset(x, y, &self.periods)
        }
    }

    fn is_fluid(&self, x: &[f64; D]) -> bool {
        self.domain.contains(x)
            && self.geometry.regions.iter().any(|region| region.contains(x))
            && overlap::is_free(&self.geometry.solids, x)
    }
}
