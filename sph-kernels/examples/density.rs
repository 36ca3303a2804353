//! Density by summation, `ρ_i = Σ m_j W(r_ij, R_ij)`, on the widest lanes of this CPU.
//!
//! A jittered block of water in two dimensions, its right half with a larger support radius. The
//! neighbour search is brute force: a library for that is another matter.
//!
//! `cargo run --release -p sph-kernels --example density`

use sph_kernels::{
    Kernel, Lanes, MeanRadius, PairRadius, Real, Vectorized, WendlandC2, simd_level,
};

const SIDE: usize = 60;
const SPACING: f64 = 0.01; // m
const DENSITY: f64 = 1000.0; // kg/m³
const UNIT: f64 = SPACING / (1 << 20) as f64; // m, of the fixed-point coordinates

/// What neighbours read of a particle: x, y, then the support radius and the mass.
type Record = [f32; 8];
const RADIUS: usize = 6;
const MASS: usize = 7;

/// Sums the density of every particle over its list.
struct Density<'a> {
    records: &'a [Record],
    lists: &'a [Vec<u32>],
}

impl Vectorized for Density<'_> {
    type Scalar = f32;
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lanes<Scalar = f32>>(self) -> Vec<f64> {
        let unit = L::splat(UNIT as f32);
        let mut densities = Vec::with_capacity(self.records.len());
        for (me, list) in self.records.iter().zip(self.lists) {
            let [x, y, .., radius, _] = me.map(L::splat);
            let mut sum = L::zero();
            for index in list.chunks_exact(L::LANES) {
                let words = L::gather(self.records, index);
                let dx = L::coordinate_difference(x, words[0]) * unit;
                let dy = L::coordinate_difference(y, words[1]) * unit;
                let distance = dx.mul_add(dx, dy * dy).sqrt();
                let pair_radius = MeanRadius::of(radius, words[RADIUS]);
                let w = WendlandC2::value::<2, L>(distance, pair_radius);
                sum = words[MASS].mul_add(w, sum);
            }
            densities.push(sum.sum().to_f64());
        }
        densities
    }
}

fn main() {
    let positions: Vec<[f64; 2]> = (0..SIDE * SIDE)
        .map(|i| {
            let jitter = |phase: f64| 0.1 * (phase * i as f64).sin();
            let node = [(i % SIDE) as f64 + jitter(12.9898), (i / SIDE) as f64 + jitter(78.233)];
            node.map(|x| x * SPACING)
        })
        .collect();
    let radius =
        |x: &[f64; 2]| SPACING * if x[0] < 0.5 * SIDE as f64 * SPACING { 3.0 } else { 4.0 };
    let mut records: Vec<Record> = positions
        .iter()
        .map(|x| {
            let [x_word, y_word] = x.map(|x| f32::encode_coordinate(x, UNIT));
            let mass = DENSITY * SPACING * SPACING;
            [x_word, y_word, 0.0, 0.0, 0.0, 0.0, radius(x) as f32, mass as f32]
        })
        .collect();

    // Fill every list up to whole lanes with a record that weighs nothing.
    let nothing = records.len() as u32;
    records.push([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let lists: Vec<Vec<u32>> = positions
        .iter()
        .map(|x| {
            let near = |y: &[f64; 2]| {
                (x[0] - y[0]).hypot(x[1] - y[1]) < MeanRadius::of(radius(x), radius(y))
            };
            let mut list: Vec<u32> =
                (0..).zip(&positions).filter(|(_, y)| near(y)).map(|(j, _)| j).collect();
            list.resize(list.len().next_multiple_of(8), nothing);
            list
        })
        .collect();

    let density = f32::dispatch(Density { records: &records, lists: &lists });

    let inside = |x: &[f64; 2]| x.iter().all(|x| (4.5..SIDE as f64 - 5.5).contains(&(x / SPACING)));
    let interior: Vec<f64> =
        positions.iter().zip(&density).filter(|(x, _)| inside(x)).map(|(_, &d)| d).collect();
    let mean = interior.iter().sum::<f64>() / interior.len() as f64;
    let spread = interior.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / interior.len() as f64;
    println!("lanes: {}", simd_level());
    println!("density inside: {mean:.1} ± {:.1} kg/m³", spread.sqrt());
    println!("density in a corner: {:.1} kg/m³", density[0]);
}
