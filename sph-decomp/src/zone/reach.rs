//! How far a particle reaches, alone and in a pair.

/// The reach of the particles of a rank: the distance within which they see others, skin included.
#[derive(Debug, Clone, Copy)]
pub enum Reach<'a> {
    /// The same for all particles of all ranks: no array.
    Uniform(f64),
    /// One per particle.
    PerParticle(&'a [f64]),
}

impl Reach<'_> {
    pub(super) fn of(&self, particle: usize) -> f64 {
        match self {
            Self::Uniform(reach) => *reach,
            Self::PerParticle(all) => all[particle],
        }
    }
}

/// The rule that gives the reach of a pair from the reaches of its two particles.
///
/// It must be symmetric, and must not shrink when one of the two grows.
pub trait PairReach: Copy {
    /// The reach of the pair.
    fn pair(a: f64, b: f64) -> f64;
}

/// The pair reaches as far as the mean of its particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeanReach;

impl PairReach for MeanReach {
    fn pair(a: f64, b: f64) -> f64 {
        0.5 * (a + b)
    }
}

/// The pair reaches as far as the farther reaching of its particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MaxReach;

impl PairReach for MaxReach {
    fn pair(a: f64, b: f64) -> f64 {
        a.max(b)
    }
}
