//! Partitions and migration.

mod common;

use common::{Cloud, clouds, random};
use proptest::prelude::*;
use sph_decomp::{
    Askew, Communicator, HilbertCurve, MigrateError, Orb, Partition, PartitionError, Solo,
    ThreadRanks, migrate,
};

/// Owners of all particles, computed on `ranks` ranks that hold particle `i` on rank `holder(i)`.
fn owners<const D: usize>(
    positions: &[[f64; D]],
    weights: &[f64],
    ranks: usize,
    hilbert: bool,
    holder: impl Fn(usize) -> usize + Sync,
) -> Vec<u32> {
    let all = ThreadRanks::run(ranks, |comm| {
        let mine: Vec<usize> = (0..positions.len()).filter(|&i| holder(i) == comm.rank()).collect();
        let x: Vec<_> = mine.iter().map(|&i| positions[i]).collect();
        let w: Vec<_> = mine.iter().map(|&i| weights[i]).collect();
        // Every rank asks for all particles, so that a difference between ranks shows.
        Ok::<_, PartitionError>(if hilbert {
            HilbertCurve::build(&comm, &x, &w)?.owners(positions)
        } else {
            Orb::build(&comm, &x, &w)?.owners(positions)
        })
    });
    let mut all = all.unwrap();
    assert!(all.iter().all(|one| *one == all[0]), "all ranks hold the same partition");
    all.swap_remove(0)
}

fn loads(owners: &[u32], weights: &[f64], ranks: usize) -> Vec<f64> {
    let mut loads = vec![0.0; ranks];
    for (&owner, weight) in owners.iter().zip(weights) {
        loads[owner as usize] += weight;
    }
    loads
}

fn imbalance(loads: &[f64]) -> f64 {
    let max = loads.iter().copied().fold(0.0, f64::max);
    max * loads.len() as f64 / loads.iter().sum::<f64>()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_holders_of_the_particles_do_not_matter(
        cloud in clouds::<3>(), ranks in 1_usize..9, hilbert: bool, seed: u64,
    ) {
        let mut random = random(seed);
        let weights: Vec<f64> = cloud.positions.iter().map(|_| random()).collect();
        let one = owners(&cloud.positions, &weights, ranks, hilbert, |_| 0);
        let spread = owners(&cloud.positions, &weights, ranks, hilbert, |i| i * 31 % 7 % ranks);
        prop_assert_eq!(&one, &spread);
        prop_assert!(one.iter().all(|&owner| (owner as usize) < ranks));
    }

    #[test]
    fn one_process_divides_as_all_ranks_together(
        cloud in clouds::<3>(), ranks in 1_usize..9, seed: u64,
    ) {
        let mut random = random(seed);
        let weights: Vec<f64> = cloud.positions.iter().map(|_| (8.0 * random()).floor()).collect();
        let together = ThreadRanks::run(ranks, |comm| {
            let mine = |i: &usize| i * 31 % 7 % ranks == comm.rank();
            let mine: Vec<usize> = (0..weights.len()).filter(mine).collect();
            let x: Vec<_> = mine.iter().map(|&i| cloud.positions[i]).collect();
            let w: Vec<_> = mine.iter().map(|&i| weights[i]).collect();
            Orb::build(&comm, &x, &w)
        });
        let mut positions = cloud.positions.clone();
        let mut ids: Vec<usize> = (0..weights.len()).collect();
        let (alone, starts) =
            Orb::divide(ranks, &mut positions, &mut ids, |&id| weights[id]).unwrap();
        prop_assert_eq!(&alone, &together.unwrap()[0]);
        prop_assert_eq!((starts[0], starts[ranks]), (0, weights.len()));
        for rank in 0..ranks {
            for place in starts[rank]..starts[rank + 1] {
                prop_assert_eq!(positions[place], cloud.positions[ids[place]]);
                prop_assert_eq!(alone.owner(&positions[place]), rank);
            }
        }
        ids.sort_unstable();
        prop_assert!(ids.iter().enumerate().all(|(place, id)| place == *id));
    }

    #[test]
    fn migration_loses_and_invents_nothing(
        count in 0_usize..80, ranks in 1_usize..6, seed: u64,
    ) {
        let mut random = random(seed);
        let mut pick = || (random() * ranks as f64) as usize;
        let holders: Vec<usize> = (0..count).map(|_| pick()).collect();
        let owners: Vec<usize> = (0..count).map(|_| pick()).collect();
        let result = ThreadRanks::run(ranks, |comm| {
            let mut ids: Vec<u64> =
                (0..count).filter(|&i| holders[i] == comm.rank()).map(|i| i as u64).collect();
            let mut state: Vec<[f32; 3]> = ids.iter().map(|&id| [id as f32, 0.0, -1.0]).collect();
            let mine: Vec<u32> = ids.iter().map(|&id| owners[id as usize] as u32).collect();
            let report = migrate(&comm, &mine, &mut (&mut ids, &mut state))?;
            assert!(ids.iter().zip(&state).all(|(id, state)| state[0] == *id as f32));
            assert_eq!(report.kept + report.received, ids.len());
            Ok::<_, MigrateError>(ids)
        });
        for (rank, mut ids) in result.unwrap().into_iter().enumerate() {
            ids.sort_unstable();
            let expected: Vec<u64> =
                (0..count).filter(|&i| owners[i] == rank).map(|i| i as u64).collect();
            prop_assert_eq!(ids, expected);
        }
    }
}

