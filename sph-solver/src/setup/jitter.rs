//! Random shifts of the initial positions.
//!
//! On a perfect lattice the errors of all particles are alike, and what a study measures is a lottery
//! of symmetries. A few seeds of a small disorder give an error with a spread.

use crate::scene::Fluid;

/// The positions, each shifted along each axis by up to `jitter` spacings as its number and the seed
/// say. Less than half a spacing, so that every particle stays in its cell of the lattice.
pub fn shifted<const D: usize>(
    fluid: &Fluid,
    spacing: f64,
    mut position: Vec<[f64; D]>,
) -> Vec<[f64; D]> {
    let largest = spacing * fluid.jitter.as_deref().copied().unwrap_or(0.0);
    if largest == 0.0 {
        return position;
    }
    let seed = fluid.seed.as_deref().copied().unwrap_or(1);
    for (i, x) in position.iter_mut().enumerate() {
        for (axis, x) in x.iter_mut().enumerate() {
            *x += largest * (2.0 * uniform(seed, (i * D + axis) as u64) - 1.0);
        }
    }
    position
}

/// Number `n` of the sequence of a seed, evenly spread over [0, 1).
///
/// Source: the generator SplitMix64 of Steele, Lea & Flood (2014), Fast splittable pseudorandom
/// number generators, OOPSLA '14, which can be asked for any of its numbers.
fn uniform(seed: u64, n: u64) -> f64 {
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;
    let mixed = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    // Seeds that follow each other begin far apart.
    let start = mixed(seed.wrapping_mul(STEP).wrapping_add(STEP));
    let bits = mixed(start.wrapping_add((n + 1).wrapping_mul(STEP)));
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_evenly_spread_and_depend_on_the_seed() {
        let count = 100_000;
        let numbers: Vec<f64> = (0..count).map(|n| uniform(3, n)).collect();
        assert!(numbers.iter().all(|number| (0.0..1.0).contains(number)));
        let mean = numbers.iter().sum::<f64>() / count as f64;
        // The mean of so many has a deviation of 0.0009.
        assert!((mean - 0.5).abs() < 5e-3, "{mean}");
        let square = numbers.iter().map(|u| (u - mean).powi(2)).sum::<f64>() / count as f64;
        assert!((12.0 * square - 1.0).abs() < 2e-2, "{square}");
        let product =
            (0..count).map(|n| (uniform(3, n) - 0.5) * (uniform(4, n) - 0.5)).sum::<f64>();
        assert!((12.0 * product / count as f64).abs() < 2e-2, "{product}");
    }

    #[test]
    fn particles_stay_near_their_places() {
        let text = "dimension = 2\nend_time = 1\n[numerics]\nspacing = 0.1\nsound_speed = 1\n\
            [fluid.water]\ndensity = 1\nregions = [{ box = { min = [0, 0], max = [1, 1] } }]\n";
        let positions = |changes: &[&str]| {
            let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
            let scene = crate::scene::Scene::parse("a.toml", text.into(), &changes).unwrap();
            crate::setup::Setup::<2>::new(&scene).unwrap().particles.position
        };
        let still = positions(&[]);
        let one = positions(&["fluid.water.jitter=0.1"]);
        assert_eq!(one, positions(&["fluid.water.jitter=0.1", "fluid.water.seed=1"]));
        assert_ne!(one, positions(&["fluid.water.jitter=0.1", "fluid.water.seed=2"]));
        let farthest =
            one.iter().zip(&still).flat_map(|(a, b)| (0..2).map(|k| (a[k] - b[k]).abs()));
        let farthest = farthest.fold(0.0, f64::max);
        assert!(farthest > 0.0095 && farthest <= 0.01, "{farthest}");
    }
}
