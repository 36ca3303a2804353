//! The largest Courant number that a scheme bears.

/// W: square of the largest frequency of sound, in units of (c0/h)².
const SOUND: f64 = 1.34;
/// G: rate at which that mode's density is smoothed, in units of δ c0/h.
const DIFFUSION_OF_SOUND: f64 = 3.1;
/// B: rate at which that mode's velocity is damped, in units of α c0/h.
const VISCOSITY_OF_SOUND: f64 = 1.1;

/// Largest δ times Courant number: what limits the smoothing of the density alone.
const DIFFUSION: f64 = 0.2;

/// Largest Courant number in a collision, whatever the dissipation.
const COLLISION: f64 = 1.2;

/// How close to the limit of sound a run may come.
const HEADROOM: f64 = 0.85;

/// The largest Courant number c0 dt/h for which kick-drift-kick with density diffusion of strength δ h c0
/// and artificial viscosity α h c0 stays calm.
///
/// A mode of sound of frequency ω, whose density is smoothed at the rate γ and whose velocity is damped
/// at the rate β, both explicitly, is stable while ω² dt² + 2 (γ + β) dt < 4 (the Jury conditions of the
/// two-step map). All three scale with c0/h, so that W x² + 2 (G δ + B α) x < 4 for the Courant number
/// x; modes that only diffuse ask for δ x below a constant.
///
/// The constants were measured with Wendland's C2 kernel in a tank at rest (2-D with 2.5, 3 and 4
/// spacings of support, 3-D with 3): noise begins at x = 1.62, 1.53, 1.33 for δ = 0.05, 0.1, 0.2 and at
/// 1.40, 0.95 for α = 0.3, 1; runs with δ = 0.3, 0.5, 1 diverge at δ x = 0.28 to 0.31. Two blocks that
/// collide, compressed and disordered, are more demanding: with δ = 0.1 their noise is a hundredfold
/// between x = 1.25 and 1.35, with δ = 0.05 and 0.2 from 1.25 on, and δ = 0.2, 0.3, 0.5 diverge from δ x = 0.25
/// on. Hence the third limit. `benches/src/bin/courant.rs` measures them again.
pub fn largest_courant(density_diffusion: f64, artificial_viscosity: f64) -> f64 {
    let damping =
        DIFFUSION_OF_SOUND * density_diffusion + VISCOSITY_OF_SOUND * artificial_viscosity;
    let sound = ((damping * damping + 4.0 * SOUND).sqrt() - damping) / SOUND;
    // A δ of 0 gives no limit.
    (HEADROOM * sound).min(DIFFUSION / density_diffusion).min(COLLISION)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn usual_values_are_not_limited_and_measured_failures_are() {
        assert!(largest_courant(0.1, 0.02) >= 1.2);
        assert!(largest_courant(0.2, 0.0) >= 1.0);
        // What was seen to fail, as (δ, α, Courant number).
        for (delta, alpha, courant) in [
            (0.05, 0.0, 1.25),
            (0.1, 0.0, 1.3),
            (0.2, 0.0, 1.27),
            (0.3, 0.02, 0.9),
            (0.5, 0.02, 0.5),
            (1.0, 0.02, 0.25),
            (0.1, 0.3, 1.4),
            (0.1, 1.0, 0.95),
            (0.0, 0.0, 1.72),
        ] {
            assert!(largest_courant(delta, alpha) < courant, "{delta} {alpha} {courant}");
        }
    }

    proptest! {
        #[test]
        fn more_dissipation_never_allows_longer_steps(
            delta in 0.0..1.0_f64,
            alpha in 0.0..1.0_f64,
            more in 0.0..0.5_f64,
        ) {
            let here = largest_courant(delta, alpha);
            prop_assert!(here > 0.05 && here < 1.5);
            prop_assert!(largest_courant(delta + more, alpha) <= here);
            prop_assert!(largest_courant(delta, alpha + more) <= here);
        }
    }
}
