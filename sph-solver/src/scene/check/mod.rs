//! What types cannot say: ranges, dimensions, names, contradictions.

mod motion;
mod outputs;
mod periodic;
mod reference;
mod refine;
mod shapes;
mod values;

use super::document::Place;
use super::error::{ErrorKind, SceneError};
use super::fluid::{Fluid, Pressure};
use super::formula::{Formula, FormulaError, TimedFormula};
use super::located::At;
use super::numerics::{Numerics, SoundSpeed};
use super::root::Scene;
use super::solid::{Solid, WallFriction};
use values::Values;

/// Checks everything that needs no file but the scene itself.
pub(super) fn check(scene: &Scene) -> Result<(), SceneError> {
    let values = Values { scene };
    if !matches!(*scene.dimension, 2 | 3) {
        return Err(values.out_of_range(
            scene.dimension.place,
            "dimension",
            "2 or 3",
            *scene.dimension,
            "flows are simulated in two or three dimensions",
        ));
    }
    if let Some(name) = &scene.name {
        values.file_name("name", name)?;
    }
    values.positive("end_time", &scene.end_time, "in seconds, for example end_time = 1.0")?;
    if let Some(gravity) = &scene.gravity {
        values.components("gravity", gravity)?;
    }
    if let Some(domain) = &scene.domain {
        values.corners("domain", &domain.min, &domain.max)?;
    }
    periodic::check(&values)?;
    numerics(&values, &scene.numerics)?;
    let (name, first) = scene.fluid()?;
    fluid(&values, name, first)?;
    let mut names = Vec::new();
    for (index, solid) in scene.solid.iter().enumerate() {
        values.name(&format!("solid.{index}.name"), &solid.name)?;
        values.unique("solid", &solid.name, &mut names)?;
        shapes::solid(&values, index, solid)?;
        walls(&values, index, solid)?;
        motion::check(&values, index, solid)?;
    }
    refine::check(&values)?;
    outputs::probes(&values)?;
    outputs::intervals(&values)?;
    scene.reference.as_ref().map_or(Ok(()), |known| reference::check(&values, known))
}

/// The largest Courant number that is accepted; leapfrog is stable up to 1.72 c0 dt/h (δ = 0.1,
/// Wendland C2, h = 2 spacings).
const LARGEST_CFL: f64 = 1.7;

fn numerics(values: &Values<'_>, numerics: &Numerics) -> Result<(), SceneError> {
    let positive = "it is the initial distance of particles in metres, for example 0.02";
    values.positive("numerics.spacing", &numerics.spacing, positive)?;
    values.within(
        "numerics.support",
        &numerics.support,
        2.0..=6.0,
        "between 2 and 6",
        "support radius divided by spacing: 3 suits most scenes, 4 is for accuracy runs",
    )?;
    values.positive("numerics.cfl", &numerics.cfl, "1.0 suits most scenes")?;
    values.within(
        "numerics.cfl",
        &numerics.cfl,
        0.0..=LARGEST_CFL,
        "at most 1.7",
        "beyond 1.72, the linear stability limit of the leapfrog scheme, every run blows up; 1.0 \
         suits most scenes",
    )?;
    if let SoundSpeed::Given(speed) = numerics.sound_speed.value {
        let speed = At { value: speed, place: numerics.sound_speed.place };
        let help = "in m/s, about ten times the largest flow speed, or \"auto\"";
        values.positive("numerics.sound_speed", &speed, help)?;
    }
    let strength = |key, value: &At<f64>, usual| {
        let help = format!("usual is {usual}; 0 leaves the term out");
        values.within(key, value, 0.0..=1.0, "between 0 and 1", &help)
    };
    if let Some(viscosity) = &numerics.artificial_viscosity {
        strength("numerics.artificial_viscosity", viscosity, "0.02")?;
    }
    strength("numerics.density_diffusion", &numerics.density_diffusion, "0.1")?;
    values.within(
        "numerics.skin",
        &numerics.skin,
        0.0..=1.0,
        "between 0 and 1",
        "skin of the neighbour lists divided by the support radius; 0.1 suits most scenes",
    )
}

fn walls(values: &Values<'_>, index: usize, solid: &At<Solid>) -> Result<(), SceneError> {
    if let Some(point) = &solid.moments_about {
        values.components(&format!("solid.{index}.moments_about"), point)?;
    }
    match &solid.wall_friction {
        Some(friction) if **friction == WallFriction::NoSlip => match values.scene.viscosity() {
            Some(_) => Ok(()),
            None => Err(values.invalid(
                friction.place,
                "a wall without slip needs a fluid with a viscosity".into(),
                "give `viscosity` in the table of the fluid, in Pa s (water has 0.001), or \
                 wall_friction = \"slip\"",
            )),
        },
        _ => Ok(()),
    }
}

