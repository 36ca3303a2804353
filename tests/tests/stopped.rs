//! A run that is asked to end leaves a checkpoint, and so does one that has come to its end: from
//! there it goes on with the same bits.

use sph_tests::{Outcome, Results, Run, SMALL, mpi_program, write_scene};
use std::time::Duration;
use tempfile::TempDir;

/// What batch systems take for "try again".
const AGAIN: i32 = 75;
/// End of the runs here, s: what `small` sets.
const END: f64 = 0.6;

fn small() -> (TempDir, Run) {
    let folder = tempfile::tempdir().unwrap();
    let run = Run::new(write_scene(folder.path(), SMALL)).threads(1).set("end_time=0.6");
    // Outputs between the steps of which a restart could lose some.
    (folder, run.set("output.snapshots=0.02").set("output.energies=0.002"))
}

#[track_caller]
fn assert_same(results: &Results, expected: &Results, how: &str) {
    assert_eq!(results.digest(), expected.digest(), "{how}");
    assert_eq!(results.summary()["steps"], expected.summary()["steps"], "{how}");
    assert_eq!(results.series(), expected.series(), "{how}");
    for path in expected.files(".csv") {
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(results.table(name), expected.table(name), "{how}: {name}");
    }
}

#[track_caller]
fn assert_stopped(outcome: &Outcome, results: &Results, words: &str) {
    assert_eq!(outcome.status.code(), Some(AGAIN), "{outcome}");
    outcome.message.assert_readable();
    outcome.message.assert_contains(&[words, "t =", "--resume goes on from", "checkpoint-"]);
    assert_eq!(outcome.message.count("--resume goes on from"), 1, "{outcome}");
    assert!(!results.files(".vtkhdf").is_empty(), "no checkpoint");
    assert!(results.files("summary.json").is_empty(), "a summary of a run that has not ended");
}

#[test]
fn a_signal_ends_a_run_that_goes_on_with_the_same_bits() {
    let (_folder, run) = small();
    let expected = Results::of(run.clone());
    let with_checkpoints = run.clone().checkpoint_every(0.11);
    for (signal, run) in [("TERM", &run), ("INT", &with_checkpoints), ("USR1", &run)] {
        for ranks in [1, 3] {
            let how = format!("SIG{signal} on {ranks} ranks");
            let results = Results::new();
            // Long enough not to end before the signal comes.
            let endless = run.clone().ranks(ranks).end_time(1e5);
            let mut running = endless.out(results.path()).start();
            let file = results.path().join("small-000003.vtu");
            assert!(running.wait_for(|| file.exists()), "{how}: {}", running.wait());
            running.signal(signal);
            assert_stopped(&running.wait(), &results, "by a signal");
            let begun = results.table("energies").times().last().copied().unwrap();
            if begun < 0.9 * END {
                results.add(run.clone().ranks(4 - ranks).resume());
                assert_same(&results, &expected, &how);
            }
        }
    }
}

#[test]
fn a_chain_of_jobs_with_a_limit_of_time() {
    let (_folder, run) = small();
    let expected = Results::of(run.clone());
    let results = Results::new();
    let mut jobs = 0;
    loop {
        let job = run.clone().ranks(1 + jobs % 2).arg("--max-wall").arg("0.15");
        let job = if jobs == 0 { job } else { job.resume() };
        let outcome = job.out(results.path()).finish();
        jobs += 1;
        if outcome.status.success() {
            break;
        }
        assert_stopped(&outcome, &results, "--max-wall");
        assert!(jobs < 400, "the jobs get nowhere");
    }
    assert_same(&results, &expected, &format!("in {jobs} jobs"));
}

#[test]
fn a_run_goes_on_from_its_very_end() {
    let (_folder, run) = small();
    let expected = Results::of(run.clone());
    for ranks in [1, 2] {
        // Its interval is longer than the run: the only checkpoint is that of the end.
        let results = Results::of(run.clone().ranks(ranks).end_time(0.3).checkpoint_every(100.0));
        assert_eq!(results.files(".vtkhdf").len(), 1);
        let steps = results.summary()["steps"].as_f64().unwrap();
        results.add(run.clone().ranks(3 - ranks).resume());
        let resumed_at = results.summary()["resumed_at"].as_f64().unwrap();
        // Lists last 100 steps at most.
        assert!(resumed_at > 0.3 * (1.0 - 110.0 / steps) && resumed_at < 0.31, "{resumed_at}");
        assert_same(&results, &expected, &format!("first on {ranks} ranks"));
    }
}

#[test]
fn without_checkpoints_there_is_none_at_the_end() {
    let (_folder, run) = small();
    assert!(Results::of(run.end_time(0.05)).files(".vtkhdf").is_empty());
}

/// `mpirun` passes SIGUSR1 on to its ranks.
#[test]
fn a_signal_ends_an_mpi_job() {
    let Some(program) = mpi_program("signals to MPI jobs") else { return };
    let (_folder, run) = small();
    let expected = Results::of(run.clone());
    let results = Results::new();
    let job = run.clone().end_time(1e5).mpi(&program, 2).patience(Duration::from_secs(120));
    let mut running = job.out(results.path()).start();
    let file = results.path().join("small-000003.vtu");
    assert!(running.wait_for(|| file.exists()), "{}", running.wait());
    running.signal("USR1");
    let outcome = running.wait();
    assert_eq!(outcome.status.code(), Some(AGAIN), "{outcome}");
    assert_eq!(outcome.message.count("--resume goes on from"), 1, "{outcome}");
    if results.table("energies").times().last().is_some_and(|time| *time < 0.9 * END) {
        results.add(run.resume());
        assert_same(&results, &expected, "from two processes to one");
    }
}