#[test]
fn loads_are_even_for_any_number_of_ranks() {
    let cloud = Cloud::<3>::lattice(30, 1.0 / 30.0, 1.0, 1.0, 1);
    let equal = vec![1.0; cloud.positions.len()];
    let graded: Vec<f64> = cloud.positions.iter().map(|x| 1.0 + 9.0 * x[1] * x[1]).collect();
    for ranks in [2, 3, 5, 7, 8, 13] {
        for (weights, hilbert) in
            [(&equal, false), (&graded, false), (&equal, true), (&graded, true)]
        {
            let owners = owners(&cloud.positions, weights, ranks, hilbert, |i| i % ranks);
            let imbalance = imbalance(&loads(&owners, weights, ranks));
            assert!(imbalance < 1.01, "{ranks} ranks, Hilbert curve {hilbert}: {imbalance}");
        }
    }
}

#[test]
fn regions_divide_space_as_owners_do() {
    let mut random = random(5);
    let positions: Vec<[f64; 3]> = (0..200).map(|_| [random(), random(), random()]).collect();
    for ranks in [1, 2, 7, 16] {
        let orb = ThreadRanks::run(ranks, |comm| {
            let mine = if comm.rank() == 0 { &positions[..] } else { &[] };
            Orb::build(&comm, mine, &[])
        });
        let orb = orb.unwrap().swap_remove(0);
        let regions = orb.regions();
        assert_eq!(regions.len(), ranks);
        for _ in 0..500 {
            let x = [2.0 * random() - 0.5, random(), random()];
            let holds = |(low, high): &([f64; 3], [f64; 3])| {
                (0..3).all(|k| low[k] <= x[k] && x[k] < high[k])
            };
            let holders: Vec<usize> = (0..ranks).filter(|&r| holds(&regions[r])).collect();
            assert_eq!(holders, [orb.owner(&x)], "{x:?}");
        }
    }
}

