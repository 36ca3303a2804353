//! From a scene to the particles and constants that a run begins with.
//!
//! Fluid and walls share one lattice: `x = origin + (i + ½) spacing`, its origin the lowest corner of
//! the box around the first fluid region. Walls flush with that region lie on cell sides, half a
//! spacing from the last layer of fluid. Every particle has the mass ρ0 · spacing^D.

mod constants;
mod domain;
mod fluid;
mod overlap;
mod particles;
mod report;
mod shapes;

pub use constants::{Constants, StepLimit, expected_speed, time_step};
pub use particles::Particles;
pub use report::{
    BYTES_PER_FLUID_PARTICLE, BYTES_PER_WALL_PARTICLE, CheckReport, MeshSummary,
    PAIRS_PER_CORE_SECOND, PASSES_PER_STEP, ParticleCounts, SolidCount,
};

use crate::eos::EquationOfState;
use crate::scene::{
    self, At, Equation, ErrorKind, Fluid, Kernel, Region, Scene, SceneError, Solid,
};
use fluid::{Column, Filling};
use shapes::Shapes;
use sph_geometry::{
    Aabb, Domain, FluidSide, Lattice, LatticeError, lattice_inside, wall_particles,
};
use sph_kernels::{Kernel as _, WendlandC2};

/// What a run begins with.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup<const D: usize> {
    /// All particles, in the order of their ids.
    pub particles: Particles<D>,
    /// Constants.
    pub constants: Constants<D>,
    /// Names of the solids; the particles of solid k have kind 1 + k.
    pub solids: Vec<String>,
    /// Largest speed expected in the run, m/s.
    pub expected_speed: f64,
    /// Largest speed at the start, m/s.
    pub initial_speed: f64,
    meshes: Vec<MeshSummary>,
}

/// More particles would not fit the 32-bit indices of neighbour lists.
const MOST_PARTICLES: f64 = u32::MAX as f64;

/// More rows of lattice cells than this are not searched; a domain that large is a mistake.
const MOST_ROWS: f64 = 1e9;

impl<const D: usize> Setup<D> {
    /// Makes particles and constants. Reads the meshes that the scene names.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        if scene.dimension() != D {
            let dimension = scene.dimension();
            let kind = ErrorKind::Components { key: "dimension".into(), found: D, dimension };
            return Err(scene.error(scene.dimension.place, kind));
        }
        let (fluid_name, fluid) = scene.fluid()?;
        let numerics = &scene.numerics;
        let spacing = *numerics.spacing;
        let mut shapes = Shapes::new(scene);
        let solids = solids(scene, &mut shapes)?;
        let regions = regions(fluid_name, fluid, &mut shapes)?;
        let fluid_box = fluid_box(scene, fluid, &regions)?;

        let lattice = Lattice::new(regions[0].bounding_box().min, spacing)
            .map_err(|error| lattice_error(scene, numerics.spacing.place, &error))?;
        let (position, ends) = fill(scene, fluid, &regions, &lattice)?;
        overlap::check(scene, fluid_name, fluid, &solids, &position, &ends)?;
        if position.is_empty() {
            return Err(nothing(scene, fluid));
        }
        let filling = Filling::new(scene, fluid, position, ends)?;

        let domain = domain::domain(scene, &solids, &fluid_box, spacing * *numerics.support);
        domain::check(scene, fluid, &domain, &filling)?;
        let gravity = scene.gravity();
        let initial_speed = filling.largest_speed();
        let expected_speed = expected_speed(&gravity, height(&gravity, &fluid_box), initial_speed);
        let sound_speed = constants::sound_speed(scene, numerics, expected_speed)?;
        let density0 = *fluid.density;
        let equation_of_state = match numerics.equation_of_state {
            Equation::Linear => EquationOfState::Linear { density0, sound_speed },
            Equation::Tait => EquationOfState::Tait { density0, sound_speed, gamma: GAMMA },
        };
        let support_radius = spacing * *numerics.support;
        let radius_over_h = match numerics.kernel {
            Kernel::WendlandC2 => WendlandC2::RADIUS_OVER_H,
        };
        let constants = Constants {
            spacing,
            smoothing_length: support_radius / radius_over_h,
            support_radius,
            skin: *numerics.skin * support_radius,
            density0,
            sound_speed,
            equation_of_state,
            gravity,
            cfl: *numerics.cfl,
            artificial_viscosity: scene.artificial_viscosity(),
            density_diffusion: *numerics.density_diffusion,
            viscosity: scene.viscosity(),
            domain: (domain.min, domain.max),
            on_lost: numerics.on_lost,
        };
        let mass = density0 * spacing.powi(D as i32);
        let column = Column::new(density0, &gravity, spacing, &filling.position);
        let mut particles = filling.finish(scene, fluid, &equation_of_state, &column, mass)?;
        add_walls(scene, &solids, &lattice, &constants, mass, &mut particles)?;
        Ok(Self {
            particles,
            constants,
            solids: solids.into_iter().map(|solid| solid.name).collect(),
            expected_speed,
            initial_speed,
            meshes: shapes.meshes,
        })
    }
}

