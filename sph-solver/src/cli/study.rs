//! `sph study`: error against cost.

use super::{BAD_INPUT, FAILED, STOPPED, count, diagnostics, duration, threads};
use crate::run::Stop;
use crate::study::{
    Axis, Case, Outcome, Plan, Program, Report, Request, StudyError, Truth, figures, markdown,
    run_all, summary, work_precision, write,
};
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Scene files, each with a table [reference]
    #[arg(required = true)]
    scenes: Vec<PathBuf>,
    /// Change a value of all runs, for example --set end_time=1
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Vary a value, for example --over numerics.spacing=0.04,0.02 --over numerics.scheme=delta,delta-plus.
    /// Every combination is run
    #[arg(long, value_name = "KEY=VALUE,...")]
    over: Vec<Axis>,
    /// Seeds of the jitter of the fluid; everything is run with each
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    seeds: Vec<u64>,
    /// Folder for runs and results [default: out/study/ and the name of the scene file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Runs at a time [default: all cores divided by the threads]
    #[arg(long, value_name = "N", value_parser = count)]
    jobs: Option<usize>,
    /// Threads of each run
    #[arg(long, value_name = "N", value_parser = threads, default_value = "1")]
    threads: usize,
    /// Give up a run after this wall-clock time, for example 600 or 1h30m; it is a row without error
    #[arg(long, value_name = "TIME", value_parser = duration)]
    max_wall: Option<Duration>,
    /// Errors whose cost is told [default: the bar of the scene, or 0.05,0.02,0.01]
    #[arg(long, value_name = "E,...", value_delimiter = ',', value_parser = error)]
    at_error: Vec<f64>,
    /// Write a Markdown table of all scenes to this file, and their plots to a folder beside it
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Repeat the runs of earlier studies instead of using them
    #[arg(long)]
    overwrite: bool,
    /// No progress and no table on the terminal
    #[arg(long)]
    quiet: bool,
}

/// A relative error.
fn error(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(error) if error > 0.0 && error.is_finite() => Ok(error),
        _ => Err("give a positive number, for example 0.02".into()),
    }
}

pub fn main(arguments: &StudyArguments) -> ExitCode {
    match study_all(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(StudyError::Scene(error)) => {
            diagnostics::show_scene_error(&error);
            ExitCode::from(BAD_INPUT)
        }
        Err(error @ StudyError::Stopped) => {
            diagnostics::show_note(&error.to_string());
            ExitCode::from(STOPPED)
        }
        Err(error) => {
            diagnostics::show_plain(&error);
            let bad = matches!(
                error,
                StudyError::Request { .. }
                    | StudyError::OtherSettings { .. }
                    | StudyError::Refused { .. }
            );
            ExitCode::from(if bad { BAD_INPUT } else { FAILED })
        }
    }
}

fn study_all(arguments: &StudyArguments) -> Result<(), StudyError> {
    // All scenes are read before the first is run.
    let mut studies = Vec::new();
    for scene in &arguments.scenes {
        let plan = Plan::new(&Request {
            scene: scene.clone(),
            overrides: arguments.overrides.clone(),
            over: arguments.over.clone(),
            seeds: arguments.seeds.clone(),
        })?;
        let truth = Truth::of(&plan.scene, &plan.reference)?;
        studies.push((plan, truth, folder(arguments, scene)));
    }
    let program = program(arguments)?;
    let mut reports = Vec::new();
    for (plan, truth, study) in &studies {
        let reference = &plan.reference;
        let progress = Progress::new(arguments.quiet, plan.cases.len());
        let mut tell =
            |case: &Case, outcome: &Outcome, new: bool| progress.tell(case, outcome, new);
        let outcomes = run_all(plan, study, &program, &mut tell);
        progress.bar.finish_and_clear();
        let figures = figures(plan, study, reference, truth, &outcomes?);
        let report = Report::new(plan, reference, &figures, &arguments.at_error);
        write(&report, study)?;
        if !arguments.quiet {
            let place = study.join("work-precision.svg");
            let text = summary(&report);
            // A closed standard output is no reason to fail.
            let _ = writeln!(std::io::stdout(), "{text}plot: {}\n", place.display());
        }
        reports.push(report);
    }
    match &arguments.table {
        Some(path) => write_table(path, &reports),
        None => Ok(()),
    }
}

fn program(arguments: &StudyArguments) -> Result<Program, StudyError> {
    let here = || PathBuf::from("sph");
    let path =
        std::env::current_exe().map_err(|source| StudyError::Start { program: here(), source })?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Ok(Program {
        jobs: arguments.jobs.unwrap_or((cores / arguments.threads).max(1)),
        threads: arguments.threads,
        max_wall: arguments.max_wall,
        overwrite: arguments.overwrite,
        stop: Stop::on_signals().map_err(|source| StudyError::Start { program: here(), source })?,
        path,
    })
}

/// Folder of the study of a scene.
fn folder(arguments: &StudyArguments, scene: &Path) -> PathBuf {
    let name = scene.file_stem().unwrap_or(scene.as_os_str());
    match &arguments.out {
        Some(out) if arguments.scenes.len() == 1 => out.clone(),
        Some(out) => out.join(name),
        None => Path::new("out").join("study").join(name),
    }
}

/// Writes the table of all studies, and their plots into a folder of the same name.
fn write_table(path: &Path, reports: &[Report]) -> Result<(), StudyError> {
    let folder = path.with_extension("");
    std::fs::create_dir_all(&folder)
        .map_err(|source| StudyError::System { path: folder.clone(), source })?;
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut plots = Vec::new();
    for report in reports {
        let file = format!("{}.svg", report.scene);
        sph_io::write_text_atomically(folder.join(&file), &work_precision(report))?;
        plots.push(format!("{name}/{}", file.replace(' ', "%20")));
    }
    let command = std::iter::once("sph".to_owned()).chain(std::env::args().skip(1));
    let command = command.collect::<Vec<_>>().join(" ");
    Ok(sph_io::write_text_atomically(path, &markdown(reports, &plots, &command))?)
}

/// Which runs are over.
struct Progress {
    bar: ProgressBar,
    quiet: bool,
}

impl Progress {
    fn new(quiet: bool, runs: usize) -> Self {
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(runs as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos} of {len} runs, {elapsed}")
        {
            bar.set_style(style);
        }
        bar.tick();
        Self { bar, quiet }
    }

    fn tell(&self, case: &Case, outcome: &Outcome, new: bool) {
        self.bar.inc(1);
        if self.quiet {
            return;
        }
        let what = match (outcome, new) {
            (_, false) => "made before".into(),
            (Outcome::Finished, true) => "finished".into(),
            (Outcome::Diverged { message }, true) => format!("diverged: {message}"),
            (Outcome::OutOfTime, true) => "took too long".into(),
        };
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
        self.bar.suspend(|| {
            let _ = writeln!(std::io::stderr(), "[{done}/{all}] {}: {what}", case.name);
        });
    }
}
