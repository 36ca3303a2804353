//! Records: the pair data of a particle, the only part of its state that neighbours read.
//!
//! A record is eight words, so that eight neighbours fill eight vector registers after one
//! transpose: `[x y z  vx vy vz  s  w]`. Two dimensions leave the third words zero. `s` is the
//! [`Quantity`](crate::terms::Quantity) of the sweep that reads the records; `w` is the volume times
//! all constants of the kernel's gradient, so that no pair multiplies by them.
//!
//! In single precision the coordinate words hold wrapping fixed-point numbers in units of
//! `R / 2^24`. Their differences are exact wherever the particle is and whoever owns it, which a
//! float relative to the box of a rank would not be.

use sph_kernels::{Kernel, Real};

/// Pair data of one particle; the module documentation names the words.
pub type Record<S> = [S; 8];

/// Word of the quantity.
pub const QUANTITY: usize = 6;
/// Word of the weight `w = V u σ f / R^(D+2)`: volume, unit of the coordinates, norm and slope factor
/// of the kernel. With the coordinate difference r in units, `∇W V = w slope_shape(q) r`.
pub const WEIGHT: usize = 7;
const VELOCITY: usize = 3;

/// Writes records for one support radius.
#[derive(Debug, Clone, Copy)]
pub struct Encoder {
    unit: f64,
    weight_per_volume: f64,
}

impl Encoder {
    /// For pairs with support radius `support_radius` (m) in `dimension` dimensions.
    pub fn new<K: Kernel>(support_radius: f64, dimension: usize) -> Self {
        let unit = support_radius / f64::from(1u32 << 24);
        let gradient = K::norm(dimension) * K::SLOPE_FACTOR;
        let weight_per_volume = unit * gradient * support_radius.powi(-(dimension as i32) - 2);
        Self { unit, weight_per_volume }
    }

    /// Metres per unit of coordinate differences.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// The weight of a volume (m^D).
    #[inline]
    pub fn weight<S: Real>(&self, volume: f64) -> S {
        S::from_f64(volume * self.weight_per_volume)
    }

    /// The words of place and motion.
    #[inline]
    pub fn motion<const D: usize, S: Real>(
        &self,
        position: &[f64; D],
        velocity: &[f64; D],
    ) -> [S; 6] {
        let mut words = [S::from_f64(0.0); 6];
        for k in 0..D {
            words[k] = S::encode_coordinate(position[k], self.unit);
            words[VELOCITY + k] = S::from_f64(velocity[k]);
        }
        words
    }
}

/// Puts a record together.
#[inline]
pub fn record<S: Real>(motion: [S; 6], quantity: S, weight: S) -> Record<S> {
    let [x, y, z, u, v, w] = motion;
    [x, y, z, u, v, w, quantity, weight]
}

/// The words of place and motion of a record.
#[inline]
pub fn motion<S: Real>(record: &Record<S>) -> [S; 6] {
    let [x, y, z, u, v, w, ..] = *record;
    [x, y, z, u, v, w]
}

/// Word of velocity component `k`.
#[inline(always)]
pub const fn velocity_word(k: usize) -> usize {
    VELOCITY + k
}
