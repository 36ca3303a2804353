//! Numbers of text and of 32 bits.

/// The shortest decimal number that 32 bits may stand for.
pub fn shortest_decimal(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}

/// A number of a text, or why it is none. Fortran's exponents (1.0D+3) are read.
pub fn number(word: &str) -> Result<f64, String> {
    let parsed = word.parse::<f64>().or_else(|_| word.replace(['d', 'D'], "e").parse::<f64>());
    match parsed {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(format!("the coordinate `{}` is not finite", shown(word))),
        Err(_) if word.contains(',') => {
            Err(format!("`{}` is not a number: decimals need a point, not a comma", shown(word)))
        }
        Err(_) => Err(format!("`{}` is not a number", shown(word))),
    }
}

/// The start of a word, for messages.
pub fn shown(word: &str) -> String {
    let mut start: String =
        word.chars().take(24).map(|c| if c.is_control() { '?' } else { c }).collect();
    if start.len() < word.len() {
        start.push('…');
    }
    start
}
