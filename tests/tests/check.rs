//! `sph check`: reads everything, reports, runs nothing.

use serde_json::Value;
use sph_tests::{BoxMesh, Results, Run, SHIPPED, SMALL, read_vtu, scene, write_scene};
use std::fs;

fn report(run: Run) -> Value {
    let outcome = run.arg("--json").succeed();
    serde_json::from_str(&outcome.output).unwrap_or_else(|error| panic!("{error} in\n{outcome}"))
}

fn number(value: &Value, path: &str) -> f64 {
    let found = value.pointer(path).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("no number {path} in {value:#}"))
}

#[test]
fn every_shipped_scene_is_in_order() {
    for shipped in &SHIPPED {
        let outcome = Run::check(scene(shipped.name)).succeed();
        for words in
            [shipped.name, "particles", "fluid", "memory", "time step", "steps", "bounding box"]
        {
            assert!(outcome.output.contains(words), "no \"{words}\" in\n{outcome}");
        }
        let report = report(Run::check(scene(shipped.name)));
        assert_eq!(report["name"], shipped.name);
        assert_eq!(report["dimension"], shipped.dimension);
        for path in [
            "/particles/fluid",
            "/particles/solids/0/particles",
            "/memory_bytes",
            "/time_step",
            "/steps",
            "/end_time",
            "/sound_speed",
        ] {
            assert!(number(&report, path) > 0.0, "{path}");
        }
        let corners = report["bounding_box"].as_array().unwrap();
        assert_eq!(corners.len(), 2);
        for axis in 0..shipped.dimension {
            let [low, high] = [0, 1].map(|corner| corners[corner][axis].as_f64().unwrap());
            assert!(low < high, "{corners:?}");
        }
        let expected = number(&report, "/end_time") / number(&report, "/time_step");
        let steps = number(&report, "/steps");
        assert!((steps / expected - 1.0).abs() < 0.01, "{steps} steps, not {expected}");
    }
}

#[test]
fn meshes_are_reported() {
    let report = report(Run::check(scene("dam-break-3d")));
    let meshes = report["meshes"].as_array().unwrap();
    assert_eq!(meshes.len(), 2, "{meshes:?}");
    for mesh in meshes {
        assert!(number(mesh, "/triangles") >= 12.0 && number(mesh, "/volume") > 0.0, "{mesh}");
        assert!(mesh["path"].as_str().unwrap().ends_with(".stl"), "{mesh}");
    }
}

#[test]
fn the_counts_are_those_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    let report = report(Run::check(&path));
    assert_eq!(report["particles"]["fluid"], 15 * 20);
    let summary = Results::of(Run::new(&path).threads(1).end_time(0.01)).summary();
    assert_eq!(report["particles"]["fluid"], summary["particles"]["fluid"]);
    let walls = report["particles"]["solids"].as_array().unwrap();
    let walls: f64 = walls.iter().map(|solid| number(solid, "/particles")).sum();
    assert_eq!(walls, number(&summary, "/particles/wall"));
    let ratio = number(&report, "/time_step") / number(&summary, "/time_step");
    assert!((0.5..2.0).contains(&ratio), "the step is {ratio} times that of the run");
}

#[test]
fn changes_to_the_scene_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    let fine = report(Run::check(&path).set("numerics.spacing=0.01"));
    assert_eq!(fine["particles"]["fluid"], 4 * 15 * 20);
    assert_eq!(fine["spacing"], 0.01);
}

#[test]
fn the_particles_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    let file = folder.path().join("particles.vtu");
    let report = report(Run::check(&path).arg("--write").arg(&file));
    let particles = read_vtu(&file);
    assert_eq!(particles.points as f64, number(&report, "/particles/total"));
    let fluid = particles.array("kind").values.iter().filter(|kind| **kind == 0.0).count();
    assert_eq!(fluid, 300);
    // And exactly these run.
    let results = Results::of(Run::new(&path).threads(1).end_time(0.01));
    let first = &results.series()[0];
    let snapshot = read_vtu(&results.path().join(&first.file));
    let written = &particles.array("Points").values;
    let start = &snapshot.array("Points").values;
    assert_eq!(written[..start.len()], start[..]);
}

#[test]
fn nothing_is_run_and_nothing_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    let outcome = Run::check(&path).within(folder.path()).succeed();
    assert!(outcome.message.0.is_empty(), "{outcome}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_mesh_that_the_test_makes_is_a_tank() {
    let folder = tempfile::tempdir().unwrap();
    BoxMesh::new([0.0, 0.0, 0.0], [0.4, 0.4, 0.4]).write(&folder.path().join("tank.stl"));
    let text = "dimension = 3\nend_time = 0.1\ngravity = [0, 0, -9.81]\n\
                [numerics]\nspacing = 0.05\n\
                [fluid.water]\ndensity = 1000\n\
                regions = [{ box = { min = [0, 0, 0], max = [0.2, 0.4, 0.3] } }]\n\
                [[solid]]\nname = \"tank\"\nmesh = \"tank.stl\"\nfluid_side = \"inside\"\n";
    let report = report(Run::check(write_scene(folder.path(), text)));
    assert_eq!(report["particles"]["fluid"], 4 * 8 * 6);
    assert_eq!(report["meshes"][0]["triangles"], 12);
    assert!((number(&report, "/meshes/0/volume") - 0.064).abs() < 1e-9);
}

/// `sub/..` is nothing, also when there is no `sub`.
#[test]
fn paths_may_take_detours() {
    let folder = tempfile::tempdir().unwrap();
    BoxMesh::new([0.0, 0.0, 0.0], [0.4, 0.4, 0.4]).write(&folder.path().join("tank.stl"));
    let text = "dimension = 3\nend_time = 0.1\ngravity = [0, 0, -9.81]\n\
                [numerics]\nspacing = 0.05\n\
                [fluid.water]\ndensity = 1000\n\
                regions = [{ box = { min = [0, 0, 0], max = [0.2, 0.4, 0.3] } }]\n\
                [[solid]]\nname = \"tank\"\nmesh = \"./sub/../tank.stl\"\nfluid_side = \"inside\"\n";
    let report = report(Run::check(write_scene(folder.path(), text)));
    assert_eq!(report["meshes"][0]["triangles"], 12);
}

/// Under a limit of memory, scenes that fit are read and the others refused: at no size the program
/// is ended by the system.
#[test]
fn a_limit_of_memory_is_respected() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_scene(folder.path(), SMALL);
    let mut codes = Vec::new();
    for spacing in [0.02, 0.002, 0.0006, 0.0004, 0.0003, 0.0002, 0.0001] {
        let run = Run::check(&path).set(&format!("numerics.spacing={spacing}"));
        let outcome = run.memory_limit(200).finish();
        match outcome.status.code() {
            Some(0) => (),
            Some(2) => outcome.message.assert_contains(&["numerics.spacing", "are free here"]),
            _ => panic!("{outcome}"),
        }
        codes.push(outcome.status.code());
    }
    assert!(codes.starts_with(&[Some(0)]) && codes.ends_with(&[Some(2)]), "{codes:?}");
    assert!(codes.is_sorted(), "{codes:?}");
}
