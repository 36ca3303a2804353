//! First accuracy evidence: the shipped scenes against measurements and exact answers, with their
//! cost. Prints the tables of the README.
//!
//! `cargo run --release -p sph-benches --bin accuracy [-- FOLDER]`, a few minutes on one core.

use sph_io::read_table;
use sph_solver::run::{Existing, RunOptions, Summary, World, run};
use sph_solver::scene::Scene;
use std::error::Error;
use std::path::{Path, PathBuf};

type Outcome<T> = Result<T, Box<dyn Error>>;

const G: f64 = 9.81;

fn main() -> Outcome<()> {
    let out = std::env::args_os().nth(1).map_or_else(|| "out/accuracy".into(), PathBuf::from);
    dam_break_front(&out)?;
    tank_at_rest(&out)
}

/// Runs a shipped scene at a spacing (m), on one thread.
fn simulate(scene: &str, spacing: f64, out: &Path) -> Outcome<(PathBuf, Summary)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = root.join("scenes").join(format!("{scene}.toml"));
    let scene = Scene::read(&path, &[format!("numerics.spacing={spacing}")])?;
    let folder = out.join(format!("{}-{spacing}", scene.name()));
    let options = RunOptions {
        out: folder.clone(),
        threads: Some(1),
        existing: Existing::Overwrite,
        ..RunOptions::default()
    };
    let summary = run(&World::Process, &scene, &options, &|_| ())?;
    Ok((folder, summary))
}

/// The front of the collapsing column against Koshizuka & Oka (1996).
fn dam_break_front(out: &Path) -> Outcome<()> {
    // The tank of the scene ends at 4 m: later points are beyond it.
    let measured: Vec<(f64, f64)> = reference("dam_break_front_koshizuka_oka.csv")?
        .into_iter()
        .filter(|p| p.1 < 3.95)
        .collect();
    let travelled = measured.last().ok_or("no measured front")?.1 - 1.0;
    println!("| dam break, 2-D: H/dp | rms of front / distance travelled | worst | core-seconds |");
    println!("|---|---|---|---|");
    for spacing in [0.05, 0.025, 0.0125] {
        let (folder, summary) = simulate("dam-break-2d", spacing, out)?;
        let table = read_table(folder.join("probe-front.csv"))?;
        let time = table.column("time").ok_or("no time")?;
        let front = table.column("x").ok_or("no front")?;
        // The water ends half a spacing beyond its last particle.
        let errors =
            measured.iter().map(|&(t, x)| interpolate(&time, &front, t) + 0.5 * spacing - x);
        let errors: Vec<f64> = errors.collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let worst = errors.iter().fold(0.0_f64, |worst, e| worst.max(e.abs()));
        println!(
            "| {:.0} | {:.1} % | {:.1} % | {:.1} |",
            2.0 / spacing,
            100.0 * rms / travelled,
            100.0 * worst / travelled,
            core_seconds(&summary),
        );
    }
    Ok(())
}

/// Water at rest against its exact pressure.
fn tank_at_rest(out: &Path) -> Outcome<()> {
    println!();
    println!(
        "| tank at rest, 2-D: H/dp | largest speed / sqrt(gH) | pressure error at 0.5 H and 0.95 H | \
         core-seconds |"
    );
    println!("|---|---|---|---|");
    for spacing in [0.05, 0.025, 0.0125] {
        let (folder, summary) = simulate("hydrostatic-2d", spacing, out)?;
        let energies = read_table(folder.join("energies.csv"))?;
        let speed = energies.column("speed").ok_or("no speed")?;
        // After the first half, when the acoustic start-up has passed.
        let late = &speed[speed.len() / 2..];
        let largest = late.iter().copied().fold(0.0, f64::max) / G.sqrt();
        let error = |name: &str, depth: f64| -> Outcome<f64> {
            let table = read_table(folder.join(format!("probe-{name}.csv")))?;
            let pressure = table.column("pressure").ok_or("no pressure")?;
            let late = &pressure[pressure.len() / 2..];
            let mean = late.iter().sum::<f64>() / late.len() as f64;
            Ok(mean / (1000.0 * G * depth) - 1.0)
        };
        println!(
            "| {:.0} | {:.1e} | {:+.2} %, {:+.2} % | {:.1} |",
            1.0 / spacing,
            largest,
            100.0 * error("middle", 0.5)?,
            100.0 * error("bottom", 0.95)?,
            core_seconds(&summary),
        );
    }
    Ok(())
}

fn core_seconds(summary: &Summary) -> f64 {
    summary.phases.rebuild + summary.phases.density + summary.phases.force
}

/// Two columns of a reference table; lines that begin with `#` say where it comes from.
fn reference(name: &str) -> Outcome<Vec<(f64, f64)>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference").join(name);
    let text = std::fs::read_to_string(&path)?;
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(|row| {
        let (a, b) = row.split_once(',').ok_or("a row needs two columns")?;
        Ok((a.trim().parse()?, b.trim().parse()?))
    })
    .collect()
}

fn interpolate(x: &[f64], y: &[f64], at: f64) -> f64 {
    let after = x.partition_point(|&x| x < at).clamp(1, x.len() - 1);
    let (x0, x1) = (x[after - 1], x[after]);
    y[after - 1] + (y[after] - y[after - 1]) * (at - x0) / (x1 - x0)
}
