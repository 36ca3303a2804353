//! Memory bandwidth: the triad of McCalpin's STREAM benchmark (1995).

use rayon::prelude::*;
use sph_solver::team::Team;

/// Three arrays for `a = b + s c`.
#[derive(Debug)]
pub struct Triad {
    a: Vec<f64>,
    b: Vec<f64>,
    c: Vec<f64>,
}

impl Triad {
    /// Arrays of `length` numbers: together many times larger than the caches.
    pub fn new(length: usize) -> Self {
        Self { a: vec![0.0; length], b: vec![1.0; length], c: vec![2.0; length] }
    }
}

/// Runs the triad once on the threads of a team and returns the bytes moved by STREAM's count:
/// two reads and one write of eight bytes. Reading the line that is to be written is not counted.
pub fn triad_bytes(team: &Team, arrays: &mut Triad) -> f64 {
    let Triad { a, b, c } = arrays;
    let piece = a.len().div_ceil(team.threads());
    let scale = std::hint::black_box(3.0);
    let run = |((a, b), c): ((&mut [f64], &[f64]), &[f64])| {
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            *a = b + scale * c;
        }
    };
    team.install(|| {
        a.par_chunks_mut(piece).zip(b.par_chunks(piece)).zip(c.par_chunks(piece)).for_each(run);
    });
    24.0 * a.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_is_written() {
        let team = Team::new(2).expect("threads");
        let mut arrays = Triad::new(1001);
        assert_eq!(triad_bytes(&team, &mut arrays), 24024.0);
        assert!(arrays.a.iter().all(|&a| a == 7.0));
    }
}
