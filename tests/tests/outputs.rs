//! What a run leaves: summary, snapshots, tables, checkpoints.

use serde_json::Value;
use sph_tests::{Results, Run, SHIPPED, SMALL, assert_finite, python_with, read_vtu, write_scene};
use std::fs;
use std::sync::OnceLock;

const COUNTS: [&str; 3] = ["/steps", "/lost_particles", "/particles/fluid"];
const NUMBERS: [&str; 23] = [
    "/simulated_time",
    "/wall_seconds",
    "/cpu_seconds",
    "/phases/rebuild",
    "/phases/density",
    "/phases/force",
    "/phases/output",
    "/particle_updates_per_second",
    "/pair_interactions_per_second",
    "/neighbours_per_particle",
    "/exposed_seconds",
    "/exposed_share",
    "/collective_seconds",
    "/collective_share",
    "/messages",
    "/bytes_sent",
    "/halo_redundancy",
    "/imbalance",
    "/predicted_imbalance",
    "/partitions",
    "/pair_interactions",
    "/energies/end/kinetic",
    "/energies/end/potential",
];

/// A dam break in the plane with every kind of output.
fn flat() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| Results::of(with_outputs(SHIPPED[0].run(), SHIPPED[0].end_time)))
}

fn solid() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| Results::of(with_outputs(SHIPPED[2].run(), SHIPPED[2].end_time)))
}

fn with_outputs(run: Run, end_time: f64) -> Run {
    run.threads(1)
        .set(&format!("output.snapshots={}", 0.25 * end_time))
        .set(&format!("output.energies={}", 0.02 * end_time))
        .checkpoint_every(0.25 * end_time)
}

fn number(value: &Value, path: &str) -> f64 {
    let found = value.pointer(path).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("no number {path} in {value:#}"))
}

#[test]
fn the_summary_says_everything() {
    for (results, scene) in [(flat(), SHIPPED[0]), (solid(), SHIPPED[2])] {
        let summary = results.summary();
        for path in COUNTS {
            let found = summary.pointer(path).and_then(Value::as_u64);
            assert!(found.is_some(), "no count {path} in {summary:#}");
        }
        for path in NUMBERS {
            let found = number(&summary, path);
            assert!(found.is_finite() && (found >= 0.0 || path.contains("potential")), "{path}");
        }
        assert_eq!(summary["name"], scene.name);
        assert_eq!(summary["dimension"], scene.dimension);
        assert_eq!(summary["momentum"].as_array().unwrap().len(), scene.dimension);
        assert_eq!(summary["ranks"], 1);
        assert_eq!(summary["lost_particles"], 0);
        let digest = results.digest();
        assert!(digest.len() == 32 && digest.chars().all(|c| c.is_ascii_hexdigit()), "{digest}");
        let time = number(&summary, "/simulated_time");
        // A step may end a little later.
        assert!(scene.end_time <= time && time < 1.05 * scene.end_time, "{time}");
        assert!(number(&summary, "/particles/wall") > 0.0);
        assert!(number(&summary, "/energies/end/kinetic") > 0.0);
        let neighbours = number(&summary, "/neighbours_per_particle");
        let sphere = if scene.dimension == 2 { 10.0..60.0 } else { 30.0..200.0 };
        assert!(sphere.contains(&neighbours), "{neighbours}");
        // Nobody updates more particles in a second than this machine has done in all.
        let all = number(&summary, "/steps") * number(&summary, "/particles/fluid");
        let rate = number(&summary, "/particle_updates_per_second");
        assert!(rate * number(&summary, "/wall_seconds") >= 0.5 * all, "{rate}");
    }
}

#[test]
fn energy_turns_from_potential_to_kinetic() {
    for results in [flat(), solid()] {
        let table = results.table("energies");
        assert!(table.times_increase() && table.rows.len() > 30, "{:?}", table.times());
        assert_eq!(table.rows[0][0], 0.0);
        let [kinetic, potential, elastic] =
            ["kinetic", "potential", "elastic"].map(|name| table.column(name));
        let total: Vec<f64> =
            (0..kinetic.len()).map(|i| kinetic[i] + potential[i] + elastic[i]).collect();
        let last = total.len() - 1;
        let fallen = potential[0] - potential[last];
        assert_eq!(kinetic[0], 0.0);
        assert!(kinetic[last] > 0.2 * fallen && fallen > 0.0, "{kinetic:?}, fallen {fallen}");
        let gained = total.iter().map(|energy| energy - total[0]).fold(0.0, f64::max);
        assert!(gained < 0.01 * fallen, "{gained} J from nowhere: {total:?}");
        let end = &results.summary()["energies"]["end"];
        assert_eq!(number(end, "/kinetic"), kinetic[last]);
        assert_eq!(number(end, "/potential"), potential[last]);
    }
}

