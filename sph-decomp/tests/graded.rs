//! Graded reaches, moving particles, a balancer at work: the same bits on any number of ranks, and
//! no pair computed twice.

mod common;

use common::graded;
use sph_decomp::{Blocking, Solo, ThreadRanks};

#[test]
fn the_same_bits_and_the_same_pairs_while_ranks_are_rebalanced() {
    let alone = graded::run(&Solo).expect("one rank succeeds");
    assert!(alone.state.len() > 1000 && alone.pairs > 1_000_000, "{}", alone.pairs);
    for ranks in [1, 2, 3, 5, 8] {
        let shared = ThreadRanks::run(ranks, |comm| graded::run(&comm)).expect("all succeed");
        let mut state = shared.iter().flat_map(|one| one.state.clone()).collect::<Vec<_>>();
        state.sort_unstable();
        assert!(state == alone.state, "{ranks} ranks give other bits");
        let pairs: u64 = shared.iter().map(|one| one.pairs).sum();
        assert_eq!(pairs, alone.pairs, "{ranks} ranks");
        let evenness = shared[0].evenness;
        println!("{ranks} ranks: {evenness:?}");
        assert!(shared.iter().all(|one| one.evenness == evenness), "all ranks agree");
        assert!(ranks == 1 || evenness.partitions > 2, "{ranks} ranks: {evenness:?}");
        assert!(evenness.predicted <= 1.05, "{ranks} ranks: {evenness:?}");
    }
    let blocking = ThreadRanks::run(3, |comm| graded::run(&Blocking::new(comm)));
    let blocking = blocking.expect("all succeed");
    let mut state = blocking.iter().flat_map(|one| one.state.clone()).collect::<Vec<_>>();
    state.sort_unstable();
    assert!(state == alone.state, "without overlap");
}
