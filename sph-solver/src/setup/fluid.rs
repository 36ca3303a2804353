//! The fluid at the start: lattice points inside regions, with the initial fields of the scene.

use super::bodies::bodies;
use super::particles::Particles;
use crate::eos::EquationOfState;
use crate::grading::root;
use crate::scene::{At, ErrorKind, Fluid, Formula, Place, Pressure, Region, Scene, SceneError};
use sph_geometry::Lattice;
use std::cell::LazyCell;

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
        cells: &Cells<'_, D>,
    ) -> Result<Particles<D>, SceneError> {
        let column =
            LazyCell::new(|| Column::new(*fluid.density, &scene.gravity(), cells, &self.position));
        let mut particles = Particles::default();
        for (region, range) in regions(fluid, &self.ends) {
            let At { value: pressure, place } = region.pressure.as_ref().unwrap_or(&fluid.pressure);
            if matches!(pressure, Pressure::Hydrostatic) {
                particles.resting.push((range.clone(), scene.gravity()));
            }
            for i in range {
                let x = self.position[i];
                let p = match pressure {
                    Pressure::Hydrostatic => column.pressure(i, &x),
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
                let mass = *fluid.density * cells.volume(i);
                particles.push(x, self.velocity[i], density, mass, 0);
            }
        }
        Ok(particles)
    }
}

/// The space of each particle at the start.
pub struct Cells<'a, const D: usize> {
    /// The lattice, the coarsest one where the spacing varies.
    pub lattice: &'a Lattice<D>,
    /// Volumes of the particles, m^D; none where they are the cells of the lattice.
    pub volume: Option<&'a [f64]>,
}

impl<const D: usize> Cells<'_, D> {
    /// Volume of particle `i`, m^D.
    fn volume(&self, i: usize) -> f64 {
        self.volume.map_or(self.lattice.spacing().powi(D as i32), |volume| volume[i])
    }

    /// Edge of its cell, m.
    fn edge(&self, i: usize) -> f64 {
        self.volume.map_or(self.lattice.spacing(), |volume| root::<D>(volume[i]))
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

/// The fluid as columns under gravity, one for each body of water.
pub struct Column<const D: usize> {
    /// ρ0 times gravity, N/m³.
    weight: [f64; D],
    /// Body of each particle.
    body: Vec<u32>,
    /// Smallest ρ0 g·x over each body, Pa: that of its surface.
    tops: Vec<f64>,
}

impl<const D: usize> Column<D> {
    /// The columns of fluid at `position`. The surface of each is half a spacing above its highest
    /// particles.
    pub fn new(
        density0: f64,
        gravity: &[f64; D],
        cells: &Cells<'_, D>,
        position: &[[f64; D]],
    ) -> Self {
        let weight = gravity.map(|g| density0 * g);
        let strength = weight.iter().map(|w| w * w).sum::<f64>().sqrt();
        let (body, count) = match cells.volume {
            None => bodies(cells.lattice, position),
            // Packed particles may leave a cell of the lattice empty, but none that is a half longer.
            Some(_) => bodies(&cells.lattice.coarser(1.5), position),
        };
        let mut tops = vec![f64::INFINITY; count];
        for (i, (x, body)) in position.iter().zip(&body).enumerate() {
            let top = &mut tops[*body as usize];
            *top = top.min(dot(&weight, x) - 0.5 * cells.edge(i) * strength);
        }
        Self { weight, body, tops }
    }

    /// Hydrostatic pressure at `x`, where particle `i` is: ρ0 g times its depth below the surface of
    /// its body of water, Pa.
    pub fn pressure(&self, i: usize, x: &[f64; D]) -> f64 {
        dot(&self.weight, x) - self.tops[self.body[i] as usize]
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
        let lattice = Lattice::new([0.0; 2], 1.0).unwrap();
        let cells = Cells { lattice: &lattice, volume: None };
        let position = [[0.5, 0.5], [0.5, 1.5]];
        let column = Column::new(1000.0, &[0.0, -10.0], &cells, &position);
        assert_eq!(column.pressure(1, &position[1]), 5_000.0);
        assert_eq!(column.pressure(0, &position[0]), 15_000.0);
        let position = [[2.5, 0.5], [3.5, 0.5], [3.5, 1.5]];
        let column = Column::new(1000.0, &[10.0, 0.0], &cells, &position);
        assert_eq!(column.pressure(2, &position[2]), 15_000.0);
    }

    #[test]
    fn every_body_of_water_has_its_own_surface() {
        let lattice = Lattice::new([0.0; 2], 1.0).unwrap();
        let cells = Cells { lattice: &lattice, volume: None };
        // A column of two cells, a gap of one, a pool of one cell; corners do not connect.
        let position = [[0.5, 0.5], [0.5, 1.5], [2.5, 0.5], [1.5, 2.5]];
        let column = Column::new(1000.0, &[0.0, -10.0], &cells, &position);
        let pressure: Vec<f64> =
            position.iter().enumerate().map(|(i, x)| column.pressure(i, x)).collect();
        assert_eq!(pressure, [15_000.0, 5_000.0, 5_000.0, 5_000.0]);
    }
}