#[test]
fn whoever_comes_near_is_named() {
    let mut random = random(11);
    let mut point = || [random(), random(), random()];
    let positions: Vec<[f64; 3]> = (0..300).map(|_| point()).collect();
    let partitions = ThreadRanks::run(13, |comm| {
        let mine = if comm.rank() == 0 { &positions[..] } else { &[] };
        let straight = Orb::build(&comm, mine, &[])?;
        let askew = Askew::new(Orb::build(&comm, &Askew::view(mine), &[])?);
        Ok::<_, PartitionError>((straight, askew))
    });
    let (straight, askew) = partitions.unwrap().swap_remove(0);
    let regions = straight.regions();
    for _ in 0..300 {
        let (x, reach) = (point(), 0.15);
        let (mut near, mut near_askew) = (vec![], vec![]);
        straight.within(&x, reach, |rank| near.push(rank));
        askew.within(&x, reach, |rank| near_askew.push(rank));
        near.sort_unstable();
        let gap = |(low, high): &([f64; 3], [f64; 3])| {
            (0..3).map(|k| (low[k] - x[k]).max(x[k] - high[k]).max(0.0).powi(2)).sum::<f64>()
        };
        let expected: Vec<usize> =
            (0..13).filter(|&rank| gap(&regions[rank]) < reach * reach).collect();
        assert_eq!(near, expected);
        assert!(near.len() < 13 && near_askew.len() < 13, "not simply all");
        for y in &positions {
            let distance2: f64 = (0..3).map(|k| (x[k] - y[k]).powi(2)).sum();
            if distance2 < reach * reach {
                assert!(near_askew.contains(&askew.owner(y)));
            }
        }
    }
}

#[test]
fn cuts_fall_between_the_layers_of_a_lattice() {
    // Rounding errors of 10⁻¹⁶ must not decide who owns a particle of the middle layers.
    let cloud = Cloud::<2>::lattice(16, 0.1, 1e-14, 1.0, 2);
    let weights = vec![1.0; 256];
    let owners = owners(&cloud.positions, &weights, 4, false, |_| 0);
    assert_eq!(loads(&owners, &weights, 4), [64.0; 4]);
    for (x, &owner) in cloud.positions.iter().zip(&owners) {
        let quadrant = |x: f64| u32::from(x > 0.8);
        assert!(owner == 2 * quadrant(x[0]) + quadrant(x[1]), "{x:?} {owner}");
    }
}

#[test]
fn more_ranks_than_particles_and_coincident_ones() {
    for hilbert in [false, true] {
        let few = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let owned = owners(&few, &[1.0; 3], 8, hilbert, |_| 0);
        assert_eq!(loads(&owned, &[1.0; 3], 8).iter().copied().fold(0.0, f64::max), 1.0);
        let same = owners(&[[2.0, 2.0]; 20], &[1.0; 20], 4, hilbert, |i| i % 4);
        assert!(same.iter().all(|owner| *owner == same[0]), "they cannot be divided");
        assert!(owners::<2>(&[], &[], 3, hilbert, |_| 0).is_empty());
        let unloaded = owners(&few, &[0.0; 3], 2, hilbert, |_| 0);
        assert_eq!(loads(&unloaded, &[1.0; 3], 2).iter().copied().fold(0.0, f64::max), 2.0);
    }
}

#[test]
fn bad_input_is_named() {
    let text = |positions: &[[f64; 2]], weights: &[f64]| {
        Orb::build(&Solo, positions, weights).unwrap_err().to_string()
    };
    assert_eq!(
        text(&[[0.0, f64::INFINITY]], &[]),
        "particle 0 (index on this rank) is at inf on axis 1"
    );
    assert!(
        text(&[[0.0; 2]; 2], &[1.0, -1.0])
            .contains("particle 1 (index on this rank) has weight -1")
    );
    assert!(text(&[[0.0; 2]; 2], &[1.0]).contains("1 weights for 2 particles"));

    let owner = migrate(&Solo, &[0, 4], &mut vec![1_u8, 2]).unwrap_err().to_string();
    assert!(owner.contains("particle 1") && owner.contains("rank 4"), "{owner}");
    let length = migrate(&Solo, &[0], &mut vec![1_u8, 2]).unwrap_err().to_string();
    assert_eq!(length, "there are 1 owners for 2 particles");
}
