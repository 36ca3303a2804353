//! Runs that fail on the way: they stop, say where and why, and leave nothing that misleads.

use sph_tests::{Outcome, Results, Run, Running, SMALL, assert_finite, mpi_program, write_scene};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Changes that make a run diverge, each in its own way.
const ABSURD: [&[&str]; 3] = [
    // The water falls faster than its sound.
    &["numerics.sound_speed=0.05"],
    // It arrives at a hundred times its sound speed.
    &["numerics.sound_speed=30", "fluid.water.velocity=[\"3000\", \"0\"]"],
    // It bursts.
    &["numerics.sound_speed=30", "fluid.water.pressure=\"1e8*sin(20*x)^2\""],
];

fn small() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    (folder, scene)
}

fn absurd(scene: &Path, changes: &[&str]) -> Run {
    changes.iter().fold(Run::new(scene).set("end_time=1"), |run, change| run.set(change))
}

/// The number after `words` in a message.
fn number_after(outcome: &Outcome, words: &str) -> Option<f64> {
    let text = outcome.message.0.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, rest) = text.split_once(words)?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !"0123456789.-+e".contains(c)).unwrap_or(rest.len());
    rest[..end].trim_end_matches('.').parse().ok()
}

#[test]
fn a_run_that_diverges_stops_and_says_where() {
    let (_folder, scene) = small();
    for changes in ABSURD {
        let results = Results::new();
        let run = absurd(&scene, changes).threads(1).checkpoint_every(0.001);
        let outcome = run.out(results.path()).fail(1);
        outcome.message.assert_contains(&["particle", " at [", "t =", "Try", "numerics."]);
        let particle = number_after(&outcome, "particle").expect("a number of a particle");
        assert!((0.0..300.0).contains(&particle) && particle.fract() == 0.0, "{outcome}");
        let time = number_after(&outcome, "t =").expect("a time");
        assert!((0.0..1.0).contains(&time), "{outcome}");
        assert_finite(&results.path(), 2);
        assert!(results.files("summary.json").is_empty(), "a summary of a run that failed");
    }
}

#[test]
fn all_ranks_stop_with_one_message() {
    let (_folder, scene) = small();
    for changes in ABSURD {
        let messages = [1, 3, 4].map(|ranks| {
            let results = Results::new();
            let run = absurd(&scene, changes).ranks(ranks).threads(1);
            let outcome = run.out(results.path()).fail(1);
            assert_eq!(outcome.message.count("error:"), 1, "{outcome}");
            assert_finite(&results.path(), 2);
            outcome.message
        });
        assert!(messages.iter().all(|message| *message == messages[0]), "{messages:?}");
    }
}

#[test]
fn a_failing_mpi_job_ends_with_one_message() {
    let Some(program) = mpi_program("failing jobs under mpirun") else { return };
    let (_folder, scene) = small();
    for processes in [2, 4] {
        let results = Results::new();
        let run = absurd(&scene, ABSURD[0]).mpi(&program, processes).patience(SECONDS);
        let outcome = run.out(results.path()).finish();
        assert!(!outcome.status.success(), "{outcome}");
        outcome.message.assert_contains(&["particle", "t =", "Try"]);
        assert_eq!(outcome.message.count("numerics.cfl"), 1, "{outcome}");
        assert!(!outcome.message.contains("panicked"), "{outcome}");
        assert_finite(&results.path(), 2);
    }
}

/// Mistakes in the scene are told once by an MPI job too.
#[test]
fn a_bad_scene_under_mpirun_is_refused_once() {
    let Some(program) = mpi_program("bad scenes under mpirun") else { return };
    let (_folder, scene) = small();
    let results = Results::new();
    let run = Run::new(&scene).set("numerics.spacng=1").mpi(&program, 2).patience(SECONDS);
    let outcome = run.out(results.path()).finish();
    assert!(!outcome.status.success(), "{outcome}");
    assert_eq!(outcome.message.count("did you mean `spacing`?"), 1, "{outcome}");
    assert!(!results.path().exists(), "files were written");
}

