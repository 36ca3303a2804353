//! The same program gives the same bits on any number of ranks.

mod common;

use common::scenario;
use sph_decomp::{Solo, ThreadRanks};

#[test]
fn thread_ranks_agree_with_one_process() {
    let alone = scenario::run(&Solo, false).unwrap();
    // Largest value and sum come first, then the values of the owned particles, here all by id.
    let mut particles = alone[2..2 + 729].to_vec();
    particles.sort_by(f64::total_cmp);
    for ranks in [1, 2, 3, 5, 8] {
        for hilbert in [false, true] {
            let shared = ThreadRanks::run(ranks, |comm| scenario::run(&comm, hilbert)).unwrap();
            let mut values = Vec::new();
            for (rank, result) in shared.iter().enumerate() {
                assert_eq!(result[..2], alone[..2], "{ranks} ranks, Hilbert curve: {hilbert}");
                let statistics = &result[result.len() - 9 * ranks..];
                let mine = &statistics[9 * rank..];
                let owned = (mine[1] + mine[2]) as usize;
                values.extend_from_slice(&result[2..2 + owned]);
            }
            values.sort_by(f64::total_cmp);
            assert_eq!(values, particles, "{ranks} ranks, Hilbert curve: {hilbert}");
        }
    }
}
