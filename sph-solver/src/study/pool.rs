//! Several runs at a time.

use super::child::{self, Running};
use super::error::StudyError;
use super::outcome::{Outcome, Record};
use super::plan::{Case, Plan};
use crate::run::Stop;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How runs are started.
#[derive(Debug, Clone)]
pub struct Program {
    /// The program `sph`.
    pub path: PathBuf,
    /// Runs at a time.
    pub jobs: usize,
    /// Threads of each.
    pub threads: usize,
    /// Limit of the wall-clock time of each.
    pub max_wall: Option<Duration>,
    /// Whether to forget the runs of earlier studies.
    pub overwrite: bool,
    /// Ends the study when it is asked to.
    pub stop: Stop,
}

/// Between two looks at the runs.
const GLANCE: Duration = Duration::from_millis(20);

/// Makes the runs of a plan that are missing in the folder `study` and tells how all of them ended, in
/// the order of the plan. `tell` hears of each run as it ends; `None` stands for one that an earlier
/// study has made.
///
/// # Errors
///
/// Runs that cannot be started or were killed; a study that was asked to end. Runs that diverge are
/// no error.
pub fn run_all(
    plan: &Plan,
    study: &Path,
    program: &Program,
    tell: &mut dyn FnMut(&Case, &Outcome, bool),
) -> Result<Vec<Outcome>, StudyError> {
    let mut outcomes = Vec::with_capacity(plan.cases.len());
    for case in &plan.cases {
        let found = Record::find(study, case, program.overwrite)?.map(|record| record.outcome);
        if let Some(outcome) = &found {
            tell(case, outcome, false);
        }
        outcomes.push(found);
    }
    let mut waiting: Vec<usize> = (0..outcomes.len()).filter(|i| outcomes[*i].is_none()).collect();
    waiting.reverse();
    let mut running: Vec<(usize, Running)> = Vec::new();
    let result = loop {
        if program.stop.reason().is_some() {
            break Err(StudyError::Stopped);
        }
        while running.len() < program.jobs
            && let Some(next) = waiting.pop()
        {
            match Running::start(program, &plan.path, &plan.cases[next], study) {
                Ok(run) => running.push((next, run)),
                Err(error) => {
                    running.iter_mut().for_each(|(_, run)| run.kill());
                    return Err(error);
                }
            }
        }
        if running.is_empty() {
            break Ok(());
        }
        match look(plan, study, program, &mut running) {
            Ok(None) => std::thread::sleep(GLANCE),
            Ok(Some((index, outcome))) => {
                tell(&plan.cases[index], &outcome, true);
                outcomes[index] = Some(outcome);
            }
            // A signal to all processes reaches the runs as well.
            Err(_) if program.stop.reason().is_some() => break Err(StudyError::Stopped),
            Err(error) => break Err(error),
        }
    };
    running.iter_mut().for_each(|(_, run)| run.kill());
    result?;
    Ok(outcomes.into_iter().flatten().collect())
}

/// The first run that is over; it is taken out and its end kept.
fn look(
    plan: &Plan,
    study: &Path,
    program: &Program,
    running: &mut Vec<(usize, Running)>,
) -> Result<Option<(usize, Outcome)>, StudyError> {
    for place in 0..running.len() {
        let (index, run) = &mut running[place];
        let Some(status) = run.ended() else { continue };
        let index = *index;
        running.swap_remove(place);
        let case = &plan.cases[index];
        let system = |source| StudyError::System { path: case.folder(study), source };
        let outcome = child::outcome(program, status.map_err(system)?, study, case)?;
        Record::keep(study, case, outcome.clone())?;
        return Ok(Some((index, outcome)));
    }
    Ok(None)
}
