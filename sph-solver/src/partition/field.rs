//! The particles of a scene, ready to be divided.

use super::error::StudyError;
use crate::rank::costs::{FLUID_COST, USUAL_NEIGHBOURS, WALL_COST};
use crate::scene::{ErrorKind, Scene, SceneError};
use crate::setup::{
    BYTES_PER_POSITION, BlockKind, Geometry, Occupancy, Positions, Sample, lattice_neighbours,
    lattice_neighbours_beyond,
};
use sph_decomp::ZoneOptions;
use sph_decomp::scale::{BlockClass, LatticeBlock, Layout, Point};

/// More fluid particles than this are sampled by blocks.
const MOST_PARTICLES: f64 = 1.2e7;

/// By what the partition weighs particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Costs {
    /// Before there are lists: all fluid particles weigh the same. A run divides so first, and goes on
    /// so when its ranks then turn out to be even.
    First,
    /// By the lengths of the lists, here those of the start: as a run divides again at once, before its
    /// first step, unless its ranks are even already.
    Lists,
}

impl Costs {
    /// Cost of a fluid particle with so many neighbours, as in the rebuild of a run.
    fn of_fluid(self, neighbours: f64) -> f64 {
        FLUID_COST
            + match self {
                Self::First => USUAL_NEIGHBOURS as f64,
                Self::Lists => neighbours,
            }
    }
}

/// The particles of a scene, or blocks that stand for them.
#[derive(Debug, Clone)]
pub struct Field<const D: usize> {
    /// Initial particle distance, m.
    pub spacing: f64,
    /// Reach of lists and overlap zone, m.
    pub reach: f64,
    /// Fluid particles.
    pub fluid: f64,
    /// Wall particles.
    pub walls: f64,
    /// Lattice points along the edge of a block; nothing when every particle is there.
    pub block_side: Option<i32>,
    content: Content<D>,
}

#[derive(Debug, Clone)]
enum Content<const D: usize> {
    Points { positions: Vec<[f64; D]>, points: Vec<Point> },
    Blocks { blocks: Vec<LatticeBlock<D>>, classes: Vec<BlockClass> },
}

impl<const D: usize> Field<D> {
    /// Reads a scene. Up to 12 million fluid particles are really placed, unless `sample` asks for blocks;
    /// more are sampled.
    ///
    /// # Errors
    ///
    /// When the scene is wrong or has no fluid.
    pub fn read(scene: &Scene, costs: Costs, sample: bool) -> Result<Self, SceneError> {
        if let Some(refine) = scene.refine.first() {
            let kind = ErrorKind::Invalid {
                what: "`sph partition` divides lattices, and this scene refines its particles"
                    .into(),
                help: "remove [[refine]] for this study; a run knows the radii of every particle"
                    .into(),
            };
            return Err(scene.error(refine.place, kind));
        }
        let geometry = Geometry::<D>::read(scene, None)?;
        let blocks = Sample::new(scene, &geometry)?;
        if sample || blocks.fluid() > MOST_PARTICLES {
            return Ok(Self::of_blocks(scene, &blocks, costs));
        }
        drop(blocks);
        let geometry = Geometry::<D>::read(scene, Some(BYTES_PER_POSITION))?;
        let positions = Positions::new(scene, &geometry)?;
        Ok(Self::of_points(scene, &geometry, positions, costs))
    }

    fn empty(scene: &Scene, content: Content<D>) -> Self {
        Self {
            spacing: *scene.numerics.spacing,
            reach: Geometry::<D>::reach(scene),
            fluid: 0.0,
            walls: 0.0,
            block_side: None,
            content,
        }
    }

