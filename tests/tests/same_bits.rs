//! The same bits on any number of ranks and threads, and under MPI.

use sph_tests::{Reduced, Results, Run, SHIPPED, mpi_program};
use std::path::Path;

/// Runs the scene as `how` says and asserts the digest.
#[track_caller]
fn assert_same(scene: &Reduced, expected: &str, how: &str, run: Run) {
    let digest = Results::of(run).digest();
    assert_eq!(digest, expected, "{}: {how} gives other bits than one rank", scene.name);
}

fn alone(scene: &Reduced) -> String {
    Results::of(scene.run().ranks(1).threads(1)).digest()
}

fn on_threads(scene: &Reduced) {
    let expected = alone(scene);
    for ranks in [3, 4] {
        let run = scene.run().ranks(ranks).threads(1);
        assert_same(scene, &expected, &format!("{ranks} ranks"), run);
    }
    assert_same(scene, &expected, "2 threads", scene.run().ranks(1).threads(2));
    assert_same(scene, &expected, "2 ranks of 2 threads", scene.run().ranks(2).threads(2));
    assert_same(scene, &expected, "the usual number of threads", scene.run());
}

#[test]
fn dam_break_in_the_plane_on_threads() {
    on_threads(&SHIPPED[0]);
}

#[test]
fn tank_at_rest_on_threads() {
    on_threads(&SHIPPED[1]);
}

#[test]
fn dam_break_in_space_on_threads() {
    on_threads(&SHIPPED[2]);
}

#[test]
fn every_scene_under_mpirun() {
    let Some(program) = mpi_program("the same bits under mpirun") else { return };
    for scene in &SHIPPED {
        let expected = alone(scene);
        for processes in [1, 2, 4] {
            let how = format!("mpirun -n {processes}");
            let results = Results::of(scene.run().mpi(&program, processes));
            let summary = results.summary();
            assert_eq!(summary["ranks"], processes, "{}: {how}", scene.name);
            assert_eq!(results.digest(), expected, "{}: {how}", scene.name);
        }
    }
}

/// Snapshots, tables and checkpoints do not tell how many ranks wrote them.
#[test]
fn every_file_is_the_same() {
    for scene in [SHIPPED[0], SHIPPED[2]] {
        let files = |run: Run| {
            let results = Results::of(run.checkpoint_every(0.3 * scene.end_time).threads(1));
            let mut contents = results.contents();
            contents.retain(|(path, _)| !path.ends_with("summary.json"));
            let name = |path: &Path| path.file_name().map(ToOwned::to_owned);
            contents.into_iter().map(|(path, bytes)| (name(&path), bytes)).collect::<Vec<_>>()
        };
        let (alone, shared) = (files(scene.run().ranks(1)), files(scene.run().ranks(3)));
        assert!(alone.len() > 10);
        for (one, other) in alone.iter().zip(&shared) {
            assert_eq!(one.0, other.0, "{}", scene.name);
            assert!(one.1 == other.1, "{}: {:?} differs", scene.name, one.0);
        }
        assert_eq!(alone.len(), shared.len());
    }
}

/// The tests above would also pass with a digest that sees nothing.
#[test]
fn another_run_has_another_digest() {
    let scene = SHIPPED[1];
    let end_time = 0.5 * scene.end_time;
    let digest = |run: Run| Results::of(run.ranks(1).threads(1)).digest();
    let digests = [
        digest(scene.run_until(end_time)),
        digest(scene.run_until(1.1 * end_time)),
        digest(Reduced { spacing: 1.25 * scene.spacing, ..scene }.run_until(end_time)),
        digest(scene.run_until(end_time).set("numerics.artificial_viscosity=0.0200001")),
        digest(scene.run_until(end_time).set("numerics.precision=double")),
    ];
    for (i, digest) in digests.iter().enumerate() {
        assert_eq!(digest.len(), 32, "{digest}");
        assert!(!digests[..i].contains(digest), "run {i} has the digest of another: {digests:?}");
    }
}

/// The runs above are worth comparing: particles changed their owners, lists were rebuilt.
#[test]
fn the_runs_have_ranks_that_talk() {
    let summary = Results::of(SHIPPED[0].run().ranks(4).threads(1)).summary();
    assert_eq!(summary["ranks"], 4);
    let steps = summary["steps"].as_f64().unwrap();
    let per_rebuild = summary["steps_per_rebuild"].as_f64().unwrap();
    // A new partition is made every 20 rebuilds.
    assert!(steps / per_rebuild > 25.0, "{steps} steps, {per_rebuild} per rebuild");
    assert!(summary["halo_redundancy"].as_f64().unwrap() > 0.0, "{summary:#}");
    for rank in summary["local_inner_outer"].as_array().unwrap() {
        let [local, inner, outer] = [0, 1, 2].map(|part| rank[part].as_u64().unwrap());
        assert!(local > 0 && inner > 0 && outer > 0, "{rank}");
    }
}
