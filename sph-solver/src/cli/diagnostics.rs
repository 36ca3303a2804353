//! Shows errors: with colours and boxes on a terminal, as plain text elsewhere.

use crate::scene::{ErrorKind, SceneError};
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::io::{IsTerminal, Write, stderr};

/// Shows what is wrong with a scene. Under mpirun all ranks read the same scene, so that the first
/// one speaks for all, unless a file is at fault, which another machine may well have.
pub fn show_scene_error(error: &SceneError) {
    let of_this_machine =
        matches!(error.kind(), ErrorKind::Unreadable { .. } | ErrorKind::Mesh { .. });
    if of_this_machine || !is_later_rank() {
        show(error);
    }
}

/// Shows an error on standard error.
pub fn show(error: &dyn miette::Diagnostic) {
    let terminal = stderr().is_terminal();
    let _ = stderr().write_all(render(error, terminal).as_bytes());
}

/// Shows an error that has no place in a text.
pub fn show_plain(error: &dyn std::error::Error) {
    let _ = writeln!(stderr(), "error: {error}");
}

/// Shows a remark that is no error.
pub fn show_note(note: &str) {
    let _ = writeln!(stderr(), "note: {note}");
}

fn render(error: &dyn miette::Diagnostic, terminal: bool) -> String {
    let handler = if terminal {
        GraphicalReportHandler::new()
    } else {
        let mut theme = GraphicalTheme::none();
        theme.characters.error = "error:".into();
        GraphicalReportHandler::new_themed(theme).with_links(false).with_wrap_lines(false)
    };
    let mut text = String::new();
    match handler.render_report(&mut text, error) {
        Ok(()) => text,
        // A message without its frame is better than none.
        Err(_) => format!("error: {error}\n"),
    }
}

/// Whether this process is a rank other than 0 of an MPI job, as the usual launchers tell it.
pub fn is_later_rank() -> bool {
    const RANK_VARIABLES: [&str; 3] = ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"];
    let rank = RANK_VARIABLES.iter().find_map(|name| std::env::var(name).ok());
    rank.is_some_and(|rank| rank != "0")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn plain_messages_name_file_line_and_way_out() {
        let text = "dimension = 2\nend_time = 1\n[numerics]\nspacng = 0.1\n";
        let error = Scene::parse("a.toml", text.into(), &[]).unwrap_err();
        let message = render(&error, false);
        for part in ["error: unknown key `spacng`", "a.toml:4:1", "help: did you mean `spacing`?"] {
            assert!(message.contains(part), "{message}");
        }
        assert!(message.is_ascii() && !message.contains('\u{1b}'), "{message}");
    }
}
