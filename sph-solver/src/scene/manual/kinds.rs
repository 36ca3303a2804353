//! The type of a key in words.

use super::description;
use super::examples::TABLES;
use serde_json::Value;

/// What a key takes: its type and its range.
pub fn kind(schema: &Value, property: &Value) -> String {
    if let Some(name) = reference(property) {
        return named(schema, name);
    }
    let only = |word: &str| match &property["type"] {
        Value::String(kind) => kind == word,
        // A key that may be left out may be null, which TOML does not have.
        Value::Array(kinds) => kinds.iter().any(|kind| kind == word),
        _ => false,
    };
    if only("array") {
        return format!("list: {}", kind(schema, &property["items"]));
    }
    if only("object") {
        return format!("by name: {}", kind(schema, &property["additionalProperties"]));
    }
    let words = [("number", "number"), ("integer", "whole number"), ("string", "text")];
    let word = words.iter().find(|(kind, _)| only(kind)).map_or("true or false", |(_, word)| word);
    format!("{word}{}", range(property))
}

/// The words that a key takes, with their meanings, if it takes words; those of a list of words too.
pub fn choices(schema: &Value, property: &Value) -> Option<Vec<(String, String)>> {
    let name = reference(property).or_else(|| reference(&property["items"]))?;
    let words = schema["$defs"][name]["oneOf"].as_array()?;
    let pair = |word: &Value| (word["const"].to_string(), description(word));
    Some(words.iter().map(pair).collect())
}

/// The definition that a key refers to, alone or beside null.
fn reference(property: &Value) -> Option<&str> {
    let direct = property["$ref"].as_str();
    let choice = || property["anyOf"].as_array()?.iter().find_map(|one| one["$ref"].as_str());
    direct.or_else(choice)?.strip_prefix("#/$defs/")
}

fn named(schema: &Value, name: &str) -> String {
    let own = &schema["$defs"][name];
    let link =
        |title: &str| format!("[{}](#{})", title.replace(['`', '[', ']'], ""), anchor(title));
    if let Some(table) = TABLES.iter().find(|table| table.definition == name) {
        return format!("table {}", link(table.title));
    }
    if own["oneOf"].is_array() {
        return "word of the list below".into();
    }
    match name {
        "Formula" | "TimedFormula" => "[formula](#formulas)".into(),
        "Pressure" => "`\"hydrostatic\"` or a [formula](#formulas)".into(),
        "Rotation" => format!("degrees, or table {}", link("`rotate`")),
        _ => description(own),
    }
}

/// What a heading is called in links.
pub fn anchor(title: &str) -> String {
    let kept = |c: char| match c {
        ' ' => Some('-'),
        c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c.to_ascii_lowercase()),
        _ => None,
    };
    title.chars().filter_map(kept).collect()
}

fn range(property: &Value) -> String {
    let bound = |key: &str| property[key].as_f64();
    let low = bound("minimum")
        .map(|low| format!("≥ {low}"))
        .or_else(|| bound("exclusiveMinimum").map(|low| format!("> {low}")));
    let high = bound("maximum").map(|high| format!("≤ {high}"));
    match (low, high) {
        (Some(low), Some(high)) => format!(" {low}, {high}"),
        (Some(one), None) | (None, Some(one)) => format!(" {one}"),
        (None, None) => String::new(),
    }
}
