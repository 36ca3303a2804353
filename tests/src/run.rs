//! A command line of the program, as one process or under `mpirun`.

use crate::program::program;
use crate::running::{Outcome, Running};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A guard against hangs only: far longer than any run here takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(240);

/// One MPI job at a time: the ranks of a job poll, and more of them than cores slow each other down.
static MPI_JOBS: Mutex<()> = Mutex::new(());

/// A command line of the program.
#[derive(Debug, Clone)]
pub struct Run {
    arguments: Vec<OsString>,
    processes: Option<(PathBuf, usize)>,
    beside: Option<Box<Self>>,
    folder: Option<PathBuf>,
    memory_limit: Option<usize>,
    patience: Duration,
}

impl Run {
    /// `sph run SCENE --quiet`.
    pub fn new(scene: impl AsRef<Path>) -> Self {
        Self::command("run", scene).arg("--quiet")
    }

    /// `sph check SCENE`.
    pub fn check(scene: impl AsRef<Path>) -> Self {
        Self::command("check", scene)
    }

    /// `sph partition SCENE --ranks RANKS`.
    pub fn partition(scene: impl AsRef<Path>, ranks: &str) -> Self {
        Self::command("partition", scene).arg("--ranks").arg(ranks)
    }

    /// `sph study SCENE`, one run of one thread at a time.
    pub fn study(scene: impl AsRef<Path>) -> Self {
        Self::command("study", scene).arg("--jobs").arg("1")
    }

    /// `sph report FOLDER ...`.
    pub fn report<P: AsRef<Path>>(folders: &[P]) -> Self {
        let (first, rest) = folders.split_first().expect("a folder to report on");
        rest.iter().fold(Self::command("report", first), |run, folder| run.arg(folder.as_ref()))
    }

    /// `sph new NAME`.
    pub fn new_scene(name: impl AsRef<Path>) -> Self {
        Self::command("new", name)
    }

    fn command(name: &str, scene: impl AsRef<Path>) -> Self {
        Self {
            arguments: vec![name.into(), scene.as_ref().into()],
            processes: None,
            beside: None,
            folder: None,
            memory_limit: None,
            patience: PATIENCE,
        }
    }

    /// Adds an argument.
    pub fn arg(mut self, argument: impl AsRef<OsStr>) -> Self {
        self.arguments.push(argument.as_ref().into());
        self
    }

    /// Without `--quiet`.
    pub fn aloud(mut self) -> Self {
        self.arguments.retain(|argument| argument != "--quiet");
        self
    }

    /// Changes a value of the scene: `--set KEY=VALUE`.
    pub fn set(self, change: &str) -> Self {
        self.arg("--set").arg(change)
    }

    /// Folder for the results.
    pub fn out(self, folder: impl AsRef<Path>) -> Self {
        self.arg("--out").arg(folder.as_ref())
    }

    /// Ranks as threads of one process.
    pub fn ranks(self, ranks: usize) -> Self {
        self.arg("--ranks").arg(ranks.to_string())
    }

    /// Threads per rank.
    pub fn threads(self, threads: usize) -> Self {
        self.arg("--threads").arg(threads.to_string())
    }

    /// Simulated time at which the run ends, s.
    pub fn end_time(self, time: f64) -> Self {
        self.arg("--end-time").arg(time.to_string())
    }

    /// Simulated time between checkpoints, s.
    pub fn checkpoint_every(self, time: f64) -> Self {
        self.arg("--checkpoint-every").arg(time.to_string())
    }

    /// Goes on from the latest checkpoint.
    pub fn resume(self) -> Self {
        self.arg("--resume")
    }

    /// Removes what earlier runs have left in the folder.
    pub fn overwrite(self) -> Self {
        self.arg("--overwrite")
    }

    /// Runs as `mpirun -n PROCESSES` of a program built with MPI, one thread per rank.
    pub fn mpi(mut self, program: &Path, processes: usize) -> Self {
        self.processes = Some((program.into(), processes));
        // The program takes the option once.
        if self.arguments.iter().any(|argument| argument == "--threads") {
            self
        } else {
            self.threads(1)
        }
    }

    /// In the same MPI job, as later ranks, another command line, as if it were by mistake.
    pub fn beside(mut self, other: Self) -> Self {
        self.beside = Some(Box::new(other));
        self
    }

    /// Runs in this working folder.
    pub fn within(mut self, folder: &Path) -> Self {
        self.folder = Some(folder.into());
        self
    }

    /// With so many MiB of address space, as `ulimit -v` sets it.
    pub fn memory_limit(mut self, mebibytes: usize) -> Self {
        self.memory_limit = Some(mebibytes);
        self
    }

    /// Fails the test after this time instead of the usual one.
    pub fn patience(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }

    /// Starts the program.
    ///
    /// # Panics
    ///
    /// When it cannot be started.
    pub fn start(&self) -> Running {
        let guard = self
            .processes
            .is_some()
            .then(|| MPI_JOBS.lock().unwrap_or_else(PoisonError::into_inner));
        let mut command = match &self.processes {
            None => match self.memory_limit {
                None => Command::new(program()),
                Some(mebibytes) => {
                    let mut command = Command::new("sh");
                    let limit = format!("ulimit -v {}; exec \"$0\" \"$@\"", 1024 * mebibytes);
                    command.args(["-c", &limit]).arg(program());
                    command
                }
            },
            Some((program, processes)) => {
                let mut command = Command::new("mpirun");
                command.arg("-n").arg(processes.to_string()).arg(program);
                command.envs(MPI_ENVIRONMENT);
                command
            }
        };
        command.args(&self.arguments);
        if let Some(Self { arguments, processes: Some((program, processes)), .. }) =
            self.beside.as_deref()
        {
            command.args([":", "-n"]).arg(processes.to_string()).arg(program).args(arguments);
        }
        if let Some(folder) = &self.folder {
            command.current_dir(folder);
        }
        Running::start(command, self.patience, guard)
    }

    /// Runs to the end, whatever that is.
    ///
    /// # Panics
    ///
    /// When the program hangs.
    #[track_caller]
    pub fn finish(&self) -> Outcome {
        self.start().wait()
    }

    /// Runs to the end and asserts success.
    ///
    /// # Panics
    ///
    /// With the message of the program when it fails.
    #[track_caller]
    pub fn succeed(&self) -> Outcome {
        let outcome = self.finish();
        assert!(outcome.status.success(), "{outcome}");
        outcome
    }

    /// Runs to the end and asserts this exit code and a readable message.
    ///
    /// # Panics
    ///
    /// When the program ends in another way.
    #[track_caller]
    pub fn fail(&self, code: i32) -> Outcome {
        let outcome = self.finish();
        assert_eq!(outcome.status.code(), Some(code), "{outcome}");
        outcome.message.assert_readable();
        outcome
    }
}

/// OpenMPI 4 and 5 refuse root and more ranks than cores, and bind each job to the same cores,
/// unless told otherwise.
const MPI_ENVIRONMENT: [(&str, &str); 8] = [
    ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
    ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
    ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
    ("OMPI_MCA_hwloc_base_binding_policy", "none"),
    ("OMPI_MCA_mpi_yield_when_idle", "1"),
    ("OMPI_MCA_btl_base_warn_component_unused", "0"),
    ("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"),
    ("PRTE_MCA_hwloc_default_binding_policy", "none"),
];
