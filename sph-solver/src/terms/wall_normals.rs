use super::wall_push::share_of_plane;
use super::{BesideWall, Crowding, Target, VectorSum, WallPair, WallTerm};
use sph_kernels::Lanes;

/// Where the elements of a solid look: Σ_w w n, w the weight of each, without a unit.
#[derive(Debug, Clone, Copy)]
pub struct WallNormals;

impl<const D: usize> WallTerm<D, Crowding> for WallNormals {
    type Total<L: Lanes> = [L; D];

    #[inline(always)]
    fn zero<L: Lanes>() -> [L; D] {
        [L::zero(); D]
    }

    #[inline(always)]
    fn add<L: Lanes>(
        &self,
        _: &Target<D, L>,
        _: &BesideWall<D, L>,
        pair: &WallPair<D, L>,
        sum: &mut [L; D],
    ) {
        for (sum, normal) in sum.iter_mut().zip(pair.normal) {
            *sum = pair.weight.mul_add(normal, *sum);
        }
    }

    #[inline(always)]
    fn finish<L: Lanes>(&self, _: &Target<D, L>, _: &BesideWall<D, L>, total: &[L; D]) -> [L; D] {
        *total
    }
}

/// How much the solids around a particle count as one plane, from 0 to 1, from the sums of [`WallNormals`]
/// over each: |Σ N|² over (Σ |N|)².
///
/// Two solids that make a corner are each a plane. What one of them pushes along itself is balanced by what
/// the fluid pushes the other way, and must not be left out: water in the corner would not come to rest.
pub fn flatness<const D: usize>(normals: impl Iterator<Item = VectorSum<D>>) -> f64 {
    let (mut sum, mut lengths) = ([0.0; D], 0.0);
    for VectorSum(normal) in normals {
        (0..D).for_each(|k| sum[k] += normal[k]);
        lengths += length2(&normal).sqrt();
    }
    if lengths > 0.0 { share_of_plane(length2(&sum) / (lengths * lengths)) } else { 1.0 }
}

fn length2<const D: usize>(a: &[f64; D]) -> f64 {
    a.iter().map(|a| a * a).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solids_in_one_plane_are_flat_and_corners_are_not() {
        let of = |normals: &[[f64; 2]]| flatness(normals.iter().map(|n| VectorSum(*n)));
        assert_eq!(of(&[]), 1.0);
        assert_eq!(of(&[[0.3, 0.4], [0.0, 0.0]]), 1.0);
        assert_eq!(of(&[[0.3, 0.4], [0.6, 0.8]]), 1.0);
        assert_eq!(of(&[[0.0, 1.0], [0.2, 0.0]]), 0.0);
        let between = of(&[[0.0, 1.0], [0.045, 1.0]]);
        assert!(between > 0.0 && between <= 1.0, "{between}");
    }
}
