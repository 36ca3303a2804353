//! `sph partition`: what it counts is what runs hold, and what it refuses.

use serde_json::Value;
use sph_tests::{Results, Run, SMALL, scene, write_scene};
use std::fs;

/// A run that stays as it begins: no gravity, no pressure, nothing moves.
const STILL: &str = r#"name = "still"
dimension = 3
end_time = 1e-6
gravity = [0.0, 0.0, 0.0]

[numerics]
spacing = 0.05
sound_speed = 10.0

[fluid.water]
density = 1000.0
pressure = 0
regions = [{ box = { min = [0, 0, 0], max = [0.8, 0.5, 0.45] } },
           { sphere = { center = [1.2, 0.3, 0.3], radius = 0.22 } }]

[[solid]]
name = "tank"
box = { min = [0, 0, 0], max = [1.5, 0.5, 0.6] }
fluid_side = "inside"
"#;

/// The report as JSON, with rates so that nothing is measured.
#[track_caller]
fn report(run: Run) -> Value {
    let run = run.arg("--pair-rate").arg("5e8").arg("--pack-rate").arg("1e8").arg("--json");
    let outcome = run.succeed();
    serde_json::from_str(&outcome.output).unwrap_or_else(|error| panic!("{error} in {outcome}"))
}

#[test]
fn the_counts_are_those_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), STILL);
    let report = report(Run::partition(&scene, "1,2,3,5"));
    for division in report["partitions"].as_array().unwrap() {
        let ranks = division["ranks"].as_u64().unwrap() as usize;
        let summary = Results::of(Run::new(&scene).ranks(ranks).threads(1)).summary();
        assert_eq!(division["local_inner_outer"], summary["local_inner_outer"], "{ranks} ranks");
        assert_eq!(report["fluid"], summary["particles"]["fluid"]);
        assert_eq!(report["walls"], summary["particles"]["wall"]);
        let close = |a: &Value, b: &Value| (a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-9;
        assert!(close(&division["halo_redundancy"], &summary["halo_redundancy"]), "{ranks} ranks");
    }
}

#[test]
fn the_counts_of_water_that_moves_are_near() {
    let path = scene("dam-break-3d");
    let report = report(Run::partition(&path, "2,3"));
    for division in report["partitions"].as_array().unwrap() {
        let ranks = division["ranks"].as_u64().unwrap() as usize;
        let run = Run::new(&path).ranks(ranks).threads(1).end_time(1e-4);
        let summary = Results::of(run).summary();
        let step = |variant: &str| division[variant]["step_seconds"].as_f64().unwrap();
        assert!(step("overlapped") < step("blocking"));
        assert!(step("overlapped") < step("overlapped_repeating_walls"));
        let total = |counts: &Value, part: usize| -> f64 {
            counts.as_array().unwrap().iter().map(|rank| rank[part].as_f64().unwrap()).sum()
        };
        for part in 0..3 {
            let predicted = total(&division["local_inner_outer"], part);
            let held = total(&summary["local_inner_outer"], part);
            let close = (predicted - held).abs() <= 0.02 * held;
            assert!(close, "{ranks} ranks, part {part}: {predicted} and {held}");
        }
    }
}

#[test]
fn a_billion_particles_are_divided_without_being_there() {
    let run = Run::partition(scene("dam-break-3d"), "512").arg("--particles").arg("1e9");
    let report = report(run.arg("--network").arg("gemini"));
    let number = |pointer: &str| report.pointer(pointer).and_then(Value::as_f64).unwrap();
    assert!((number("/fluid") / 1e9 - 1.0).abs() < 0.02);
    assert!(number("/sampled_by_blocks_of") > 1.0);
    let ranks = report["partitions"][0]["local_inner_outer"].as_array().unwrap();
    assert_eq!(ranks.len(), 512);
    let owned = ranks.iter().map(|rank| rank[0].as_f64().unwrap() + rank[1].as_f64().unwrap());
    assert!((owned.sum::<f64>() - number("/fluid")).abs() <= 512.0);
    let efficiency = |variant: &str| number(&format!("/partitions/0/{variant}/efficiency"));
    assert!(efficiency("overlapped") > 0.9 && efficiency("overlapped") <= 1.0);
    assert!(efficiency("blocking") < efficiency("overlapped"));
    // The slowest rank need not be one at a wall.
    assert!(efficiency("overlapped_repeating_walls") <= efficiency("overlapped"));
    assert!(efficiency("blocking_repeating_walls") <= efficiency("blocking"));
}

#[test]
fn rates_are_measured_and_a_table_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    let network = folder.path().join("ours.toml");
    let text = "latency = 1e-6\noverhead = 2e-7\ngap = 3e-7\nnode_bandwidth = 1e10\n\
                ranks_per_node = 64\n";
    fs::write(&network, text).unwrap();
    let run = Run::partition(&path, "2,16").arg("--network").arg(&network).within(folder.path());
    let outcome = run.succeed();
    for words in ["small (2 dimensions)", "300 fluid", "ours: L 1.00 us", "efficient", "blocking"] {
        assert!(outcome.output.contains(words), "{words} in {outcome}");
    }
    let lines = outcome.output.lines();
    let rows: Vec<&str> = lines.filter(|line| line.trim_start().starts_with("16 ")).collect();
    assert_eq!(rows.len(), 2, "{outcome}");
    // The scene, the network, and nothing of the run that measures.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn mistakes_are_answered_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    let words = |run: Run| run.arg("--pair-rate").arg("5e8").fail(2).message.0;
    let text = words(Run::partition(&path, "100000"));
    assert!(text.contains("100000 ranks are more than the"), "{text}");
    let text = words(Run::partition(&path, "2").arg("--network").arg("token-ring"));
    assert!(
        text.contains("token-ring") && text.contains("gemini, slingshot, infiniband"),
        "{text}"
    );
    let network = folder.path().join("bad.toml");
    fs::write(&network, "latency = \"short\"\n").unwrap();
    let text = words(Run::partition(&path, "2").arg("--network").arg(&network));
    assert!(text.contains("bad.toml") && text.contains("line 1"), "{text}");
    let text = words(Run::partition(&path, "2").set("numerics.spacng=1"));
    assert!(text.contains("did you mean `spacing`"), "{text}");
    let text = words(Run::partition(&path, "2,zero"));
    assert!(text.contains("whole number from 1"), "{text}");
}
