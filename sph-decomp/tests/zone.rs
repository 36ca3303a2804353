//! The overlap zone against brute force.

mod common;

use common::{Cloud, clouds, owners};
use proptest::prelude::*;
use sph_decomp::{
    Communicator, MaxReach, MeanReach, PairReach, Reach, ThreadRanks, Zone, ZoneError, ZoneOptions,
};

/// For each rank and each other rank, the global indices that the one sends to the other.
type Sends = Vec<Vec<Vec<usize>>>;

/// Builds the zone on thread ranks.
fn built<const D: usize, R: PairReach + Sync>(
    cloud: &Cloud<D>,
    owners: &[usize],
    ranks: usize,
    rule: R,
    options: &ZoneOptions<D>,
) -> Sends {
    let result = ThreadRanks::run(ranks, |comm| {
        let mine: Vec<usize> = (0..owners.len()).filter(|&i| owners[i] == comm.rank()).collect();
        let positions: Vec<[f64; D]> = mine.iter().map(|&i| cloud.positions[i]).collect();
        let reach: Vec<f64> = mine.iter().map(|&i| cloud.reach[i]).collect();
        let zone = Zone::build(&comm, &positions, Reach::PerParticle(&reach), rule, options)?;
        let mut sends = vec![Vec::new(); ranks];
        for (rank, list) in zone.sends() {
            assert!(list.is_sorted(), "lists are ascending");
            sends[*rank] = list.iter().map(|&i| mine[i as usize]).collect();
        }
        Ok::<_, ZoneError>(sends)
    });
    result.expect("the zone is built")
}

/// The particles that are really needed, by looking at all pairs.
fn exact<const D: usize, R: PairReach>(
    cloud: &Cloud<D>,
    owners: &[usize],
    ranks: usize,
    period: &[Option<f64>; D],
    widened: f64,
) -> Sends {
    let mut sends = vec![vec![Vec::new(); ranks]; ranks];
    for i in 0..owners.len() {
        for q in (0..ranks).filter(|&q| q != owners[i]) {
            let sees = |j: usize| {
                owners[j] == q
                    && cloud.distance(i, j, period)
                        < R::pair(cloud.reach[i], cloud.reach[j]) * widened
            };
            if (0..owners.len()).any(sees) {
                sends[owners[i]][q].push(i);
            }
        }
    }
    sends
}

fn count(sends: &Sends) -> usize {
    sends.iter().flatten().map(Vec::len).sum()
}

/// Complete, and exact with blocks of one particle.
fn check<const D: usize, R: PairReach + Sync>(
    cloud: &Cloud<D>,
    owners: &[usize],
    ranks: usize,
    rule: R,
    options: ZoneOptions<D>,
) -> (Sends, Sends) {
    let needed = exact::<D, R>(cloud, owners, ranks, &options.period, 1.0);
    let sent = built(cloud, owners, ranks, rule, &options);
    for p in 0..ranks {
        for q in 0..ranks {
            for i in &needed[p][q] {
                assert!(sent[p][q].binary_search(i).is_ok(), "particle {i} of {p} misses at {q}");
            }
        }
    }
    let single = built(cloud, owners, ranks, rule, &ZoneOptions { block: 1, ..options });
    if single != needed {
        // The reach is widened by a hair: only pairs at that very distance may be sent in addition.
        let hair = exact::<D, R>(cloud, owners, ranks, &options.period, 1.0 + 2e-6);
        for (p, q) in (0..ranks).flat_map(|p| (0..ranks).map(move |q| (p, q))) {
            assert!(needed[p][q].iter().all(|i| single[p][q].contains(i)));
            assert!(single[p][q].iter().all(|i| hair[p][q].contains(i)));
        }
    }
    (sent, needed)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..Default::default() })]

    #[test]
    fn complete_in_three_dimensions(
        cloud in clouds::<3>(), ranks in 2_usize..6, split in 0_u8..4, block in 1_usize..12,
        periodic: bool,
    ) {
        let owners = owners(&cloud, ranks, split);
        let period = if periodic { [Some(2.0), None, Some(2.0)] } else { [None; 3] };
        check(&cloud, &owners, ranks, MeanReach, ZoneOptions { block, period });
        check(&cloud, &owners, ranks, MaxReach, ZoneOptions { block, period });
    }

    #[test]
    fn complete_in_two_dimensions(
        cloud in clouds::<2>(), ranks in 2_usize..8, split in 0_u8..4, block in 1_usize..12,
    ) {
        let owners = owners(&cloud, ranks, split);
        check(&cloud, &owners, ranks, MeanReach, ZoneOptions { block, period: [None; 2] });
        check(&cloud, &owners, ranks, MaxReach, ZoneOptions { block, period: [None; 2] });
    }
}

