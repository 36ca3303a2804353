//! The book in `docs/` and the README: commands run, links lead somewhere, and what is said of the code is so.

use sph_tests::{Chapter, chapters, program, skipped, workspace};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

/// Largest picture, bytes.
const MOST_BYTES: u64 = 150_000;

#[track_caller]
fn assert_runs(page: &str) {
    let outcome = Chapter::read(page).run().expect("the page has commands");
    assert!(outcome.status.success(), "{page}: {outcome}");
}

#[test]
fn the_commands_of_the_readme_run() {
    assert_runs("README.md");
}

#[test]
fn the_commands_of_the_tutorial_run() {
    assert_runs("docs/tutorial.md");
}

#[test]
fn the_commands_of_the_other_pages_run() {
    let others = chapters().into_iter().filter(|chapter| {
        // Tables of results say what made them.
        !chapter.path.starts_with("docs/results")
            && !["README.md", "docs/tutorial.md"].iter().any(|path| chapter.path == Path::new(path))
    });
    for chapter in others {
        if let Some(outcome) = chapter.run() {
            assert!(outcome.status.success(), "{}: {outcome}", chapter.path.display());
        }
    }
}

#[test]
fn the_scene_of_the_tutorial_is_what_the_page_says() {
    let page = Chapter::read("docs/tutorial.md");
    let scene = Chapter::read("docs/tutorial/flood.toml");
    let house = page.fences().into_iter().find(|fence| fence.kind == "toml").unwrap();
    assert!(scene.text.contains(&house.text), "{}", house.text);
}

/// Commands of a block: what stands between `&&`, `|`, `;` and line ends, without comments.
fn commands(block: &str) -> Vec<Vec<String>> {
    let joined = block.replace("\\\n", " ");
    let lines = joined.lines().map(|line| line.split(" #").next().unwrap_or_default());
    let parts = lines.flat_map(|line| line.split(['|', ';']).flat_map(|part| part.split("&&")));
    let words = |part: &str| -> Vec<String> { part.split_whitespace().map(Into::into).collect() };
    parts.map(words).filter(|words| !words.is_empty() && words[0] != "#").collect()
}

fn help(cache: &mut BTreeMap<String, String>, subcommand: &str) -> String {
    let make = || {
        let output = Command::new(program()).args([subcommand, "--help"]).output().unwrap();
        assert!(output.status.success(), "there is no `sph {subcommand}`");
        String::from_utf8(output.stdout).unwrap()
    };
    cache.entry(subcommand.into()).or_insert_with(make).clone()
}

