//! The page of `sph report`: whole, alone, small, and with what the runs did.

use sph_tests::{Page, Results, Run, SHIPPED, SMALL, write_scene};
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

const MOST_BYTES: usize = 5_000_000;

fn small() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        // In the water, so that it has something to tell.
        let run = Run::new(write_scene(folder.path(), SMALL)).set("probe.0.at=[0.1, 0.05]");
        Results::of(run.threads(1))
    })
}

#[track_caller]
fn page_of<P: AsRef<Path>>(folders: &[P]) -> Page {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("page.html");
    let outcome = Run::report(folders).arg("-o").arg(&file).succeed();
    assert_eq!(outcome.output.trim(), file.to_str().unwrap());
    let html = fs::read_to_string(&file).unwrap();
    assert!(html.len() < MOST_BYTES, "{} bytes", html.len());
    assert!(html.starts_with("<!DOCTYPE html>") && html.contains("name=\"viewport\""));
    let page = Page::read(&html);
    page.assert_self_contained();
    for curve in &page.curves {
        assert!(curve.starts_with('M') && !curve.contains("NaN"), "{curve}");
    }
    page
}

#[track_caller]
fn assert_caption(page: &Page, words: &str) {
    let found = page.captions.iter().any(|caption| caption.contains(words));
    assert!(found, "\"{words}\" is not among {:?}", page.captions);
}

#[test]
fn a_run_becomes_a_page() {
    let results = small();
    let page = page_of(&[results.path()]);
    // Five snapshots, each by speed and by pressure.
    assert_eq!(page.pictures, 10, "{:?}", page.captions);
    for words in
        ["Force on tank", "Moment on tank", "Probe P1: pressure", "Energies", "Largest speed"]
    {
        assert_caption(&page, words);
    }
    for words in ["t = 0 s", "t = 0.05"] {
        assert_caption(&page, words);
    }
    let summary = results.summary();
    for words in [
        "in Pa",
        "x in m",
        "y in m",
        "Speed in m/s",
        "in N/m",
        "Density passes",
        "Local",
        "[fluid.water]",
        "sph run",
        "--threads 1",
        summary["state_digest"].as_str().unwrap(),
        summary["version"].as_str().unwrap(),
    ] {
        assert!(page.text.contains(words), "\"{words}\" is not in the page");
    }
    for note in summary["notes"].as_array().unwrap() {
        assert!(page.text.contains(note.as_str().unwrap()), "{note}");
    }
}

#[test]
fn runs_are_compared_curve_by_curve() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write_scene(folder.path(), SMALL);
    let coarse = folder.path().join("coarse & cheap");
    let run = Run::new(scene).threads(1).ranks(2).set("numerics.spacing=0.04").out(&coarse);
    run.succeed();
    let page = page_of(&[small().path(), coarse]);
    assert!(page.text.contains("coarse & cheap") && page.text.contains("small: 2 runs"));
    assert!(page.text.contains("numerics.spacing=0.04"));
    assert_eq!(page.pictures, 2 * 2 * 4);
    assert_caption(&page, "Force on tank, mean between rows: x");
    // The probe of the second run is dry to the end, and the page says so.
    assert!(page.text.contains("Probe P1 met no fluid in coarse & cheap"));
    // Every other plot has a curve of each run, and a piece of each in its legend.
    let plots = page.captions.iter().filter(|caption| {
        ["Force", "force", "Moment", "Energies", "Momentum", "Largest"]
            .iter()
            .any(|word| caption.contains(word))
    });
    assert_eq!(page.curves.len(), 2 * 2 * plots.count() + 2);
}

#[test]
fn space_is_shown_in_depth() {
    let results = Results::of(SHIPPED[2].run_until(0.1).threads(1).set("output.snapshots=0.05"));
    let page = page_of(&[results.path()]);
    assert_eq!(page.pictures, 6);
    for words in ["x in m", "y in m", "z in m", "in N"] {
        assert!(page.text.contains(words), "\"{words}\" is not in the page");
    }
    assert_caption(&page, "Force on obstacle");
}

#[test]
fn a_run_without_snapshots_or_end_has_a_page_that_says_so() {
    let results = small().copy();
    for file in results.files(".vtu").into_iter().chain(results.files(".pvd")) {
        fs::remove_file(file).unwrap();
    }
    fs::remove_file(results.path().join("summary.json")).unwrap();
    let page = page_of(&[results.path()]);
    assert_eq!(page.pictures, 0);
    for words in ["There are no pictures", "no summary.json", "sph run"] {
        assert!(page.text.contains(words), "\"{words}\" is not in the page");
    }
    assert_caption(&page, "Probe P1");
}

#[test]
fn half_written_files_are_named_and_the_rest_is_shown() {
    let results = small().copy();
    let cut = |name: &str| {
        let path = results.path().join(name);
        let bytes = fs::read(&path).unwrap();
        fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
    };
    ["summary.json", "run.json", "small-000001.vtu", "small-walls.vtu"].into_iter().for_each(cut);
    fs::write(results.path().join("energies.csv"), "time [s],kinetic [J]\n0,oops\n").unwrap();
    let page = page_of(&[results.path()]);
    assert_eq!(page.pictures, 8);
    for words in ["summary.json", "run.json", "small-000001.vtu", "small-walls.vtu", "energies.csv"]
    {
        assert!(page.text.contains(words), "\"{words}\" is not in the page");
    }
}

#[test]
fn a_folder_that_is_no_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = Run::report(&[folder.path()]).fail(2);
    outcome.message.assert_contains(&["holds no results of a run", "sph run"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let nowhere = folder.path().join("nowhere");
    Run::report(&[&nowhere]).fail(2).message.assert_contains(&["cannot read the folder"]);
}

#[test]
fn a_run_names_the_command_of_its_page() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("my results");
    let run = Run::new(write_scene(folder.path(), SMALL)).threads(1).end_time(0.01).aloud();
    let said = run.out(&out).succeed().output;
    assert!(said.contains(&format!("sph report '{}'", out.display())), "{said}");
    Run::report(&[&out]).succeed();
    assert!(out.join("report.html").exists());
}
