//! What the program remarks about a scene and a run: the same in `check`, on standard error and in
//! `summary.json`.

use serde_json::Value;
use sph_tests::{Results, Run, SMALL, read_vtu, write_scene};

fn texts(value: &Value) -> Vec<String> {
    let notes = value["notes"].as_array().unwrap_or_else(|| panic!("no notes in {value:#}"));
    notes.iter().map(|note| note.as_str().unwrap().to_owned()).collect()
}

fn checked(run: Run) -> Value {
    serde_json::from_str(&run.arg("--json").succeed().output).unwrap()
}

#[test]
fn a_run_says_what_check_says() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let probes = r#"probe=[
        { name = "deep", at = [-0.03, 0.05], fields = ["pressure"] },
        { name = "away", at = [7, 0.05], fields = ["pressure"] },
        { name = "dry", at = [0.9, 0.05], fields = ["pressure"] },
        { name = "wet", at = [0.1, 0.05], fields = ["pressure"] }]"#;
    let changes = [
        "numerics.sound_speed=20",
        "fluid.water.regions=[{ box = { min = [0, 0], max = [0.31, 0.4] } }]",
        &probes.replace('\n', " "),
    ];
    let with = |run: Run| changes.iter().fold(run, |run, change| run.set(change));
    let report = checked(with(Run::check(&scene)));
    let expected = texts(&report);
    for words in [
        "the sound speed is only 5.0 times",
        "the particles hold 3.2 % less fluid than the regions",
        "probe deep at [-0.03, 0.05] is 0.0300 m inside solid tank",
        "probe away at [7.0, 0.05] is outside of the domain",
        "dry at the start, so that their cells stay empty until fluid is within 0.0600 m: probe dry",
    ] {
        assert!(expected.iter().any(|note| note.contains(words)), "\"{words}\": {expected:#?}");
    }
    assert_eq!(expected.len(), 5, "{expected:#?}");
    assert!((report["volume"]["regions"].as_f64().unwrap() - 0.124).abs() < 1e-12);
    assert!((report["volume"]["particles"].as_f64().unwrap() - 0.12).abs() < 1e-12);
    let text = with(Run::check(&scene)).succeed().output;
    let results = Results::new();
    let run = with(Run::new(&scene)).threads(1).end_time(0.005);
    let outcome = results.add(run.aloud());
    assert_eq!(texts(&results.summary()), expected);
    for note in &expected {
        assert!(text.contains(note.as_str()), "{note} is not in\n{text}");
        assert_eq!(outcome.message.count(&format!("note: {note}")), 1, "{outcome}");
    }
}

#[test]
fn a_flow_too_fast_for_its_sound_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    for ranks in [1, 3] {
        let results = Results::new();
        let run = Run::new(&scene).ranks(ranks).threads(1).set("numerics.sound_speed=9");
        let outcome = results.add(run.aloud());
        let words = "beyond 0.15 it is visibly compressible";
        assert_eq!(outcome.message.count(words), 1, "{outcome}");
        let notes = texts(&results.summary());
        assert_eq!(notes.iter().filter(|note| note.contains(words)).count(), 1, "{notes:?}");
    }
    let calm = Results::of(Run::new(&scene).threads(1).end_time(0.05)).summary();
    assert!(!texts(&calm).iter().any(|note| note.contains("visibly compressible")), "{calm:#}");
}

/// Empty cells and a 0 until the water comes, numbers and a 1 from then on.
#[test]
fn dry_probes_are_empty() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let probes = r#"probe=[{ name = "floor", at = [0.5, 0.01], fields = ["pressure", "velocity"] },
        { name = "away", at = [9, 9], fields = ["density"] }]"#;
    let run = Run::new(&scene).threads(1).end_time(0.3).set(&probes.replace('\n', " "));
    let results = Results::of(run);
    let table = results.table("probe-floor");
    assert_eq!(
        table.titles,
        ["time [s]", "pressure [Pa]", "velocity_x [m/s]", "velocity_y [m/s]", "wet [1]"]
    );
    let wet = table.column("wet");
    assert!(wet[0] == 0.0 && wet[wet.len() - 1] == 1.0, "{wet:?}");
    for row in &table.rows {
        assert!(row[4] == 0.0 || row[4] == 1.0, "{row:?}");
        assert!(row[1..4].iter().all(|value| value.is_nan() == (row[4] == 0.0)), "{row:?}");
    }
    let away = results.table("probe-away");
    assert!(away.rows.iter().all(|row| row[1].is_nan() && row[2] == 0.0), "{away:?}");
}

/// A pool beside a column, and two basins: the surface of each counts for itself.
#[test]
fn separate_waters_have_separate_surfaces() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let file = folder.path().join("particles.vtu");
    let pool = r#"fluid.water.regions=[{ box = { min = [0, 0], max = [0.2, 0.5] } },
        { box = { min = [0.4, 0], max = [1, 0.1] } }]"#;
    let basins = r#"solid=[
        { name = "tank", box = { min = [0, 0], max = [1, 0.6] }, fluid_side = "inside" },
        { name = "wall", box = { min = [0.2, 0], max = [0.4, 0.6] }, fluid_side = "outside" }]"#;
    for changes in [vec![pool], vec![pool, basins]] {
        let run = Run::check(&scene).arg("--write").arg(&file);
        let set = |run: Run, change: &&str| run.set(&change.replace('\n', " "));
        changes.iter().fold(run, set).succeed();
        let particles = read_vtu(&file);
        let points = &particles.array("Points").values;
        let pressure = &particles.array("pressure").values;
        let kind = &particles.array("kind").values;
        let mut seen = [0, 0];
        for (i, _) in kind.iter().enumerate().filter(|(_, kind)| **kind == 0.0) {
            let (x, y) = (points[3 * i], points[3 * i + 1]);
            let body = usize::from(x > 0.3);
            let expected = 9810.0 * ([0.5, 0.1][body] - y);
            assert!((pressure[i] - expected).abs() < 1e-6 * 9810.0, "{x} {y}: {}", pressure[i]);
            seen[body] += 1;
        }
        assert_eq!(seen, [10 * 25, 30 * 5]);
    }
}
