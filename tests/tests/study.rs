//! `sph study`: errors against cost, from a small flow whose solution is known.

use serde_json::Value;
use sph_tests::{Outcome, Results, Run, line_of, write_scene};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

/// Taylor-Green vortices for a moment.
const VORTICES: &str = r#"dimension = 2
end_time = 0.2
periodic = ["x", "y"]
domain = { min = [0, 0], max = [1, 1] }

[numerics]
spacing = 0.1
sound_speed = 10.0

[fluid.water]
density = 1.0
viscosity = 0.1
regions = [{ box = { min = [0, 0], max = [1, 1] } }]
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
pressure = "-(cos(4*pi*x) + cos(4*pi*y))/4"

[output]
energies = 0.05

[reference]
velocity = [
    "-cos(2*pi*x)*sin(2*pi*y)*exp(-0.8*pi^2*t)",
    "sin(2*pi*x)*cos(2*pi*y)*exp(-0.8*pi^2*t)",
]
norm = "l2"
bar = 0.05

[study]
over = ["numerics.spacing=0.1,0.05"]
"#;

const SCHEMES: &str = "numerics.scheme=delta,delta-plus";

fn study(scene: &Path, out: &Path, arguments: &[&str]) -> Run {
    arguments.iter().fold(Run::study(scene).arg("--out").arg(out), Run::arg)
}

fn report(out: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(out.join("study.json")).unwrap()).unwrap()
}

/// When the runs of a study were written.
fn ages(out: &Path) -> BTreeMap<String, SystemTime> {
    let runs = fs::read_dir(out.join("runs")).unwrap().map(Result::unwrap);
    let folders = runs.filter(|entry| entry.path().is_dir());
    folders
        .map(|folder| {
            let summary = fs::metadata(folder.path().join("summary.json")).unwrap();
            (folder.file_name().to_string_lossy().into_owned(), summary.modified().unwrap())
        })
        .collect()
}

#[test]
fn errors_fall_with_the_spacing_and_nothing_is_done_twice() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), VORTICES);
    let out = folder.path().join("study");
    let outcome = study(&scene, &out, &["--over", SCHEMES]).succeed();
    for words in ["scheme = delta-plus", "order", "core-s", "error 0.05 costs"] {
        assert!(outcome.output.contains(words), "{words}: {outcome}");
    }
    let first = report(&out);
    assert_eq!(first["rows"].as_array().unwrap().len(), 4);
    let curves = first["curves"].as_array().unwrap();
    assert_eq!(curves.len(), 2);
    for curve in curves {
        assert!(curve["order"].as_f64().unwrap() > 1.0, "{curve:#}");
        let errors: Vec<f64> = curve["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(|point| point["error"].as_f64().unwrap())
            .collect();
        assert!(errors[0] < 0.5 && errors[1] < errors[0], "{errors:?}");
    }
    let table = fs::read_to_string(out.join("study.csv")).unwrap();
    assert!(table.starts_with("run,scheme,spacing [m],seed,outcome,error [1]"), "{table}");
    assert_eq!(table.lines().count(), 5);
    let plot = fs::read_to_string(out.join("work-precision.svg")).unwrap();
    assert_eq!(plot.matches("core-s</title>").count(), 4, "{plot}");

    let before = ages(&out);
    let again = study(&scene, &out, &["--over", SCHEMES]).succeed();
    assert_eq!(again.message.count("made before"), 4, "{again}");
    assert_eq!(ages(&out), before);
    assert_eq!(report(&out), first);

    // A run more, and the others stay.
    let more = "numerics.scheme=delta,delta-plus";
    let spacings = "numerics.spacing=0.1,0.05,0.125";
    let outcome = study(&scene, &out, &["--over", more, "--over", spacings]).succeed();
    assert_eq!(outcome.message.count("made before"), 4, "{outcome}");
    assert_eq!(outcome.message.count(": finished"), 2, "{outcome}");

    // What cannot be run is told.
    let odd = study(&scene, &out, &["--over", "numerics.spacing=0.15"]).fail(2);
    odd.message.assert_contains(&["spacing-0.15", "refused", "domain"]);

    // The same names with another flow are not taken for the same runs.
    let changed =
        write_scene(folder.path(), &VORTICES.replace("viscosity = 0.1", "viscosity = 0.2"));
    let refused = study(&changed, &out, &["--over", SCHEMES]).fail(2);
    refused.message.assert_contains(&[
        "other settings",
        "fluid.water.viscosity = 0.2",
        "--overwrite",
    ]);
    assert_eq!(report(&out)["rows"].as_array().unwrap().len(), 6);
}

