//! From a scene to the particles and constants that a run begins with.
//!
//! Fluid and walls share one lattice: `x = origin + (i + ½) spacing`, its origin the lowest corner of
//! the box around the first fluid region. Walls flush with that region lie on cell sides, half a
//! spacing from the last layer of fluid. Every particle has the mass ρ0 · spacing^D.

mod bodies;
mod choice;
mod constants;
mod domain;
mod estimate;
mod fluid;
mod geometry;
mod graded;
mod jitter;
mod memory;
mod moving;
mod neighbours;
mod notes;
mod overlap;
mod particles;
mod placed;
mod positions;
mod report;
mod sampling;
mod shapes;
mod sizes;
mod thickness;
mod volume;
mod walls;

pub use choice::{Beginning, Kind, SchemeChoice};
pub use constants::{Constants, StepLimit, expected_speed, time_step};
pub use geometry::Geometry;
pub use neighbours::{Occupancy, lattice_neighbours, lattice_neighbours_beyond};
pub use particles::Particles;
pub use positions::{BYTES_PER_POSITION, Positions};
pub(crate) use report::grouped;
pub use report::{
    BYTES_PER_FLUID_PARTICLE, BYTES_PER_WALL_PARTICLE, CheckReport, MeshSummary,
    PAIRS_PER_CORE_SECOND, PASSES_PER_STEP, ParticleCounts, SolidCount, VolumeOfFluid,
};
pub use sampling::{BlockKind, Sample};

use crate::bodies::Body;
use crate::eos::EquationOfState;
use crate::grading::Grading;
use crate::model::SolidModel;
use crate::scene::{self, At, Equation, ErrorKind, Fluid, Kernel, Region, Scene, SceneError};
use fluid::{Cells, Filling};
use graded::GradedFluid;
use shapes::Shapes;
use sph_geometry::{Aabb, Lattice, LatticeError, Solid, lattice_inside};
use sph_kernels::{Kernel as _, WendlandC2};

/// What a run begins with.
#[derive(Debug, Clone)]
pub struct Setup<const D: usize> {
    /// All particles, in the order of their ids.
    pub particles: Particles<D>,
    /// Constants.
    pub constants: Constants<D>,
    /// The solids; the particles of solid k have kind 1 + k.
    pub solids: Vec<SolidModel<D>>,
    /// Those of them that move, with their wall particles.
    pub bodies: Vec<Body<D>>,
    /// Those that rest, as geometry.
    pub at_rest: Vec<Solid<D>>,
    /// Largest speed expected in the run, m/s.
    pub expected_speed: f64,
    /// Largest speed at the start, m/s.
    pub initial_speed: f64,
    /// The scheme, and why.
    pub choice: SchemeChoice,
    /// Volume of the regions of fluid, m³ (m² in two dimensions).
    pub volume_of_regions: f64,
    notes_on_geometry: Vec<String>,
    meshes: Vec<MeshSummary>,
}

/// More particles would not fit the 32-bit indices of neighbour lists.
const MOST_PARTICLES: f64 = u32::MAX as f64;

/// The same for messages.
const LARGEST: &str = "4.2e9 is the most";

