//! Affine maps: scaling, rotation, translation.

use crate::vector::{dot, norm, scaled};
use std::array::from_fn;

/// Two lengths or directions are the same when they differ by less than this part of them.
const SAME: f64 = 1e-12;

/// The map `x ↦ A x + b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<const D: usize> {
    /// Rows of A.
    rows: [[f64; D]; D],
    /// b, m.
    offset: [f64; D],
}

impl<const D: usize> Affine<D> {
    /// Everything stays where it is.
    pub fn identity() -> Self {
        Self::scaling([1.0; D])
    }

    /// Scaling from the origin, axis by axis. Negative factors mirror.
    pub fn scaling(factors: [f64; D]) -> Self {
        let rows = from_fn(|i| from_fn(|j| if i == j { factors[i] } else { 0.0 }));
        Self { rows, offset: [0.0; D] }
    }

    /// Translation by an offset, m.
    pub fn translation(offset: [f64; D]) -> Self {
        Self { offset, ..Self::identity() }
    }

    /// Rotation about an axis through the origin (about z in two dimensions), anticlockwise seen
    /// against the axis. Quarter turns are exact. `None` when the axis has no direction.
    ///
    /// The formula of Rodrigues, `R = cos φ + (1 − cos φ) u uᵀ + sin φ [u]×`.
    pub fn rotation(axis: [f64; 3], degrees: f64) -> Option<Self> {
        let length = norm(&axis);
        if !length.is_finite() || length == 0.0 || !degrees.is_finite() {
            return None;
        }
        let u = scaled(1.0 / length, &axis);
        let (sin, cos) = sin_cos(degrees);
        let across = [[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]];
        let entry = |i: usize, j: usize| {
            let same = if i == j { cos } else { 0.0 };
            same + (1.0 - cos) * u[i] * u[j] + sin * across[i][j]
        };
        Some(Self { rows: from_fn(|i| from_fn(|j| entry(i, j))), offset: [0.0; D] })
    }

    /// This map after another one.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let column = |j: usize| -> [f64; D] { from_fn(|k| first.rows[k][j]) };
        Self {
            rows: from_fn(|i| from_fn(|j| dot(&self.rows[i], &column(j)))),
            offset: self.apply(&first.offset),
        }
    }

    /// Where a point goes.
    pub fn apply(&self, x: &[f64; D]) -> [f64; D] {
        from_fn(|i| dot(&self.rows[i], x) + self.offset[i])
    }

    /// The offset of the origin, m.
    pub(crate) fn offset(&self) -> [f64; D] {
        self.offset
    }

    /// Where the unit vector along an axis goes.
    pub(crate) fn column(&self, axis: usize) -> [f64; D] {
        from_fn(|k| self.rows[k][axis])
    }

    /// Whether nothing moves.
    pub fn is_identity(&self) -> bool {
        *self == Self::identity()
    }

    /// The factor by which all lengths grow, if there is one: then the map is a similarity.
    pub fn uniform_scale(&self) -> Option<f64> {
        let scale = norm(&self.column(0));
        let same = (1..D).all(|k| (norm(&self.column(k)) / scale - 1.0).abs() < SAME);
        (same && self.is_orthogonal()).then_some(scale)
    }

    /// Whether axes at right angles stay at right angles.
    pub(crate) fn is_orthogonal(&self) -> bool {
        (0..D).all(|j| {
            (0..j).all(|i| {
                let (a, b) = (self.column(i), self.column(j));
                dot(&a, &b).abs() < SAME * norm(&a) * norm(&b)
            })
        })
    }

    /// Whether every axis goes to an axis.
    pub(crate) fn keeps_axes(&self) -> bool {
        (0..D).all(|j| self.column(j).iter().filter(|x| **x != 0.0).count() == 1)
    }

    /// Volume of what had volume 1, negative when the map mirrors.
    pub fn determinant(&self) -> f64 {
        dot(&self.rows[0], &self.cofactors()[0])
    }

    /// Where the normal of a plane goes; its length means nothing.
    pub(crate) fn apply_to_normal(&self, normal: &[f64; D]) -> [f64; D] {
        let cofactors = self.cofactors();
        let sign = self.determinant().signum();
        from_fn(|i| sign * dot(&cofactors[i], normal))
    }

    /// Cofactors of A, by which normals go (in two and three dimensions).
    fn cofactors(&self) -> [[f64; D]; D] {
        let a = &self.rows;
        if D == 2 {
            return from_fn(|i| {
                from_fn(|j| if i == j { a[1 - i][1 - j] } else { -a[1 - i][1 - j] })
            });
        }
        from_fn(|i| {
            from_fn(|j| {
                let [p, q] = [(i + 1) % D, (i + 2) % D];
                let [r, s] = [(j + 1) % D, (j + 2) % D];
                a[p][r] * a[q][s] - a[p][s] * a[q][r]
            })
        })
    }
}

/// Sine and cosine of an angle in degrees, exact for quarter turns.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let quarter = degrees.rem_euclid(360.0) / 90.0;
    for (index, exact) in [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)].into_iter().enumerate()
    {
        if quarter == index as f64 {
            return exact;
        }
    }
    degrees.to_radians().sin_cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quarter_turns_are_exact() {
        let turn = Affine::<3>::rotation([0.0, 0.0, 2.0], 90.0).unwrap();
        assert_eq!(turn.apply(&[1.0, 2.0, 3.0]), [-2.0, 1.0, 3.0]);
        assert!(turn.keeps_axes());
        let back = Affine::<2>::rotation([0.0, 0.0, 1.0], -450.0).unwrap();
        assert_eq!(back.apply(&[0.0, 1.0]), [1.0, 0.0]);
        assert!(Affine::<3>::rotation([0.0; 3], 10.0).is_none());
    }

    #[test]
    fn maps_follow_each_other() {
        let scale = Affine::scaling([2.0, 3.0]);
        let turn = Affine::rotation([0.0, 0.0, 1.0], 90.0).unwrap();
        let all = Affine::translation([10.0, 20.0]).after(&turn).after(&scale);
        assert_eq!(all.apply(&[1.0, 1.0]), [7.0, 22.0]);
        assert!((all.determinant() - 6.0).abs() < 1e-12);
        assert_eq!((scale.uniform_scale(), turn.uniform_scale()), (None, Some(1.0)));
        assert!(scale.is_orthogonal() && !scale.after(&turn).is_identity());
    }

    proptest! {
        #[test]
        fn rotations_keep_lengths_and_normals_stay_normals(
            axis in prop::array::uniform3(0.1..1.0_f64),
            degrees in -400.0..400.0_f64,
            factors in prop::array::uniform3(0.2..3.0_f64),
            a in prop::array::uniform3(-1.0..1.0_f64),
            b in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let turn = Affine::<3>::rotation(axis, degrees).unwrap();
            prop_assert!((norm(&turn.apply(&a)) - norm(&a)).abs() < 1e-12);
            prop_assert!((turn.uniform_scale().unwrap() - 1.0).abs() < 1e-12);
            prop_assert!((turn.determinant() - 1.0).abs() < 1e-12);
            let all = turn.after(&Affine::scaling([-factors[0], factors[1], factors[2]]));
            let normal = crate::vector::cross(&a, &b);
            let moved = all.apply_to_normal(&normal);
            for direction in [a, b] {
                prop_assert!(dot(&moved, &all.apply(&direction)).abs() < 1e-10);
            }
            // What was in front stays in front.
            prop_assert!(dot(&moved, &all.apply(&normal)) >= 0.0);
        }
    }
}