#[test]
fn seeds_give_a_spread_and_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), VORTICES);
    let refused = study(&scene, &folder.path().join("a"), &["--seeds", "1,2"]).fail(2);
    refused.message.assert_contains(&["jitter"]);
    let out = folder.path().join("b");
    let table = folder.path().join("accuracy.md");
    let arguments = ["--seeds", "1,2", "--set", "fluid.water.jitter=0.2", "--table"];
    study(&scene, &out, &arguments).arg(&table).succeed();
    let report = report(&out);
    let points = report["curves"][0]["points"].as_array().unwrap();
    for point in points {
        let range = point["error_range"].as_array().unwrap();
        assert!(range[0].as_f64() < range[1].as_f64(), "{point:#}");
        assert_eq!(point["runs"][0], 2);
    }
    let text = fs::read_to_string(&table).unwrap();
    assert!(text.contains("| [scene](accuracy/scene.svg) |"), "{text}");
    assert!(folder.path().join("accuracy/scene.svg").exists());
}

/// A study that was ended goes on where it was; the run that was on its way is made again.
#[test]
fn an_ended_study_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), VORTICES);
    let out = folder.path().join("study");
    let long = ["--set", "end_time=100", "--over", "numerics.spacing=0.05,0.025"];
    let mut running = study(&scene, &out, &long).start();
    let begun = out.join("runs/spacing-0.05/energies.csv");
    assert!(running.wait_for(|| begun.exists()));
    running.signal("INT");
    let outcome = running.wait();
    assert_eq!(outcome.status.code(), Some(75), "{outcome}");
    outcome.message.assert_contains(&["goes on with the runs that are missing"]);
    assert!(!out.join("runs/spacing-0.05.json").exists(), "a run that never ended");
    // The other end time makes it another study.
    let outcome = study(&scene, &out, &[]).succeed();
    assert_eq!(outcome.message.count(": finished"), 2, "{outcome}");
}

/// A column of a table against a formula, a CSV and the finest run; a run that diverges is a row.
#[test]
fn columns_are_compared_and_a_divergence_is_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let (field, rest) = VORTICES.split_once("[reference]").unwrap();
    let study_keys = rest.split_once("[study]").unwrap().1;
    let with = |reference: &str| format!("{field}[reference]\n{reference}\n[study]{study_keys}");
    fs::write(folder.path().join("decay.csv"), "# exact\nt,E\n0,0.25\n100,25.0\n1000,0.0\n")
        .unwrap();
    let column = "table = \"energies\"\ncolumn = \"kinetic\"\n";
    for (number, reference) in [
        "formula = \"start*exp(-1.6*pi^2*t)\"\nscale = 0.25\n",
        "file = \"decay.csv\"\nnorm = \"max\"\nvalue_unit = 1.0\n",
        "finest = true\n",
    ]
    .iter()
    .enumerate()
    {
        let scene = write_scene(folder.path(), &with(&format!("{reference}{column}")));
        let out = folder.path().join(format!("study-{number}"));
        let unstable = "numerics.density_diffusion=0.1,0";
        let outcome =
            study(&scene, &out, &["--over", unstable, "--set", "numerics.cfl=0.5"]).succeed();
        let report = report(&out);
        let rows = report["rows"].as_array().unwrap();
        assert_eq!(rows.len(), 4, "{outcome}");
        let error = rows[0]["error"].as_f64().unwrap();
        match number {
            0 => assert!(error < 0.1, "{error}"),
            // The table grows, the vortices decay.
            1 => assert!(error > 0.5, "{error}"),
            _ => {
                assert!(error < 0.2, "{error}");
                assert!(rows[2]["error"].is_null(), "{report:#}");
            }
        }
    }
    let scene = write_scene(folder.path(), VORTICES);
    let out = folder.path().join("wild");
    // The second flow meets itself at a hundred times its sound speed.
    let flows = "fluid.water.velocity=[\"0\", \"0\"],[\"3000*x\", \"0\"]";
    let outcome = study(&scene, &out, &["--over", flows, "--max-wall", "60"]).succeed();
    let outcomes: Vec<String> = report(&out)["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["outcome"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(outcomes, ["finished", "diverged", "finished", "diverged"], "{outcome}");
    assert!(outcome.output.contains("diverged: the run diverged"), "{outcome}");
}

