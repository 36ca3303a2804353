//! How well each kernel sums to one: `ΣVW` and `ΣV r⊗∇W` on a lattice and with 10 % jitter.
//!
//! For each kernel and support the table shows the error of `ΣVW = 1` and of the diagonal of
//! `ΣV r⊗∇W = −I`: its size on a perfect lattice, and the root mean square over neighbourhoods
//! whose particles, the one in the middle too, are moved by up to a tenth of the spacing along each
//! axis.
//!
//! `cargo run --release -p sph-kernels --example moments`

use sph_kernels::{
    CubicSpline, Gaussian, Kernel, Moments, QuinticSpline, WendlandC2, WendlandC4, WendlandC6,
};

const SAMPLES: usize = 8000;

/// Marsaglia's xorshift, uniform in [−1, 1].
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Moments of the particle in the middle of a lattice with spacing 1.
fn moments<K: Kernel, const D: usize>(radius: f64, jitter: f64, noise: &mut Noise) -> Moments<D> {
    let reach = (radius + 2.0 * jitter).ceil() as i32;
    let side = 2 * reach + 1;
    let mut moved = |x: i32| f64::from(x) + jitter * noise.next();
    let centre: [f64; D] = std::array::from_fn(|_| moved(0));
    let mut moments = Moments::zero();
    for cell in 0..side.pow(D as u32) {
        let node: [i32; D] = std::array::from_fn(|k| cell / side.pow(k as u32) % side - reach);
        let offset = if node == [0; D] {
            [0.0; D]
        } else {
            std::array::from_fn(|k| centre[k] - moved(node[k]))
        };
        moments.add::<K>(&offset, radius, 1.0);
    }
    moments
}

/// Root mean square errors of `ΣVW` and of the diagonal of `ΣV r⊗∇W`.
fn errors<K: Kernel, const D: usize>(radius: f64, jitter: f64, samples: usize) -> [f64; 2] {
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
    let mut squares = [0.0; 2];
    for _ in 0..samples {
        let moments = moments::<K, D>(radius, jitter, &mut noise);
        squares[0] += (moments.unity() - 1.0).powi(2);
        let diagonal = moments.gradient().diagonal();
        squares[1] += diagonal.iter().map(|x| (x + 1.0).powi(2)).sum::<f64>() / D as f64;
    }
    squares.map(|square| (square / samples as f64).sqrt())
}

fn row<K: Kernel, const D: usize>(radius: f64) {
    let [unity, gradient] = errors::<K, D>(radius, 0.0, 1);
    let [unity_jitter, gradient_jitter] = errors::<K, D>(radius, 0.1, SAMPLES);
    println!(
        "{:15} {D}  {radius:4.1}  {unity:8.1e}  {gradient:10.1e}   {unity_jitter:8.1e}  \
         {gradient_jitter:10.1e}",
        K::NAME
    );
}

fn rows<K: Kernel>() {
    for radius in [2.6, 3.0, 4.0] {
        row::<K, 2>(radius);
    }
    for radius in [2.6, 3.0, 4.0] {
        row::<K, 3>(radius);
    }
}

fn main() {
    println!("                              lattice                 jitter, rms");
    println!("kernel          d  R/dp  ΣVW − 1   ΣV r⊗∇W + I  ΣVW − 1   ΣV r⊗∇W + I");
    rows::<WendlandC2>();
    rows::<WendlandC4>();
    rows::<WendlandC6>();
    rows::<CubicSpline>();
    rows::<QuinticSpline>();
    rows::<Gaussian>();
}
