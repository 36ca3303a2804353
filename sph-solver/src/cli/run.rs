//! `sph run`: simulates a scene.

use super::log::Log;
use super::progress::Progress;
use super::{
    BAD_INPUT, FAILED, STOPPED, SceneArguments, count, diagnostics, duration, seconds, threads,
};
use crate::error::RunError;
use crate::run::{Existing, Notes, RunOptions, Stop, Summary, World, run, shell_line};
use crate::scene::{ErrorKind, SceneError, Sources};
use clap::Args;
use std::io::Write;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

#[derive(Debug, Args)]
pub struct RunArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Folder for the results [default: out/ and the path of the scene file, without its ending]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Simulated time at which the run ends, s, instead of the scene's
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    end_time: Option<f64>,
    /// Ranks as threads of this process (under mpirun, the ranks are the processes)
    #[arg(long, value_name = "N", value_parser = count)]
    ranks: Option<usize>,
    /// Threads per rank [default: all cores divided by the ranks; 1 under mpirun]
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<usize>,
    /// Simulated time between checkpoints, s, instead of the scene's
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    checkpoint_every: Option<f64>,
    /// Go on from the latest checkpoint in the folder of the results
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Remove the results of earlier runs from the folder, instead of refusing to begin
    #[arg(long)]
    overwrite: bool,
    /// End with a checkpoint and exit code 75 after this wall-clock time, for example 3600, 90m or
    /// 1h30m. Leave time for writing the checkpoint. SIGTERM, SIGINT and SIGUSR1 do the same
    #[arg(long, value_name = "TIME", value_parser = duration)]
    max_wall: Option<Duration>,
    /// Without overlap: each pass waits for its messages before it computes the local particles.
    /// The same results, only slower; shows what the overlap is worth
    #[arg(long)]
    blocking: bool,
    /// Add progress, notes and the end to this file, as lines with the time and without control
    /// characters, for batch jobs
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// No progress bar, notes and closing words; summary.json holds the notes
    #[arg(long)]
    pub quiet: bool,
}

impl RunArguments {
    pub fn options(&self) -> RunOptions {
        RunOptions {
            out: self.out.clone().unwrap_or_else(|| default_folder(&self.scene.scene)),
            end_time: self.end_time,
            ranks: self.ranks,
            threads: self.threads,
            checkpoint_every: self.checkpoint_every,
            existing: match (self.resume, self.overwrite) {
                (true, _) => Existing::Resume,
                (false, true) => Existing::Overwrite,
                (false, false) => Existing::Refuse,
            },
            blocking: self.blocking,
            max_wall: self.max_wall,
            stop: Stop::default(),
            notes: Notes::default(),
            command: None,
        }
    }
}

/// `out/` and the path of a scene, so that scenes of one name in different folders keep apart: as
/// seen from the current folder, or from the root for a scene elsewhere.
fn default_folder(scene: &Path) -> PathBuf {
    let whole = scene.canonicalize().unwrap_or_else(|_| scene.into());
    let here = std::env::current_dir().and_then(|here| here.canonicalize()).unwrap_or_default();
    let path = whole.strip_prefix(&here).unwrap_or(&whole).with_extension("");
    let names = path.components().filter(|part| matches!(part, Component::Normal(_)));
    Path::new("out").join(names.collect::<PathBuf>())
}

pub fn main(arguments: &RunArguments) -> ExitCode {
    let world = match World::start() {
        Ok(world) => world,
        Err(error) => {
            if !diagnostics::is_later_rank() {
                diagnostics::show_plain(&error);
            }
            return ExitCode::from(BAD_INPUT);
        }
    };
    match simulate(&world, arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(RunError::Scene(error)) => {
            diagnostics::show_scene_error(&error);
            ExitCode::from(BAD_INPUT)
        }
        Err(RunError::TooManyRanks { ranks, particles }) => {
            // The words of `sph check`, which knows this too.
            let kind = ErrorKind::TooManyRanks { ranks, particles };
            diagnostics::show_scene_error(&SceneError::new(kind, None, Sources::default()));
            ExitCode::from(BAD_INPUT)
        }
        Err(error @ RunError::Stopped { .. }) => {
            if world.speaks() {
                diagnostics::show_note(&error.to_string());
            }
            ExitCode::from(STOPPED)
        }
        Err(error) => {
            // All ranks have met the same error: one of them says it.
            if world.speaks() {
                diagnostics::show_plain(&error);
            }
            ExitCode::from(if error.is_bad_input() { BAD_INPUT } else { FAILED })
        }
    }
}

