//! `sph completions` and `sph man`: the command line, told to shells and to `man`.

use super::{Arguments, FAILED, diagnostics};
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

#[derive(Debug, Args)]
pub struct ManArguments {
    /// Folder for the pages sph.1, sph-run.1, …
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Writes a completion script on standard output.
pub fn completions(arguments: &CompletionsArguments) -> ExitCode {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "sph", &mut script);
    let _ = std::io::stdout().write_all(&script);
    ExitCode::SUCCESS
}

/// Writes the manual pages of the program and of its commands.
pub fn man(arguments: &ManArguments) -> ExitCode {
    let folder = &arguments.folder;
    let written = std::fs::create_dir_all(folder).and_then(|()| {
        clap_mangen::generate_to(Arguments::command().disable_help_subcommand(true), folder)
    });
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let message = format!("cannot write manual pages into {}: {error}", folder.display());
            diagnostics::show_plain(&std::io::Error::other(message));
            ExitCode::from(FAILED)
        }
    }
}
