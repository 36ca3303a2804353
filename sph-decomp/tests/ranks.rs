//! Thread ranks: delivery, order, and what happens when one fails.

use std::time::{Duration, Instant};

use sph_decomp::{
    CommError, Communicator, Halo, HaloPlan, Part, PlanError, RanksError, Solo, ThreadRanks,
    Traffic,
};

/// A plan in which every rank sends its particles 0 and 1 to the next rank.
fn ring<C: Communicator>(comm: &C) -> Result<HaloPlan, CommError> {
    HaloPlan::new(comm, vec![((comm.rank() + 1) % comm.size(), vec![0, 1])])
}

#[test]
fn a_pass_delivers_reduces_and_counts() {
    let result = ThreadRanks::run(3, |comm| {
        let plan = ring(&comm)?;
        let mut halo = Halo::<[f32; 2]>::new();
        let me = comm.rank() as f32;
        for round in 0..50 {
            let mut maxima =
                [me, -me, if comm.rank() == 1 { f32::NAN } else { 0.0 }].map(f64::from);
            let (received, exposed) = halo.exchange(
                &comm,
                &plan,
                &mut maxima,
                |send| plan.pack(send, |i| [me, i as f32 + round as f32]),
                |progress| (0..round).for_each(|_| progress.poll()),
            )?;
            let from = ((comm.rank() + 2) % 3) as f32;
            assert_eq!(received, [[from, round as f32], [from, 1.0 + round as f32]]);
            assert_eq!((exposed.bytes_sent, exposed.messages, exposed.polls), (16, 1, round));
            assert!(maxima[0] == 2.0 && maxima[1] == 0.0 && maxima[2].is_nan());
        }
        Ok::<_, CommError>(())
    });
    assert_eq!(result, Ok(vec![(); 3]));
}

#[test]
fn one_rank_may_write_to_itself() {
    let plan = ring(&Solo).unwrap();
    let mut halo = Halo::<u64>::new();
    let received = halo.exchange_now(&Solo, &plan, |i| 7 + u64::from(i)).unwrap();
    assert_eq!(received, [7, 8]);
    let alone = ThreadRanks::run(1, |comm| {
        let plan = ring(&comm)?;
        let mut halo = Halo::<u64>::new();
        let (received, exposed) = halo.exchange(
            &comm,
            &plan,
            &mut [],
            |send| plan.pack(send, |i| 7 + u64::from(i)),
            |_| (),
        )?;
        assert_eq!((received, exposed.messages), (&[7, 8][..], 0));
        Ok::<_, CommError>(())
    });
    assert_eq!(alone, Ok(vec![()]));
}

#[test]
fn the_first_error_is_what_the_caller_sees() {
    let start = Instant::now();
    let result = ThreadRanks::run(4, |comm| {
        if comm.rank() == 2 {
            return Err("the mesh has a hole".to_string());
        }
        // The others wait for rank 2 for ever, unless they are told.
        let error = comm.all_gather(&[1]).unwrap_err();
        let told = CommError::RankFailed { rank: 2, message: "the mesh has a hole".to_string() };
        assert_eq!(error, told);
        Err::<(), _>(error.to_string())
    });
    let error = "the mesh has a hole".to_string();
    assert_eq!(result, Err(RanksError::Failed { rank: 2, error }));
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn a_panic_is_an_error_for_the_others() {
    let result = ThreadRanks::run(3, |comm| {
        let plan = ring(&comm)?;
        let mut halo = Halo::<u64>::new();
        halo.exchange(
            &comm,
            &plan,
            &mut [],
            |_| (),
            |_| {
                assert!(comm.rank() != 1, "an index is out of range");
            },
        )?;
        halo.exchange(&comm, &plan, &mut [0.0], |_| (), |_| ())?;
        Ok::<_, CommError>(())
    });
    let message = "an index is out of range".to_string();
    assert_eq!(result, Err(RanksError::Panicked { rank: 1, message }));
}

#[test]
fn a_rank_that_returns_early_is_named() {
    let result = ThreadRanks::run(2, |comm| match comm.rank() {
        0 => Ok(vec![]),
        _ => comm.all_gather(&[]),
    });
    let Err(RanksError::Failed { rank: 1, error: CommError::RankFailed { rank: 0, message } }) =
        result
    else {
        panic!("{result:?}")
    };
    assert!(message.contains("returned while rank 1 waited"), "{message}");
}

#[test]
fn ranks_out_of_step_do_not_read_each_others_data() {
    let result = ThreadRanks::run(2, |comm| {
        comm.all_gather(&[])?;
        if comm.rank() == 0 {
            comm.exchange_some(vec![])?;
        }
        comm.all_gather(&[])
    });
    // Either rank may be the first to notice.
    let text = result.unwrap_err().to_string();
    assert!(text.contains("operation 2 (all_gather)"), "{text}");
    assert!(text.contains("operation 2 (exchange_some)"), "{text}");
}

#[test]
fn a_run_without_ranks_is_refused() {
    let result = ThreadRanks::run(0, |_| Ok::<_, CommError>(()));
    assert_eq!(result, Err(RanksError::NoRanks));
}

#[test]
fn plans_that_do_not_fit_are_found() {
    let result = ThreadRanks::run(2, |comm| {
        let plan = ring(&comm)?;
        plan.verify(&comm)?;
        // Rank 0 leaves a particle out, rank 1 still expects it.
        let broken = plan.restrict(|i| comm.rank() == 1 || i == 0, |_| true);
        broken.verify(&comm)
    });
    let expected = PlanError::Unequal { rank: 0, sent: 1, expected: 2 };
    assert_eq!(result, Err(RanksError::Failed { rank: 1, error: expected }));

    let result = ThreadRanks::run(2, |comm| {
        let plan = ring(&comm)?;
        let broken = plan.restrict(|i| comm.rank() == 1 || i == 0, |_| true);
        Halo::<u32>::new().exchange_now(&comm, &broken, |i| i).map(<[u32]>::to_vec)
    });
    let expected = CommError::WrongLength { rank: 0, got: 4, expected: 8 };
    assert_eq!(result, Err(RanksError::Failed { rank: 1, error: expected }));
}

#[test]
fn bad_traffic_is_refused() {
    let overlap = |parts: &[(usize, std::ops::Range<usize>)]| {
        let parts: Vec<Part> =
            parts.iter().map(|(rank, bytes)| Part { rank: *rank, bytes: bytes.clone() }).collect();
        let traffic = Traffic {
            send: &mut [0; 8],
            send_parts: &parts,
            receive: &mut [0; 8],
            receive_parts: &[],
            maxima: &mut [],
        };
        Solo.overlap(traffic, &mut |_| (), &mut |_| ()).unwrap_err()
    };
    assert_eq!(overlap(&[(1, 0..8)]), CommError::NoSuchRank { rank: 1, size: 1 });
    assert_eq!(overlap(&[(0, 0..9)]), CommError::BadPart { start: 0, end: 9, length: 8 });
    assert_eq!(
        overlap(&[(0, 0..5), (0, 4..8)]),
        CommError::BadPart { start: 4, end: 8, length: 8 }
    );
    assert_eq!(overlap(&[(0, 0..8)]), CommError::WrongLength { rank: 0, got: 8, expected: 0 });
    let twice = Solo.exchange_some(vec![(0, vec![1]), (0, vec![2])]);
    assert_eq!(twice, Err(CommError::TwoMessages { rank: 0 }));
}
