//! `sph new`: writes a scene to start from.

use super::{BAD_INPUT, FAILED, diagnostics};
use crate::run::shell_line;
use crate::scene::{Scene, Template};
use clap::Args;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub struct NewArguments {
    /// Name of the scene; the file is NAME.toml
    #[arg(value_name = "NAME")]
    name: PathBuf,
    /// What it is about
    #[arg(long, value_enum, default_value = "dam-break")]
    kind: Template,
    /// Number of space dimensions
    #[arg(long, value_name = "2|3", default_value = "2", value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: u8,
}

/// Why there is no new scene.
#[derive(Debug, thiserror::Error)]
enum NewError {
    #[error("{} is there already, and is left as it is: choose another name, or move it away", .0.display())]
    Exists(PathBuf),
    #[error("`{0}` cannot be the name of a scene: use letters, digits, - and _")]
    Name(String),
    #[error("cannot write {}: {source}", path.display())]
    Write { path: PathBuf, source: std::io::Error },
}

pub fn main(arguments: &NewArguments) -> ExitCode {
    match write(arguments) {
        Ok(path) => {
            let path = path.display().to_string();
            let next = shell_line(["sph", "run", &path]);
            let _ = writeln!(std::io::stdout(), "{path} is written; run it: {next}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            diagnostics::show_plain(&error);
            let is_system = matches!(error, NewError::Write { .. });
            ExitCode::from(if is_system { FAILED } else { BAD_INPUT })
        }
    }
}

fn write(arguments: &NewArguments) -> Result<PathBuf, NewError> {
    let (path, name) = named(&arguments.name)?;
    let text = arguments.kind.text(arguments.dimension.into(), &name);
    // What is no name for files is none for a scene.
    if Scene::parse("", text.clone(), &[]).is_err() {
        return Err(NewError::Name(name));
    }
    let failed = |source: std::io::Error| match source.kind() {
        ErrorKind::AlreadyExists => NewError::Exists(path.clone()),
        _ => NewError::Write { path: path.clone(), source },
    };
    let mut file = File::create_new(&path).map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(failed)?;
    Ok(path)
}

/// The file and the name of the scene.
fn named(name: &Path) -> Result<(PathBuf, String), NewError> {
    let bad = || NewError::Name(name.display().to_string());
    let file = name.file_name().and_then(|file| file.to_str()).ok_or_else(bad)?;
    let stem = file.strip_suffix(".toml").unwrap_or(file);
    Ok((name.with_file_name(format!("{stem}.toml")), stem.to_owned()))
}
