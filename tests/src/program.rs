//! Where the built programs are.

use std::env;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The program of the default build.
///
/// # Panics
///
/// When it has not been built.
pub fn program() -> PathBuf {
    let path = match env::var_os("SPH_PROGRAM") {
        Some(path) => PathBuf::from(path),
        None => target().join("release/sph"),
    };
    path.canonicalize().unwrap_or_else(|error| {
        panic!(
            "the program {} is not there ({error}): build it with `cargo build --release`, or name \
             it in SPH_PROGRAM",
            path.display()
        )
    })
}

/// Cargo's target folder: the tests lie in it under PROFILE/deps.
fn target() -> PathBuf {
    let test = env::current_exe().expect("the system names this program");
    test.ancestors().nth(3).map_or_else(|| workspace().join("target"), Into::into)
}

/// The program built with the feature `mpi`, or `None`, said on standard error, when
/// `SPH_MPI_PROGRAM` names none. `what` is what is left out then.
///
/// # Panics
///
/// When the variable names a program that is not there.
pub fn mpi_program(what: &str) -> Option<PathBuf> {
    let Some(path) = env::var_os("SPH_MPI_PROGRAM").map(PathBuf::from) else {
        skipped(what, "SPH_MPI_PROGRAM names no program built with --features mpi");
        return None;
    };
    Some(path.canonicalize().unwrap_or_else(|error| {
        panic!("SPH_MPI_PROGRAM names {}, which is not there ({error})", path.display())
    }))
}

/// Says that something was not tested, past the test runner's capture so that it is seen.
pub fn skipped(what: &str, why: &str) {
    let _ = writeln!(std::io::stderr(), "SKIPPED: {what}: {why}");
}

/// Root of the workspace.
///
/// # Panics
///
/// Never: the package lies in it.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package lies in the workspace")
}
