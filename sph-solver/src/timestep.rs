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
/// Lists hold all pairs closer than support + skin, so they are complete as long as no particle has
/// moved farther than skin/2. The sum over the steps of dt times the largest speed bounds every
/// displacement; it needs no memory per particle and is the same on every rank.
#[derive(Debug, Clone, Copy)]
pub struct Skin {
    allowance: f64,
    used: f64,
    steps: u32,
    fresh: bool,
}

impl Skin {
    /// For lists with a skin of `width` (m).
    pub fn new(width: f64) -> Self {
        Self { allowance: 0.5 * width, used: 0.0, steps: 0, fresh: true }
    }

    /// The lists have just been built for the present positions.
    pub fn renew(&mut self) {
        self.used = 0.0;
        self.steps = 0;
        self.fresh = true;
    }

    /// The present positions were reached by a drift of `dt` (s) with the largest speed `speed`
    /// (m/s). Called once a step; the drift that ended just before a rebuild does not count.
    pub fn moved(&mut self, dt: f64, speed: f64) {
        if !self.fresh {
            self.used += dt * speed;
        }
        self.steps += 1;
        self.fresh = false;
    }

    /// Whether the present positions are farther apart than the lists allow for.
    pub fn exceeded(&self) -> bool {
        self.used > self.allowance
    }

    /// Whether a further drift of `dt` at `speed` would ask for new lists.
    pub fn would_exceed(&self, dt: f64, speed: f64) -> bool {
        self.steps >= LONGEST_LIFE || self.used + dt * speed > self.allowance
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
        let calm = Extremes { speed2: 1.0, acceleration2: 0.0, fault: 0.0 };
        assert!((LIMITS.step(calm) - 1e-3).abs() < 1e-15);
        let hit = Extremes { acceleration2: 1e10, ..calm };
        assert!((LIMITS.step(hit) - 0.25 * (0.03f64 / 1e5).sqrt()).abs() < 1e-15);
        let syrup = StepLimits { kinematic_viscosity: 1.0, ..LIMITS };
        assert!((syrup.step(calm) - 0.125 * 9e-4).abs() < 1e-15);
    }

    #[test]
    fn lists_last_until_half_the_skin_is_used() {
        let mut skin = Skin::new(0.01);
        skin.moved(1.0, 9.0);
        skin.moved(1e-3, 4.0);
        assert!(!skin.would_exceed(1e-3, 0.9));
        assert!(skin.would_exceed(1e-3, 1.1));
        skin.moved(1e-3, 1.1);
        assert!(skin.exceeded());
        skin.renew();
        assert!(!skin.exceeded());
    }

    #[test]
    fn a_tank_at_rest_still_rebuilds() {
        let mut skin = Skin::new(0.01);
        let mut steps = 0;
        while !skin.would_exceed(1e-3, 0.0) {
            skin.moved(1e-3, 0.0);
            steps += 1;
        }
        assert_eq!(steps, LONGEST_LIFE);
    }
}