#[test]
fn errors_have_the_same_bits_on_any_ranks() {
    let folder = tempfile::tempdir().unwrap();
    let pressure = "pressure = \"-(cos(4*pi*x) + cos(4*pi*y))*exp(-1.6*pi^2*t)/4\"";
    let velocity = VORTICES.split_once("[reference]").unwrap().1;
    let velocity = velocity.split_once("norm").unwrap().0;
    for text in [VORTICES.to_owned(), VORTICES.replace(velocity, &format!("\n{pressure}\n"))] {
        let scene = write_scene(folder.path(), &text);
        let tables = [1, 2, 5].map(|ranks| {
            let jitter = Run::new(&scene).set("fluid.water.jitter=0.3").ranks(ranks);
            let results = Results::of(jitter.threads(1).end_time(0.1));
            let table = results.table("reference");
            assert!(table.rows.len() >= 3, "{table:?}");
            fs::read(results.path().join("reference.csv")).unwrap()
        });
        assert!(tables.iter().all(|table| *table == tables[0]));
    }
}

/// Asserts that a study of the vortices is refused after `old` became `new`, for the line with `new`.
#[track_caller]
fn refused(old: &str, new: &str, words: &[&str]) -> Outcome {
    assert!(VORTICES.contains(old), "{old}");
    let text = VORTICES.replacen(old, new, 1);
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), &text);
    let out = folder.path().join("study");
    let outcome = study(&scene, &out, &[]).fail(2);
    let culprit = new.lines().find(|line| !line.is_empty()).unwrap_or("dimension");
    let place = format!("scene.toml:{}:", line_of(&text, culprit));
    outcome.message.assert_contains(&[words, &[place.as_str(), "help:"]].concat());
    assert!(!out.exists());
    outcome
}

#[test]
fn mistakes_in_a_reference_have_a_line() {
    let column = "norm = \"l2\"\n";
    refused("*exp(-0.8*pi^2*t)\",\n]", "*exq(t)\",\n]", &["exq", "did you mean `exp`?"]);
    refused("sin(2*pi*x)*cos(2*pi*y)*exp(-0.8*pi^2*t)", "start", &["`start`", "column"]);
    refused("bar = 0.05", "bar = -1", &["reference.bar", "positive"]);
    refused("bar = 0.05", "norn = 1", &["norn", "norm"]);
    refused("bar = 0.05", "norm = \"last\"\n", &["duplicate"]);
    refused(column, "norm = \"mean\"\n", &["columns of tables"]);
    refused("bar = 0.05", "pressure = \"x\"", &["two truths"]);
    refused("bar = 0.05", "table = \"energies\"", &["table"]);
    refused("over = [", "over = [\"numerics.spacing\", ", &["cannot be varied"]);
    let field = &VORTICES[VORTICES.find("velocity = [\n").unwrap()..VORTICES.find(column).unwrap()];
    for (reference, words) in [
        ("formula = \"start\"\ntable = \"energys\"\ncolumn = \"a\"\n", ["energys", "energies"]),
        ("table = \"energies\"\ncolumn = \"kinetik\"\nformula = \"t\"\n", ["kinetik", "kinetic"]),
        (
            "file = \"no.csv\"\ntable = \"energies\"\ncolumn = \"kinetic\"\n",
            ["no.csv", "cannot read"],
        ),
    ] {
        let line = reference.lines().find(|line| line.contains(words[0])).unwrap();
        let text = VORTICES.replacen(field, reference, 1);
        let folder = tempfile::tempdir().unwrap();
        let scene = write_scene(folder.path(), &text);
        let outcome = study(&scene, &folder.path().join("study"), &[]).fail(2);
        let place = format!("scene.toml:{}:", line_of(&text, line));
        outcome.message.assert_contains(&[&words[..], &[place.as_str(), "help:"]].concat());
    }
}

#[test]
fn a_scene_without_reference_is_refused() {
    let text = VORTICES.split_once("[reference]").unwrap().0;
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), text);
    let outcome = study(&scene, &folder.path().join("study"), &[]).fail(2);
    outcome.message.assert_contains(&["no [reference]", "help:"]);
}