/// Exponent of Tait's equation for water (Cole 1948, Underwater Explosions).
const GAMMA: f64 = 7.0;

fn solids<const D: usize>(
    scene: &Scene,
    shapes: &mut Shapes<'_>,
) -> Result<Vec<sph_geometry::Solid<D>>, SceneError> {
    let make = |solid: &At<Solid>| {
        let user = format!("solid {}", *solid.name);
        let shape = shapes.only(&user, solid.place, &solid.shapes())?;
        // Only planes have no side; their material is the half space itself.
        let side = match solid.fluid_side.map(|side| *side) {
            Some(scene::FluidSide::Inside) => FluidSide::Inside,
            Some(scene::FluidSide::Outside) | None => FluidSide::Outside,
        };
        Ok(sph_geometry::Solid::new(solid.name.as_str(), shape, side))
    };
    if let Some(surplus) = scene.solid.get(usize::from(u16::MAX)) {
        let kind = ErrorKind::Invalid {
            what: format!("the scene has {} solids", scene.solid.len()),
            help: "65535 is the most; join some by `union`".into(),
        };
        return Err(scene.error(surplus.place, kind));
    }
    scene.solid.iter().map(make).collect()
}

fn regions<const D: usize>(
    name: &str,
    fluid: &Fluid,
    shapes: &mut Shapes<'_>,
) -> Result<Vec<sph_geometry::Shape<D>>, SceneError> {
    let make = |(index, region): (usize, &At<Region>)| {
        let user = format!("region {index} of {name}");
        shapes.only(&user, region.place, &region.shapes())
    };
    fluid.regions.iter().enumerate().map(make).collect()
}

/// The box around all regions, which must be finite and hold no more cells than can be counted.
fn fluid_box<const D: usize>(
    scene: &Scene,
    fluid: &Fluid,
    regions: &[sph_geometry::Shape<D>],
) -> Result<Aabb<D>, SceneError> {
    let mut all = Aabb::EMPTY;
    let mut cells = 0.0;
    for (region, keys) in regions.iter().zip(fluid.regions.iter()) {
        let bounds = region.bounding_box();
        if !bounds.is_finite() {
            let kind = ErrorKind::Invalid {
                what: "a region of fluid has no end".into(),
                help: "cut it off: difference = [{ box = … }, …] is never larger than its first \
                       shape"
                    .into(),
            };
            return Err(scene.error(keys.place, kind));
        }
        let sides = (0..D).map(|axis| (bounds.max[axis] - bounds.min[axis]).max(0.0));
        cells += sides.map(|side| side / *scene.numerics.spacing).product::<f64>();
        all = all.union(&bounds);
    }
    if cells > MOST_PARTICLES {
        return Err(too_many(scene, cells));
    }
    Ok(all)
}

