//! `--set key.path=value`: changes to a parsed scene before it is read.

use super::document::{Entry, Node, Place, Sources, Value, parse_value};
use super::error::{ErrorKind, SceneError};

/// A step of a path and where it was written.
struct Step<'a> {
    key: &'a str,
    place: Place,
}

/// Applies the argument that is source `source`: `key.path=value`. Tables on the way are made when
/// they are missing; a number is an index into an array.
pub fn apply(
    root: &mut Node,
    sources: &Sources,
    source: usize,
    argument: &str,
) -> Result<(), SceneError> {
    let whole = Place { source, start: 0, end: argument.len() };
    let Some((path, value)) = argument.split_once('=') else {
        return Err(sources.error(whole, ErrorKind::OverrideForm));
    };
    let mut steps = Vec::new();
    let mut start = 0;
    for key in path.split('.') {
        let skipped = key.len() - key.trim_start().len();
        let (key, end) = (key.trim(), start + key.len());
        let place = Place { source, start: start + skipped, end: start + skipped + key.len() };
        if key.is_empty() {
            return Err(sources.error(whole, ErrorKind::OverrideForm));
        }
        steps.push(Step { key, place });
        start = end + 1;
    }
    let value = parse_value(sources, source, path.len() + 1, value)?;
    place_value(root, sources, &steps, value)
}

fn place_value(
    mut node: &mut Node,
    sources: &Sources,
    steps: &[Step<'_>],
    value: Node,
) -> Result<(), SceneError> {
    for step in steps {
        node = match &mut node.value {
            Value::Table(entries) => {
                let found = entries.iter().position(|entry| entry.key == step.key);
                let index = found.unwrap_or_else(|| {
                    let empty = Node { place: step.place, value: Value::Table(Vec::new()) };
                    let entry = Entry { key: step.key.into(), place: step.place, node: empty };
                    entries.push(entry);
                    entries.len() - 1
                });
                let entry = &mut entries[index];
                entry.place = step.place;
                &mut entry.node
            }
            Value::Array(nodes) => {
                let length = nodes.len();
                let index = step.key.parse().ok();
                match index.and_then(|index: usize| nodes.get_mut(index)) {
                    Some(element) => element,
                    None => {
                        let kind = ErrorKind::OverrideIndex { key: step.key.into(), length };
                        return Err(sources.error(step.place, kind));
                    }
                }
            }
            other => {
                let kind =
                    ErrorKind::OverridePath { key: step.key.into(), found: other.describe() };
                return Err(sources.error(step.place, kind));
            }
        };
    }
    *node = value;
    Ok(())
}