#[test]
fn a_rank_enclosed_by_another() {
    let cloud = Cloud::<2>::lattice(40, 0.025, 0.3, 1.0, 7);
    let inside = |x: &[f64; 2]| x.iter().all(|x| (0.4..0.6).contains(x));
    let owners: Vec<usize> = cloud.positions.iter().map(|x| usize::from(inside(x))).collect();
    let (sent, needed) = check(&cloud, &owners, 2, MeanReach, ZoneOptions::default());
    assert!(count(&needed) > 100);
    let redundancy = count(&sent) as f64 / count(&needed) as f64;
    assert!(redundancy <= 1.10, "{redundancy}");
}

#[test]
fn a_rank_with_one_particle_and_ranks_with_none() {
    let cloud = Cloud::<3>::lattice(10, 0.1, 0.3, 1.0, 3);
    let owners: Vec<usize> = (0..1000).map(|i| if i == 444 { 3 } else { 1 }).collect();
    let (sent, _) = check(&cloud, &owners, 5, MaxReach, ZoneOptions::default());
    assert_eq!(sent[3][1], [444]);
    assert!(sent[0].iter().chain(&sent[2]).chain(&sent[4]).all(Vec::is_empty));
}

#[test]
fn bad_input_is_named() {
    let build = |positions: &[[f64; 2]], reach: Reach<'_>, block| {
        let options = ZoneOptions { block, period: [None; 2] };
        Zone::build(&sph_decomp::Solo, positions, reach, MeanReach, &options)
            .unwrap_err()
            .to_string()
    };
    let nan = build(&[[0.0, 0.0], [1.0, f64::NAN]], Reach::Uniform(1.0), 4);
    assert_eq!(nan, "particle 1 (index on this rank) is at NaN on axis 1");
    let negative = build(&[[0.0; 2]; 2], Reach::PerParticle(&[1.0, -2.0]), 4);
    assert!(negative.contains("particle 1") && negative.contains("-2"), "{negative}");
    let short = build(&[[0.0; 2]; 2], Reach::PerParticle(&[1.0]), 4);
    assert_eq!(short, "there are 1 reaches for 2 particles");
    assert!(build(&[], Reach::Uniform(1.0), 0).contains("`block` is 0"));
}

/// Sent over needed particles for jittered lattices cut by bisection.
#[test]
fn few_particles_are_sent_needlessly() {
    let uniform = Cloud::<3>::lattice(24, 1.0 / 24.0, 0.4, 1.0, 5);
    let sparse = Cloud::<3>::lattice(24, 1.0 / 24.0, 0.4, 8.0, 6);
    let graded = Cloud::<3>::graded(8);
    let flat = Cloud::<2>::lattice(100, 0.01, 0.4, 1.0, 7);
    fn redundancy<const D: usize>(cloud: &Cloud<D>, ranks: usize) -> f64 {
        let owners = owners(cloud, ranks, 0);
        let options = ZoneOptions::default();
        let needed = exact::<D, MeanReach>(cloud, &owners, ranks, &options.period, 1.0);
        let sent = built(cloud, &owners, ranks, MeanReach, &options);
        count(&sent) as f64 / count(&needed) as f64
    }
    for (name, ratio) in [
        ("uniform 3-D, 4 ranks", redundancy(&uniform, 4)),
        ("sparse for its reach, 4 ranks", redundancy(&sparse, 4)),
        ("spacing 1:8, 4 ranks", redundancy(&graded, 4)),
        ("spacing 1:8, 7 ranks", redundancy(&graded, 7)),
        ("uniform 2-D, 8 ranks", redundancy(&flat, 8)),
    ] {
        println!("{name}: {ratio:.4}");
        assert!((1.0..=1.10).contains(&ratio), "{name}: {ratio}");
    }
}
