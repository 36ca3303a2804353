//! Solids of a scene and the particles of their walls.

use super::constants::Constants;
use super::particles::Particles;
use super::shapes::Shapes;
use super::thickness::Thin;
use super::{Geometry, LARGEST, MOST_PARTICLES, graded, lattice_error, memory, moving, too_many};
use crate::bodies::Body;
use crate::model::SolidModel;
use crate::scene::{self, At, ErrorKind, Scene, SceneError};
use sph_geometry::{
    Aabb, Domain, FluidSide, Lattice, LatticeError, Solid, SpacingField, WallElements, free_cells,
    graded_wall_elements, thin_wall_elements, wall_elements, wall_particles,
};

/// More rows of lattice cells than this are not searched; a domain that large is a mistake.
const MOST_ROWS: f64 = 1e9;

/// Nor longer ones.
const LONGEST_ROW: f64 = 2e7;

/// The solids of the scene as geometry.
pub fn solids<const D: usize>(
    scene: &Scene,
    shapes: &mut Shapes<'_>,
) -> Result<Vec<Solid<D>>, SceneError> {
    let make = |solid: &At<scene::Solid>| {
        let user = format!("solid {}", *solid.name);
        let shape = shapes.only(&user, solid.place, &solid.shapes(), &solid.placing())?;
        // Only planes have no side; their material is the half space itself.
        let side = match solid.fluid_side.map(|side| *side) {
            Some(scene::FluidSide::Inside) => FluidSide::Inside,
            Some(scene::FluidSide::Outside) | None => FluidSide::Outside,
        };
        Ok(Solid::new(solid.name.as_str(), shape, side))
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

/// What a run knows of the solids besides their particles.
pub fn models<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    thin: &[Option<Thin<D>>],
) -> Vec<SolidModel<D>> {
    let viscous = scene.viscosity().is_some();
    let model = |((solid, keys), thin): ((&Solid<D>, &At<scene::Solid>), &Option<Thin<D>>)| {
        let bounds = solid.shape.bounding_box();
        let middle = |k: usize| {
            let middle = 0.5 * (bounds.min[k] + bounds.max[k]);
            if middle.is_finite() { middle } else { 0.0 }
        };
        SolidModel {
            name: solid.name.clone(),
            center: match &keys.moments_about {
                Some(point) => scene::vector(point),
                None => std::array::from_fn(middle),
            },
            slips: match keys.wall_friction.map(|friction| *friction) {
                Some(friction) => friction == scene::WallFriction::Slip,
                None => !viscous,
            },
            thin: thin.as_ref().map(|thin| thin.wall(*scene.numerics.spacing)),
        }
    };
    solids.iter().zip(&scene.solid).zip(thin).map(model).collect()
}

/// Whether so many particles of fluid, of these volumes where they differ, fill every cell that fluid can
/// be in.
pub fn is_closed<const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    fluid: usize,
    volume: Option<&[f64]>,
) -> Result<bool, SceneError> {
    let Geometry { solids, lattice, domain, .. } = geometry;
    let (domain, place) = searchable(scene, lattice, domain)?;
    let free = free_cells(solids, lattice, &domain)
        .map_err(|error| lattice_error(scene, place, &error))?;
    Ok(match volume {
        None => free.count() <= fluid as u64,
        Some(volume) => {
            let cells = free.count() as f64 * lattice.spacing().powi(D as i32);
            cells <= volume.iter().sum::<f64>() * (1.0 + CLOSED)
        }
    })
}

/// Fluid whose particles have volumes of their own fills a space up to this share.
const CLOSED: f64 = 1e-3;

/// Adds the wall particles, solid by solid.
pub fn add_walls<const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    thin: &[Option<Thin<D>>],
    bodies: &mut [Body<D>],
    constants: &Constants<D>,
    particles: &mut Particles<D>,
) -> Result<(), SceneError> {
    let solids = &geometry.solids;
    let support = constants.support_radius;
    let walls = match &geometry.spacing {
        None => find_walls(scene, solids, thin, &geometry.lattice, &geometry.domain, support)?,
        Some(field) => find_graded_walls(scene, geometry, field)?,
    };
    for body in &mut *bodies {
        let elements = match &geometry.spacing {
            None => moving::elements(body, thin, &geometry.lattice, support),
            Some(field) => graded::body_elements(scene, geometry, field, body),
        };
        moving::add_elements(scene, body, elements)?;
    }
    let moving = bodies.iter().map(|body| body.elements.len()).sum::<usize>();
    let total = particles.len() + walls.positions.len() + moving;
    if total as f64 > MOST_PARTICLES {
        return Err(too_many(scene, total as f64, LARGEST));
    }
    let needed = memory::to_set_up::<D>((walls.positions.len() + moving) as f64);
    if let Some(available) = memory::available().filter(|available| needed > *available) {
        let [needed, available] = [needed, available].map(memory::gibibytes);
        let why = format!("its walls need {needed}, and {available} are free here");
        return Err(too_many(scene, total as f64, &why));
    }
    // Solid by solid; within a solid in the order of the lattice.
    let mut order: Vec<usize> = (0..walls.positions.len()).collect();
    order.sort_by_key(|wall| walls.solids[*wall]);
    let mut rest = order.into_iter().peekable();
    let density = constants.density0;
    for number in 0..solids.len() {
        while let Some(wall) = rest.next_if(|wall| walls.solids[*wall] as usize == number) {
            let (position, kind) = (walls.positions[wall], 1 + number as u16);
            particles.push_wall(position, density, kind, walls.normals[wall]);
            particles.volume.push(walls.volumes[wall]);
            particles.depth.push(walls.depths[wall]);
        }
        let Some(body) = bodies.iter_mut().find(|body| usize::from(body.solid) == number) else {
            continue;
        };
        let first = particles.len() as u64;
        let elements = &mut body.elements;
        elements.id.iter_mut().zip(first..).for_each(|(id, number)| *id = number);
        for (x, normal) in elements.position.iter().zip(&elements.normal) {
            particles.push_wall(*x, density, 1 + number as u16, *normal);
        }
        particles.volume.extend_from_slice(&elements.volume);
        particles.depth.extend_from_slice(&elements.depth);
    }
    Ok(())
}