fn simulate(world: &World, arguments: &RunArguments) -> Result<(), RunError> {
    let scene = world.agree(arguments.scene.read().map_err(RunError::from))?;
    let progress = Progress::new(arguments.quiet || !world.speaks());
    let stop = Stop::on_signals().map_err(RunError::Signals)?;
    let command = Some(command(world));
    let log = world.agree(open_log(world, arguments))?;
    let told = log.clone();
    let (bar, quiet) = (progress.clone(), arguments.quiet || !world.speaks());
    let notes = Notes::told_to(move |note| {
        if let Some(log) = &told {
            log.line(&format!("note: {note}"));
        }
        if !quiet {
            bar.above(|| diagnostics::show_note(note));
        }
    });
    let say = |text: &str| {
        if let Some(log) = &log {
            log.line(text);
        }
    };
    say(&format!("begin: {}", command.as_deref().unwrap_or_default()));
    let options = RunOptions { stop, notes, command, ..arguments.options() };
    let result = run(world, &scene, &options, &|status| {
        progress.show(status);
        if let Some(log) = &log {
            log.show(status);
        }
    });
    progress.finish();
    let summary = result.inspect_err(|error| say(&format!("end: {error}")))?;
    if world.speaks() {
        let path = options.out.join("summary.json");
        let text = serde_json::to_string_pretty(&summary).map_err(|error| {
            RunError::Ranks(format!("the summary cannot be written as JSON: {error}"))
        })?;
        sph_io::write_text_atomically(&path, &(text + "\n"))?;
        closing_words(&summary, &options).lines().for_each(|line| say(&format!("end: {line}")));
        if !arguments.quiet {
            // A closed standard output is no reason to fail a finished run.
            let _ = writeln!(std::io::stdout(), "{}", closing_words(&summary, &options));
        }
    }
    Ok(())
}

/// The log of the process that speaks.
fn open_log(world: &World, arguments: &RunArguments) -> Result<Option<Arc<Log>>, RunError> {
    let Some(path) = arguments.log.as_ref().filter(|_| world.speaks()) else { return Ok(None) };
    let failed = |source| sph_io::IoError::Write { path: path.clone(), source };
    let log = Log::open(path).map_err(failed)?;
    Ok(Some(Arc::new(log)))
}

/// The command that started this run.
fn command(world: &World) -> String {
    let arguments = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    let launcher = match world.size() {
        1 => String::new(),
        size => format!("mpirun -n {size} "),
    };
    launcher + &shell_line(std::iter::once("sph".to_owned()).chain(arguments))
}

fn closing_words(summary: &Summary, options: &RunOptions) -> String {
    let mut text = format!(
        "{} particles ({} of them walls), {} steps to t = {:.4} s in {:.1} s\n\
         {:.2} M particle-updates/s, {:.0} M pair interactions/s on {} rank(s) x {} thread(s)",
        summary.particles.fluid + summary.particles.wall,
        summary.particles.wall,
        summary.steps,
        summary.simulated_time,
        summary.wall_seconds,
        summary.particle_updates_per_second / 1e6,
        summary.pair_interactions_per_second / 1e6,
        summary.ranks,
        summary.threads,
    );
    if summary.ranks > 1 {
        let share = 100.0 * summary.exposed_share;
        text += &format!(", {share:.1} % of the steps in exposed communication");
    }
    if summary.lost_particles > 0 {
        let lost = summary.lost_particles;
        text += &format!("\n{lost} particle(s) left the domain and were removed: see lost.csv");
    }
    let out = options.out.display().to_string();
    let report = shell_line(["sph", "report", &out]);
    text + &format!("\nresults in {out}\nas a page with pictures and curves: {report}")
}
