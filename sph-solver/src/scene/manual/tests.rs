use super::frames::{PLANE, SPACE, frames};
use super::*;
use crate::scene::Scene;

#[test]
fn shipped_page_is_up_to_date() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/scene.md");
    // A package of this crate alone has no book.
    let Ok(shipped) = std::fs::read_to_string(path) else { return };
    assert!(
        shipped == manual(),
        "docs/scene.md is out of date; write it again with\n    \
         cargo run -p sph-solver --example scene_manual > docs/scene.md"
    );
}

/// Whether the scene can be read when the example stands in one of the frames of its table.
fn works(table: &Table, key: &str, example: &str) -> Result<(), Vec<String>> {
    let mut refusals = Vec::new();
    for (place, before) in frames(table.definition) {
        let (text, place) = match place.strip_prefix("3:") {
            Some(place) => (SPACE, place),
            None => (PLANE, *place),
        };
        let path = if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
        let changes: Vec<String> =
            before.iter().map(ToString::to_string).chain([format!("{path}={example}")]).collect();
        match Scene::parse("frame.toml", text.into(), &changes) {
            Ok(_) => return Ok(()),
            Err(error) => refusals.push(error.to_string()),
        }
    }
    Err(refusals)
}

#[test]
fn every_example_is_read() {
    let mut refused = Vec::new();
    for table in TABLES {
        for (key, example) in table.examples {
            if let Err(why) = works(table, key, example) {
                refused.push(format!("{}: {key} = {example}: {why:#?}", table.title));
            }
        }
        assert!(works(table, "nonsense", "1").is_err(), "{}", table.title);
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

#[test]
fn every_key_has_an_example() {
    let schema: Value = serde_json::from_str(&json_schema()).unwrap();
    let keys = |name: &str| -> Vec<String> {
        let own = definition(&schema, name)["properties"].as_object();
        own.into_iter().flatten().map(|(key, _)| key.clone()).collect()
    };
    let shape = keys("ShapeKeys");
    let of_shapes = |name: &str| ["Refine", "Region", "Solid"].contains(&name);
    for table in TABLES {
        let mut shown: Vec<_> = table.examples.iter().map(|(key, _)| (*key).to_owned()).collect();
        let mut there = keys(table.definition);
        if of_shapes(table.definition) {
            assert!(shape.iter().all(|key| there.contains(key)));
            there.retain(|key| !shape.contains(key));
        }
        shown.sort();
        there.sort();
        assert_eq!(shown, there, "{}", table.title);
    }
    // No table is forgotten.
    for (name, own) in schema["$defs"].as_object().unwrap() {
        let is_table = own["properties"].is_object();
        assert!(!is_table || TABLES.iter().any(|table| table.definition == name), "{name}");
    }
}
