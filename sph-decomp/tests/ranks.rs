//! Thread ranks: delivery, order, and what happens when one fails.

use std::time::{Duration, Instant};

use sph_decomp::{
    Blocking, CommError, Communicator, Exposed, Halo, HaloPlan, Metered, Part, PlanError,
    RanksError, Solo, ThreadRank, ThreadRanks, Traffic,
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

/// Whatever the others wait in, they learn of a rank that dies, at once and with its words.
#[test]
fn a_rank_that_dies_wakes_the_others_from_every_operation() {
    type Wait = fn(&ThreadRank) -> Result<(), CommError>;
    let waits: [(&str, Wait); 6] = [
        ("sum_u64", |comm| comm.sum_u64(&mut [1])),
        ("max_f64", |comm| comm.max_f64(&mut [1.0])),
        ("all_gather", |comm| comm.all_gather(&[1]).map(drop)),
        ("exchange_some", |comm| comm.exchange_some(vec![]).map(drop)),
        ("a pass with a reduction", |comm| {
            let plan = HaloPlan::empty();
            Halo::<u64>::new().exchange(comm, &plan, &mut [0.0], |_| (), |_| ()).map(drop)
        }),
        ("a pass with messages", |comm| {
            let (send, receive) = (&mut [0; 4], &mut [0; 4]);
            let other = (comm.rank() + 2) % 4;
            let part = [Part { rank: other, bytes: 0..4 }];
            let (send_parts, receive_parts) = (&part, &part);
            let traffic = Traffic { send, send_parts, receive, receive_parts, maxima: &mut [] };
            comm.overlap(traffic, &mut |_| (), &mut |progress| progress.poll()).map(drop)
        }),
    ];
    for (name, wait) in waits {
        for panics in [false, true] {
            let start = Instant::now();
            let result = ThreadRanks::run(4, |comm| {
                comm.sum_u64(&mut [1])?;
                if comm.rank() == 2 {
                    std::thread::sleep(Duration::from_millis(20));
                    assert!(!panics, "the bottom fell out");
                    return Err(CommError::Mpi("the bottom fell out".to_string()));
                }
                wait(&comm)?;
                // Ranks 1 and 3 need nothing of rank 2 in a pass; here they do.
                comm.max_f64(&mut [0.0])
            });
            let error = result.expect_err(name);
            match &error {
                RanksError::Failed { rank: 2, error: CommError::Mpi(_) } => assert!(!panics),
                RanksError::Panicked { rank: 2, .. } => assert!(panics),
                other => panic!("{name}: {other}"),
            }
            assert!(error.to_string().contains("the bottom fell out"), "{name}: {error}");
            assert!(start.elapsed() < Duration::from_secs(20), "{name}");
        }
    }
}

#[test]
fn unequal_reductions_are_an_error() {
    let result = ThreadRanks::run(2, |comm| comm.sum_u64(&mut vec![0; 1 + comm.rank()]));
    let text = result.expect_err("they do not fit").to_string();
    assert!(text.contains("sent 8 bytes where 16") || text.contains("sent 16 bytes where 8"));
}

#[test]
fn a_pass_without_overlap_gives_the_same() {
    let result = ThreadRanks::run(3, |comm| {
        let plan = ring(&comm)?;
        let blocking = Blocking::new(&comm);
        let run = |comm: &dyn Communicator| {
            let (mut halo, mut largest) = (Halo::<u64>::new(), [comm.rank() as f64]);
            // In the local part everything has arrived already, or it may still be on its way.
            let (received, exposed) = halo.exchange(
                &comm,
                &plan,
                &mut largest,
                |send| plan.pack(send, |i| 10 * comm.rank() as u64 + u64::from(i)),
                |progress| (0..5).for_each(|_| progress.poll()),
            )?;
            let Exposed { bytes_sent, messages, polls, .. } = exposed;
            Ok::<_, CommError>((received.to_vec(), largest, bytes_sent, messages, polls))
        };
        let overlapped = run(&comm)?;
        assert_eq!(overlapped, run(&blocking)?);
        assert_eq!((overlapped.1, overlapped.4), ([2.0], 5));
        Ok::<_, CommError>(())
    });
    assert_eq!(result, Ok(vec![(); 3]));
}

#[test]
fn the_work_of_a_pass_is_told_apart_from_its_waiting() {
    let result = ThreadRanks::run(2, |comm| {
        let comm = Metered::new(comm);
        let plan = HaloPlan::new(&comm, vec![(1 - comm.rank(), vec![0])])?;
        let pause = Duration::from_millis(if comm.rank() == 0 { 60 } else { 0 });
        let mut halo = Halo::<u64>::new();
        let (_, exposed) =
            halo.exchange(&comm, &plan, &mut [], |_| std::thread::sleep(pause), |_| ())?;
        // Rank 1 waits for rank 0, which sleeps in its inner part and has no core meanwhile.
        let (waits, works) = (exposed.wait_seconds, exposed.work_seconds);
        assert!(if comm.rank() == 0 { works > waits } else { waits > works }, "{exposed:?}");
        assert!(exposed.thread_seconds <= works + 1e-3, "{exposed:?}");
        assert_eq!(comm.collectives().calls, 1, "the plan, but not the pass");
        Ok::<_, CommError>(())
    });
    assert_eq!(result, Ok(vec![(); 2]));
}

/// A rank that announces more particles than can be numbered is named, before any memory is taken.
#[test]
fn absurd_numbers_of_outer_particles_are_refused() {
    let result = ThreadRanks::run(2, |comm| match comm.rank() {
        // What a plan sends: the number of particles, in eight bytes.
        0 => {
            comm.exchange_some(vec![(1, u64::from(u32::MAX).wrapping_add(2).to_ne_bytes().into())])
        }
        _ => HaloPlan::new(&comm, vec![]).map(|_| vec![]),
    });
    let text = result.expect_err("they cannot be numbered").to_string();
    assert!(text.contains("rank 0 is about to send 4294967297 particles"), "{text}");
}
