//! Many ranks in one process: right, and in memory that grows with their number, not with its
//! square.
//!
//! In a test program of its own, because it looks at the memory of the whole process.

mod common;

use common::scenario;
use sph_decomp::{CommError, Communicator, Solo, ThreadRanks};

/// The most memory that this process has had, in bytes, where the system tells.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok()?)
}

/// Values by ascending size, and what every rank knows of all: largest and sum.
fn particles(results: &[Vec<f64>], ranks: usize) -> Vec<f64> {
    let mut values = Vec::new();
    for (rank, result) in results.iter().enumerate() {
        let statistics = &result[result.len() - 9 * ranks..];
        let mine = &statistics[9 * rank..];
        values.extend_from_slice(&result[2..2 + (mine[1] + mine[2]) as usize]);
    }
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn hundreds_of_ranks_in_one_process() {
    let alone = scenario::run(&Solo, false).expect("one rank succeeds");
    let expected = particles(std::slice::from_ref(&alone), 1);
    // Three particles per rank, and more ranks than the 729 particles.
    for ranks in [256, 800] {
        let shared = ThreadRanks::run(ranks, |comm| scenario::run(&comm, false));
        let shared = shared.expect("all ranks succeed");
        assert!(shared.iter().all(|result| result[..2] == alone[..2]), "{ranks} ranks");
        assert_eq!(particles(&shared, ranks), expected, "{ranks} ranks");
        let owned = |rank: usize| {
            let statistics = &shared[rank][shared[rank].len() - 9 * ranks..];
            statistics[9 * rank + 1] + statistics[9 * rank + 2]
        };
        let empty = (0..ranks).filter(|&rank| owned(rank) == 0.0).count();
        assert_eq!(empty > 0, ranks > 729, "{empty} of {ranks} ranks are empty");
        if ranks == 256 {
            // A copy of every histogram of the partition for every pair of ranks is gigabytes.
            // `RUST_MIN_STACK` and the allocator take their share, hence not less.
            println!("{ranks} ranks: peak {:?} MB", peak().map(|bytes| bytes / 1_000_000));
            assert!(peak().is_none_or(|bytes| bytes < 400_000_000), "{:?}", peak());
        }
    }
}

#[test]
fn a_large_reduction_holds_one_copy() {
    let sums = ThreadRanks::run(64, |comm| {
        let mut sums = vec![comm.rank() as u64; 10_000];
        let mut maxima: Vec<f64> = (0..10_000).map(|i| (i % (7 + comm.rank())) as f64).collect();
        comm.sum_u64(&mut sums)?;
        comm.max_f64(&mut maxima)?;
        Ok::<_, CommError>((sums, maxima))
    });
    for (sums, maxima) in sums.expect("all ranks succeed") {
        assert!(sums.iter().all(|&sum| sum == 63 * 64 / 2));
        let largest = |i: u32| (7..71).map(|n| i % n).max().unwrap_or(0);
        assert!((0..).zip(&maxima).all(|(i, max)| *max == f64::from(largest(i))));
    }
}
