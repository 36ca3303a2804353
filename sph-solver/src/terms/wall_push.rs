use super::{WallPair, dot, lanes};
use sph_kernels::Lanes;

/// The push of a wall on a particle: Σ_w c ∇W_iw V_w, of which a plane leaves what a plane should.
///
/// The integral of ∇W over the material behind a plane lies along the normal of the plane. Its sum
/// over elements does so only up to their uneven distribution, which acts as friction on a fluid that
/// slides along. So of that part of c that is the same for all elements, a plane leaves the push along
/// its normal alone. Near an edge or a corner, where the integral has parts along several faces, all of
/// it is left; what tells is the mean normal n̄ = Σ w n / Σ w over the elements that the particle sees,
/// which has the length 1 where all of them are of one plane. A sum is over one solid; whether others make
/// a corner with it, their [`WallNormals`](super::WallNormals) tell.
#[derive(Debug, Clone, Copy)]
pub struct WallPush<const D: usize, L> {
    /// Σ c w r.
    push: [L; D],
    /// The part across the normals that a plane does not have.
    across: [L; D],
    normal: [L; D],
    weight: L,
    /// What the push leans by where support radii vary.
    lean: [L; D],
}

/// |n̄|² from which on a wall counts as a plane.
const PLANE: f64 = 0.9995;
/// |n̄|² up to which it counts as anything else.
const BENT: f64 = 0.995;

/// How much walls with this |n̄|² count as a plane, from 0 to 1.
#[inline(always)]
pub fn share_of_plane<L: Lanes>(mean2: L) -> L {
    ((mean2 - lanes(BENT)) * lanes(1.0 / (PLANE - BENT))).max(L::zero()).min(lanes(1.0))
}

