use crate::passes::kicked;
use std::array::from_fn;

/// The two half kicks of a particle at a full step, the closing one of the step that ends and the opening
/// one of the step that begins.
///
/// A kick from u to w over τ changes the kinetic energy by exactly m (w − u)·(u + w)/2. So a part b of
/// the acceleration takes −m b·(τ (u + w)/2) in it, and all parts together take what the energy loses.
#[derive(Debug, Clone, Copy)]
pub struct Kicks<const D: usize> {
    mass: f64,
    /// Durations, s.
    spans: [f64; 2],
    /// Durations times mean velocities, m.
    paths: [[f64; D]; 2],
}

impl<const D: usize> Kicks<D> {
    /// For a particle of this mass (kg) and velocity (m/s, before both kicks) that pairs accelerate by
    /// `acceleration` and gravity by `gravity` (m/s²), between steps of `dt_before` and `dt` (s).
    #[inline]
    pub fn new(
        mass: f64,
        velocity: [f64; D],
        acceleration: [f64; D],
        gravity: [f64; D],
        [dt_before, dt]: [f64; 2],
    ) -> Self {
        let spans = [0.5 * dt_before, 0.5 * dt];
        let now = kicked(velocity, spans[0], acceleration, gravity);
        let then = kicked(now, spans[1], acceleration, gravity);
        let path = |u: [f64; D], w: [f64; D], span: f64| from_fn(|k| span * 0.5 * (u[k] + w[k]));
        Self { mass, spans, paths: [path(velocity, now, spans[0]), path(now, then, spans[1])] }
    }

    /// Energy (J) that a part of the acceleration takes from the particle in each kick, as seen by who
    /// moves with `velocity` (m/s), and what it takes by the work on who moves so.
    #[inline]
    pub fn taken(&self, part: &[f64; D], velocity: &[f64; D]) -> ([f64; 2], [f64; 2]) {
        let dot = |path: &[f64; D]| (0..D).map(|k| part[k] * path[k]).sum::<f64>();
        let (all, carried) = (self.paths.map(|path| dot(&path)), dot(velocity));
        let mass = self.mass;
        (
            from_fn(|k| -mass * (all[k] - self.spans[k] * carried)),
            self.spans.map(|span| -mass * (span * carried)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_to_the_loss_of_kinetic_energy() {
        let (mass, v, a, g) = (3.0, [1.0, -2.0], [40.0, 7.0], [0.0, -9.81]);
        let steps = [0.02, 0.03];
        let now = kicked(v, 0.01, a, g);
        let then = kicked(now, 0.015, a, g);
        let kinetic = |v: [f64; 2]| 0.5 * mass * (v[0] * v[0] + v[1] * v[1]);
        let kicks = Kicks::new(mass, v, a, g, steps);
        let wall = [0.3, 0.8];
        let mut sum = [0.0; 2];
        for part in [[10.0, -5.0], [30.0, 12.0], g] {
            let (seen, carried) = kicks.taken(&part, &wall);
            for k in 0..2 {
                sum[k] += seen[k] + carried[k];
            }
        }
        assert!((sum[0] - (kinetic(v) - kinetic(now))).abs() < 1e-12);
        assert!((sum[1] - (kinetic(now) - kinetic(then))).abs() < 1e-12);
    }

    #[test]
    fn friction_takes_from_what_slides_and_gives_to_what_is_dragged() {
        // A belt at 2 m/s pulls on fluid at 1 m/s: it gives 2, of which friction takes 1.
        let kicks = Kicks::new(1.0, [1.0], [0.0], [0.0], [0.0, 2.0]);
        let (taken, carried) = kicks.taken(&[1.0], &[2.0]);
        assert_eq!((taken[1], carried[1]), (1.0, -2.0));
    }
}
