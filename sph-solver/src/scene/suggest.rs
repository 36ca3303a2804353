//! The nearest valid word for a mistyped one.

/// The candidate most like `word`, if any is like it at all.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(&word, candidate), candidate))
        .filter(|(distance, candidate)| {
            let length = word.chars().count().max(candidate.chars().count());
            *distance * 2 <= length || (!word.is_empty() && candidate.starts_with(&word))
        })
        .min_by(|(a, one), (b, other)| {
            // Of equally many mistakes, those that leave more of the word alone.
            let likeness = |candidate| strsim::jaro(&word, candidate);
            a.cmp(b).then(likeness(other).total_cmp(&likeness(one)))
        })
        .map(|(_, candidate)| candidate)
}

/// "did you mean `x`? " or nothing, and then all that is valid.
pub fn help(word: &str, valid: &[String], what: &str) -> String {
    let list = valid.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
    match nearest(word, valid.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`? {what}: {list}"),
        None => format!("{what}: {list}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_typing_mistakes_and_leaves_strangers_alone() {
        let keys = ["spacing", "support", "scheme", "cfl"];
        assert_eq!(nearest("spacng", keys), Some("spacing"));
        assert_eq!(nearest("CFL", keys), Some("cfl"));
        assert_eq!(nearest("supp", keys), Some("support"));
        assert_eq!(nearest("siin", ["sign", "sin"]), Some("sin"));
        assert_eq!(nearest("temperature", keys), None);
        assert_eq!(nearest("", keys), None);
    }

    #[test]
    fn help_lists_what_is_valid() {
        let valid = ["min".to_string(), "max".to_string()];
        assert_eq!(help("mn", &valid, "keys here"), "did you mean `min`? keys here: `min`, `max`");
        assert_eq!(help("colour", &valid, "keys here"), "keys here: `min`, `max`");
    }
}
