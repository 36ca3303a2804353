//! Renormalised gradients: exact for linear fields on any arrangement of neighbours.

use super::eigen::symmetric_eigen;
use crate::{Lanes, Real};
use core::array::from_fn;
use nalgebra::{SMatrix, SVector};

/// Sums `M_i = Σ V_j (x_j − x_i) ⊗ ∇_i W_ij`: the identity for a perfect neighbourhood.
///
/// M is symmetric and, as kernels fall with distance, has no negative eigenvalue.
#[derive(Debug, Clone, Copy)]
pub struct GradientSum<const D: usize, L> {
    /// Upper triangle.
    entries: [[L; D]; D],
}

impl<const D: usize, L: Lanes> GradientSum<D, L> {
    /// Nothing added yet.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { entries: [[L::zero(); D]; D] }
    }

    /// Adds a neighbour a lane: `offset = x_i − x_j` and `weight = V_j F_ij` with
    /// `∇_i W_ij = F_ij r_ij`, see [`Kernel::gradient_factor`](crate::Kernel::gradient_factor).
    #[inline(always)]
    pub fn add(&mut self, offset: &[L; D], weight: L) {
        for (a, row) in self.entries.iter_mut().enumerate() {
            // (x_j − x_i) ⊗ F r_ij = −F r_ij ⊗ r_ij.
            let scaled = -(weight * offset[a]);
            for (entry, &x) in row.iter_mut().zip(offset).skip(a) {
                *entry = scaled.mul_add(x, *entry);
            }
        }
    }

    /// The sum M.
    #[inline(always)]
    pub fn matrix(&self) -> SMatrix<f64, D, D> {
        let upper: [[f64; D]; D] = self.entries.map(|row| row.map(|entry| entry.sum().to_f64()));
        SMatrix::from_fn(|a, b| upper[a.min(b)][a.max(b)])
    }
}

/// The matrix `L_i = M_i⁻¹` that makes `L_i Σ V_j (f_j − f_i) ∇_i W_ij` the exact gradient of every
/// linear field f.
///
/// Source: P. W. Randles and L. D. Libersky, Comput. Methods Appl. Mech. Eng. 139 (1996) 375;
/// J. Bonet and T.-S. L. Lok, Comput. Methods Appl. Mech. Eng. 180 (1999) 97.
///
/// ```
/// use sph_kernels::{GradientCorrection, GradientSum, Kernel, WendlandC2};
///
/// let neighbors = [[0.5, 0.1], [-0.3, 0.4], [0.0, -0.6], [-0.5, -0.2]];
/// let field = |x: [f64; 2]| 1.0 + 2.0 * x[0] - 3.0 * x[1];
///
/// let (volume, radius) = (0.25, 1.0);
/// let mut sum = GradientSum::<2, f64>::zero();
/// let mut gradient = [0.0; 2];
/// for x in neighbors {
///     let offset = x.map(|x| -x); // x_i − x_j of a particle at the origin
///     let distance = f64::hypot(x[0], x[1]);
///     let weight = volume * WendlandC2::gradient_factor::<2, f64>(distance, radius);
///     sum.add(&offset, weight);
///     for k in 0..2 {
///         gradient[k] += (field(x) - field([0.0; 2])) * weight * offset[k];
///     }
/// }
/// let correction = GradientCorrection::new(&sum.matrix(), 0.1);
/// let [x, y] = correction.apply(&gradient);
/// assert!((x - 2.0).abs() < 1e-12 && (y + 3.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GradientCorrection<const D: usize> {
    matrix: SMatrix<f64, D, D>,
    smallest: f64,
}

impl<const D: usize> GradientCorrection<D> {
    /// Inverts M, given by [`GradientSum::matrix`].
    ///
    /// Along eigenvectors whose eigenvalue is below `floor`, the neighbours do not determine a
    /// gradient; the eigenvalue counts as `floor` there. So the correction never amplifies by more
    /// than 1/`floor` and is finite for a particle alone. It is exact where
    /// [`smallest_eigenvalue`](Self::smallest_eigenvalue) ≥ `floor`. Usual: 0.05 to 0.2.
    ///
    /// # Panics
    /// If `floor` is not positive.
    pub fn new(matrix: &SMatrix<f64, D, D>, floor: f64) -> Self {
        assert!(floor > 0.0, "the floor of the eigenvalues must be positive, not {floor}");
        let (values, vectors) = symmetric_eigen(matrix);
        let inverse = SVector::from(values.map(|value| 1.0 / value.max(floor)));
        let matrix = vectors * SMatrix::from_diagonal(&inverse) * vectors.transpose();
        Self { matrix, smallest: values.into_iter().fold(f64::INFINITY, f64::min) }
    }

    /// Changes nothing.
    pub fn identity() -> Self {
        Self { matrix: SMatrix::identity(), smallest: 1.0 }
    }

    /// The matrix L.
    pub fn matrix(&self) -> &SMatrix<f64, D, D> {
        &self.matrix
    }

    /// Smallest eigenvalue λ of M: near 1 inside, near 0 for a particle alone.
    ///
    /// Marrone et al. take particles with λ ≤ 0.2 for isolated and look for the free surface among
    /// those with λ ≤ 0.75. Source: S. Marrone, A. Colagrossi, D. Le Touzé and G. Graziani,
    /// J. Comput. Phys. 229 (2010) 3652.
    pub fn smallest_eigenvalue(&self) -> f64 {
        self.smallest
    }

    /// `L g` for a gradient sum `g = Σ V_j (f_j − f_i) ∇_i W_ij`.
    pub fn apply(&self, gradient: &[f64; D]) -> [f64; D] {
        from_fn(|a| (0..D).map(|b| self.matrix[(a, b)] * gradient[b]).sum())
    }
}

#[cfg(test)]
mod tests;
