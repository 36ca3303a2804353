//! The JSON schema of scene files.

use super::root::Scene;

/// The JSON schema of scene files, as text. Editors check and complete scenes with it.
pub fn json_schema() -> String {
    let schema = schemars::schema_for!(Scene);
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn shipped_schema_is_up_to_date() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scene.schema.json");
        let shipped = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            shipped == json_schema(),
            "scene.schema.json is out of date; write it again with\n    \
             cargo run -p sph-solver --example scene_schema > sph-solver/scene.schema.json"
        );
    }

    #[test]
    fn every_key_is_described() {
        fn visit(value: &Value, path: &str, missing: &mut Vec<String>) {
            let Value::Object(object) = value else { return };
            if let Some(Value::Object(properties)) = object.get("properties") {
                for (key, schema) in properties {
                    if schema.get("description").is_none() && schema.get("$ref").is_none() {
                        missing.push(format!("{path}.{key}"));
                    }
                }
            }
            for (key, inner) in object {
                visit(inner, &format!("{path}/{key}"), missing);
            }
        }
        let schema: Value = serde_json::from_str(&json_schema()).unwrap();
        let mut missing = Vec::new();
        visit(&schema, "", &mut missing);
        assert_eq!(missing, Vec::<String>::new());
        assert!(json_schema().contains("\"checkpoint_every\""));
    }
}