#[test]
fn commands_that_are_not_run_have_known_options_and_files() {
    let mut helps = BTreeMap::new();
    let mut seen = 0;
    for chapter in chapters() {
        let path = chapter.path.display().to_string();
        for fence in chapter.fences().iter().filter(|fence| fence.kind.starts_with("sh")) {
            assert!(["sh", "sh,no-run"].contains(&fence.kind.as_str()), "{path}: {}", fence.kind);
            for words in commands(&fence.text) {
                let line = words.join(" ");
                let after = |word: &str| words.iter().position(|w| w == word).map(|k| k + 1);
                // The program by its name, by its path, under mpirun, or through cargo.
                let of_program = words
                    .iter()
                    .position(|word| word == "sph" || word.ends_with("release/sph"))
                    .map(|k| k + 1)
                    .filter(|&k| k == 1 || words[0] == "mpirun")
                    .or_else(|| {
                        after("--").filter(|_| line.starts_with("cargo run --release -- "))
                    });
                if let Some(first) = of_program {
                    let help = help(&mut helps, &words[first]);
                    for option in words[first..].iter().filter(|word| word.starts_with("--")) {
                        let name = option.split('=').next().unwrap_or_default();
                        assert!(help.contains(name), "{path}: {line}: there is no {name}");
                    }
                    seen += 1;
                }
                for (word, folder) in [("--example", "examples"), ("--bin", "src/bin")] {
                    let (Some(name), Some(package)) = (after(word), after("-p")) else { continue };
                    let package = words[package].replace("sph-benches", "benches");
                    let file = workspace().join(package).join(folder).join(&words[name]);
                    assert!(file.is_dir() || file.with_extension("rs").is_file(), "{path}: {line}");
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 20, "{seen}");
}

/// A path without `..`.
fn tidy(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(tidy.pop()),
            part => tidy.push(part),
        }
    }
    tidy
}

#[test]
fn links_lead_somewhere() {
    let mut broken = Vec::new();
    let mut pages = chapters();
    pages.push(Chapter::read("docs/SUMMARY.md"));
    for chapter in &pages {
        let folder = chapter.path.parent().unwrap();
        for link in chapter.links() {
            if link.starts_with("https://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target =
                if file.is_empty() { chapter.path.clone() } else { tidy(&folder.join(file)) };
            let there = workspace().join(&target).exists();
            let fits = anchor.is_empty()
                || there && Chapter::read(&target).anchors().iter().any(|have| have == anchor);
            // The book holds nothing from outside of its folder.
            let inside = !chapter.path.starts_with("docs") || target.starts_with("docs");
            if !(there && fits && inside) {
                broken.push(format!("{}: {link}", chapter.path.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn the_table_of_contents_has_every_page() {
    let summary = Chapter::read("docs/SUMMARY.md");
    let mut listed: Vec<PathBuf> =
        summary.links().iter().map(|link| Path::new("docs").join(link)).collect();
    let pages = chapters().into_iter().map(|chapter| chapter.path);
    let mut there: Vec<PathBuf> = pages.filter(|path| path.starts_with("docs")).collect();
    listed.sort();
    there.sort();
    assert_eq!(listed, there);
}

#[test]
fn pictures_are_small() {
    fn visit(folder: &Path, seen: &mut usize) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && !path.ends_with("docs/book") {
                visit(&path, seen);
            } else if path.extension().is_some_and(|end| end == "png" || end == "svg") {
                let bytes = fs::metadata(&path).unwrap().len();
                assert!(bytes < MOST_BYTES, "{}: {bytes}", path.display());
                *seen += 1;
            }
        }
    }
    let mut seen = 0;
    visit(&workspace().join("docs"), &mut seen);
    assert!(seen > 4);
}

#[test]
fn every_term_is_in_the_theory() {
    let theory = Chapter::read("docs/theory.md").text;
    for entry in fs::read_dir(workspace().join("sph-solver/src/terms")).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        let own = text.split("#[cfg(test)]").next().unwrap();
        // Terms are what implements one of the two traits.
        for part in own.split(" for ").skip(1) {
            let name: String = part.chars().take_while(|c| c.is_alphanumeric()).collect();
            let is_type = name.starts_with(char::is_uppercase);
            let is_term = own.contains("Term<D, ") && own.contains(&format!("pub struct {name}"));
            if is_type && is_term {
                assert!(theory.contains(&format!("`{name}`")), "{name} of {}", path.display());
            }
        }
    }
}

/// Lines as they are compared: without indentation.
fn lines(text: &str) -> Vec<&str> {
    text.lines().map(str::trim).collect()
}

#[test]
fn changes_of_the_page_about_extending_fit_the_sources() {
    let page = Chapter::read("docs/extending.md");
    let sources: Vec<String> = [
        "sph-solver/examples/own_term.rs",
        "sph-solver/examples/dam_break_by_hand.rs",
        "sph-decomp/src/comm/mod.rs",
    ]
    .map(|file| fs::read_to_string(workspace().join(file)).unwrap())
    .into();
    let mut found = [0; 2];
    for fence in page.fences() {
        if fence.kind == "rust" {
            let there = sources.iter().any(|source| source.contains(&fence.text));
            assert!(there, "this is in none of the sources:\n{}", fence.text);
            found[0] += 1;
        } else if fence.kind == "diff" {
            let (head, change) = fence.text.split_once('\n').unwrap();
            let file = head.strip_prefix("--- ").expect("the file that is changed");
            let source = fs::read_to_string(workspace().join(file)).unwrap();
            let old: Vec<&str> = change
                .lines()
                .filter(|line| !line.starts_with('+'))
                .map(|line| line[1..].trim())
                .collect();
            let there = lines(&source).windows(old.len()).any(|window| window == old);
            assert!(there, "{file} has no such lines:\n{}", old.join("\n"));
            found[1] += 1;
        }
    }
    assert!(found[0] >= 4 && found[1] >= 4, "{found:?}");
}

/// The rows of the accuracy table: case, runs, ours, bar.
fn rows(text: &str, columns: [usize; 4], width: usize) -> Vec<[String; 4]> {
    let mut rows: Vec<[String; 4]> = Vec::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        if !line.starts_with("| ") || cells.len() != width {
            continue;
        }
        let mut row = columns.map(|column| cells[column].to_owned());
        let name = row[0].split(']').next().unwrap_or_default();
        row[0] = name.trim_matches(['[', '`']).to_owned();
        if row[0].is_empty() {
            row[0] = rows.last().map_or_else(String::new, |row| row[0].clone());
        }
        rows.push(row);
    }
    rows
}

#[test]
fn the_readme_has_the_results_of_the_accuracy_table() {
    let accuracy = rows(&Chapter::read("docs/results/accuracy.md").text, [0, 2, 4, 5], 9);
    let bars: Vec<_> = accuracy.iter().filter(|row| row[3] != "–" && row[0] != "case").collect();
    let readme = rows(&Chapter::read("README.md").text, [0, 2, 3, 4], 5);
    let shown: Vec<_> = readme.iter().filter(|row| row[0] != "case").collect();
    assert_eq!(shown, bars, "copy the rows with a bar from docs/results/accuracy.md to README.md");
    assert!(shown.iter().any(|row| row[2].contains('✗')));
}

#[test]
fn the_book_can_be_made() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new("mdbook")
        .args(["build", "docs", "--dest-dir"])
        .arg(folder.path())
        .current_dir(workspace())
        .output();
    let Ok(output) = output else {
        return skipped("the book", "there is no mdbook (cargo install mdbook)");
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("WARN"), "{said}");
    for page in ["tutorial.html", "scene.html", "results/accuracy.html", "tutorial/flow.png"] {
        assert!(folder.path().join(page).is_file(), "{page}");
    }
}