impl<const D: usize> Setup<D> {
    /// Makes particles and constants. Reads the meshes that the scene names.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        let mut geometry = Geometry::<D>::read(scene, Some(memory::to_set_up::<D>(1.0)))?;
        let mut notes = std::mem::take(&mut geometry.notes);
        let Geometry { solids, regions, fluid_box, lattice, domain, meshes, .. } = &geometry;
        let (fluid_name, fluid) = scene.fluid()?;
        let numerics = &scene.numerics;
        let spacing = *numerics.spacing;
        let (mut position, mut ends) = match &geometry.spacing {
            None => fill(scene, fluid, regions, lattice)?,
            Some(field) => graded::cells(scene, &geometry, field)?,
        };
        let explain = |error| sizes::explain(error, scene, solids, regions, meshes);
        notes.extend(
            overlap::give_way(scene, fluid_name, fluid, solids, &mut position, &mut ends)
                .map_err(explain)?,
        );
        if position.is_empty() {
            let error = nothing(scene, fluid);
            return Err(explain(error));
        }
        let position = jitter::shifted(fluid, spacing, position);
        let (filling, volume) = match &geometry.spacing {
            None => (Filling::new(scene, fluid, position, ends)?, None),
            Some(field) => {
                let graded = graded::pack(scene, &geometry, field, &position, &ends)?;
                let GradedFluid { position, volume, ends } = graded;
                (Filling::new(scene, fluid, position, ends)?, Some(volume))
            }
        };
        domain::check(scene, fluid, domain, &filling.position)?;
        let support = Geometry::<D>::support(scene);
        notes.extend(notes::on_probes(scene, domain, solids, &filling.position, support));
        let gravity = scene.gravity();
        let mut bodies = moving::bodies(scene, solids)?;
        let initial_speed = filling.largest_speed().max(moving::largest_speed(scene, &bodies));
        let expected_speed = expected_speed(&gravity, height(&gravity, fluid_box), initial_speed);
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
        // Answered by a search of the domain, so asked only where it matters.
        let closed = numerics.scheme != scene::Scheme::Delta
            && walls::is_closed(scene, &geometry, filling.position.len(), volume.as_deref())?;
        let choice = match numerics.scheme {
            scene::Scheme::Auto => SchemeChoice::made(
                scene,
                &Beginning {
                    closed,
                    speed: initial_speed,
                    gravity: &gravity,
                    height: height(&gravity, fluid_box),
                    position: &filling.position,
                    spacing,
                    solids,
                    periodic: scene.periodic_axes(),
                },
            ),
            _ => SchemeChoice::given(scene),
        };
        let constants = Constants {
            spacing,
            smoothing_length: support_radius / radius_over_h,
            support_radius,
            grading: geometry.spacing.as_ref().map(|field| {
                Grading::new(density0 * spacing.powi(D as i32), field.finest() / field.coarsest())
            }),
            skin: *numerics.skin
                * geometry
                    .spacing
                    .as_ref()
                    .map_or(support_radius, |field| field.finest() * *numerics.support),
            density0,
            sound_speed,
            equation_of_state,
            gravity,
            cfl: *numerics.cfl,
            artificial_viscosity: choice.artificial_viscosity,
            density_diffusion: *numerics.density_diffusion,
            viscosity: scene.viscosity(),
            closed: choice.scheme == scene::Scheme::DeltaPlus && closed,
            cavitation_pressure: fluid.cavitation_pressure.map(|pressure| *pressure),
            domain: (domain.min, domain.max),
            periods: domain::periods(scene, domain, spacing, Geometry::<D>::reach(scene))?,
            on_lost: numerics.on_lost,
        };
        let cells = Cells { lattice, volume: volume.as_deref() };
        let mut particles = filling.finish(scene, fluid, &equation_of_state, &cells)?;
        let thin = thickness::thin_solids(scene, solids, lattice, domain, support);
        let (thin, of_thickness) = match &geometry.spacing {
            None => {
                let notes = thickness::notes(solids, &thin, spacing);
                (thin, notes)
            }
            Some(_) => (vec![None; solids.len()], thickness::graded_notes(solids, &thin)),
        };
        let made = &mut particles;
        walls::add_walls(scene, &geometry, &thin, &mut bodies, &constants, made)
            .map_err(explain)?;
        sizes::without_particles(scene, solids, regions, meshes, domain, &particles)?;
        notes.extend(of_thickness);
        Ok(Self {
            particles,
            constants,
            solids: walls::models(scene, solids, &thin),
            at_rest: moving::at_rest(scene, solids),
            bodies,
            expected_speed,
            initial_speed,
            choice,
            volume_of_regions: volume::of_regions(regions, solids),
            notes_on_geometry: notes,
            meshes: geometry.meshes,
        })
    }
}

impl<const D: usize> Setup<D> {
    /// Volume that the fluid particles hold at rest, m³ (m² in two dimensions).
    pub fn volume(&self) -> f64 {
        let fluid = self.particles.of_kind(0);
        match self.constants.grading {
            None => fluid.len() as f64 * self.constants.spacing.powi(D as i32),
            Some(_) => self.particles.mass[fluid].iter().sum::<f64>() / self.constants.density0,
        }
    }

    /// Memory of a run on all ranks together, bytes.
    pub fn memory_bytes(&self) -> f64 {
        let fluid = self.particles.of_kind(0).len();
        let walls = self.particles.len() - fluid;
        fluid as f64 * BYTES_PER_FLUID_PARTICLE + walls as f64 * BYTES_PER_WALL_PARTICLE
    }
}

/// Exponent of Tait's equation for water (Cole 1948, Underwater Explosions).
const GAMMA: f64 = 7.0;

fn regions<const D: usize>(
    name: &str,
    fluid: &Fluid,
    shapes: &mut Shapes<'_>,
) -> Result<Vec<sph_geometry::Shape<D>>, SceneError> {
    let make = |(index, region): (usize, &At<Region>)| {
        let user = format!("region {index} of {name}");
        shapes.only(&user, region.place, &region.shapes(), &region.placing())
    };
    fluid.regions.iter().enumerate().map(make).collect()
}

/// The box around all regions, which must be finite. With `bytes` per particle, also no more cells
/// than can be counted and held.
fn fluid_box<const D: usize>(
    scene: &Scene,
    fluid: &Fluid,
    regions: &[sph_geometry::Shape<D>],
    bytes: Option<f64>,
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
    let Some(bytes) = bytes else { return Ok(all) };
    if cells > MOST_PARTICLES {
        return Err(too_many(scene, cells, LARGEST));
    }
    let needed = bytes * cells;
    if let Some(available) = memory::available().filter(|available| needed > *available) {
        let [needed, available] = [needed, available].map(memory::gibibytes);
        let why = format!("they need about {needed}, and {available} are free here");
        return Err(too_many(scene, cells, &why));
    }
    Ok(all)
}

fn too_many(scene: &Scene, particles: f64, why: &str) -> SceneError {
    let kind = ErrorKind::OutOfRange {
        key: "numerics.spacing".into(),
        range: "larger",
        found: scene.numerics.spacing.to_string(),
        help: format!("it makes about {particles:.1e} particles; {why}"),
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

#[cfg(test)]
mod tests;
