//! Eigenvalues of small symmetric matrices.
//!
//! Jacobi's rotations: accurate also for tiny and for equal eigenvalues, one code for every
//! dimension, and no function but the square root, so that it works without the standard library.

use crate::Lanes;
use nalgebra::SMatrix;

/// Rotations of all pairs until nothing is left off the diagonal. Convergence is quadratic: five
/// are enough for 3 × 3, the limit only ends the loop for entries that are not numbers.
const SWEEPS: usize = 16;

/// Eigenvalues and, in columns, eigenvectors of a symmetric matrix; reads the upper triangle.
pub(super) fn symmetric_eigen<const D: usize>(
    matrix: &SMatrix<f64, D, D>,
) -> ([f64; D], SMatrix<f64, D, D>) {
    let mut a = *matrix;
    let mut vectors = SMatrix::<f64, D, D>::identity();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..D {
            for q in p + 1..D {
                rotated |= rotate(&mut a, &mut vectors, p, q);
            }
        }
        if !rotated {
            break;
        }
    }
    (core::array::from_fn(|k| a[(k, k)]), vectors)
}

/// Makes entry `(p, q)` zero, `p < q`; false if it is negligible already.
fn rotate<const D: usize>(
    a: &mut SMatrix<f64, D, D>,
    vectors: &mut SMatrix<f64, D, D>,
    p: usize,
    q: usize,
) -> bool {
    let (app, aqq, apq) = (a[(p, p)], a[(q, q)], a[(p, q)]);
    if apq.abs() <= 0.25 * f64::EPSILON * Lanes::sqrt(app.abs() * aqq.abs()) {
        a[(p, q)] = 0.0;
        return false;
    }
    // Tangent of the smaller of the two angles that would do.
    let theta = 0.5 * (aqq - app) / apq;
    let t = 1.0f64.copysign(theta) / (theta.abs() + Lanes::sqrt(theta * theta + 1.0));
    let c = 1.0 / Lanes::sqrt(t * t + 1.0);
    let s = t * c;
    a[(p, p)] = app - t * apq;
    a[(q, q)] = aqq + t * apq;
    a[(p, q)] = 0.0;
    for k in (0..D).filter(|&k| k != p && k != q) {
        let (kp, kq) = ((k.min(p), k.max(p)), (k.min(q), k.max(q)));
        (a[kp], a[kq]) = (c * a[kp] - s * a[kq], s * a[kp] + c * a[kq]);
    }
    for k in 0..D {
        let (vp, vq) = (vectors[(k, p)], vectors[(k, q)]);
        vectors[(k, p)] = c * vp - s * vq;
        vectors[(k, q)] = s * vp + c * vq;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, SVector};
    use proptest::prelude::*;

    fn check<const D: usize>(m: SMatrix<f64, D, D>) {
        let (values, vectors) = symmetric_eigen(&m);
        let diagonal = SMatrix::from_diagonal(&SVector::from(values));
        let size = m.norm();
        assert!((vectors * diagonal * vectors.transpose() - m).norm() <= 1e-14 * size, "{m}");
        assert!((vectors.transpose() * vectors - SMatrix::identity()).norm() < 1e-14, "{m}");
    }

    proptest! {
        #[test]
        fn eigenvectors_diagonalise_random_matrices(x in prop::array::uniform9(-3.0..3.0f64)) {
            let m = Matrix3::from_column_slice(&x);
            check(m + m.transpose());
            check(m * m.transpose());
            check((m + m.transpose()).fixed_view::<2, 2>(0, 0).into_owned());
            check((m + m.transpose()).fixed_view::<1, 1>(0, 0).into_owned());
        }

        #[test]
        fn flat_and_thin_neighborhoods_are_no_special_case(
            x in prop::array::uniform3(-1.0..1.0f64), y in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let (x, y) = (SVector::from(x), SVector::from(y));
            check(x * x.transpose());
            check(x * x.transpose() + y * y.transpose());
            check(1e-200 * x * x.transpose());
        }
    }

    #[test]
    fn known_eigenvalues() {
        check(SMatrix::<f64, 3, 3>::zeros());
        check(SMatrix::<f64, 3, 3>::identity());
        let (mut values, _) = symmetric_eigen(&SMatrix::<f64, 2, 2>::new(2.0, 1.0, 1.0, 2.0));
        values.sort_by(f64::total_cmp);
        assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15);
    }
}
