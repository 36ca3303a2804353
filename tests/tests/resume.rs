//! A run that was stopped goes on from its checkpoint as if nothing had happened.

use sph_tests::{Reduced, Results, Run, SHIPPED, SMALL, mpi_program, write_scene};
use std::path::Path;
use std::sync::OnceLock;

/// Scene of most tests here.
const SCENE: Reduced = SHIPPED[0];
/// Where the stopped run stops.
const STOP: f64 = 0.55 * SCENE.end_time;
/// Interval of the checkpoints: between the times of the other outputs.
const EVERY: f64 = 0.19 * SCENE.end_time;

fn with_checkpoints(run: Run) -> Run {
    run.checkpoint_every(EVERY).threads(1)
}

/// The run that nothing disturbs, without checkpoints.
fn undisturbed() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| Results::of(frequent(SCENE.run()).threads(1)))
}

/// A run that stopped on the way.
fn stopped() -> Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    let stopped = RESULTS.get_or_init(|| {
        let results = Results::of(with_checkpoints(frequent(SCENE.run_until(STOP))));
        assert_ne!(results.digest(), undisturbed().digest());
        assert!(!results.files(".vtkhdf").is_empty(), "no checkpoint was written");
        results
    });
    stopped.copy()
}

/// Outputs often enough for the stop to fall between many.
fn frequent(run: Run) -> Run {
    run.set("output.snapshots=0.05").set("output.energies=0.005")
}

#[track_caller]
fn assert_undisturbed(results: &Results, how: &str) {
    let expected = undisturbed();
    let summary = results.summary();
    let resumed_at = summary["resumed_at"].as_f64();
    let resumed_at = resumed_at.unwrap_or_else(|| panic!("{how}: not resumed: {summary:#}"));
    // The last checkpoint is of the end itself if lists were due then.
    let end = stopped().summary()["simulated_time"].as_f64().expect("a time");
    assert!(0.0 < resumed_at && resumed_at <= end, "{how}: resumed at {resumed_at}");
    assert_eq!(results.digest(), expected.digest(), "{how}");
    assert_eq!(summary["steps"], expected.summary()["steps"], "{how}");
    assert_eq!(results.series(), expected.series(), "{how}");
    for path in expected.files(".csv") {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let table = results.table(name);
        assert!(table.times_increase(), "{how}: {name}: {:?}", table.times());
        assert_eq!(table, expected.table(name), "{how}: {name}");
    }
    for path in expected.files(".vtu") {
        let name = path.file_name().unwrap();
        let same =
            std::fs::read(results.path().join(name)).unwrap() == std::fs::read(&path).unwrap();
        assert!(same, "{how}: {} differs", name.display());
    }
}

#[test]
fn checkpoints_do_not_change_the_run() {
    let results = Results::of(with_checkpoints(frequent(SCENE.run())));
    assert!(!results.files(".vtkhdf").is_empty(), "no checkpoint was written");
    assert_eq!(results.digest(), undisturbed().digest());
    assert_eq!(results.series(), undisturbed().series());
}

#[test]
fn on_the_same_rank() {
    let results = stopped();
    results.add(with_checkpoints(frequent(SCENE.run())).resume());
    assert_undisturbed(&results, "on one rank");
    // Without further checkpoints too.
    let results = stopped();
    results.add(frequent(SCENE.run()).resume());
    assert_undisturbed(&results, "without further checkpoints");
}

#[test]
fn with_particles_that_are_shifted() {
    let run = |end| SCENE.run_until(end).set("numerics.scheme=delta-plus");
    let expected = Results::of(run(SCENE.end_time).threads(1)).digest();
    assert_ne!(expected, Results::of(SCENE.run().threads(1)).digest(), "nothing was shifted");
    let results = Results::new();
    results.add(with_checkpoints(run(STOP)));
    results.add(run(SCENE.end_time).ranks(2).resume());
    assert_eq!(results.digest(), expected);
}