impl<const D: usize, L: Lanes> WallPush<D, L> {
    /// Nothing added yet.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = [L::zero(); D];
        Self { push: zero, across: zero, normal: zero, weight: L::zero(), lean: zero }
    }

    /// Adds an element whose push has the coefficient c = `even` + `uneven`, `even` that part of it
    /// that is the same for all elements.
    #[inline(always)]
    pub fn add(&mut self, even: L, uneven: L, pair: &WallPair<D, L>) {
        let height = dot(&pair.offset, &pair.normal);
        let (all, even) = ((even + uneven) * pair.weight, even * pair.weight);
        for k in 0..D {
            self.push[k] = all.mul_add(pair.offset[k], self.push[k]);
            let across = pair.offset[k] - height * pair.normal[k];
            self.across[k] = even.mul_add(across, self.across[k]);
            self.normal[k] = pair.weight.mul_add(pair.normal[k], self.normal[k]);
        }
        self.weight += pair.weight;
        if let Some(stretch) = &pair.stretch {
            // Where support radii grow along the wall, see `RadiusSlope`.
            let above = (height * pair.unit - pair.depth).max(L::zero());
            let size = all * height * above;
            let along = dot(&stretch.lean, &pair.normal);
            for k in 0..D {
                let lean = stretch.lean[k] - along * pair.normal[k];
                self.lean[k] = size.mul_add(lean, self.lean[k]);
            }
        }
    }

    /// Adds what an element does along its own normal alone, with the coefficient `along`: a damping of the
    /// velocity along the normal must act along it too. Along the line to the element it would drive on what
    /// flows around a ball. So would elements of a face that the particle is behind, as beyond an edge: they
    /// do nothing.
    #[inline(always)]
    pub fn damp(&mut self, along: L, pair: &WallPair<D, L>) {
        let size = along * pair.weight * dot(&pair.offset, &pair.normal).max(L::zero());
        for k in 0..D {
            self.push[k] = size.mul_add(pair.normal[k], self.push[k]);
        }
    }

    /// Σ c w r as the particle feels it. `flatness` is 1 where all the walls around are of one plane, 0
    /// where other solids make a corner with this one.
    #[inline(always)]
    pub fn felt(&self, flatness: L) -> [L; D] {
        // Weights are not positive, and small in any units; without any the push is zero as well.
        let inverse = lanes::<L>(1.0).div(self.weight.min(lanes(-1e-30)));
        let normal: [L; D] = std::array::from_fn(|k| self.normal[k] * inverse);
        let plane = flatness * share_of_plane(dot(&normal, &normal));
        std::array::from_fn(|k| self.push[k] - plane * self.across[k] + self.lean[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(offset: [f64; 2], normal: [f64; 2], weight: f64) -> WallPair<2, f64> {
        let distance2 = offset[0] * offset[0] + offset[1] * offset[1];
        let (depth, squeezed) = (0.1, None);
        WallPair {
            offset,
            distance2,
            normal,
            depth,
            weight,
            squeezed,
            unit: 1.0,
            per_unit: 1.0,
            stretch: None,
        }
    }

    fn push(elements: &[([f64; 2], [f64; 2])]) -> [f64; 2] {
        let mut push = WallPush::<2, f64>::zero();
        for (offset, normal) in elements {
            push.add(3.0, 0.0, &pair(*offset, *normal, -2.0));
        }
        push.felt(1.0)
    }

    #[test]
    fn a_plane_pushes_along_its_normal_whatever_the_elements() {
        let n = [0.6, 0.8];
        let felt = push(&[([1.0, 2.0], n), ([-0.5, 1.0], n), ([3.0, 0.1], n)]);
        assert!((felt[0] * n[1] - felt[1] * n[0]).abs() < 1e-13, "{felt:?}");
        let along = (3.5 * 0.6 + 3.1 * 0.8) * 3.0 * -2.0;
        assert!((felt[0] * n[0] + felt[1] * n[1] - along).abs() < 1e-13);
    }

    #[test]
    fn a_corner_pushes_along_both_faces() {
        let (up, right) = ([0.0, 1.0], [1.0, 0.0]);
        let felt = push(&[([0.2, 1.0], up), ([1.0, 0.3], right)]);
        assert!((felt[0] + 7.2).abs() < 1e-14 && (felt[1] + 7.8).abs() < 1e-14, "{felt:?}");
    }

    #[test]
    fn a_plane_in_the_corner_with_another_solid_pushes_as_it_is() {
        let mut push = WallPush::<2, f64>::zero();
        push.add(3.0, 0.0, &pair([1.0, 2.0], [0.0, 1.0], -2.0));
        assert_eq!(push.felt(0.0), [-6.0, -12.0]);
        assert_eq!(push.felt(1.0), [0.0, -12.0]);
    }

    #[test]
    fn what_differs_between_elements_is_left() {
        let mut push = WallPush::<2, f64>::zero();
        push.add(0.0, 1.0, &pair([1.0, 2.0], [0.0, 1.0], -2.0));
        assert_eq!(push.felt(1.0), [-2.0, -4.0]);
    }

    #[test]
    fn damping_takes_energy_from_what_flows_around_a_ball() {
        // Elements of a ball to the left and to the right below a particle that moves to the right.
        let mut push = WallPush::<2, f64>::zero();
        for side in [-1.0, 1.0] {
            let normal = [0.6 * side, 0.8];
            let speed = -normal[0];
            push.damp(-speed, &pair([-0.5 * side, 1.0], normal, -2.0));
        }
        assert!(push.felt(1.0)[0] < 0.0, "{:?}", push.felt(1.0));
    }

    #[test]
    fn damping_drives_nothing_beyond_an_edge() {
        // Beside a block, below its top: elements under the top face up.
        let mut push = WallPush::<2, f64>::zero();
        push.damp(-1.0, &pair([-1.0, -0.5], [0.0, 1.0], -2.0));
        assert_eq!(push.felt(1.0), [0.0; 2]);
    }

    #[test]
    fn nothing_pushes_nowhere() {
        assert_eq!(WallPush::<2, f64>::zero().felt(1.0), [0.0; 2]);
        let mut beyond = WallPush::<2, f64>::zero();
        beyond.add(3.0, 1.0, &pair([1.0, 2.0], [0.0, 1.0], 0.0));
        assert_eq!(beyond.felt(1.0), [0.0; 2]);
    }
}
