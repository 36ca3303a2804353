//! Starts the program, as one process or under `mpirun`, and waits for it, but not for ever.

use crate::message::Message;
use crate::program::program;
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::Read;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A guard against hangs only: far longer than any run here takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(240);

/// One MPI job at a time: the ranks of a job poll, and more of them than cores slow each other down.
static MPI_JOBS: Mutex<()> = Mutex::new(());

/// A command line of the program.
#[derive(Debug, Clone)]
pub struct Run {
    arguments: Vec<OsString>,
    processes: Option<(PathBuf, usize)>,
    folder: Option<PathBuf>,
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

    fn command(name: &str, scene: impl AsRef<Path>) -> Self {
        Self {
            arguments: vec![name.into(), scene.as_ref().into()],
            processes: None,
            folder: None,
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

    /// Runs as `mpirun -n PROCESSES` of a program built with MPI, one thread per rank.
    pub fn mpi(mut self, program: &Path, processes: usize) -> Self {
        self.processes = Some((program.into(), processes));
        self.threads(1)
    }

    /// Runs in this working folder.
    pub fn within(mut self, folder: &Path) -> Self {
        self.folder = Some(folder.into());
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
            None => Command::new(program()),
            Some((program, processes)) => {
                let mut command = Command::new("mpirun");
                command.arg("-n").arg(processes.to_string()).arg(program);
                command.envs(MPI_ENVIRONMENT);
                command
            }
        };
        command.args(&self.arguments);
        if let Some(folder) = &self.folder {
            command.current_dir(folder);
        }
        // Files, not pipes: nobody has to read while the program runs.
        let scratch = tempfile::tempdir().expect("a folder for what the program says");
        let file = |name| File::create(scratch.path().join(name)).expect("a scratch file");
        command.stdin(Stdio::null()).stdout(file("stdout")).stderr(file("stderr"));
        // A group of its own, so that a hanging job can be ended as a whole.
        command.process_group(0);
        let child = command.spawn().unwrap_or_else(|error| panic!("{command:?}: {error}"));
        let deadline = Instant::now() + self.patience;
        Running { line: format!("{command:?}"), child, scratch, deadline, _guard: guard }
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

/// A program that runs. It is ended when this is dropped.
#[derive(Debug)]
pub struct Running {
    line: String,
    child: Child,
    scratch: TempDir,
    deadline: Instant,
    _guard: Option<MutexGuard<'static, ()>>,
}

impl Running {
    /// Whether the program has ended by itself.
    ///
    /// # Panics
    ///
    /// When the system does not tell.
    pub fn has_ended(&mut self) -> bool {
        self.child.try_wait().expect("the child is ours").is_some()
    }

    /// Waits until `condition` holds or the program has ended; returns whether it holds.
    ///
    /// # Panics
    ///
    /// When neither happens for too long.
    #[track_caller]
    pub fn wait_for(&mut self, condition: impl Fn() -> bool) -> bool {
        loop {
            if condition() {
                return true;
            }
            if self.has_ended() {
                return condition();
            }
            self.pause();
        }
    }

    /// Waits for the end.
    ///
    /// # Panics
    ///
    /// When the program hangs.
    #[track_caller]
    pub fn wait(mut self) -> Outcome {
        while !self.has_ended() {
            self.pause();
        }
        self.outcome()
    }

    /// SIGKILL, now; the program has no chance to clean up.
    ///
    /// # Panics
    ///
    /// When the system refuses.
    pub fn kill(mut self) -> Outcome {
        self.child.kill().expect("the child is ours");
        self.outcome()
    }

    /// SIGKILL to one rank of an MPI job.
    ///
    /// # Panics
    ///
    /// When there are no ranks.
    pub fn kill_a_rank(&self) {
        let launcher = self.child.id();
        let children =
            std::fs::read_to_string(format!("/proc/{launcher}/task/{launcher}/children"));
        let children = children.expect("the launcher runs");
        let rank = children.split_whitespace().last().expect("mpirun has children");
        let killed = Command::new("kill").args(["-KILL", rank]).status();
        assert!(killed.is_ok_and(|status| status.success()), "{rank} was not killed");
    }

    #[track_caller]
    fn pause(&mut self) {
        if Instant::now() > self.deadline {
            let line = self.line.clone();
            let said = self.said("stderr");
            panic!("this does not end:\n{line}\n{said}");
        }
        sleep(Duration::from_millis(2));
    }

    fn outcome(&mut self) -> Outcome {
        let status = self.child.wait().expect("the child is ours");
        let (output, message) = (self.said("stdout"), Message(self.said("stderr")));
        Outcome { line: self.line.clone(), status, output, message }
    }

    fn said(&self, name: &str) -> String {
        let mut bytes = Vec::new();
        File::open(self.scratch.path().join(name))
            .and_then(|mut file| file.read_to_end(&mut bytes))
            .expect("the scratch file is there");
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(None)) {
            // mpirun ends its ranks when it is asked to, not when it is killed.
            signal("TERM", self.child.id());
            let patience = Instant::now() + Duration::from_secs(5);
            while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < patience {
                sleep(Duration::from_millis(20));
            }
            signal("KILL", self.child.id());
            let _ = self.child.wait();
        }
    }
}

/// Sends a signal to a process group.
fn signal(name: &str, group: u32) {
    let _ = Command::new("kill")
        .args([format!("-{name}"), "--".into(), format!("-{group}")])
        .stderr(Stdio::null())
        .status();
}

/// How a program ended.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The command line.
    pub line: String,
    /// Exit status.
    pub status: ExitStatus,
    /// Standard output.
    pub output: String,
    /// Standard error.
    pub message: Message,
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { line, status, output, message } = self;
        write!(f, "{line}\n{status}\n{output}\n{message}")
    }
}