#[test]
fn on_another_number_of_ranks_and_back() {
    let results = stopped();
    results.add(with_checkpoints(frequent(SCENE.run_until(1.3 * STOP))).ranks(3).resume());
    assert_eq!(results.summary()["ranks"], 3);
    results.add(with_checkpoints(frequent(SCENE.run())).ranks(2).resume());
    let resumed_at = results.summary()["resumed_at"].as_f64().unwrap();
    assert!(resumed_at > 0.0, "{resumed_at}");
    assert_eq!(results.digest(), undisturbed().digest());
    let results = stopped();
    results.add(with_checkpoints(frequent(SCENE.run())).ranks(4).resume());
    assert_undisturbed(&results, "on four ranks");
}

#[test]
fn under_mpirun_and_back() {
    let Some(program) = mpi_program("resuming under mpirun") else { return };
    let results = stopped();
    results.add(frequent(SCENE.run()).checkpoint_every(EVERY).mpi(&program, 2).resume());
    assert_undisturbed(&results, "from one process to two");
    let results = Results::new();
    results.add(frequent(SCENE.run_until(STOP)).checkpoint_every(EVERY).mpi(&program, 4));
    results.add(with_checkpoints(frequent(SCENE.run())).resume());
    assert_undisturbed(&results, "from four processes to one");
}

#[test]
fn in_three_dimensions() {
    let scene = SHIPPED[2];
    let expected = Results::of(scene.run().threads(1)).digest();
    let results = Results::new();
    let every = 0.2 * scene.end_time;
    results.add(scene.run_until(0.55 * scene.end_time).checkpoint_every(every).ranks(2));
    results.add(scene.run().ranks(3).resume());
    let resumed_at = results.summary()["resumed_at"].as_f64();
    assert!(resumed_at.is_some_and(|time| time > 0.0), "{resumed_at:?}");
    assert_eq!(results.digest(), expected);
}

#[test]
fn without_a_checkpoint_it_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = Run::new(write_scene(folder.path(), SMALL)).threads(1);
    for results in [Results::new(), Results::of(run.clone())] {
        let before = results.contents();
        let outcome = run.clone().resume().out(results.path()).fail(2);
        outcome.message.assert_contains(&["no checkpoint", "--checkpoint-every", "--resume"]);
        assert!(results.contents() == before, "the refused run changed files");
        assert_eq!(results.path().exists(), !before.is_empty());
    }
}

/// The results of the small scene until half its time, with checkpoints.
fn small(scene: &Path) -> Results {
    let run = Run::new(scene).threads(1).end_time(0.1).checkpoint_every(0.02);
    let results = Results::of(run);
    assert!(!results.files(".vtkhdf").is_empty(), "no checkpoint was written");
    results
}

#[track_caller]
fn assert_refused(results: &Results, run: Run, words: &str) {
    let before = results.contents();
    let outcome = run.threads(1).resume().out(results.path()).finish();
    assert!(matches!(outcome.status.code(), Some(1 | 2)), "{outcome}");
    outcome.message.assert_readable();
    outcome.message.assert_contains(&["another scene", "--out", "checkpoint-", words]);
    assert!(results.contents() == before, "the refused run changed files");
}

#[test]
fn another_scene_or_other_values_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let results = small(&scene);
    let changed = |change: &str| Run::new(&scene).set(change);
    let words = "numerics.spacing is 0.025 and was 0.02";
    assert_refused(&results, changed("numerics.spacing=0.025"), words);
    let words = "numerics.precision is double and was mixed";
    assert_refused(&results, changed("numerics.precision=double"), words);
    let words = "gravity is [0.0, -5.0] and was [0.0, -9.81]";
    assert_refused(&results, changed("gravity=[0, -5]"), words);
    let words = "fluid.water.pressure is 0 and was hydrostatic";
    assert_refused(&results, changed("fluid.water.pressure=0"), words);
    let other = tempfile::tempdir().unwrap();
    let moved = SMALL.replace("max = [0.3, 0.4]", "max = [0.4, 0.3]");
    let moved = Run::new(write_scene(other.path(), &moved));
    assert_refused(&results, moved, "places of the particles differ");
    // What does not change the flow may change: the end, the ranks, the outputs.
    results.add(Run::new(&scene).set("output.snapshots=0.1").end_time(0.15).ranks(2).resume());
    assert!(results.summary()["resumed_at"].as_f64().is_some());
}

