//! The command line of the program `sph`.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | the run failed |
//! | 2 | the scene or the command line is wrong |
//! | 75 | the run was asked to end early; `--resume` goes on from its checkpoint |

mod check;
mod diagnostics;
mod log;
mod new;
mod partition;
mod progress;
mod report;
mod run;
mod shell;
mod study;

use crate::scene::{Scene, SceneError};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

/// Exit code of a failed run.
const FAILED: u8 = 1;
/// Exit code of a scene or command line that is wrong.
const BAD_INPUT: u8 = 2;
/// Exit code of a run that ended early and can go on: `EX_TEMPFAIL` of sysexits.h, upon which batch
/// systems try again.
const STOPPED: u8 = 75;

/// Smoothed particle hydrodynamics from scene files.
#[derive(Debug, Parser)]
#[command(name = "sph", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a commented scene to start from
    New(new::NewArguments),
    /// Simulate a scene and write snapshots, tables and summary.json
    Run(run::RunArguments),
    /// Read a scene and everything it names, and report counts, time step, memory and cost
    Check(check::CheckArguments),
    /// Divide a scene among many ranks without running it, and predict the time of a step
    Partition(partition::PartitionArguments),
    /// Run scenes over spacings, schemes and seeds, and report their errors against their cost
    Study(study::StudyArguments),
    /// Make a page of pictures, curves and figures out of the results of runs
    Report(report::ReportArguments),
    /// Write a completion script for a shell on standard output
    Completions(shell::CompletionsArguments),
    /// Write manual pages
    Man(shell::ManArguments),
}

/// Which scene.
#[derive(Debug, Args)]
struct SceneArguments {
    /// Scene file
    scene: PathBuf,
    /// Change a value of the scene, for example --set numerics.spacing=0.01
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Let the scene name files outside of its folder
    #[arg(long)]
    allow_paths: bool,
}

impl SceneArguments {
    fn read(&self) -> Result<Scene, SceneError> {
        let scene = Scene::read(&self.scene, &self.overrides)?;
        if !self.allow_paths {
            scene.check_paths()?;
        }
        Ok(scene)
    }
}

/// Runs the program with the arguments of this process.
pub fn main() -> ExitCode {
    match Arguments::parse().command {
        Command::New(arguments) => new::main(&arguments),
        Command::Run(arguments) => run::main(&arguments),
        Command::Check(arguments) => check::main(&arguments),
        Command::Partition(arguments) => partition::main(&arguments),
        Command::Study(arguments) => study::main(&arguments),
        Command::Report(arguments) => report::main(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man(arguments) => shell::man(&arguments),
    }
}

/// A time in seconds that can be the length of an interval.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(time) if time > 0.0 && time.is_finite() => Ok(time),
        Ok(time) => Err(format!("{time} is not positive; give a time in seconds")),
        Err(_) => Err("give a time in seconds, for example 0.5".into()),
    }
}

/// A wall-clock time: seconds, or numbers with the units d, h, m, s from the longest to the shortest.
fn duration(text: &str) -> Result<Duration, String> {
    let mistake = || "give seconds, or days, hours, minutes and seconds such as 1h30m".to_string();
    if let Ok(seconds) = text.parse::<f64>() {
        let duration = Duration::try_from_secs_f64(seconds).map_err(|_| mistake())?;
        return if duration.is_zero() { Err(mistake()) } else { Ok(duration) };
    }
    let mut seconds = 0_u64;
    let mut rest = text;
    for (unit, length) in [('d', 86_400), ('h', 3600), ('m', 60), ('s', 1)] {
        let Some((number, after)) = rest.split_once(unit) else { continue };
        let number: u64 = number.parse().map_err(|_| mistake())?;
        let part = number.checked_mul(length).ok_or_else(mistake)?;
        seconds = seconds.checked_add(part).ok_or_else(mistake)?;
        rest = after;
    }
    if rest.is_empty() && seconds > 0 { Ok(Duration::from_secs(seconds)) } else { Err(mistake()) }
}

/// More threads than this in one process are a typing error, and would bring the machine down.
const MOST_THREADS: usize = 1024;

/// A number of threads.
fn threads(text: &str) -> Result<usize, String> {
    match count(text)? {
        count if count <= MOST_THREADS => Ok(count),
        count => Err(format!("{count} is more than the {MOST_THREADS} that one process may start")),
    }
}

/// A number of ranks.
fn count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if count > 0 => Ok(count),
        _ => Err("give a whole number from 1".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Existing;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn arguments_are_read() {
        let line = "sph run a.toml --out o --end-time 0.5 --set a=1 --set b=2 --ranks 3 --threads 2 \
                    --checkpoint-every 0.1 --resume --quiet";
        let Command::Run(run) = Arguments::parse_from(line.split_whitespace()).command else {
            panic!("not a run");
        };
        assert_eq!(run.scene.overrides, ["a=1", "b=2"]);
        let options = run.options();
        assert_eq!(options.out, PathBuf::from("o"));
        assert_eq!((options.ranks, options.threads), (Some(3), Some(2)));
        assert_eq!((options.end_time, options.checkpoint_every), (Some(0.5), Some(0.1)));
        assert!(options.existing == Existing::Resume && run.quiet);
    }

    #[test]
    fn wall_clock_times_are_read() {
        for (text, seconds) in
            [("90", 90.0), ("0.5", 0.5), ("90m", 5400.0), ("1h30m", 5400.0), ("2d1s", 172_801.0)]
        {
            assert_eq!(duration(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in
            ["", "0", "-1", "nan", "inf", "1h30", "30m1h", "h", "1.5h", "999999999999999999d"]
        {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn lists_of_ranks_are_read() {
        let line = "sph partition a.toml --ranks 8,64,32768 --particles 1e9 --set a=1";
        let Command::Partition(arguments) = Arguments::parse_from(line.split_whitespace()).command
        else {
            panic!("not a partition");
        };
        assert_eq!(arguments.ranks, [8, 64, 32768]);
        assert_eq!(arguments.scene.overrides, ["a=1"]);
    }

    #[test]
    fn bad_numbers_are_refused() {
        for line in [
            "sph run a.toml --ranks 0",
            "sph run a.toml --threads 100000",
            "sph run a.toml --end-time -1",
            "sph run a.toml --end-time nan",
            "sph run a.toml --resume --overwrite",
            "sph run a.toml --max-wall soon",
            "sph check a.toml --ranks many",
            "sph partition a.toml",
            "sph partition a.toml --ranks 8,0",
            "sph partition a.toml --ranks 8 --particles -1",
            "sph partition a.toml --ranks 8 --pair-rate fast",
            "sph partition a.toml --ranks 8 --rebuild-share 1",
            "sph run",
        ] {
            assert!(Arguments::try_parse_from(line.split_whitespace()).is_err(), "{line}");
        }
    }
}
