//! All that determines the result of a run of a study, as lines of text.

use crate::run::digest::Digest;
use crate::scene::Scene;
use std::fmt::Write;
use std::path::PathBuf;
use toml::{Table, Value};

/// A line for each value of the scene as it is run, for the program, and for each file that the scene
/// names. Remarks, titles and bars leave the result alone and are not in it.
pub fn of(scene: &Scene) -> String {
    let mut table: Table = scene.text().parse().unwrap_or_default();
    table.remove("study");
    if let Some(Value::Table(reference)) = table.get_mut("reference") {
        // Only fields over particles are compared while a run goes on.
        reference.retain(|key, _| ["velocity", "pressure", "scale"].contains(&key));
    }
    let mut files = Vec::new();
    meshes(&table, &mut files);
    let mut lines = format!("sph {}\n", env!("CARGO_PKG_VERSION"));
    flatten("", &Value::Table(table), &mut lines);
    for change in scene.overrides() {
        let _ = writeln!(lines, "--set {change}");
    }
    for file in files {
        let bytes = std::fs::read(scene.resolve(&file)).unwrap_or_default();
        let _ = writeln!(lines, "{} has digest {}", file.display(), digest(&bytes));
    }
    lines
}

fn digest(bytes: &[u8]) -> String {
    let mut digest = Digest::default();
    for (number, chunk) in bytes.chunks(8).enumerate() {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        digest.add(number as u64, [f64::from_le_bytes(word), chunk.len() as f64]);
    }
    digest.to_string()
}

/// Files of meshes that a table names.
fn meshes(table: &Table, files: &mut Vec<PathBuf>) {
    for (key, value) in table {
        match value {
            Value::String(path) if key == "mesh" => files.push(path.into()),
            Value::Table(inner) => meshes(inner, files),
            Value::Array(elements) => {
                elements.iter().filter_map(Value::as_table).for_each(|inner| meshes(inner, files));
            }
            _ => (),
        }
    }
}

fn flatten(path: &str, value: &Value, lines: &mut String) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, value, lines);
            }
        }
        Value::Array(elements) => {
            for (number, value) in elements.iter().enumerate() {
                flatten(&format!("{path}.{number}"), value, lines);
            }
        }
        Value::String(text) => {
            let _ = writeln!(lines, "{path} = {:?}", text.split_whitespace().collect::<Vec<_>>());
        }
        other => {
            let _ = writeln!(lines, "{path} = {other}");
        }
    }
}

/// The lines in which two identities differ, the present ones first.
pub fn difference(now: &str, then: &str) -> String {
    let missing = |from: &str, other: &str, word: &str| {
        let has = |line: &&str| !other.lines().any(|other| other == *line);
        from.lines().filter(has).map(|line| format!("  {word} {line}\n")).collect::<String>()
    };
    missing(now, then, "now: ") + missing(then, now, "then:").trim_end_matches('\n')
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "dimension = 2\nend_time = 1\n[numerics]\nspacing = 0.1\nsound_speed = 1\n\
        [fluid.water]\ndensity = 1\nregions = [{ box = { min = [0, 0], max = [1, 1] } }]\n\
        [reference]\nvelocity = [\"x\", \"y\"]\nremark = \"a\"\n";

    fn identity(text: &str, changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
        of(&Scene::parse("a.toml", text.into(), &changes).unwrap())
    }

    #[test]
    fn only_what_matters_is_in_it() {
        let first = identity(TEXT, &[]);
        assert_eq!(first, identity(&TEXT.replace("\"a\"", "\"b\"  # c"), &[]));
        for (other, line) in [
            (identity(&TEXT.replace("0.1", "0.2"), &[]), "now:  numerics.spacing = 0.2"),
            (identity(TEXT, &["numerics.cfl=0.5"]), "now:  --set numerics.cfl=0.5"),
            (identity(&TEXT.replace("\"y\"", "\"t\""), &[]), "reference.velocity.1"),
        ] {
            assert_ne!(first, other);
            let difference = difference(&other, &first);
            assert!(difference.contains(line), "{difference}");
        }
    }
}