/// Ranks of one job that were started with different settings.
#[test]
fn ranks_with_different_settings_are_refused() {
    let Some(program) = mpi_program("unequal ranks under mpirun") else { return };
    let (_folder, scene) = small();
    let results = Results::new();
    let run = |cfl: &str| {
        let run = Run::new(&scene).set(cfl).out(results.path());
        run.patience(SECONDS)
    };
    let two = run("numerics.cfl=0.9").mpi(&program, 2);
    let outcome = two.beside(run("numerics.cfl=0.8").mpi(&program, 1)).finish();
    assert!(!outcome.status.success(), "{outcome}");
    outcome.message.assert_contains(&["rank 2 runs a different build", "cfl: 0.8", "cfl: 0.9"]);
    assert_eq!(outcome.message.count("different build"), 1, "{outcome}");
    assert!(results.files(".vtu").is_empty(), "a run began");
}

/// How long a job that fails may take: a hang lasts for ever.
const SECONDS: Duration = Duration::from_secs(60);

/// Waits until the run has written something, then takes its folder away: the rank that writes
/// fails, the others are in the middle of a step.
fn take_folder_away(mut running: Running, results: &Path) -> Outcome {
    let begun = running.wait_for(|| results.join("small-000001.vtu").exists());
    assert!(begun, "{}", running.wait());
    fs::rename(results, results.with_extension("away")).unwrap();
    running.wait()
}

/// A run that would take hours.
fn endless(scene: &Path) -> Run {
    Run::new(scene).end_time(1e5).set("output.snapshots=0.01").patience(SECONDS)
}

#[test]
fn one_rank_that_fails_ends_the_run() {
    let (_folder, scene) = small();
    for ranks in [1, 3] {
        let results = Results::new();
        let running = endless(&scene).ranks(ranks).threads(1).out(results.path()).start();
        let outcome = take_folder_away(running, &results.path());
        assert_eq!(outcome.status.code(), Some(1), "{outcome}");
        outcome.message.assert_readable();
        outcome.message.assert_contains(&["cannot write", "results/small", "does not exist"]);
        assert_eq!(outcome.message.count("error:"), 1, "{outcome}");
    }
}

#[test]
fn one_process_that_fails_ends_the_mpi_job() {
    let Some(program) = mpi_program("a failing process of an MPI job") else { return };
    let (_folder, scene) = small();
    let results = Results::new();
    let running = endless(&scene).mpi(&program, 2).out(results.path()).start();
    let outcome = take_folder_away(running, &results.path());
    assert!(!outcome.status.success(), "{outcome}");
    assert_eq!(outcome.message.count("cannot write"), 1, "{outcome}");
    assert!(!outcome.message.contains("panicked"), "{outcome}");
}

/// A tank without a right wall, over whose sill the water leaves the domain.
fn leaking() -> String {
    let (start, end) = SMALL.split_once("[[solid]]").unwrap();
    let (_, end) = end.split_once("[[probe]]").unwrap();
    let floor = "box = { min = [-0.2, -0.2], max = [0.6, 0] }";
    let wall = "box = { min = [-0.2, -0.2], max = [0, 0.6] }";
    format!(
        "{start}[domain]\nmin = [-0.3, -0.3]\nmax = [0.5, 0.7]\n\n[[solid]]\nname = \"bath\"\n\
         union = [{{ {floor} }}, {{ {wall} }}]\nfluid_side = \"outside\"\n\n[[probe]]{end}"
    )
}

fn leak(on_lost: &str) -> (TempDir, Run) {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), &leaking());
    let run = Run::new(scene).set("end_time=0.6").set(&format!("numerics.on_lost={on_lost}"));
    (folder, run)
}

#[test]
fn a_particle_that_leaves_stops_the_run() {
    let (_folder, run) = leak("stop");
    let messages = [1, 3].map(|ranks| {
        let results = Results::new();
        let outcome = run.clone().ranks(ranks).threads(1).out(results.path()).fail(1);
        outcome.message.assert_contains(&[
            "particle",
            "left the domain",
            "at [",
            "t =",
            "on_lost",
            "\"remove\"",
        ]);
        let time = number_after(&outcome, "t =").expect("a time");
        assert!((0.05..0.6).contains(&time), "{outcome}");
        assert_finite(&results.path(), 2);
        outcome.message
    });
    assert_eq!(messages[0], messages[1]);
}