    fn of_points(
        scene: &Scene,
        geometry: &Geometry<D>,
        positions: Positions<D>,
        costs: Costs,
    ) -> Self {
        let Positions { position, fluid } = positions;
        let reach = Geometry::<D>::reach(scene);
        let (waters, walls) = position.split_at(fluid);
        let maps = [waters, walls].map(|some| Occupancy::new(&geometry.lattice, some));
        let inside = lattice_neighbours::<D>(reach / geometry.lattice.spacing()) as u32;
        let near = |map: &Option<Occupancy<D>>, otherwise: u32| -> Vec<u32> {
            match map {
                Some(map) => {
                    let count = map.within(reach);
                    position.iter().map(count).collect()
                }
                None => vec![otherwise; position.len()],
            }
        };
        let near_fluid = near(&maps[0], inside + 1);
        let mut near_walls = near(&maps[1], 0);
        near_walls.truncate(fluid);
        let point = |(i, near): (usize, &u32)| {
            if i < fluid {
                // A particle is not in its own list.
                let pairs = (near.saturating_sub(1) + near_walls[i]) as f32;
                Point { active: true, cost: costs.of_fluid(pairs.into()) as f32, pairs }
            } else {
                Point { active: false, cost: WALL_COST as f32, pairs: *near as f32 }
            }
        };
        let points: Vec<Point> = near_fluid.iter().enumerate().map(point).collect();
        let (fluid, walls) = (fluid as f64, (position.len() - fluid) as f64);
        let content = Content::Points { positions: position, points };
        Self { fluid, walls, ..Self::empty(scene, content) }
    }

    fn of_blocks(scene: &Scene, sample: &Sample<D>, costs: Costs) -> Self {
        let radius = Geometry::<D>::reach(scene) / *scene.numerics.spacing;
        let pairs = lattice_neighbours::<D>(radius) as f64;
        // Particles of wetted walls see the fluid from one, two … layers below its surface.
        let layers = (*scene.numerics.support - 0.5 - 1e-6).ceil().max(1.0) as i64;
        let seen = (1..=layers).map(|layer| lattice_neighbours_beyond::<D>(radius, layer) as f64);
        let seen = seen.sum::<f64>() / layers as f64;
        let cost = costs.of_fluid(pairs);
        let wall = BlockClass {
            active: false,
            density: sample.wall_density,
            cost: WALL_COST,
            pairs: seen,
        };
        let classes = vec![
            BlockClass { active: true, density: 1.0, cost, pairs },
            wall,
            BlockClass { pairs: 0.0, ..wall },
        ];
        let block = |&(first, end, kind): &([i32; D], [i32; D], BlockKind)| {
            let class = match kind {
                BlockKind::Fluid => 0,
                BlockKind::WetWall => 1,
                BlockKind::DryWall => 2,
            };
            LatticeBlock { first, end, class }
        };
        let blocks = sample.blocks.iter().map(block).collect();
        Self {
            fluid: sample.fluid(),
            walls: sample.walls(),
            block_side: Some(sample.side),
            ..Self::empty(scene, Content::Blocks { blocks, classes })
        }
    }

    /// Divides the field among so many ranks.
    ///
    /// # Errors
    ///
    /// When there are more ranks than particles.
    pub fn layout(&mut self, ranks: usize) -> Result<Layout, StudyError> {
        let (reach, spacing) = (self.reach, self.spacing);
        Ok(match &mut self.content {
            Content::Points { positions, points } => {
                let options = ZoneOptions::default();
                Layout::of_points(ranks, positions, points, reach, &options)?
            }
            Content::Blocks { blocks, classes } => {
                Layout::of_blocks(ranks, blocks.clone(), classes, reach / spacing)?
            }
        })
    }
}

/// The spacing (m) at which a scene has about so many fluid particles.
///
/// # Errors
///
/// When the scene is wrong or has no fluid at its own spacing.
pub fn spacing_for<const D: usize>(scene: &Scene, particles: f64) -> Result<f64, SceneError> {
    let geometry = Geometry::<D>::read(scene, None)?;
    let fluid = Sample::new(scene, &geometry)?.fluid();
    Ok(*scene.numerics.spacing * (fluid / particles).powf(1.0 / D as f64))
}

#[cfg(test)]
mod tests;
