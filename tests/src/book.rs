//! The pages for users: the book in `docs/` and the README of the project.

use crate::program::{program, workspace};
use crate::running::{Outcome, Running};
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// A guard against hangs only.
const PATIENCE: Duration = Duration::from_secs(600);

/// A fenced block of a page.
#[derive(Debug, Clone, PartialEq)]
pub struct Fence {
    /// What stands behind the opening fence, such as `sh` or `sh,no-run`.
    pub kind: String,
    /// Its lines.
    pub text: String,
}

/// A page in Markdown.
#[derive(Debug, Clone)]
pub struct Chapter {
    /// Its place in the workspace.
    pub path: PathBuf,
    /// All of it.
    pub text: String,
}

/// The README and all pages of the book, but for its table of contents.
///
/// # Panics
///
/// When they cannot be read.
pub fn chapters() -> Vec<Chapter> {
    let mut paths = vec![PathBuf::from("README.md")];
    collect(Path::new("docs"), &mut paths);
    paths.sort();
    paths.into_iter().map(Chapter::read).collect()
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(workspace().join(folder)).expect("the folder is there") {
        let name = entry.expect("a readable folder").file_name();
        let path = folder.join(&name);
        // What mdBook has made is not part of the source.
        if workspace().join(&path).is_dir() && name != "book" {
            collect(&path, paths);
        } else if path.extension().is_some_and(|end| end == "md") && name != "SUMMARY.md" {
            paths.push(path);
        }
    }
}

impl Chapter {
    /// Reads a page of the workspace.
    ///
    /// # Panics
    ///
    /// When there is none.
    pub fn read(path: impl AsRef<Path>) -> Self {
        let path = path.as_ref();
        let text = fs::read_to_string(workspace().join(path));
        let text = text.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Self { path: path.into(), text }
    }

    /// Its fenced blocks, indented ones too.
    pub fn fences(&self) -> Vec<Fence> {
        let mut fences = Vec::new();
        let mut open: Option<Fence> = None;
        for line in self.text.lines() {
            match (line.trim_start().strip_prefix("```"), open.take()) {
                (None, None) => (),
                (None, Some(mut fence)) => {
                    fence.text.push_str(line);
                    fence.text.push('\n');
                    open = Some(fence);
                }
                (Some(kind), None) => {
                    open = Some(Fence { kind: kind.into(), text: String::new() });
                }
                (Some(_), Some(fence)) => fences.push(fence),
            }
        }
        assert!(open.is_none(), "{}: a block does not end", self.path.display());
        fences
    }

    /// Its text without blocks and code in lines: where links are.
    pub fn prose(&self) -> String {
        let mut within = false;
        let outside = |line: &&str| {
            let fence = line.trim_start().starts_with("```");
            within ^= fence;
            !within && !fence
        };
        self.text.lines().filter(outside).map(|line| format!("{line}\n")).collect()
    }

    /// What its headings are called in links.
    pub fn anchors(&self) -> Vec<String> {
        let prose = self.prose();
        let headings = prose.lines().filter_map(|line| line.strip_prefix('#'));
        headings.map(|line| anchor(line.trim_start_matches('#').trim())).collect()
    }

    /// Where its links and pictures lead.
    pub fn links(&self) -> Vec<String> {
        let prose = self.prose();
        let ends = prose.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
        ends.map(|(link, _)| link.to_owned()).collect()
    }

    /// Runs its blocks of kind `sh`, one after the other as one script, in a copy of what a clone has: scenes and
    /// pages. Returns `None` when there are none.
    ///
    /// # Panics
    ///
    /// When the copy cannot be made, or the script hangs.
    pub fn run(&self) -> Option<Outcome> {
        let blocks: Vec<String> =
            self.fences().into_iter().filter(|f| f.kind == "sh").map(|f| f.text).collect();
        if blocks.is_empty() {
            return None;
        }
        let folder = tempfile::tempdir().expect("a scratch folder");
        let clone = folder.path().join("clone");
        for part in ["scenes", "docs", "packaging"] {
            copy_tree(&workspace().join(part), &clone.join(part));
        }
        let bin = folder.path().join("bin");
        fs::create_dir(&bin).expect("a scratch folder");
        symlink(program(), bin.join("sph")).expect("a link to the program");
        let cargo = bin.join("cargo");
        fs::write(&cargo, CARGO).expect("a scratch file");
        fs::set_permissions(&cargo, fs::Permissions::from_mode(0o755)).expect("our own file");
        let path = std::env::var("PATH").unwrap_or_default();
        let mut command = Command::new("sh");
        command.arg("-ec").arg(blocks.concat()).current_dir(&clone);
        command.env("PATH", format!("{}:{path}", bin.display())).env("HOME", folder.path());
        Some(Running::start(command, PATIENCE, None).wait())
    }
}

/// The program has been built already; all else that cargo does is not for pages that are run.
const CARGO: &str = r#"#!/bin/sh
case "$*" in
    "run --release -- "*) shift 3; exec sph "$@" ;;
esac
echo "cargo $*: mark the block sh,no-run" >&2
exit 1
"#;

fn copy_tree(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a scratch folder");
    for entry in fs::read_dir(from).expect("the folder is there") {
        let entry = entry.expect("a readable folder");
        let (path, copy) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_tree(&path, &copy);
        } else {
            fs::copy(&path, &copy).expect("a readable file");
        }
    }
}

/// What a heading is called in links: GitHub and mdBook agree as long as no two are alike.
pub fn anchor(heading: &str) -> String {
    let kept = |c: char| match c {
        ' ' => Some('-'),
        c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c.to_ascii_lowercase()),
        _ => None,
    };
    heading.chars().filter_map(kept).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_links_and_headings_are_found() {
        let text =
            "# A `b` c\n[x](y.md#z) and ![p](q.png)\n```sh\n# not a heading\nls [a](b)\n```\n";
        let chapter = Chapter { path: "t.md".into(), text: text.into() };
        assert_eq!(chapter.links(), ["y.md#z", "q.png"]);
        assert_eq!(chapter.anchors(), ["a-b-c"]);
        let fence = Fence { kind: "sh".into(), text: "# not a heading\nls [a](b)\n".into() };
        assert_eq!(chapter.fences(), [fence]);
    }
}