#[test]
fn every_probe_has_its_table() {
    for results in [flat(), solid()] {
        let probes = results.files(".csv");
        let probes: Vec<_> = probes
            .iter()
            .filter_map(|path| path.file_stem()?.to_str()?.strip_prefix("probe-"))
            .collect();
        assert!(!probes.is_empty(), "the scene has no probes");
        let energies = results.table("energies");
        for probe in probes {
            let table = results.table(&format!("probe-{probe}"));
            assert_eq!(table.times(), energies.times(), "{probe}");
            for title in &table.titles {
                assert!(title.contains(" [") && title.ends_with(']'), "no unit: {title}");
            }
        }
    }
}

#[test]
fn snapshots_hold_all_particles() {
    for (results, dimension) in [(flat(), 2), (solid(), 3)] {
        let summary = results.summary();
        let (fluid, wall) =
            (number(&summary, "/particles/fluid"), number(&summary, "/particles/wall"));
        let series = results.series();
        let moving: Vec<_> = series.iter().filter(|entry| entry.part == 0).collect();
        assert_eq!(moving.len(), 5, "{series:?}");
        assert!(moving.windows(2).all(|pair| pair[0].time < pair[1].time), "{series:?}");
        assert_eq!(moving[4].time, number(&summary, "/simulated_time"));
        for moment in &moving {
            let mut kinds = Vec::new();
            let mut ids = Vec::new();
            for entry in series.iter().filter(|entry| entry.time == moment.time) {
                let file = read_vtu(&results.path().join(&entry.file));
                for (name, components) in
                    [("velocity", 3), ("pressure", 1), ("density", 1), ("kind", 1), ("id", 1)]
                {
                    let array = file.array(name);
                    let shape = [1, dimension, 3].contains(&array.components);
                    assert!(shape && array.components <= components, "{name}: {array:?}");
                }
                kinds.extend_from_slice(&file.array("kind").values);
                ids.extend_from_slice(&file.array("id").values);
            }
            let count = |fluid: bool| kinds.iter().filter(|kind| (**kind == 0.0) == fluid).count();
            assert_eq!((count(true) as f64, count(false) as f64), (fluid, wall), "{moment:?}");
            ids.sort_by(f64::total_cmp);
            ids.dedup();
            assert_eq!(ids.len(), kinds.len(), "ids are not unique");
        }
        assert_finite(&results.path(), dimension);
    }
}

#[test]
fn vtk_and_h5py_open_everything() {
    for results in [flat(), solid()] {
        let script = "read_outputs.py";
        let Some(report) = python_with(&["vtk", "h5py"], script, &results.path()) else { return };
        let report: Value = serde_json::from_str(&report).unwrap();
        let summary = results.summary();
        let snapshots = report["snapshots"].as_array().unwrap();
        let fluid: Vec<_> = snapshots.iter().filter(|one| one["part"] == 0).collect();
        assert_eq!(fluid.len(), 5);
        for snapshot in &fluid {
            assert_eq!(snapshot["fluid"], summary["particles"]["fluid"]);
            assert_eq!(snapshot["points"], snapshot["fluid"]);
        }
        assert_eq!(number(fluid[0], "/largest_speed"), 0.0);
        assert!(number(fluid[4], "/largest_speed") > 0.1);
        assert!(number(fluid[4], "/front") > number(fluid[0], "/front") + 0.05);
        for walls in snapshots.iter().filter(|one| one["part"] == 1) {
            assert_eq!(walls["points"], summary["particles"]["wall"]);
            assert_eq!(walls["fluid"], 0);
        }
        let checkpoints = report["checkpoints"].as_array().unwrap();
        assert!(!checkpoints.is_empty());
        for checkpoint in checkpoints {
            assert_eq!(checkpoint["points"], summary["particles"]["fluid"]);
            assert!(number(checkpoint, "/time") > 0.0 && number(checkpoint, "/step") > 0.0);
            assert!(number(checkpoint, "/mass") > 0.0);
            assert!(checkpoint["scene"].as_str().unwrap().contains("[fluid."), "{checkpoint}");
        }
    }
}

#[test]
fn no_file_but_those_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let results = Results::of(Run::new(&scene).threads(1).within(folder.path()));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "files outside of --out");
    let names: Vec<_> = results
        .contents()
        .iter()
        .map(|(path, _)| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    let expected = [
        "energies.csv",
        "lost.csv",
        "probe-P1.csv",
        "run.json",
        "small-000000.vtu",
        "small-000001.vtu",
        "small-000002.vtu",
        "small-000003.vtu",
        "small-000004.vtu",
        "small-walls.vtu",
        "small.pvd",
        "solid-tank.csv",
        "summary.json",
    ];
    assert_eq!(names, expected);
    assert!(results.table("lost").rows.is_empty());
}

/// Bytes per particle of the last snapshot, with what it holds beside positions.
fn snapshot_of(changes: &[&str]) -> (f64, sph_tests::Vtu) {
    let run = SHIPPED[2].run_until(0.3).threads(1).set("output.snapshots=1");
    let results = Results::of(changes.iter().fold(run, |run, change| run.set(change)));
    let last = results.series().into_iter().rfind(|entry| entry.part == 0).unwrap();
    let path = results.path().join(last.file);
    let (bytes, vtu) = (fs::metadata(&path).unwrap().len() as f64, read_vtu(&path));
    (bytes / vtu.points as f64, vtu)
}

