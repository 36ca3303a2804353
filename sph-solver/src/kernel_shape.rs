//! What is left of a kernel where no pair is looked at: a few numbers and one function.

use sph_kernels::Kernel;

/// A kernel as a value, for everything outside of the sweeps. Sweeps are compiled for a
/// [`Kernel`]; this says which one it was.
#[derive(Debug, Clone, Copy)]
pub struct KernelShape {
    /// Name in files, such as "wendland-c2".
    pub name: &'static str,
    /// Support radius divided by the smoothing length.
    pub radius_over_h: f64,
    /// σ times the factor of the slope: `∇W V R^(D+2) = gradient · slope_shape(q) r V`.
    pub gradient: f64,
    /// `w(q)`, see [`Kernel::w`].
    pub w: fn(f64) -> f64,
}

impl KernelShape {
    /// The shape of a kernel in a number of dimensions.
    pub fn of<K: Kernel>(dimension: usize) -> Self {
        Self {
            name: K::NAME,
            radius_over_h: K::RADIUS_OVER_H,
            gradient: K::norm(dimension) * K::SLOPE_FACTOR,
            w: K::w::<f64>,
        }
    }
}

impl PartialEq for KernelShape {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.gradient.to_bits() == other.gradient.to_bits()
    }
}
