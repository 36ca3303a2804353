//! Exactness on disordered and one-sided neighbours, and what happens where it cannot be.

use super::*;
use crate::{
    CubicSpline, Gaussian, Kernel, MeanRadius, PairRadius, QuinticSpline, Vectorized, WendlandC2,
    WendlandC4, WendlandC6,
};
use proptest::prelude::*;

/// A neighbour of a particle of radius 1 at the origin.
#[derive(Debug, Clone, Copy)]
struct Neighbor<const D: usize> {
    at: [f64; D],
    volume: f64,
    radius: f64,
}

fn neighbors<const D: usize>(size: usize) -> impl Strategy<Value = Vec<Neighbor<D>>> {
    let one = (prop::collection::vec(-0.8..0.8f64, D), 0.01..0.3f64, 0.8..1.6f64)
        .prop_map(|(at, volume, radius)| Neighbor { at: at.try_into().unwrap(), volume, radius });
    prop::collection::vec(one, size..3 * size + 1)
}

/// Uncorrected gradient of a field that vanishes at the origin, and the sum M.
fn sums<K: Kernel, const D: usize>(
    neighbors: &[Neighbor<D>],
    field: impl Fn(&[f64; D]) -> f64,
) -> ([f64; D], SMatrix<f64, D, D>) {
    let mut sum = GradientSum::<D, f64>::zero();
    let mut gradient = [0.0; D];
    for j in neighbors {
        let offset = j.at.map(|x| -x);
        let distance = j.at.iter().map(|x| x * x).sum::<f64>().sqrt();
        let radius = MeanRadius::of(1.0, j.radius);
        let weight = j.volume * K::gradient_factor::<D, f64>(distance, radius);
        sum.add(&offset, weight);
        for (g, x) in gradient.iter_mut().zip(offset) {
            *g += field(&j.at) * weight * x;
        }
    }
    (gradient, sum.matrix())
}

fn linear_field_is_exact<K: Kernel, const D: usize>(neighbors: &[Neighbor<D>]) {
    let slope: [f64; D] = from_fn(|k| 2.0 - 3.0 * k as f64);
    let (gradient, matrix) =
        sums::<K, D>(neighbors, |x| x.iter().zip(slope).map(|(x, s)| x * s).sum());
    let floor = 1e-3;
    let correction = GradientCorrection::new(&matrix, floor);
    // Rounding grows like the ratio of the eigenvalues; 0.01 is a very thin neighbourhood.
    if correction.smallest_eigenvalue() >= floor.max(0.01 * matrix.trace()) {
        for (computed, exact) in correction.apply(&gradient).into_iter().zip(slope) {
            assert!((computed - exact).abs() < 1e-12, "{}: {computed} {exact}", K::NAME);
        }
    }
}

proptest! {
    #[test]
    fn linear_fields_are_exact_in_three_dimensions(neighbors in neighbors::<3>(8)) {
        linear_field_is_exact::<WendlandC2, 3>(&neighbors);
        linear_field_is_exact::<WendlandC4, 3>(&neighbors);
        linear_field_is_exact::<WendlandC6, 3>(&neighbors);
        linear_field_is_exact::<CubicSpline, 3>(&neighbors);
        linear_field_is_exact::<QuinticSpline, 3>(&neighbors);
        linear_field_is_exact::<Gaussian, 3>(&neighbors);
    }

    #[test]
    fn linear_fields_are_exact_in_one_and_two_dimensions(
        line in neighbors::<1>(2), plane in neighbors::<2>(5),
    ) {
        linear_field_is_exact::<WendlandC2, 1>(&line);
        linear_field_is_exact::<WendlandC2, 2>(&plane);
        linear_field_is_exact::<QuinticSpline, 2>(&plane);
    }

    #[test]
    fn amplification_has_a_limit(neighbors in neighbors::<3>(1), floor in 0.01..0.5f64) {
        let (_, matrix) = sums::<WendlandC2, 3>(&neighbors, |_| 0.0);
        let correction = GradientCorrection::new(&matrix, floor);
        prop_assert!(correction.smallest_eigenvalue() >= -1e-12 * matrix.trace());
        let length: f64 = correction.apply(&[0.0, 1.0, 0.0]).iter().map(|x| x * x).sum();
        prop_assert!(length.sqrt() <= (1.0 + 1e-12) / floor);
    }
}

#[test]
fn inside_a_lattice_the_sum_is_nearly_the_identity() {
    let lattice: Vec<Neighbor<2>> = (-4..=4)
        .flat_map(|x| (-4..=4).map(move |y| [f64::from(x) / 4.0, f64::from(y) / 4.0]))
        .map(|at| Neighbor { at, volume: 1.0 / 16.0, radius: 1.0 })
        .collect();
    let (_, matrix) = sums::<WendlandC2, 2>(&lattice, |_| 0.0);
    assert!((matrix - SMatrix::identity()).norm() < 2e-3);
    let half: Vec<_> = lattice.into_iter().filter(|j| j.at[1] < 0.1).collect();
    let (_, matrix) = sums::<WendlandC2, 2>(&half, |_| 0.0);
    let smallest = GradientCorrection::new(&matrix, 0.1).smallest_eigenvalue();
    assert!((0.4..0.6).contains(&smallest), "at a free surface: {smallest}");
}

#[test]
fn particles_alone_in_pairs_or_on_top_of_each_other_are_finite() {
    let at = |at| Neighbor { at, volume: 0.1, radius: 1.0 };
    for neighbors in [vec![], vec![at([0.0; 3])], vec![at([1e-9, 0.0, 0.0])], vec![at([0.3; 3])]] {
        let (gradient, matrix) = sums::<WendlandC2, 3>(&neighbors, |x| x[0]);
        let correction = GradientCorrection::new(&matrix, 0.2);
        assert!(correction.smallest_eigenvalue().abs() < 1e-12);
        assert!(correction.apply(&gradient).iter().all(|g| g.is_finite()));
    }
}

#[test]
fn identity_changes_nothing() {
    assert_eq!(GradientCorrection::<2>::identity().apply(&[3.0, -4.0]), [3.0, -4.0]);
}

#[test]
#[should_panic(expected = "must be positive")]
fn a_floor_of_zero_is_refused() {
    GradientCorrection::new(&SMatrix::<f64, 2, 2>::identity(), 0.0);
}

/// Eight neighbours, lanes at a time.
struct SumOf([[f64; 3]; 8]);

impl Vectorized for SumOf {
    type Scalar = f64;
    type Output = SMatrix<f64, 2, 2>;

    #[inline(always)]
    fn run<L: Lanes<Scalar = f64>>(self) -> Self::Output {
        let mut sum = GradientSum::<2, L>::zero();
        for group in self.0.chunks_exact(L::LANES) {
            let column = |k: usize| {
                let mut lanes = [0.0; 8];
                for (lane, row) in lanes.iter_mut().zip(group) {
                    *lane = row[k];
                }
                L::load(&lanes)
            };
            sum.add(&[column(0), column(1)], column(2));
        }
        sum.matrix()
    }
}

#[test]
fn lanes_add_up_to_the_scalar_sum() {
    let rows: [[f64; 3]; 8] = from_fn(|k| {
        let k = k as f64;
        [(0.7 * k).sin(), (1.3 * k).cos(), -0.1 - 0.02 * k]
    });
    let scalar = SumOf(rows).run::<f64>();
    assert!((scalar - f64::dispatch(SumOf(rows))).norm() < 1e-14);
    assert!((scalar - f64::dispatch_portable(SumOf(rows))).norm() < 1e-14);
    assert_eq!(scalar, scalar.transpose());
}