#[test]
fn snapshots_hold_what_the_scene_chooses() {
    let (all, whole) = snapshot_of(&[]);
    let choice = "output.fields=[\"velocity\", \"pressure\"]";
    let small = ["output.positions=f32", "output.compression=zlib", choice];
    let (few, same) = snapshot_of(&small);
    assert!(few < 40.0 && few < 0.6 * all, "{few} and {all} bytes per particle");
    let names: Vec<_> = same.arrays.iter().map(|array| array.name.as_str()).collect();
    assert_eq!(names, ["Points", "velocity", "pressure"]);
    assert_eq!(same.array("velocity"), whole.array("velocity"));
    let single = whole.array("Points").values.iter().map(|x| f64::from(*x as f32));
    assert!(single.eq(same.array("Points").values.iter().copied()));
    let region = "output.region={ min = [0.2, 0, 0], max = [0.7, 0.3, 1] }";
    let (_, part) = snapshot_of(&[region, "output.every_nth=3"]);
    let chosen = |(id, x): &(&f64, &[f64])| {
        **id % 3.0 == 0.0 && (0.2..=0.7).contains(&x[0]) && x[1] <= 0.3 && x[2] >= 0.0
    };
    let places = whole.array("Points").values.chunks(3);
    let ids = whole.array("id").values.iter().zip(places).filter(chosen).map(|(id, _)| *id);
    let ids: Vec<f64> = ids.collect();
    assert!(ids.len() > 20, "{ids:?}");
    assert_eq!(part.array("id").values, ids);
}

#[test]
fn the_check_predicts_the_room_of_snapshots() {
    for changes in [
        &["output.snapshots=0.1"][..],
        &["output.snapshots=0.05", "output.positions=f32", "output.compression=zlib"],
    ] {
        let with = |run: Run| changes.iter().fold(run, |run, change| run.set(change));
        let scene = with(Run::check(sph_tests::scene(SHIPPED[2].name)).arg("--json"))
            .set(&format!("numerics.spacing={}", SHIPPED[2].spacing))
            .set("end_time=0.3");
        let report: Value = serde_json::from_str(&scene.succeed().output).unwrap();
        let predicted = number(&report, "/snapshots/bytes");
        let results = Results::of(with(SHIPPED[2].run_until(0.3).threads(1)));
        let files = results.files(".vtu").into_iter();
        let bytes: f64 = files.map(|path| fs::metadata(path).unwrap().len() as f64).sum();
        // What still lies on the lattice packs better than what flows.
        assert!((0.9..2.5).contains(&(predicted / bytes)), "{predicted} for {bytes}: {changes:?}");
    }
}

#[test]
fn a_log_is_for_batch_jobs() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, log) = (write_scene(folder.path(), SMALL), folder.path().join("run.log"));
    let results = Results::of(Run::new(&scene).threads(1).arg("--log").arg(&log));
    let first = fs::read_to_string(&log).unwrap();
    let time = |line: &str| {
        let (stamp, _) = line.split_once(' ').unwrap();
        stamp.len() == 20 && stamp.ends_with('Z') && &stamp[10..11] == "T"
    };
    assert!(first.lines().all(time), "{first}");
    assert!(first.chars().all(|c| c == '\n' || !c.is_control()), "{first}");
    for words in ["begin: sph run ", "note: ", ", step 1, ", "end: results in "] {
        assert!(first.contains(words), "\"{words}\" is not in\n{first}");
    }
    Run::new(&scene).out(results.path()).arg("--log").arg(&log).fail(2);
    let second = fs::read_to_string(&log).unwrap();
    assert!(second.starts_with(&first) && second.contains("end: "), "{second}");
}

/// Two runs into one folder: nothing of the first is left in the series and the tables.
#[test]
fn a_second_run_replaces_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let run = |end_time| Run::new(&scene).threads(1).end_time(end_time).checkpoint_every(0.02);
    let results = Results::of(run(0.2));
    results.add(run(0.1).overwrite());
    let fresh = Results::of(run(0.1));
    assert_eq!(results.digest(), fresh.digest());
    assert_eq!(results.series(), fresh.series());
    assert_eq!(results.table("energies"), fresh.table("energies"));
    // A checkpoint of the longer run would be taken for one of the shorter run.
    results.add(run(0.15).resume());
    assert_eq!(results.digest(), Results::of(run(0.15)).digest());
}

#[test]
fn a_quiet_run_is_quiet_and_the_usual_one_tells() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let results = Results::new();
    let quiet = results.add(Run::new(&scene).threads(1));
    assert!(quiet.output.is_empty() && quiet.message.0.is_empty(), "{quiet}");
    let usual = results.add(Run::new(&scene).threads(1).overwrite().aloud());
    let said = format!("{}{}", usual.output, usual.message);
    let out = results.path();
    assert!(said.contains(out.to_str().unwrap()), "the results are not named: {usual}");
}
