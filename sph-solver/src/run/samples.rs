//! Numbers sampled from a full step: energies, momentum, probes. The same bits on any ranks.

use super::gauges::Field;
use crate::error::RunError;
use crate::kernel_shape::KernelShape;
use crate::model::Model;
use crate::simulation::FullStep;
use sph_decomp::{Communicator, ExactSum, global_sums};

/// What a probe reads at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Pressure, Pa.
    Pressure,
    /// Density, kg/m³.
    Density,
    /// Velocity component along an axis, m/s.
    Velocity(usize),
}

/// A probe: one table of numbers over time.
#[derive(Debug, Clone, PartialEq)]
pub enum Probe<const D: usize> {
    /// Fields at a fixed point, by Shepard interpolation over the fluid within one support radius.
    Point {
        /// Where, m.
        at: [f64; D],
        /// What.
        quantities: Vec<Quantity>,
    },
    /// Means of fields over a patch, such as the face of a pressure sensor.
    Patch {
        /// Points that cover it, m.
        points: Vec<[f64; D]>,
        /// What.
        quantities: Vec<Quantity>,
    },
    /// The level of the water on the vertical line through a point.
    Level {
        /// The point, m.
        at: [f64; D],
    },
    /// The flow of volume through a plane.
    Flow {
        /// A point of the plane, m.
        at: [f64; D],
        /// The direction that counts as positive, of any length.
        normal: [f64; D],
    },
    /// The farthest fluid particle along an axis: the front of a dam break.
    Front {
        /// 0, 1 or 2 for x, y, z.
        axis: usize,
    },
}

/// Conserved quantities of the fluid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget<const D: usize> {
    /// Kinetic energy, J (J/m in two dimensions, like all of these).
    pub kinetic: f64,
    /// Potential energy in gravity along the open axes, zero at the origin, J.
    pub potential: f64,
    /// Elastic energy, J.
    pub elastic: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; D],
    /// Mass, kg.
    pub mass: f64,
    /// Largest |ρ/ρ0 − 1|.
    pub compression: f64,
    /// Largest speed, m/s.
    pub speed: f64,
    /// Lowest potential energy per mass, J/kg.
    pub lowest: f64,
}

/// Sums the budget over all ranks. Collective.
pub fn budget<const D: usize>(
    comm: &dyn Communicator,
    model: &Model<D>,
    full: &FullStep<D>,
) -> Result<Budget<D>, RunError> {
    let eos = &model.equation_of_state;
    let n = full.id.len();
    let dot = |a: &[f64; D], b: &[f64; D]| (0..D).map(|k| a[k] * b[k]).sum::<f64>();
    let kinetic = (0..n).map(|i| 0.5 * full.mass[i] * dot(&full.velocity[i], &full.velocity[i]));
    let potential = (0..n).map(|i| full.mass[i] * model.potential_energy(&full.position[i]));
    let elastic = (0..n).map(|i| full.mass[i] * model.elastic_energy(full.density[i]));
    let mut sums: Vec<ExactSum> = vec![
        kinetic.collect(),
        potential.collect(),
        elastic.collect(),
        full.mass.iter().copied().collect(),
    ];
    for k in 0..D {
        sums.push((0..n).map(|i| full.mass[i] * full.velocity[i][k]).collect());
    }
    let sums = global_sums(&comm, &sums)?;
    let compression = full.density.iter().map(|d| (d / eos.density0() - 1.0).abs());
    let speed = full.velocity.iter().map(|v| dot(v, v).sqrt());
    let depth = full.position.iter().map(|x| -model.potential_energy(x));
    let mut maxima = [
        compression.fold(0.0, f64::max),
        speed.fold(0.0, f64::max),
        depth.fold(f64::NEG_INFINITY, f64::max),
    ];
    comm.max_f64(&mut maxima)?;
    Ok(Budget {
        kinetic: sums[0],
        potential: sums[1],
        elastic: sums[2],
        mass: sums[3],
        momentum: std::array::from_fn(|k| sums[4 + k]),
        compression: maxima[0],
        speed: maxima[1],
        lowest: -maxima[2],
    })
}

/// Reads a probe; one number per column of [`Probe::columns`], NaN where there is nothing to read: at a
/// point without fluid within one support radius, for a front or level without fluid. Collective.
pub fn read<const D: usize>(
    comm: &dyn Communicator,
    model: &Model<D>,
    kernel: &KernelShape,
    full: &FullStep<D>,
    probe: &Probe<D>,
) -> Result<Vec<f64>, RunError> {
    let field = Field { comm, model, full, weight: kernel.w };
    match probe {
        Probe::Patch { points, quantities } => field.means(points, quantities),
        Probe::Level { at } => Ok(vec![field.level(at)?]),
        Probe::Flow { at, normal } => Ok(vec![field.flow(at, normal)?]),
        Probe::Front { axis } => {
            let farthest = full.position.iter().map(|x| x[*axis]);
            let mut front = [farthest.fold(f64::NEG_INFINITY, f64::max)];
            comm.max_f64(&mut front)?;
            Ok(vec![if front[0].is_finite() { front[0] } else { f64::NAN }])
        }
        Probe::Point { at, quantities } => {
            let sums = field.sums(&[*at], quantities)?;
            let wet = sums[0] > 0.0;
            let read = |sum: &f64| if wet { sum / sums[0] } else { f64::NAN };
            let readings = sums[1..].iter().map(read);
            Ok(readings.chain([f64::from(u8::from(wet))]).collect())
        }
    }
}

/// A quantity of particle `i`.
pub fn value<const D: usize>(
    model: &Model<D>,
    full: &FullStep<D>,
    i: usize,
    quantity: Quantity,
) -> f64 {
    match quantity {
        Quantity::Pressure => model.equation_of_state.pressure(full.density[i]),
        Quantity::Density => full.density[i],
        Quantity::Velocity(axis) => full.velocity[i][axis],
    }
}

impl<const D: usize> Probe<D> {
    /// Names and units of the numbers that a reading gives.
    pub fn columns(&self) -> Vec<(&'static str, &'static str)> {
        match self {
            Self::Front { axis } => vec![(["x", "y", "z"][*axis], "m")],
            Self::Level { .. } => vec![("level", "m")],
            Self::Flow { .. } => vec![("flow", if D == 2 { "m2/s" } else { "m3/s" })],
            Self::Point { quantities, .. } | Self::Patch { quantities, .. } => {
                quantities.iter().map(Quantity::column).chain([("wet", "1")]).collect()
            }
        }
    }
}

impl Quantity {
    fn column(&self) -> (&'static str, &'static str) {
        match self {
            Self::Pressure => ("pressure", "Pa"),
            Self::Density => ("density", "kg/m3"),
            Self::Velocity(axis) => (["velocity_x", "velocity_y", "velocity_z"][*axis], "m/s"),
        }
    }
}
