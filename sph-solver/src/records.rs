//! Records: the pair data of a particle, the only part of its state that neighbours read.
//!
//! A record is eight words, so that eight neighbours fill eight vector registers after one
//! transpose: `[x y z  vx vy vz  s  w]`. Two dimensions leave the third words zero. `s` is the
//! [`Quantity`](crate::terms::Quantity) of the sweep that reads the records; `w` is the volume times
//! all constants of the kernel's gradient, so that no pair multiplies by them.
//!
//! The records of [walls](crate::walls) are made once: the words of velocity hold the normal of the
//! wall and `s` the depth below its surface.
//!
//! In single precision the coordinate words hold wrapping fixed-point numbers in units of
//! `R / 2^24`. Their differences are exact wherever the particle is and whoever owns it, which a
//! float relative to the box of a rank would not be.

use crate::kernel_shape::KernelShape;
use crate::space::PairScale;
use sph_kernels::Real;
use std::marker::PhantomData;

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
pub struct Encoder<const D: usize, S> {
    coordinate_units: [f64; D],
    weight_per_volume: f64,
    scalar: PhantomData<S>,
}

impl<const D: usize, S: Real> Encoder<D, S> {
    /// For pairs of this scale with a kernel.
    pub fn new(scale: &PairScale<D>, kernel: &KernelShape) -> Self {
        let PairScale { unit, support_radius, .. } = *scale;
        Self {
            coordinate_units: std::array::from_fn(|axis| scale.coordinate_unit::<S>(axis)),
            weight_per_volume: unit * kernel.gradient * support_radius.powi(-(D as i32) - 2),
            scalar: PhantomData,
        }
    }

    /// The weight of a volume (m^D).
    #[inline]
    pub fn weight(&self, volume: f64) -> S {
        S::from_f64(volume * self.weight_per_volume)
    }

    /// The words of place and motion.
    #[inline]
    pub fn motion(&self, position: &[f64; D], velocity: &[f64; D]) -> [S; 6] {
        let mut words = [S::from_f64(0.0); 6];
        for k in 0..D {
            words[k] = S::encode_coordinate(position[k], self.coordinate_units[k]);
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
