//! The fluid at the start: lattice points inside regions, with the initial fields of the scene.

use super::particles::Particles;
use crate::eos::EquationOfState;
use crate::scene::{At, ErrorKind, Fluid, Formula, Place, Pressure, Region, Scene, SceneError};

/// Fluid particles before they have a density: positions, velocities and the region of each.
pub struct Filling<const D: usize> {
    pub position: Vec<[f64; D]>,
    pub velocity: Vec<[f64; D]>,
    /// Particles of region k end before index `ends[k]`.
    pub ends: Vec<usize>,
}

impl<const D: usize> Filling<D> {
    /// The particles at `position`, moving as the fluid and its regions say.
    pub fn new(
        scene: &Scene,
        fluid: &Fluid,
        position: Vec<[f64; D]>,
        ends: Vec<usize>,
    ) -> Result<Self, SceneError> {
        let mut velocity = vec![[0.0; D]; position.len()];
        for (region, range) in regions(fluid, &ends) {
            let Some(formulas) = region.velocity.as_ref().or(fluid.velocity.as_ref()) else {
                continue;
            };
            for (v, x) in velocity[range.clone()].iter_mut().zip(&position[range]) {
                for (component, formula) in v.iter_mut().zip(formulas.iter()) {
                    *component = finite(scene, formula, formula.place, x)?;
                }
            }
        }
        Ok(Self { position, velocity, ends })
    }

    /// Largest initial speed, m/s.
    pub fn largest_speed(&self) -> f64 {
        let square = |v: &[f64; D]| v.iter().map(|c| c * c).sum::<f64>();
        self.velocity.iter().map(square).fold(0.0, f64::max).sqrt()
    }

    /// Adds the fluid particles with the densities that belong to their initial pressures.
    pub fn finish(
        self,
        scene: &Scene,
        fluid: &Fluid,
        state: &EquationOfState,
        column: &Column<D>,
        mass: f64,
    ) -> Result<Particles<D>, SceneError> {
        let mut particles = Particles::default();
        for (region, range) in regions(fluid, &self.ends) {
            let At { value: pressure, place } = region.pressure.as_ref().unwrap_or(&fluid.pressure);
            for i in range {
                let x = self.position[i];
                let p = match pressure {
                    Pressure::Hydrostatic => column.pressure(&x),
                    Pressure::Formula(formula) => finite(scene, formula, *place, &x)?,
                };
                let density = state.density(p);
                // Tait's equation gives NaN for a tension that is too strong.
                if density.is_nan() || density <= 0.0 {
                    let kind = ErrorKind::Invalid {
                        what: format!(
                            "the initial pressure at {x:?} is {p} Pa, which no density belongs to"
                        ),
                        help: "give a larger pressure or a larger numerics.sound_speed".into(),
                    };
                    return Err(scene.error(*place, kind));
                }
                particles.push(x, self.velocity[i], density, mass, 0);
            }
        }
        Ok(particles)
    }
}

/// Each region with its range of particles.
fn regions<'a>(
    fluid: &'a Fluid,
    ends: &'a [usize],
) -> impl Iterator<Item = (&'a At<Region>, std::ops::Range<usize>)> {
    let starts = std::iter::once(0).chain(ends.iter().copied());
    fluid.regions.iter().zip(starts.zip(ends).map(|(start, end)| start..*end))
}

fn finite<const D: usize>(
    scene: &Scene,
    formula: &Formula,
    place: Place,
    x: &[f64; D],
) -> Result<f64, SceneError> {
    let value = formula.at(x);
    if value.is_finite() {
        return Ok(value);
    }
    let kind = ErrorKind::Formula {
        formula: formula.text().into(),
        reason: format!("it gives {value} at {x:?}, where there is a particle"),
        help: "change the formula so that it is defined everywhere in the fluid".into(),
    };
    Err(scene.error(place, kind))
}

/// The fluid as a column under gravity.
pub struct Column<const D: usize> {
    /// ρ0 times gravity, N/m³.
    weight: [f64; D],
    /// Smallest ρ0 g·x over the fluid, Pa: that of its highest point.
    top: f64,
}

impl<const D: usize> Column<D> {
    /// The column of fluid at `position`. Its surface is half a `spacing` above the highest particle.
    pub fn new(density0: f64, gravity: &[f64; D], spacing: f64, position: &[[f64; D]]) -> Self {
        let weight = gravity.map(|g| density0 * g);
        let strength = weight.iter().map(|w| w * w).sum::<f64>().sqrt();
        let highest = position.iter().map(|x| dot(&weight, x)).fold(f64::INFINITY, f64::min);
        Self { weight, top: highest - 0.5 * spacing * strength }
    }

    /// Hydrostatic pressure at a point: ρ0 g times its depth below the surface, Pa.
    pub fn pressure(&self, x: &[f64; D]) -> f64 {
        dot(&self.weight, x) - self.top
    }
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_grows_with_depth_along_any_gravity() {
        let position = [[0.5, 0.5], [0.5, 1.5]];
        let column = Column::new(1000.0, &[0.0, -10.0], 1.0, &position);
        assert_eq!(column.pressure(&position[1]), 5_000.0);
        assert_eq!(column.pressure(&position[0]), 15_000.0);
        let column = Column::new(1000.0, &[10.0, 0.0], 1.0, &[[2.0, 0.0], [4.0, 0.0]]);
        assert_eq!(column.pressure(&[4.0, 7.0]), 25_000.0);
    }
}
