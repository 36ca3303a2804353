//! One run as a process of its own.

use super::error::StudyError;
use super::outcome::Outcome;
use super::plan::Case;
use super::pool::Program;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};

/// Exit code of a run that reached its limit of wall-clock time.
const STOPPED: i32 = 75;
/// Exit code of a run whose scene is wrong, such as for a period that is no whole number of spacings.
const BAD_INPUT: i32 = 2;

/// A run that goes on.
pub struct Running {
    child: Child,
}

impl Running {
    /// Starts a run; what it says goes to `NAME.log` beside its folder.
    pub fn start(
        program: &Program,
        scene: &Path,
        case: &Case,
        study: &Path,
    ) -> Result<Self, StudyError> {
        let folder = case.folder(study);
        let log = log(study, case);
        let system = |path: &Path| {
            let path = path.to_owned();
            move |source| StudyError::System { path, source }
        };
        let parent = study.join("runs");
        std::fs::create_dir_all(&parent).map_err(system(&parent))?;
        let said = File::create(&log).map_err(system(&log))?;
        let mut command = Command::new(&program.path);
        command.arg("run").arg(scene).arg("--out").arg(folder).args(["--overwrite", "--quiet"]);
        command.arg("--threads").arg(program.threads.to_string());
        if let Some(limit) = program.max_wall {
            command.arg("--max-wall").arg(limit.as_secs_f64().to_string());
        }
        for change in &case.overrides {
            command.arg("--set").arg(change);
        }
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(said);
        let child = command
            .spawn()
            .map_err(|source| StudyError::Start { program: program.path.clone(), source })?;
        Ok(Self { child })
    }

    /// Whether it is over, and how.
    pub fn ended(&mut self) -> Option<std::io::Result<ExitStatus>> {
        self.child.try_wait().transpose()
    }

    /// Ends it.
    pub fn kill(&mut self) {
        // It may be over already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What an exit of a run means.
///
/// # Errors
///
/// A run that was refused, ended from outside, or failed for another reason than its flow: it says
/// nothing, and is to be made again.
pub fn outcome(
    program: &Program,
    status: ExitStatus,
    study: &Path,
    case: &Case,
) -> Result<Outcome, StudyError> {
    let name = case.name.clone();
    match status.code() {
        Some(0) => Ok(Outcome::Finished),
        Some(STOPPED) if program.max_wall.is_some() && program.stop.reason().is_none() => {
            Ok(Outcome::OutOfTime)
        }
        None | Some(STOPPED) => Err(StudyError::Killed { name }),
        Some(code) => {
            let text = std::fs::read_to_string(log(study, case)).unwrap_or_default();
            let line = text.lines().map(str::trim).find(|line| line.starts_with("error:"));
            let line = line.or_else(|| text.lines().next()).unwrap_or("it did not say why");
            let message = line.trim_start_matches("error:").trim().to_owned();
            match code {
                BAD_INPUT => Err(StudyError::Refused { name, message }),
                // What goes wrong in the flow goes wrong at a time.
                _ if message.contains("t = ") => Ok(Outcome::Diverged { message }),
                _ => Err(StudyError::Failed { name, message }),
            }
        }
    }
}

fn log(study: &Path, case: &Case) -> PathBuf {
    study.join("runs").join(format!("{}.log", case.name))
}
