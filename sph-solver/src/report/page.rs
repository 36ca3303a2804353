//! The page around pictures, curves and tables. It is written as XML too, so that every reader of
//! either understands it.

use super::curves;
use super::facts;
use super::html::{escape, shorten};
use super::pictures;
use super::results::Results;
use super::scan::Scan;

/// How much of everything goes into a page.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// Pixels of all pictures together.
    pub pixels: f64,
    /// Pairs of points per curve.
    pub bins: usize,
    /// Number of plots.
    pub plots: usize,
    /// Characters of a scene.
    pub scene: usize,
}

const STYLE: &str = include_str!("page.css");

/// The page of these runs.
pub fn page(runs: &[Results], scans: &[Scan], problems: &[String], budget: Budget) -> String {
    let mut problems = problems.to_vec();
    let pictures = pictures::section(runs, scans, budget.pixels, &mut problems);
    let names: Vec<&str> = runs.iter().map(Results::name).collect();
    let same = names.iter().all(|name| *name == names[0]);
    let title = match names.len() {
        1 => names[0].to_owned(),
        runs if same => format!("{}: {runs} runs", names[0]),
        _ => names.join(", "),
    };
    let title = escape(&shorten(&title, 120));
    let mut html = format!(
        "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n\
         <meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
         <p class=\"lead\">Report of a run of <code>sph</code>: smoothed particle hydrodynamics.</p>\n"
    );
    html += &notes(runs, &problems);
    html += "<h2>Key figures</h2>\n";
    html += &facts::key_figures(runs);
    if pictures.is_empty() {
        html += "<h2>Flow</h2>\n<p>There are no pictures: ";
        html += if scans.iter().any(|scan| !scan.moments.is_empty()) {
            "the snapshots hold neither velocity nor pressure.</p>\n"
        } else {
            "the run has written no snapshots that can be read. The key <code>snapshots</code> of \
             the table <code>[output]</code> in the scene makes some.</p>\n"
        };
    }
    html += &pictures;
    if runs.len() > scans.len() {
        html += &format!("<p>Pictures of the first {} runs only.</p>\n", scans.len());
    }
    let plots = curves::plots(runs);
    if !plots.is_empty() {
        html += "<h2>Over time</h2>\n<div class=\"grid\">\n";
        plots.iter().take(budget.plots).for_each(|plot| html += &plot.figure(budget.bins));
        html += "</div>\n";
        if plots.len() > budget.plots {
            html += &format!(
                "<p>{} more plots are left out to keep the page small; the tables have \
                 everything.</p>\n",
                plots.len() - budget.plots
            );
        }
    }
    for (probe, run) in curves::dry_probes(runs) {
        let of = if runs.len() > 1 { format!(" in {}", run.label) } else { String::new() };
        html += &format!("<p>{}.</p>\n", escape(&format!("Probe {probe} met no fluid{of}")));
    }
    let (phases, parts) = (facts::phases(runs), facts::parts(runs));
    if !phases.is_empty() {
        html += &format!("<h2>Where the time went</h2>\n{phases}");
    }
    if !parts.is_empty() {
        html += "<h2>Particles of each rank</h2>\n<p>Local particles need nothing of other ranks, \
                 inner ones are copied to them, outer ones are copies received.</p>\n";
        html += &parts;
    }
    html += &origin(runs, budget.scene);
    html + "</body>\n</html>\n"
}

/// Texts of a run that are shown.
const MOST_NOTES: usize = 60;

fn notes(runs: &[Results], problems: &[String]) -> String {
    let several = runs.len() > 1;
    let of_runs = runs.iter().flat_map(|run| {
        let own = run.problems.iter().map(String::as_str);
        let label = &run.label;
        let with_label = move |note: &str| {
            if several { format!("{label}: {note}") } else { note.to_owned() }
        };
        own.chain(run.notes()).map(with_label)
    });
    let notes: Vec<String> = of_runs.chain(problems.iter().cloned()).collect();
    if notes.is_empty() {
        return String::new();
    }
    let mut html = String::from("<h2>Notes</h2>\n<ul class=\"notes\">\n");
    for note in notes.iter().take(MOST_NOTES) {
        html += &format!("<li>{}</li>\n", escape(&shorten(note, 1000)));
    }
    if notes.len() > MOST_NOTES {
        html += &format!("<li>and {} more in summary.json</li>\n", notes.len() - MOST_NOTES);
    }
    html + "</ul>\n"
}

/// Commands, versions and scenes.
fn origin(runs: &[Results], most: usize) -> String {
    let mut html = String::from("<h2>How to repeat it</h2>\n");
    for run in runs {
        if runs.len() > 1 {
            html += &format!("<h3>{}</h3>\n", escape(&run.label));
        }
        if run.record.commands.is_empty() {
            html +=
                "<p>The command is not known: the folder has no run.json that can be read.</p>\n";
        } else {
            let commands = shorten(&run.record.commands.join("\n"), 4000);
            html += &format!("<pre>{}</pre>\n", escape(&commands));
        }
        let version = run.summary["version"].as_str().unwrap_or(&run.record.version);
        let simd = run.summary["simd"].as_str();
        let unit = simd.map(|simd| format!(", vector unit {simd}")).unwrap_or_default();
        if !version.is_empty() {
            html += &format!("<p>sph {}{}</p>\n", escape(version), escape(&unit));
        }
    }
    // Runs of one scene with other settings are common.
    let mut shown: Vec<&str> = Vec::new();
    let changed = runs.iter().any(|run| !run.record.overrides.is_empty());
    let before = if changed { ", before the changes by <code>--set</code>" } else { "" };
    for run in runs {
        let scene = run.record.scene.as_str();
        if scene.is_empty() || shown.contains(&scene) {
            continue;
        }
        shown.push(scene);
        let file = escape(&run.record.scene_file);
        let same = runs.iter().filter(|other| other.record.scene == scene).count();
        let of =
            if same > 1 { format!(", the scene of {same} of these runs") } else { String::new() };
        html += &format!(
            "<h2>Scene</h2>\n<p><code>{file}</code>{of}{before}:\
             </p>\n<pre>{}</pre>\n",
            escape(&shorten(scene, most))
        );
    }
    html + &format!("<p class=\"foot\">Made by sph {}.</p>\n", env!("CARGO_PKG_VERSION"))
}
