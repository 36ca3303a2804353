//! The folder of a run: nothing is overwritten by accident, and one run writes at a time.

use sph_tests::{Results, Run, SMALL, mpi_program, write_scene};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

fn small() -> (TempDir, Run) {
    let folder = tempfile::tempdir().unwrap();
    let run = Run::new(write_scene(folder.path(), SMALL)).threads(1);
    (folder, run)
}

fn names(results: &Results) -> BTreeSet<String> {
    let name = |(path, _): &(PathBuf, Vec<u8>)| path.file_name().unwrap().display().to_string();
    results.contents().iter().map(name).collect()
}

#[track_caller]
fn assert_refused(run: &Run, results: &Results, words: &[&str]) {
    let before = results.contents();
    let outcome = run.clone().out(results.path()).fail(2);
    outcome.message.assert_contains(words);
    assert!(results.contents() == before, "the refused run changed files");
}

#[test]
fn the_same_command_again_is_refused() {
    let (_folder, run) = small();
    let results = Results::of(run.clone().end_time(0.02));
    let words = ["no checkpoint for --resume", "--overwrite", "--out", "summary.json"];
    assert_refused(&run, &results, &words);
    let results = Results::of(run.clone().end_time(0.05).checkpoint_every(0.02));
    let words = ["--resume goes on from their last checkpoint", "--overwrite", "--out"];
    assert_refused(&run, &results, &words);
    // And after a kill, when there is no summary.
    fs::remove_file(results.path().join("summary.json")).unwrap();
    assert_refused(&run, &results, &words);
    assert_refused(&run.clone().resume().overwrite(), &results, &["--resume", "--overwrite"]);
}

#[test]
fn overwriting_leaves_nothing_of_the_old_run() {
    let (_folder, run) = small();
    let probe = r#"probe=[{ name = "gone", kind = "front", axis = "x" }]"#;
    let old = run.clone().set("name=old").set(probe).checkpoint_every(0.02);
    let results = Results::of(old);
    for mine in ["notes.txt", "measured.csv", "picture.vtu"] {
        fs::write(results.path().join(mine), "mine").unwrap();
    }
    results.add(run.clone().end_time(0.1).overwrite());
    let fresh = Results::of(run.end_time(0.1));
    let mut expected = names(&fresh);
    expected.extend(["notes.txt", "measured.csv", "picture.vtu"].map(String::from));
    assert_eq!(names(&results), expected);
    assert_eq!(results.digest(), fresh.digest());
}

#[test]
fn a_second_run_at_the_same_time_is_refused() {
    let (_folder, run) = small();
    let endless = run.clone().end_time(1e5).checkpoint_every(0.01);
    let results = Results::new();
    let mut first = endless.clone().out(results.path()).start();
    let written = first.wait_for(|| !results.files(".vtkhdf").is_empty());
    assert!(written, "{}", first.wait());
    for second in [endless.clone().resume(), endless.clone().overwrite()] {
        let outcome = second.out(results.path()).fail(2);
        outcome.message.assert_contains(&["another run is writing into", "--out"]);
    }
    // Nobody has to tidy up behind a run that was killed.
    first.kill();
    results.add(run.clone().end_time(0.2).overwrite());
    assert_eq!(results.digest(), Results::of(run.end_time(0.2)).digest());
    assert!(!names(&results).contains(".sph.lock"));
}

#[test]
fn scenes_of_one_name_keep_apart() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a", "b"] {
        fs::create_dir(folder.path().join(name)).unwrap();
        let scene = write_scene(&folder.path().join(name), SMALL);
        // As seen from the folder, and as a whole path.
        let relative = Path::new(name).join("scene.toml");
        let run = |scene: &Path| Run::new(scene).threads(1).end_time(0.01).within(folder.path());
        run(&relative).succeed();
        let out = folder.path().join("out").join(name).join("scene");
        assert!(out.join("summary.json").is_file(), "no results in {}", out.display());
        run(&scene).fail(2).message.assert_contains(&["--overwrite"]);
    }
}

#[test]
fn an_mpi_job_is_refused_once() {
    let Some(program) = mpi_program("folders in use under mpirun") else { return };
    let (_folder, run) = small();
    let results = Results::of(run.clone().end_time(0.02));
    let before = results.contents();
    let job = run.clone().mpi(&program, 2).patience(Duration::from_secs(60));
    let outcome = job.clone().out(results.path()).finish();
    assert!(!outcome.status.success(), "{outcome}");
    assert_eq!(outcome.message.count("--overwrite"), 1, "{outcome}");
    assert!(results.contents() == before, "the refused job changed files");
    results.add(job.overwrite());
    assert_eq!(results.digest(), Results::of(run).digest());
}