fn fluid(values: &Values<'_>, name: &str, fluid: &At<Fluid>) -> Result<(), SceneError> {
    let path = format!("fluid.{name}");
    values.positive(&format!("{path}.density"), &fluid.density, "in kg/m³, water has 1000")?;
    if let Some(viscosity) = &fluid.viscosity {
        let key = format!("{path}.viscosity");
        values.not_negative(&key, viscosity, "in Pa s; leave it out for an inviscid fluid")?;
        let artificial = values.scene.numerics.artificial_viscosity.filter(|alpha| **alpha > 0.0);
        if let Some(artificial) = artificial.filter(|_| **viscosity > 0.0) {
            return Err(values.invalid(
                artificial.place,
                format!("`numerics.artificial_viscosity` and `{key}` cannot act together"),
                "remove one of them",
            ));
        }
    }
    if let Some(pressure) = &fluid.cavitation_pressure {
        values.within(
            &format!("{path}.cavitation_pressure"),
            pressure,
            f64::MIN..=0.0,
            "at most 0",
            "pressures are relative to that of the air: water cavitates at about -100000 Pa",
        )?;
    }
    if fluid.regions.is_empty() {
        let kind = ErrorKind::Nothing {
            why: format!("fluid `{name}` has no regions"),
            help: "for example: regions = [{ box = { min = [0, 0], max = [1, 2] } }]".into(),
        };
        return Err(values.scene.error(fluid.regions.place, kind));
    }
    jitter(values, &path, fluid)?;
    fields(values, &path, fluid.velocity.as_ref(), Some(&fluid.pressure))?;
    for (index, region) in fluid.regions.iter().enumerate() {
        let path = format!("{path}.regions.{index}");
        shapes::one_of(values, &path, region.place, &region.shapes(), &region.placing())?;
        fields(values, &path, region.velocity.as_ref(), region.pressure.as_ref())?;
    }
    Ok(())
}

fn jitter(values: &Values<'_>, path: &str, fluid: &Fluid) -> Result<(), SceneError> {
    let Some(jitter) = &fluid.jitter else { return Ok(()) };
    values.within(
        &format!("{path}.jitter"),
        jitter,
        0.0..=0.4,
        "between 0 and 0.4",
        "the largest shift along each axis divided by the spacing; 0.1 suits most studies",
    )?;
    if **jitter > 0.0 && !values.scene.solid.is_empty() {
        return Err(values.invalid(
            jitter.place,
            format!("`{path}.jitter` would push particles into the walls"),
            "leave it out: runs with walls begin on the lattice",
        ));
    }
    Ok(())
}

fn fields(
    values: &Values<'_>,
    path: &str,
    velocity: Option<&At<Vec<At<Formula>>>>,
    pressure: Option<&At<Pressure>>,
) -> Result<(), SceneError> {
    if let Some(velocity) = velocity {
        values.length(&format!("{path}.velocity"), velocity.place, velocity.len())?;
        for component in velocity.iter() {
            formula(values, component, component.place)?;
        }
    }
    match pressure {
        Some(At { value: Pressure::Formula(pressure), place }) => formula(values, pressure, *place),
        Some(At { value: Pressure::Hydrostatic, place }) if !has_gravity(values.scene) => {
            Err(values.scene.error(
                *place,
                ErrorKind::Invalid {
                    what: format!("`{path}.pressure` is hydrostatic, but the scene has no gravity"),
                    help: "add `gravity`, or give the pressure as a formula".into(),
                },
            ))
        }
        _ => Ok(()),
    }
}

fn has_gravity(scene: &Scene) -> bool {
    scene.gravity.as_ref().is_some_and(|gravity| gravity.iter().any(|g| *g != 0.0))
}

fn formula(values: &Values<'_>, formula: &Formula, place: Place) -> Result<(), SceneError> {
    let found = formula.check(values.scene.dimension());
    found.map_err(|error| refuse(values, formula.text(), place, error))
}

fn formula_of_time(
    values: &Values<'_>,
    formula: &TimedFormula,
    place: Place,
) -> Result<(), SceneError> {
    formula.check_of_time().map_err(|error| refuse(values, formula.text(), place, error))
}

fn refuse(values: &Values<'_>, formula: &str, place: Place, error: FormulaError) -> SceneError {
    let FormulaError { reason, help } = error;
    values.scene.error(place, ErrorKind::Formula { formula: formula.into(), reason, help })
}
