//! Moments of a neighbourhood: how well its sums stand for integrals.

use crate::{GradientSum, Kernel, Lanes};
use nalgebra::{SMatrix, SVector};

/// Sums over the neighbours of one particle, itself included, that would be 1, 0 and −I if they
/// were integrals.
///
/// * `ΣVW` = Σ V_j W_ij: a constant is reproduced up to the factor `ΣVW`.
/// * `ΣV∇W` = Σ V_j ∇_i W_ij, 1/m: a constant gets this gradient.
/// * `ΣV r⊗∇W` = Σ V_j r_ij ⊗ ∇_i W_ij: the gradient of a linear field is multiplied by its negative.
///
/// Source: N. J. Quinlan, M. Basa and M. Lastiwka, Int. J. Numer. Meth. Eng. 66 (2006) 2064, on
/// the errors that follow.
#[derive(Debug, Clone, Copy)]
pub struct Moments<const D: usize> {
    unity: f64,
    first: [f64; D],
    gradient: GradientSum<D, f64>,
}

impl<const D: usize> Moments<D> {
    /// Nothing added yet.
    pub fn zero() -> Self {
        Self { unity: 0.0, first: [0.0; D], gradient: GradientSum::zero() }
    }

    /// Adds a neighbour, or the particle itself with a zero offset.
    ///
    /// `offset = x_i − x_j` in m, the radius `R_ij` of the pair in m, the volume `V_j` in m^D.
    pub fn add<K: Kernel>(&mut self, offset: &[f64; D], radius: f64, volume: f64) {
        let distance = Lanes::sqrt(offset.iter().map(|x| x * x).sum::<f64>());
        let weight = volume * K::gradient_factor::<D, f64>(distance, radius);
        self.unity += volume * K::value::<D, f64>(distance, radius);
        for (sum, x) in self.first.iter_mut().zip(offset) {
            *sum += weight * x;
        }
        self.gradient.add(offset, weight);
    }

    /// `ΣVW`, 1 if perfect.
    pub fn unity(&self) -> f64 {
        self.unity
    }

    /// `ΣV∇W`, 1/m, 0 if perfect.
    pub fn first(&self) -> SVector<f64, D> {
        SVector::from(self.first)
    }

    /// `ΣV r⊗∇W`, −I if perfect.
    pub fn gradient(&self) -> SMatrix<f64, D, D> {
        -self.gradient.matrix()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CubicSpline, WendlandC2, WendlandC4};

    /// Marsaglia's xorshift, uniform in [−1, 1].
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// Moments of the particle in the middle of a unit lattice, each coordinate of each particle
    /// moved by up to `jitter`.
    fn lattice<K: Kernel, const D: usize>(
        radius: f64,
        jitter: f64,
        noise: &mut Noise,
    ) -> Moments<D> {
        let reach = (radius + 2.0 * jitter).ceil() as i32;
        let side = 2 * reach + 1;
        let centre: [f64; D] = core::array::from_fn(|_| jitter * noise.next());
        let mut moments = Moments::zero();
        for cell in 0..side.pow(D as u32) {
            let node: [i32; D] = core::array::from_fn(|k| cell / side.pow(k as u32) % side - reach);
            let offset: [f64; D] = if node == [0; D] {
                [0.0; D]
            } else {
                core::array::from_fn(|k| centre[k] - f64::from(node[k]) - jitter * noise.next())
            };
            moments.add::<K>(&offset, radius, 1.0);
        }
        moments
    }

    /// Root mean square over `samples` neighbourhoods of the error of `ΣVW` and of the diagonal of
    /// `ΣV r⊗∇W`.
    fn errors<K: Kernel, const D: usize>(radius: f64, jitter: f64, samples: usize) -> [f64; 2] {
        let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
        let mut squares = [0.0; 2];
        for _ in 0..samples {
            let moments = lattice::<K, D>(radius, jitter, &mut noise);
            squares[0] += (moments.unity() - 1.0).powi(2);
            let diagonal = (moments.gradient() + SMatrix::identity()).diagonal();
            squares[1] += diagonal.norm_squared() / D as f64;
        }
        squares.map(|square| (square / samples as f64).sqrt())
    }

    fn check<K: Kernel, const D: usize>(radius: f64, lattice: [f64; 2], jitter: [f64; 2]) {
        let exact = errors::<K, D>(radius, 0.0, 1);
        let random = errors::<K, D>(radius, 0.1, 4000);
        for k in 0..2 {
            let (error, expected) = (exact[k], lattice[k]);
            assert!((error / expected - 1.0).abs() < 0.01, "{D}-D {radius} {k}: {error}");
            let (error, expected) = (random[k], jitter[k]);
            assert!((error / expected - 1.0).abs() < 0.05, "{D}-D {radius} jitter {k}: {error}");
        }
    }

    // The expected errors come from an independent program with another generator and 80 000
    // neighbourhoods each.
    #[test]
    fn wendland_c2_has_the_known_moments() {
        check::<WendlandC2, 2>(2.6, [1.05e-2, 2.61e-2], [3.37e-2, 3.85e-2]);
        check::<WendlandC2, 2>(3.0, [5.14e-3, 2.60e-3], [2.49e-2, 2.50e-2]);
        check::<WendlandC2, 2>(4.0, [1.21e-3, 8.01e-4], [1.39e-2, 1.51e-2]);
        check::<WendlandC2, 3>(2.6, [9.50e-3, 2.11e-2], [2.78e-2, 3.03e-2]);
        check::<WendlandC2, 3>(3.0, [3.14e-3, 6.19e-4], [1.84e-2, 1.79e-2]);
        check::<WendlandC2, 3>(4.0, [5.49e-4, 5.87e-4], [8.86e-3, 9.32e-3]);
    }

    #[test]
    fn wendland_c2_suffers_least_from_disorder() {
        let [unity, gradient] = errors::<WendlandC2, 3>(3.0, 0.1, 500);
        let [unity_c4, gradient_c4] = errors::<WendlandC4, 3>(3.0, 0.1, 500);
        assert!(unity < unity_c4 && gradient < gradient_c4);
    }

    #[test]
    fn a_constant_has_no_gradient_on_a_lattice() {
        let moments = lattice::<CubicSpline, 3>(2.5, 0.0, &mut Noise(1));
        assert!(moments.first().norm() < 1e-14);
        let disordered = lattice::<CubicSpline, 3>(2.5, 0.1, &mut Noise(1));
        assert!(disordered.first().norm() > 1e-3);
    }
}
