//! A run that is killed at any moment leaves whole files, from which it goes on.

use sph_tests::{Results, Run, Running, SHIPPED, SMALL, assert_whole, mpi_program, write_scene};
use std::fs;
use std::thread::sleep;
use std::time::Duration;

/// Moments from 0 to 1, spread evenly and the same in every run: the golden ratio's multiples.
fn moments(seed: u32) -> impl Iterator<Item = f64> {
    (seed..).map(|k| (f64::from(k) * 0.618_033_988_749_894_9).fract())
}

/// Lets the run write `rows` of its table and go on for a while, then kills it. Returns whether it
/// was still running.
fn kill_after(mut running: Running, results: &Results, rows: usize, delay: Duration) -> bool {
    let written = || {
        let table = fs::read(results.path().join("energies.csv")).unwrap_or_default();
        table.iter().filter(|byte| **byte == b'\n').count().saturating_sub(1)
    };
    running.wait_for(|| written() >= rows);
    sleep(delay);
    if running.has_ended() {
        let outcome = running.wait();
        assert!(outcome.status.success(), "{outcome}");
        return false;
    }
    !running.kill().status.success()
}

/// Goes on from the last checkpoint, or starts anew when there is none yet.
fn go_on(run: Run, results: &Results) -> Run {
    if results.files(".vtkhdf").is_empty() { run.overwrite() } else { run.resume() }
}

/// Kills `run` again and again while it goes on from its checkpoints; then lets it end.
fn check(run: &Run, dimension: usize, kills: u32) {
    let undisturbed = Results::of(run.clone());
    let rows = undisturbed.table("energies").rows.len();
    let results = Results::new();
    let mut killed = 0;
    for (kill, moment) in (0..kills).zip(moments(1)) {
        let again = go_on(run.clone().ranks(1 + kill as usize % 2), &results);
        let running = again.out(results.path()).start();
        // Each kill a little later in the run than the one before.
        let part = (f64::from(kill) + moment) / f64::from(kills + 1);
        let target = (part * rows as f64) as usize;
        let delay = Duration::from_micros((5000.0 * moment) as u64);
        killed += u32::from(kill_after(running, &results, target, delay));
        assert_whole(&results.path(), dimension);
    }
    // On a machine that is busy with other things, a run may end before it can be killed.
    assert!(killed > kills / 2, "only {killed} of {kills} runs were killed");
    results.add(go_on(run.clone(), &results));
    assert_whole(&results.path(), dimension);
    assert_eq!(results.digest(), undisturbed.digest());
    assert_eq!(results.series(), undisturbed.series());
    for path in undisturbed.files(".csv") {
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(results.table(name), undisturbed.table(name), "{name}");
    }
    let temporaries = results.contents().into_iter().map(|(path, _)| path);
    let left: Vec<_> =
        temporaries.filter(|path| path.to_string_lossy().ends_with(".tmp")).collect();
    assert!(left.is_empty(), "{left:?} stay behind");
}

#[test]
fn a_run_that_writes_all_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let run = Run::new(write_scene(folder.path(), SMALL)).threads(1).end_time(1.0);
    let outputs = ["output.snapshots=0.002", "output.energies=0.001"];
    let run = outputs.iter().fold(run, |run, change| run.set(change));
    check(&run.checkpoint_every(0.004), 2, 10);
}

#[test]
fn a_dam_break_in_space() {
    let scene = SHIPPED[2];
    let run = scene.run().threads(1).set("output.snapshots=0.02");
    check(&run.checkpoint_every(0.05 * scene.end_time), 3, 5);
}

/// From the very first moments, before there is anything to go on from.
#[test]
fn at_the_start() {
    let folder = tempfile::tempdir().unwrap();
    // So long that no machine is at the end when it is killed.
    let run = Run::new(write_scene(folder.path(), SMALL)).threads(1).end_time(1.0);
    let run = run.checkpoint_every(0.01);
    let undisturbed = Results::of(run.clone());
    for moment in moments(100).take(12) {
        let results = Results::new();
        let running = run.clone().out(results.path()).start();
        kill_after(running, &results, 0, Duration::from_millis(40).mul_f64(moment));
        assert_whole(&results.path(), 2);
        results.add(go_on(run.clone(), &results));
        assert_whole(&results.path(), 2);
        assert_eq!(results.digest(), undisturbed.digest());
    }
}

/// A job that loses a rank ends, and goes on from its checkpoint.
#[test]
fn a_rank_of_an_mpi_job() {
    let Some(program) = mpi_program("a killed rank of an MPI job") else { return };
    let scene = SHIPPED[0];
    let run = scene.run().set("output.snapshots=0.02");
    let expected = Results::of(run.clone().threads(1)).digest();
    let run = run.checkpoint_every(0.2 * scene.end_time);
    let results = Results::new();
    let job = run.clone().mpi(&program, 3).patience(Duration::from_secs(60));
    let mut job = job.out(results.path()).start();
    assert!(job.wait_for(|| !results.files(".vtkhdf").is_empty()), "{}", job.wait());
    job.kill_a_rank();
    let outcome = job.wait();
    assert!(!outcome.status.success(), "{outcome}");
    assert_whole(&results.path(), 2);
    results.add(run.resume().mpi(&program, 2));
    assert!(results.summary()["resumed_at"].as_f64().is_some_and(|time| time > 0.0));
    assert_eq!(results.digest(), expected);
}