fn too_many(scene: &Scene, particles: f64) -> SceneError {
    let kind = ErrorKind::OutOfRange {
        key: "numerics.spacing".into(),
        range: "larger",
        found: scene.numerics.spacing.to_string(),
        help: format!("it makes about {particles:.1e} particles; 4.2e9 is the most"),
    };
    scene.error(scene.numerics.spacing.place, kind)
}

fn lattice_error(scene: &Scene, place: scene::Place, error: &LatticeError) -> SceneError {
    let message = error.to_string();
    let (what, help) = message.split_once("; ").unwrap_or((&message, ""));
    scene.error(place, ErrorKind::Invalid { what: what.into(), help: help.into() })
}

/// Positions of the fluid, region by region, and where the regions end.
fn fill<const D: usize>(
    scene: &Scene,
    fluid: &Fluid,
    regions: &[sph_geometry::Shape<D>],
    lattice: &Lattice<D>,
) -> Result<(Vec<[f64; D]>, Vec<usize>), SceneError> {
    let mut position: Vec<[f64; D]> = Vec::new();
    let mut ends = Vec::new();
    // Points on the surface of a region are not in it, so that later regions may have them.
    let margin = 1e-6 * lattice.spacing();
    for (index, (region, keys)) in regions.iter().zip(fluid.regions.iter()).enumerate() {
        let runs = lattice_inside(region, lattice)
            .map_err(|error| lattice_error(scene, keys.place, &error))?;
        let earlier = &regions[..index];
        let taken =
            |x: &[f64; D]| earlier.iter().any(|earlier| earlier.signed_distance(x) + margin < 0.0);
        position.extend(runs.points().filter(|x| !taken(x)));
        ends.push(position.len());
    }
    Ok((position, ends))
}

fn nothing(scene: &Scene, fluid: &At<Fluid>) -> SceneError {
    let spacing = *scene.numerics.spacing;
    let kind = ErrorKind::Nothing {
        why: format!("no particle fits into the regions of fluid at a spacing of {spacing} m"),
        help: "use a smaller numerics.spacing or larger regions".into(),
    };
    scene.error(fluid.regions.place, kind)
}

/// Extent of a box along gravity, m.
fn height<const D: usize>(gravity: &[f64; D], bounds: &Aabb<D>) -> f64 {
    let strength = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    if strength == 0.0 {
        return 0.0;
    }
    (0..D).map(|axis| gravity[axis].abs() / strength * (bounds.max[axis] - bounds.min[axis])).sum()
}

fn add_walls<const D: usize>(
    scene: &Scene,
    solids: &[sph_geometry::Solid<D>],
    lattice: &Lattice<D>,
    constants: &Constants<D>,
    mass: f64,
    particles: &mut Particles<D>,
) -> Result<(), SceneError> {
    if solids.is_empty() {
        return Ok(());
    }
    let place = scene.domain.as_ref().map_or(scene.numerics.spacing.place, |domain| domain.place);
    let bounds = Aabb::new(constants.domain.0, constants.domain.1);
    let sides = (1..D).map(|axis| (bounds.max[axis] - bounds.min[axis]) / lattice.spacing());
    if sides.product::<f64>() > MOST_ROWS {
        let kind = ErrorKind::Invalid {
            what: format!(
                "the domain {:?} to {:?} is too large for a spacing of {} m",
                bounds.min,
                bounds.max,
                lattice.spacing()
            ),
            help: "give a smaller [domain] or a larger numerics.spacing".into(),
        };
        return Err(scene.error(place, kind));
    }
    let walls = wall_particles(solids, lattice, constants.support_radius, &Domain::new(bounds))
        .map_err(|error| lattice_error(scene, place, &error))?;
    let total = particles.len() + walls.positions.len();
    if total as f64 > MOST_PARTICLES {
        return Err(too_many(scene, total as f64));
    }
    // Solid by solid; within a solid in the order of the lattice.
    let mut order: Vec<usize> = (0..walls.positions.len()).collect();
    order.sort_by_key(|wall| walls.solids[*wall]);
    for wall in order {
        let kind = 1 + walls.solids[wall] as u16;
        particles.push(walls.positions[wall], [0.0; D], constants.density0, mass, kind);
    }
    Ok(())
}