/// Settings that leave the particles alone may change; the summary says which did.
#[test]
fn settings_may_change() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let plain = Results::of(Run::new(&scene).threads(1)).digest();
    for (change, words) in [
        ("numerics.cfl=0.5", "numerics.cfl is 0.5 and was 1"),
        ("numerics.density_diffusion=0.05", "numerics.density_diffusion is 0.05 and was 0.1"),
        ("numerics.skin=0.2", "numerics.skin is 0.2 and was 0.15"),
        ("numerics.artificial_viscosity=0.1", "artificial_viscosity is 0.1 and was 0.02"),
        ("fluid.water.viscosity=1", "fluid.water.viscosity is 1 and was 0"),
        ("numerics.on_lost=remove", "numerics.on_lost is remove and was stop"),
    ] {
        let results = small(&scene);
        results.add(Run::new(&scene).threads(1).set(change).resume());
        let summary = results.summary();
        let resumed_at = summary["resumed_at"].as_f64().unwrap();
        let notes = summary["notes"].as_array().unwrap();
        let notes: Vec<_> = notes.iter().filter_map(|note| note.as_str()).collect();
        let told = |note: &&&str| note.contains("resumed at t =") && note.contains(words);
        assert_eq!(notes.iter().filter(told).count(), 1, "{change}: {notes:?}");
        assert!(resumed_at > 0.0 && resumed_at < 0.1, "{change}: {resumed_at}");
        assert_eq!(results.digest() == plain, change.contains("on_lost"), "{change}");
        // Up to there, everything is as it was.
        let (table, before) = (results.table("energies"), small(&scene).table("energies"));
        let same = before.rows.iter().filter(|row| row[0] < resumed_at).count();
        assert!(same > 5 && table.rows[..same] == before.rows[..same], "{change}");
        assert!(table.times_increase(), "{change}");
    }
}

#[test]
fn outputs_and_probes_may_change() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let results = small(&scene);
    let probes = "probe=[{ name = \"P1\", at = [0.1, 0.05], fields = [\"density\"] }, \
                  { name = \"new\", kind = \"front\", axis = \"x\" }]";
    let change = Run::new(&scene).threads(1).set("output.energies=0.03").set(probes);
    results.add(change.resume());
    let plain = Results::of(Run::new(&scene).threads(1));
    assert_eq!(results.digest(), plain.digest());
    let resumed_at = results.summary()["resumed_at"].as_f64().unwrap();
    // Rows every 0.01 s until then, every 0.03 s from then on, and the last state.
    let times = results.table("energies").times();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    let (before, after): (Vec<f64>, Vec<f64>) = times.iter().partition(|time| **time < resumed_at);
    assert!(before.len() as f64 >= resumed_at / 0.01, "{times:?}");
    let due = (1..=6).map(|n| 0.03 * f64::from(n)).filter(|time| *time >= resumed_at).count();
    assert!((due..=due + 1).contains(&after.len()), "{times:?} from {resumed_at}");
    // The new probe begins there; the one that reads something else goes on in a new table.
    assert_eq!(results.table("probe-new").times(), after);
    assert_eq!(results.table("probe-P1").times(), after);
    let old =
        results.files(".csv").into_iter().filter(|path| path.to_string_lossy().contains("until"));
    assert_eq!(old.count(), 1);
}
