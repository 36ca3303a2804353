//! The same bits on any number of ranks and threads, and under MPI.

use serde_json::Value;
use sph_tests::{Reduced, Results, Run, SHIPPED, SMALL, mpi_program, write_scene};
use std::path::Path;

/// The state at the end, and all pair interactions: no rank computes what another one computes,
/// walls included.
#[derive(Debug, PartialEq)]
struct Outcome {
    digest: String,
    pair_interactions: u64,
}

fn outcome(summary: &Value) -> Outcome {
    Outcome {
        digest: summary["state_digest"].as_str().expect("a digest").to_owned(),
        pair_interactions: summary["pair_interactions"].as_u64().expect("a count"),
    }
}

/// Runs the scene as `how` says, asserts the outcome, and returns the summary.
#[track_caller]
fn assert_same(scene: &Reduced, expected: &Outcome, how: &str, run: Run) -> Value {
    let summary = Results::of(run).summary();
    assert_eq!(outcome(&summary), *expected, "{}: {how} differs from one rank", scene.name);
    summary
}

fn alone(scene: &Reduced) -> Outcome {
    let alone = outcome(&Results::of(scene.run().ranks(1).threads(1)).summary());
    assert!(alone.pair_interactions > 1_000_000, "{alone:?}");
    alone
}

fn on_threads(scene: &Reduced) {
    let expected = alone(scene);
    for ranks in [3, 5, 8] {
        let run = scene.run().ranks(ranks).threads(1);
        let summary = assert_same(scene, &expected, &format!("{ranks} ranks"), run);
        // Particles have really changed their owners because the load had become uneven: more
        // often than at the start, where space is divided twice, without lists and with them.
        let partitions = summary["partitions"].as_u64().unwrap();
        let least = if scene.name.starts_with("dam-break") { 3 } else { 2 };
        assert!(partitions >= least, "{}: {partitions} partitions, {ranks} ranks", scene.name);
        assert!(summary["predicted_imbalance"].as_f64().unwrap() < 1.2, "{summary:#}");
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
        for processes in [1, 2, 3, 8] {
            let how = format!("mpirun -n {processes}");
            let summary = assert_same(scene, &expected, &how, scene.run().mpi(&program, processes));
            assert_eq!(summary["ranks"], processes, "{}: {how}", scene.name);
        }
    }
}

/// Far more ranks than a small tank can feed: some have only walls, some a few particles.
#[test]
fn many_ranks_for_few_particles() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let run = || Run::new(&scene).end_time(0.1).threads(1);
    let expected = outcome(&Results::of(run().ranks(1)).summary());
    let summary = Results::of(run().ranks(120)).summary();
    assert_eq!(outcome(&summary), expected);
    let shares = summary["local_inner_outer"].as_array().unwrap();
    let fluid = |share: &Value| share[0].as_u64().unwrap() + share[1].as_u64().unwrap();
    assert_eq!(shares.iter().map(fluid).sum::<u64>(), 300);
    assert!(shares.iter().map(fluid).min().unwrap() < 3, "{shares:?}");
}

/// Without overlap nothing changes but the time.
#[test]
fn blocking_exchange_gives_the_same_bits() {
    for scene in [SHIPPED[0], SHIPPED[2]] {
        let expected = alone(&scene);
        let blocking = |run: Run| run.arg("--blocking").threads(1);
        let shared = assert_same(&scene, &expected, "blocking", blocking(scene.run().ranks(3)));
        assert_eq!(shared["overlapped"], false);
        let usual = assert_same(&scene, &expected, "overlap", scene.run().ranks(3).threads(1));
        assert_eq!(usual["overlapped"], true);
        if let Some(program) = mpi_program("blocking exchange under mpirun") {
            let run = scene.run().arg("--blocking").mpi(&program, 2);
            assert_same(&scene, &expected, "mpirun -n 2, blocking", run);
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
            // These tell of the command and its cost.
            contents.retain(|(path, _)| {
                !(path.ends_with("summary.json") || path.ends_with("run.json"))
            });
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
    assert!(steps / per_rebuild > 25.0, "{steps} steps, {per_rebuild} per rebuild");
    assert!(summary["partitions"].as_u64().unwrap() > 2, "{summary:#}");
    assert!(summary["messages"].as_f64().unwrap() >= 2.0 * 3.0 * steps, "{summary:#}");
    assert!(summary["bytes_sent"].as_u64().unwrap() > 100_000, "{summary:#}");
    for share in ["exposed_share", "collective_share"] {
        assert!((0.0..=1.0).contains(&summary[share].as_f64().unwrap()), "{summary:#}");
    }
    assert!(summary["halo_redundancy"].as_f64().unwrap() > 0.0, "{summary:#}");
    for rank in summary["local_inner_outer"].as_array().unwrap() {
        let [local, inner, outer] = [0, 1, 2].map(|part| rank[part].as_u64().unwrap());
        assert!(local > 0 && inner > 0 && outer > 0, "{rank}");
    }
}
