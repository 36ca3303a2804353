//! What a study varies: a key of the scene and its values.

use std::fmt;
use std::str::FromStr;

/// A key of the scene with the values that it takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// The key with its path, as for `--set`.
    pub key: String,
    /// Its values as the scene would write them.
    pub values: Vec<String>,
}

impl Axis {
    /// The last part of the key, for titles.
    pub fn short(&self) -> &str {
        self.key.rsplit('.').next().unwrap_or(&self.key)
    }
}

impl FromStr for Axis {
    type Err = String;

    /// Reads `key.path=value,value,…`. Commas in brackets, braces and quotes belong to a value.
    fn from_str(text: &str) -> Result<Self, String> {
        let form = "write key.path=value,value, for example numerics.spacing=0.04,0.02,0.01";
        let (key, values) = text.split_once('=').ok_or(form)?;
        let key = key.trim();
        let values = split(values);
        if key.is_empty() || values.iter().any(String::is_empty) {
            return Err(form.into());
        }
        if let Some(twice) = values.iter().enumerate().find(|(i, v)| values[..*i].contains(v)) {
            return Err(format!("the value {} of {key} is there twice", twice.1));
        }
        Ok(Self { key: key.into(), values })
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.values.join(","))
    }
}

/// The parts between commas that are in no brackets and no quotes.
fn split(text: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let (mut depth, mut quote) = (0_u32, None);
    for c in text.chars() {
        match (c, quote) {
            (',', None) if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            ('[' | '{', None) => depth += 1,
            (']' | '}', None) => depth = depth.saturating_sub(1),
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => (),
        }
        if let Some(last) = parts.last_mut() {
            last.push(c);
        }
    }
    parts.iter().map(|part| part.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_split_outside_of_brackets() {
        let axis: Axis = "fluid.water.velocity=[\"x, 1\", \"0\"], [\"0\", \"0\"]".parse().unwrap();
        assert_eq!(axis.values, ["[\"x, 1\", \"0\"]", "[\"0\", \"0\"]"]);
        assert_eq!(axis.short(), "velocity");
        let axis: Axis = "numerics.spacing = 0.04,0.02".parse().unwrap();
        assert_eq!((axis.key.as_str(), axis.values.len()), ("numerics.spacing", 2));
        assert_eq!(axis.to_string(), "numerics.spacing=0.04,0.02");
        for text in ["spacing", "=1", "a=", "a=1,,2", "a=1,1"] {
            assert!(text.parse::<Axis>().is_err(), "{text}");
        }
    }
}
