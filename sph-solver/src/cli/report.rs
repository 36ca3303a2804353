//! `sph report`: results as a page.

use super::{BAD_INPUT, FAILED, diagnostics};
use crate::report::report;
use clap::Args;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Folders with results of sph run; several are compared
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// The page [default: report.html in the folder, comparison.html in the first of several]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub fn main(arguments: &ReportArguments) -> ExitCode {
    let page = match report(&arguments.folders) {
        Ok(page) => page,
        Err(error) => {
            diagnostics::show_plain(&error);
            return ExitCode::from(BAD_INPUT);
        }
    };
    let out = arguments.out.clone().unwrap_or_else(|| {
        let name = if arguments.folders.len() > 1 { "comparison.html" } else { "report.html" };
        arguments.folders[0].join(name)
    });
    if let Err(error) = sph_io::write_text_atomically(&out, &page) {
        diagnostics::show_plain(&error);
        return ExitCode::from(FAILED);
    }
    let _ = writeln!(std::io::stdout(), "{}", out.display());
    ExitCode::SUCCESS
}
