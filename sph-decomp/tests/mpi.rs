//! The MPI communicator against thread ranks, and what happens when a rank of a job fails.
//!
//! Every test starts this very program again under `mpirun`; the ranks of such a job run
//! `rank_program`, and an environment variable tells them what to do.
#![cfg(feature = "mpi")]

mod common;

use std::process::{Command, Output};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use common::{graded, scenario};
use sph_decomp::{
    CommError, Communicator, Mpi, Part, Progress, Solo, ThreadRanks, Traffic, check_same_build,
};

const TASK: &str = "SPH_DECOMP_MPI_TASK";

/// What rank 0 writes when all ranks have come through.
const DONE: &str = "every rank has finished its task";

/// Runs a task on the ranks of an MPI job.
fn job(ranks: usize, task: &str) -> Output {
    // One job at a time, each with a directory of its own: Open MPI jobs that start and end at the
    // same moment remove each other's directories.
    static ONE: Mutex<u32> = Mutex::new(0);
    let mut number = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    *number += 1;
    let name = format!("sph-decomp-{}-{number}", std::process::id());
    let directory = std::env::temp_dir().join(name);
    std::fs::create_dir(&directory).expect("a directory for the job");
    let program = std::env::current_exe().expect("the path of this program");
    let output = Command::new("mpirun")
        .args(["--oversubscribe", "-n", &ranks.to_string()])
        .arg(program)
        .args(["--ignored", "--exact", "rank_program", "--nocapture", "--test-threads=1"])
        .env(TASK, task)
        .env("TMPDIR", &directory)
        // The text of a panic, and nothing that the launcher's own words could be mixed with.
        .env("RUST_BACKTRACE", "0")
        // Only for machines on which the tests run as root, such as containers.
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .output()
        .expect("mpirun is installed");
    // A directory that stays behind says nothing about the communicator.
    let _ = std::fs::remove_dir_all(&directory);
    output
}

fn succeeds(ranks: usize, task: &str) {
    let output = job(ranks, task);
    let text = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{ranks} ranks: {text}\n{errors}");
    assert!(text.contains(DONE), "{ranks} ranks: {text}\n{errors}");
}

/// The job ends by itself, soon, with an error code and this message.
fn fails(ranks: usize, task: &str, message: &str) {
    let start = Instant::now();
    let output = job(ranks, task);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success());
    assert!(errors.contains(message), "{errors}");
    // A rank that hangs would sit there for minutes.
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
}

#[test]
fn the_same_bits_as_thread_ranks() {
    for ranks in 1..=4 {
        succeeds(ranks, "scenario");
    }
}

#[test]
fn graded_reaches_with_rebalancing_give_the_bits_of_one_rank() {
    for ranks in [2, 3, 5, 8] {
        succeeds(ranks, "graded");
    }
}

#[test]
fn collectives_deliver() {
    for ranks in [1, 2, 3] {
        succeeds(ranks, "collectives");
    }
}

#[test]
fn long_messages_travel_in_pieces() {
    succeeds(2, "pieces");
}

#[test]
#[ignore = "needs 12 GB of memory"]
fn messages_above_two_gibibytes() {
    succeeds(2, "huge");
}

#[test]
fn an_error_of_one_rank_ends_the_job() {
    fails(3, "error", "rank 1: the tank is empty");
}

#[test]
fn a_panic_of_one_rank_ends_the_job() {
    fails(2, "panic", "the bottom fell out");
}

#[test]
fn a_panic_in_the_middle_of_a_pass_ends_the_job() {
    fails(2, "panic in flight", "a neighbour list is broken");
}

#[test]
fn a_rank_that_is_killed_ends_the_job() {
    fails(2, "kill", "signal 9");
}

#[test]
fn unequal_plans_are_an_error() {
    fails(2, "unequal", "rank 1 sent 8 bytes where 16 were expected");
}

#[test]
fn a_different_build_is_named() {
    fails(3, "build", "rank 2 runs a different build: it says `2`");
}

type Outcome = Result<(), Box<dyn std::error::Error + Send + Sync>>;

/// What one rank of a job does.
#[test]
#[ignore = "runs under mpirun, started by the other tests"]
fn rank_program() {
    let task = std::env::var(TASK).expect("started by the other tests");
    let mpi = Mpi::start().expect("MPI starts");
    let mpi = if task == "pieces" { mpi.with_pieces_of(1000) } else { mpi };
    if let Err(error) = rank(&mpi, &task) {
        mpi.abort(&error.to_string());
    }
    mpi.max_f64(&mut [0.0]).expect("all ranks are here");
    if mpi.rank() == 0 {
        // In one piece, because the ranks share a stream.
        let line = format!("\n{DONE}\n");
        print!("{line}");
    }
}