impl<const D: usize> Setup<D> {
    /// What a run of the scene on so many ranks would be and cost. Fails when there are more ranks
    /// than particles.
    pub fn report(&self, scene: &Scene, ranks: usize) -> Result<CheckReport, SceneError> {
        let total = self.particles.len();
        if ranks > total {
            let kind = ErrorKind::TooManyRanks { ranks, particles: total };
            return Err(scene.error_without_place(kind));
        }
        let constants = &self.constants;
        let fluid = self.particles.of_kind(0).len();
        let solids = self.solids.iter().zip(1..).map(|(name, kind)| SolidCount {
            name: name.clone(),
            kind,
            particles: self.particles.of_kind(kind).len(),
        });
        let solids: Vec<SolidCount> = solids.collect();
        let (step, step_limit) = time_step(constants, self.expected_speed);
        let steps = (*scene.end_time / step).ceil();
        let particle_updates = fluid as f64 * steps;
        let neighbours = lattice_neighbours::<D>(constants.support_radius / constants.spacing);
        let pairs = particle_updates * neighbours as f64 * PASSES_PER_STEP;
        let walls = total - fluid;
        let bounds = Aabb::around(&self.particles.position);
        Ok(CheckReport {
            name: scene.name().into(),
            dimension: D,
            warnings: self.warnings(&solids),
            particles: ParticleCounts { total, fluid, solids },
            bounding_box: [bounds.min.to_vec(), bounds.max.to_vec()],
            domain: [constants.domain.0.to_vec(), constants.domain.1.to_vec()],
            spacing: constants.spacing,
            smoothing_length: constants.smoothing_length,
            support_radius: constants.support_radius,
            neighbours,
            sound_speed: constants.sound_speed,
            expected_speed: self.expected_speed,
            time_step: step,
            step_limit,
            end_time: *scene.end_time,
            steps: steps as u64,
            particle_updates,
            core_seconds: pairs / PAIRS_PER_CORE_SECOND,
            memory_bytes: fluid as f64 * BYTES_PER_FLUID_PARTICLE
                + walls as f64 * BYTES_PER_WALL_PARTICLE,
            ranks,
            meshes: self.meshes.clone(),
        })
    }

    fn warnings(&self, solids: &[SolidCount]) -> Vec<String> {
        let mut warnings = Vec::new();
        for solid in solids.iter().filter(|solid| solid.particles == 0) {
            warnings.push(format!(
                "solid {} has no particles: it is thinner than the spacing or out of reach of the \
                 fluid",
                solid.name
            ));
        }
        let mach = self.expected_speed / self.constants.sound_speed;
        if mach > 0.102 {
            warnings.push(format!(
                "the sound speed is only {:.1} times the expected flow speed; below 10 the fluid \
                 is visibly compressible",
                1.0 / mach
            ));
        }
        warnings
    }
}

/// Points of a lattice of spacing 1 closer than `radius` to one of them, itself left out.
fn lattice_neighbours<const D: usize>(radius: f64) -> usize {
    // Support over spacing is a round number up to rounding; points at just that distance weigh 0.
    let radius = radius * (1.0 - 1e-9);
    let reach = radius.ceil() as i64;
    let side = 2 * reach + 1;
    let count = (0..side.pow(D as u32)).filter(|cell| {
        let mut rest = *cell;
        let mut square = 0.0;
        for _ in 0..D {
            square += ((rest % side - reach) as f64).powi(2);
            rest /= side;
        }
        square < radius * radius
    });
    count.count() - 1
}

#[cfg(test)]
mod tests;