/// The wall elements of solids at rest within `support` (m) of where fluid can be, `thin` ones among them.
pub fn find_walls<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    thin: &[Option<Thin<D>>],
    lattice: &Lattice<D>,
    bounds: &Aabb<D>,
    support: f64,
) -> Result<WallElements<D>, SceneError> {
    let (thin, thick): (Vec<usize>, Vec<usize>) =
        numbers_at_rest(scene).into_iter().partition(|&k| thin[k].is_some());
    if thin.is_empty() && thick.is_empty() {
        return Ok(WallElements::default());
    }
    let (domain, place) = searchable(scene, lattice, bounds)?;
    let refuse = |error| lattice_error(scene, place, &error);
    let mut walls = WallElements::default();
    if !thick.is_empty() {
        let make = |rest: &[Solid<D>]| wall_elements(rest, lattice, support, &domain);
        walls = of_some(solids, &thick, make).map_err(refuse)?;
    }
    if !thin.is_empty() {
        let rest = some(solids, &thick);
        let make = |few: &[Solid<D>]| thin_wall_elements(few, &rest, lattice, support, &domain);
        walls.append(of_some(solids, &thin, make).map_err(refuse)?);
    }
    Ok(walls)
}

/// The wall elements of solids at rest in cells that match the spacing.
///
/// # Errors
///
/// As [`find_walls`].
pub fn find_graded_walls<const D: usize>(
    scene: &Scene,
    geometry: &Geometry<D>,
    field: &SpacingField<D>,
) -> Result<WallElements<D>, SceneError> {
    let numbers = numbers_at_rest(scene);
    if numbers.is_empty() {
        return Ok(WallElements::default());
    }
    let tree = graded::tree(scene, geometry, field)?;
    let (domain, place) = searchable(scene, &geometry.lattice, &geometry.domain)?;
    let supports = *scene.numerics.support;
    let make = |solids: &[Solid<D>]| graded_wall_elements(solids, &tree, supports, &domain);
    of_some(&geometry.solids, &numbers, make).map_err(|error| lattice_error(scene, place, &error))
}

/// Numbers in the scene of the solids that rest.
fn numbers_at_rest(scene: &Scene) -> Vec<usize> {
    let moves = moving::moves(scene);
    (0..moves.len()).filter(|&number| !moves[number]).collect()
}

/// The solids with these numbers.
fn some<const D: usize>(solids: &[Solid<D>], numbers: &[usize]) -> Vec<Solid<D>> {
    numbers.iter().map(|&number| solids[number].clone()).collect()
}

/// The wall elements that `make` makes of the solids with these numbers, which it does not know.
fn of_some<const D: usize>(
    solids: &[Solid<D>],
    numbers: &[usize],
    make: impl FnOnce(&[Solid<D>]) -> Result<WallElements<D>, LatticeError>,
) -> Result<WallElements<D>, LatticeError> {
    let mut walls = make(&some(solids, numbers))?;
    walls.solids.iter_mut().for_each(|solid| *solid = numbers[*solid as usize] as u32);
    Ok(walls)
}

/// The lattice points in material at rest within `support` (m) of where fluid can be.
pub fn find_cells<const D: usize>(
    scene: &Scene,
    solids: &[Solid<D>],
    lattice: &Lattice<D>,
    bounds: &Aabb<D>,
    support: f64,
) -> Result<Vec<[f64; D]>, SceneError> {
    let at_rest = moving::at_rest(scene, solids);
    if at_rest.is_empty() {
        return Ok(Vec::new());
    }
    let (domain, place) = searchable(scene, lattice, bounds)?;
    wall_particles(&at_rest, lattice, support, &domain)
        .map(|cells| cells.positions)
        .map_err(|error| lattice_error(scene, place, &error))
}

/// The domain, unless it is too large to be searched, and where the scene gives it.
fn searchable<const D: usize>(
    scene: &Scene,
    lattice: &Lattice<D>,
    bounds: &Aabb<D>,
) -> Result<(Domain<D>, scene::Place), SceneError> {
    let place = scene.domain.as_ref().map_or(scene.numerics.spacing.place, |domain| domain.place);
    let side = |axis: usize| (bounds.max[axis] - bounds.min[axis]) / lattice.spacing();
    if (1..D).map(side).product::<f64>() > MOST_ROWS || side(0) > LONGEST_ROW {
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
    Ok((Domain { bounds: *bounds, periodic: scene.periodic_axes() }, place))
}