fn rank(mpi: &Mpi, task: &str) -> Outcome {
    match task {
        "scenario" => same_as_threads(mpi),
        "collectives" => collectives(mpi),
        "graded" => {
            let mine = graded::run(mpi)?;
            let all = mpi.all_gather(bytemuck::cast_slice(&mine.state))?;
            let mut pairs = [mine.pairs];
            mpi.sum_u64(&mut pairs)?;
            if mpi.rank() == 0 {
                let alone = graded::run(&Solo)?;
                let all = all.concat();
                let words = all.chunks_exact(24).map(bytemuck::pod_read_unaligned::<[u64; 3]>);
                let mut state: Vec<[u64; 3]> = words.collect();
                state.sort_unstable();
                assert!(state == alone.state, "other bits than one rank");
                assert_eq!(pairs[0], alone.pairs, "a pair was computed twice or never");
                assert!(mine.evenness.partitions > 2, "{:?}", mine.evenness);
            }
            Ok(())
        }
        "pieces" => {
            collectives(mpi)?;
            same_as_threads(mpi)
        }
        "huge" => {
            let bytes = (1_usize << 31) + 12_345;
            pass(mpi, bytes, bytes, &mut |progress| progress.poll())?;
            let got = mpi.exchange_some(vec![(1 - mpi.rank(), vec![7; bytes])])?;
            assert!(got[0].1.len() == bytes && got[0].1.iter().all(|&byte| byte == 7));
            Ok(())
        }
        "error" if mpi.rank() == 1 => Err("the tank is empty".into()),
        "panic" if mpi.rank() == 1 => panic!("the bottom fell out"),
        "kill" if mpi.rank() == 1 => {
            let me = std::process::id().to_string();
            Command::new("kill").args(["-9", &me]).status()?;
            Err("it survived".into())
        }
        "error" | "panic" | "kill" => Ok(mpi.max_f64(&mut [0.0])?),
        "panic in flight" => {
            pass(mpi, 8, 8, &mut |_| assert!(mpi.rank() == 0, "a neighbour list is broken"))
        }
        // Rank 1 sends less than rank 0 expects.
        "unequal" if mpi.rank() == 0 => pass(mpi, 8, 16, &mut |_| ()),
        "unequal" => pass(mpi, 8, 8, &mut |_| ()),
        "build" => Ok(check_same_build(mpi, if mpi.rank() == 2 { b"2" } else { b"1" })?),
        other => Err(format!("there is no task `{other}`").into()),
    }
}

/// A pass between ranks 0 and 1.
fn pass(
    mpi: &Mpi,
    sent: usize,
    expected: usize,
    local: &mut dyn FnMut(&mut dyn Progress),
) -> Outcome {
    let other = 1 - mpi.rank();
    let mut received = vec![0; expected];
    mpi.overlap(
        Traffic {
            send: &mut vec![1; sent],
            send_parts: &[Part { rank: other, bytes: 0..sent }],
            receive: &mut received,
            receive_parts: &[Part { rank: other, bytes: 0..expected }],
            maxima: &mut [],
        },
        &mut |_| (),
        local,
    )?;
    assert!(received.iter().all(|&byte| byte == 1), "everything has arrived");
    Ok(())
}

fn same_as_threads(mpi: &Mpi) -> Outcome {
    for hilbert in [false, true] {
        let mine = scenario::run(mpi, hilbert)?;
        let all = mpi.all_gather(bytes(&mine))?;
        if mpi.rank() == 0 {
            let threads = ThreadRanks::run(mpi.size(), |comm| scenario::run(&comm, hilbert))?;
            for (rank, (mpi, threads)) in all.iter().zip(&threads).enumerate() {
                assert!(mpi == bytes(threads), "rank {rank} differs");
            }
        }
    }
    Ok(())
}

fn bytes(values: &[f64]) -> &[u8] {
    bytemuck::cast_slice(values)
}

/// Every blocking operation, several times in a row so that one could overtake another.
fn collectives(mpi: &Mpi) -> Outcome {
    let (me, size) = (mpi.rank(), mpi.size());
    for round in 0..20 {
        // Only to ranks below, of unequal length, and to itself.
        let letter =
            |from: usize, to: usize| vec![(from + to + round) as u8; 100 * from * (to + 1) + 1];
        let sent = (0..=me).map(|to| (to, letter(me, to))).collect();
        let got = mpi.exchange_some(sent)?;
        assert_eq!(got, (me..size).map(|from| (from, letter(from, me))).collect::<Vec<_>>());

        let all = mpi.all_gather(&letter(me, 0)[..round % 2])?;
        assert_eq!(
            all,
            (0..size).map(|from| letter(from, 0)[..round % 2].to_vec()).collect::<Vec<_>>()
        );

        let all = mpi.all_to_all((0..size).map(|to| letter(me, to)).collect())?;
        assert_eq!(all, (0..size).map(|from| letter(from, me)).collect::<Vec<_>>());

        let mut sums = [me as u64, u64::MAX];
        mpi.sum_u64(&mut sums)?;
        assert_eq!(sums, [(0..size as u64).sum(), (size as u64).wrapping_neg()]);

        let mut maxima = [-(me as f64), if me == 0 { f64::NAN } else { 1.0 }];
        mpi.max_f64(&mut maxima)?;
        assert!(maxima[0] == 0.0 && maxima[1].is_nan());
    }
    let far = mpi.exchange_some(vec![(size, vec![1])]);
    assert_eq!(far, Err(CommError::NoSuchRank { rank: size, size }));
    Ok(())
}
