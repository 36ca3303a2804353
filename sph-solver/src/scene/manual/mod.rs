//! The page about scene files in the documentation: every key with its type, its meaning and an example.
//!
//! Types and meanings are those of the JSON schema, examples are in [`examples`], and a test reads a scene with
//! each of them.

mod examples;
#[cfg(test)]
mod frames;
mod kinds;
#[cfg(test)]
mod tests;

use super::schema::json_schema;
use examples::{TABLES, Table};
use kinds::{choices, kind};
use serde_json::Value;
use std::fmt::Write;

const BEFORE: &str = "# Scene files

<!-- Made of the schema by `cargo run -p sph-solver --example scene_manual > docs/scene.md`; do not edit. -->

A scene is a TOML file in SI units: metres, kilograms, seconds, pascals. Lists of coordinates have one number per
dimension. Keys that are not known are refused, with the line and the nearest key that is; `sph check SCENE` reads
everything and runs nothing, and `--set TABLE.KEY=VALUE` changes a value for one command. Editors complete
keys with the JSON schema `sph-solver/scene.schema.json` when the first line names it: `#:schema PATH`.

`sph new NAME` writes a commented scene to start from; the [tutorial](tutorial.md) goes from there to a load.
";

/// The page as Markdown.
pub fn manual() -> String {
    let schema: Value = serde_json::from_str(&json_schema()).unwrap_or_default();
    let mut page = BEFORE.to_owned();
    for table in TABLES {
        // Writing to a string does not fail.
        let _ = section(&mut page, &schema, table);
    }
    page + &formulas(&schema)
}

/// The schema of a table: a definition, or all of it for the scene itself.
fn definition<'a>(schema: &'a Value, name: &str) -> &'a Value {
    if name.is_empty() { schema } else { &schema["$defs"][name] }
}

/// A description on one line.
fn description(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

fn section(page: &mut String, schema: &Value, table: &Table) -> std::fmt::Result {
    let own = definition(schema, table.definition);
    writeln!(page, "\n## {}\n\n{}", table.title, description(own))?;
    if !table.words.is_empty() {
        writeln!(page, "{}", table.words)?;
    }
    writeln!(page, "\n| key | value | meaning | example |\n|---|---|---|---|")?;
    let required: Vec<&str> =
        own["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let mut lists = String::new();
    for (key, example) in table.examples {
        let property = &own["properties"][key];
        let mut value = kind(schema, property);
        if required.contains(key) {
            value += ", required";
        }
        let default = &property["default"];
        if !default.is_null() && *default != Value::Array(Vec::new()) {
            write!(value, ", else `{default}`")?;
        }
        let meaning = description(property);
        let example = example.replace('|', "\\|");
        writeln!(page, "| `{key}` | {value} | {meaning} | `{key} = {example}` |")?;
        if let Some(choices) = choices(schema, property) {
            writeln!(lists, "\n`{key}` is one of\n")?;
            for (choice, words) in choices {
                writeln!(lists, "* `{choice}`: {words}")?;
            }
        }
    }
    page.push_str(&lists);
    Ok(())
}

fn formulas(schema: &Value) -> String {
    let [fixed, timed] =
        ["Formula", "TimedFormula"].map(|name| description(&schema["$defs"][name]));
    format!(
        "\n## Formulas\n\nA number, or a text that is computed. At the start of a run: {fixed}. Over time: {timed}. \
         Formulas cannot do anything but compute; they have at most 4096 characters and 100 levels of \
         parentheses.\n"
    )
}