#[test]
fn particles_that_leave_are_removed_and_counted() {
    let (_folder, run) = leak("remove");
    let results = Results::of(run.clone().ranks(1).threads(1));
    let summary = results.summary();
    let lost = summary["lost_particles"].as_u64().unwrap();
    let left = summary["particles"]["fluid"].as_u64().unwrap();
    assert!(lost > 10, "{summary:#}");
    assert_eq!(left + lost, 300);
    let table = results.table("lost");
    assert_eq!(table.rows.len() as u64, lost);
    let times = table.times();
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]), "{times:?}");
    let mut ids = table.column("id");
    ids.sort_by(f64::total_cmp);
    ids.dedup();
    assert_eq!(ids.len() as u64, lost, "a particle was lost twice");
    let outside = |(x, y): (&f64, &f64)| !(-0.3..=0.5).contains(x) || !(-0.3..=0.7).contains(y);
    assert!(
        table.column("x").iter().zip(&table.column("y")).all(outside),
        "lost inside the domain"
    );
    assert_finite(&results.path(), 2);
    // The same particles on other ranks.
    let shared = Results::of(run.ranks(3).threads(1));
    assert_eq!(shared.digest(), results.digest());
    assert_eq!(shared.table("lost"), table);
}

#[test]
fn the_count_of_lost_particles_survives_a_restart() {
    let (_folder, run) = leak("remove");
    let run = run.ranks(1).threads(1);
    let whole = Results::of(run.clone());
    let results = Results::of(run.clone().end_time(0.4).checkpoint_every(0.05));
    assert!(results.summary()["lost_particles"].as_u64().unwrap() > 0);
    results.add(run.resume());
    assert!(results.summary()["resumed_at"].as_f64().is_some_and(|time| time > 0.2));
    assert_eq!(results.digest(), whole.digest());
    assert_eq!(results.summary()["lost_particles"], whole.summary()["lost_particles"]);
    assert_eq!(results.table("lost"), whole.table("lost"));
}

#[test]
fn lost_particles_under_mpirun() {
    let Some(program) = mpi_program("lost particles under mpirun") else { return };
    let (_folder, run) = leak("remove");
    let expected = Results::of(run.clone().ranks(1).threads(1));
    let results = Results::of(run.mpi(&program, 2));
    assert_eq!(results.digest(), expected.digest());
    assert_eq!(results.table("lost"), expected.table("lost"));
    let (_folder, run) = leak("stop");
    let outcome = run.mpi(&program, 2).patience(SECONDS).out(Results::new().path()).finish();
    assert!(!outcome.status.success(), "{outcome}");
    assert_eq!(outcome.message.count("left the domain"), 1, "{outcome}");
}

/// A checkpoint of which the end is missing, as after a full disk: the older one is used.
#[test]
fn a_damaged_checkpoint_is_passed_over() {
    let (_folder, scene) = small();
    let run = Run::new(scene).threads(1);
    let expected = Results::of(run.clone()).digest();
    let results = Results::of(run.clone().end_time(0.15).checkpoint_every(0.03));
    let checkpoints = results.files(".vtkhdf");
    assert_eq!(checkpoints.len(), 2, "{checkpoints:?}");
    let newest = fs::read(&checkpoints[1]).unwrap();
    fs::write(&checkpoints[1], &newest[..newest.len() / 2]).unwrap();
    results.add(run.clone().resume());
    assert_eq!(results.digest(), expected);
    // When none can be used, that is an error: starting anew would throw results away.
    let results = Results::of(run.clone().end_time(0.15).checkpoint_every(0.03));
    for checkpoint in results.files(".vtkhdf") {
        fs::write(checkpoint, "damaged").unwrap();
    }
    let outcome = run.resume().out(results.path()).finish();
    assert!(!outcome.status.success(), "{outcome}");
    outcome.message.assert_readable();
    outcome.message.assert_contains(&["checkpoint-", "not a whole checkpoint"]);
}
