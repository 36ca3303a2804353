//! The time step, and how long a neighbour list lasts.

use crate::lio::Extremes;

/// Limits of the explicit scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepLimits {
    /// Courant number.
    pub cfl: f64,
    /// Smoothing length h, m.
    pub smoothing_length: f64,
    /// Sound speed c0, m/s.
    pub sound_speed: f64,
    /// Kinematic viscosity ν, m²/s; 0 without physical viscosity.
    pub kinematic_viscosity: f64,
}

impl StepLimits {
    /// dt = min(CFL h/(c0 + |v|max), 0.25 √(h/|a|max), 0.125 h²/ν), s.
    ///
    /// Source: Monaghan & Kos (1999), J. Waterw. Port Coast. Ocean Eng. 125 (first two); Morris,
    /// Fox & Zhu (1997), J. Comput. Phys. 136, eq. 21 (viscous).
    pub fn step(&self, extremes: Extremes) -> f64 {
        let h = self.smoothing_length;
        let acoustic = self.cfl * h / (self.sound_speed + extremes.speed2.sqrt());
        let forces = 0.25 * (h / extremes.acceleration2.sqrt()).sqrt();
        let viscous = 0.125 * h * h / self.kinematic_viscosity;
        acoustic.min(forces).min(viscous)
    }
}

/// Largest number of steps between two list rebuilds. A tank at rest would never need one, but a
/// checkpoint waits for the next.
const LONGEST_LIFE: u32 = 100;

/// How much of the Verlet skin has been used up since the lists were built.
///
/// Lists hold all pairs closer than support + skin, so they are complete as long as no two particles
/// have moved farther than the skin relative to each other. Two bounds of that, of which the smaller
/// one counts: twice the sum over the steps of dt times the largest speed, and the diagonal of the
/// box that holds all displacements, walls at rest included, from the sums of dt times the largest
/// velocities along each axis and against it. The second one lets a flow go its way as a whole. Both
/// need no memory per particle and are the same on every rank.
#[derive(Debug, Clone, Copy)]
pub struct Skin {
    width: f64,
    /// Largest displacement of one particle.
    path: f64,
    /// Edges of the box of all displacements.
    spread: [f64; 3],
    steps: u32,
    fresh: bool,
}

impl Skin {
    /// For lists with a skin of `width` (m).
    pub fn new(width: f64) -> Self {
        Self { width, path: 0.0, spread: [0.0; 3], steps: 0, fresh: true }
    }

    /// The lists have just been built for the present positions.
    pub fn renew(&mut self) {
        self.path = 0.0;
        self.spread = [0.0; 3];
        self.steps = 0;
        self.fresh = true;
    }

    /// The present positions were reached by a drift of `dt` (s) with velocities within these
    /// extremes. Called once a step; the drift that ended just before a rebuild does not count.
    pub fn moved(&mut self, dt: f64, extremes: &Extremes) {
        if !self.fresh {
            self.drift(dt, extremes, 0.0);
        }
        self.steps += 1;
        self.fresh = false;
    }

    /// Whether the present positions are farther apart than the lists allow for.
    pub fn exceeded(&self) -> bool {
        let diagonal = self.spread.iter().map(|edge| edge * edge).sum::<f64>().sqrt();
        (2.0 * self.path).min(diagonal) > self.width
    }

    /// Whether a further drift of `dt` with velocities within these extremes, each changed by up to
    /// `kick` (m/s), would ask for new lists.
    pub fn would_exceed(mut self, dt: f64, extremes: &Extremes, kick: f64) -> bool {
        self.drift(dt, extremes, kick);
        self.steps >= LONGEST_LIFE || self.exceeded()
    }

    fn drift(&mut self, dt: f64, extremes: &Extremes, kick: f64) {
        self.path += dt * (extremes.speed2.sqrt() + kick);
        for (edge, ways) in self.spread.iter_mut().zip(extremes.velocity) {
            *edge += dt * (ways[0] + ways[1] + 2.0 * kick);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: StepLimits = StepLimits {
        cfl: 1.0,
        smoothing_length: 0.03,
        sound_speed: 29.0,
        kinematic_viscosity: 0.0,
    };

    #[test]
    fn each_limit_can_be_the_smallest() {
        let calm = Extremes { speed2: 1.0, ..Extremes::NONE };
        assert!((LIMITS.step(calm) - 1e-3).abs() < 1e-15);
        let hit = Extremes { acceleration2: 1e10, ..calm };
        assert!((LIMITS.step(hit) - 0.25 * (0.03f64 / 1e5).sqrt()).abs() < 1e-15);
        let syrup = StepLimits { kinematic_viscosity: 1.0, ..LIMITS };
        assert!((syrup.step(calm) - 0.125 * 9e-4).abs() < 1e-15);
    }

    fn flowing<const D: usize>(velocities: &[[f64; D]]) -> Extremes {
        let of = |v: &[f64; D]| Extremes {
            speed2: v.iter().map(|c| c * c).sum(),
            velocity: Extremes::ways(v),
            ..Extremes::NONE
        };
        velocities.iter().map(of).fold(Extremes::NONE, Extremes::max)
    }

    #[test]
    fn lists_last_until_particles_may_have_moved_a_skin_apart() {
        let mut skin = Skin::new(0.01);
        // Apart at up to 8 m/s.
        let flow = flowing(&[[4.0, 0.0], [-4.0, 0.0]]);
        skin.moved(1.0, &flow);
        skin.moved(1e-3, &flow);
        assert!(!skin.would_exceed(0.24e-3, &flow, 0.0));
        assert!(skin.would_exceed(0.26e-3, &flow, 0.0));
        assert!(skin.would_exceed(0.24e-3, &flow, 0.5));
        skin.moved(0.26e-3, &flow);
        assert!(skin.exceeded());
        skin.renew();
        assert!(!skin.exceeded());
    }

    #[test]
    fn a_flow_in_one_direction_may_go_twice_as_far() {
        // No two particles, and no particle and a wall, are more than 4 m/s apart.
        let flow = flowing(&[[4.0], [1.0]]);
        let mut skin = Skin::new(0.01);
        skin.moved(1.0, &flow);
        skin.moved(2e-3, &flow);
        assert!(!skin.would_exceed(0.4e-3, &flow, 0.0));
        assert!(skin.would_exceed(0.6e-3, &flow, 0.0));
    }

    #[test]
    fn a_flow_in_all_directions_is_bounded_by_its_speed() {
        let sides = [[3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]];
        let all: Vec<[f64; 3]> = sides.iter().flat_map(|v| [*v, v.map(|c| -c)]).collect();
        let mut skin = Skin::new(0.01);
        skin.moved(1.0, &flowing(&all));
        skin.moved(1.6e-3, &flowing(&all));
        assert!(!skin.exceeded());
    }

    #[test]
    fn a_tank_at_rest_still_rebuilds() {
        let mut skin = Skin::new(0.01);
        let mut steps = 0;
        while !skin.would_exceed(1e-3, &Extremes::NONE, 0.0) {
            skin.moved(1e-3, &Extremes::NONE);
            steps += 1;
        }
        assert_eq!(steps, LONGEST_LIFE);
    }
}
