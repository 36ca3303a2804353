//! The state of the particles that a rank owns: what is integrated, migrated and checkpointed.

use sph_decomp::Columns;

/// Structure of arrays over particles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct State<const D: usize> {
    /// Global id.
    pub id: Vec<u64>,
    /// Mass, kg.
    pub mass: Vec<f64>,
    /// Density, kg/m³.
    pub density: Vec<f64>,
    /// Position, m.
    pub position: Vec<[f64; D]>,
    /// Velocity, m/s; half a step behind or ahead of the positions, see [`crate::passes`].
    pub velocity: Vec<[f64; D]>,
    /// ∇p/ρ as walls continue it, m/s². A new run that begins without takes gravity, as at rest.
    pub pressure_gradient: Vec<[f64; D]>,
}

impl<const D: usize> State<D> {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// All columns, to sort, send and receive particles.
    pub fn columns(&mut self) -> impl Columns + '_ {
        (
            &mut self.id,
            &mut self.mass,
            &mut self.density,
            &mut self.position,
            &mut self.velocity,
            &mut self.pressure_gradient,
        )
    }

    /// Keeps the particles named by `index`, in that order.
    pub fn keep(&mut self, index: &[u32]) {
        // Particles that no run has seen yet need not say.
        self.pressure_gradient.resize(self.id.len(), [0.0; D]);
        self.columns().permute(index);
    }

    /// The columns themselves, ids first.
    pub fn into_columns(self) -> StateColumns<D> {
        (self.id, self.mass, self.density, self.position, self.velocity, self.pressure_gradient)
    }

    /// Back from [`into_columns`](Self::into_columns).
    pub fn from_columns(columns: StateColumns<D>) -> Self {
        let (id, mass, density, position, velocity, pressure_gradient) = columns;
        Self { id, mass, density, position, velocity, pressure_gradient }
    }
}

/// Ids, masses, densities, positions, velocities, pressure gradients.
pub type StateColumns<const D: usize> =
    (Vec<u64>, Vec<f64>, Vec<f64>, Vec<[f64; D]>, Vec<[f64; D]>, Vec<[f64; D]>);
