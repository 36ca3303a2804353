//! A program that runs, and how it ended: waited for, but not for ever.

use crate::message::Message;
use std::fs::File;
use std::io::Read;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::MutexGuard;
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A program that runs. It is ended when this is dropped.
#[derive(Debug)]
pub struct Running {
    line: String,
    child: Child,
    scratch: TempDir,
    deadline: Instant,
    _turn: Option<MutexGuard<'static, ()>>,
}

impl Running {
    /// Starts a command, which fails the test when it takes longer than `patience`, and keeps its
    /// turn among MPI jobs until it has ended.
    pub(crate) fn start(
        mut command: Command,
        patience: Duration,
        turn: Option<MutexGuard<'static, ()>>,
    ) -> Self {
        // Files, not pipes: nobody has to read while the program runs.
        let scratch = tempfile::tempdir().expect("a folder for what the program says");
        let file = |name| File::create(scratch.path().join(name)).expect("a scratch file");
        command.stdin(Stdio::null()).stdout(file("stdout")).stderr(file("stderr"));
        // A group of its own, so that a hanging job can be ended as a whole.
        command.process_group(0);
        let child = command.spawn().unwrap_or_else(|error| panic!("{command:?}: {error}"));
        let deadline = Instant::now() + patience;
        Self { line: format!("{command:?}"), child, scratch, deadline, _turn: turn }
    }

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

    /// Sends a signal, such as `TERM`, to the program alone.
    ///
    /// # Panics
    ///
    /// When the system refuses.
    pub fn signal(&self, name: &str) {
        let process = self.child.id().to_string();
        let sent = Command::new("kill").args([&format!("-{name}"), &process]).status();
        assert!(sent.is_ok_and(|status| status.success()), "no signal {name} to {process}");
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
