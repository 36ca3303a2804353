//! ASCII STL, also as programs write it that take the format lightly.

use super::number::{number, shown};
use super::soup::Soup;
use super::text::{Lines, is_comment};

/// Adds the triangles of all solids of a text. Numbers are read in double precision; normals are
/// not, as the order of the corners says more.
pub fn read(text: &[u8], soup: &mut Soup) -> Result<(), String> {
    let mut reader = Reader { soup, open: false, started: false, facet: None };
    for (line, words) in Lines::new(text) {
        if is_comment(&words) || words.trim().is_empty() {
            continue;
        }
        reader.line(&words).map_err(|reason| format!("line {line}: {reason}"))?;
    }
    if reader.open || reader.facet.is_some() {
        return Err("it ends before \"endsolid\": the end of the file is missing".into());
    }
    Ok(())
}

struct Reader<'a> {
    soup: &'a mut Soup,
    /// In a solid.
    open: bool,
    /// A solid has begun, now or earlier.
    started: bool,
    /// Corners of the facet that has begun.
    facet: Option<Vec<u32>>,
}

impl Reader<'_> {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        while let Some(word) = words.next() {
            let mut word = word.to_ascii_lowercase();
            if word == "end" {
                word.push_str(&words.next().unwrap_or("").to_ascii_lowercase());
            }
            match word.as_str() {
                "solid" if self.open => return Err("a solid starts inside a solid".into()),
                // The rest of these lines is a name.
                "solid" => {
                    (self.open, self.started) = (true, true);
                    return Ok(());
                }
                "endsolid" if self.facet.is_some() => {
                    return Err("the solid ends inside a facet".into());
                }
                "endsolid" => {
                    self.open = false;
                    return Ok(());
                }
                "facet" => {
                    self.started = true;
                    if self.facet.replace(Vec::with_capacity(3)).is_some() {
                        return Err("a facet starts inside a facet".into());
                    }
                }
                "vertex" => self.vertex(&mut words)?,
                "endfacet" => self.end_facet()?,
                "normal" | "outer" | "loop" | "endloop" | "color" if self.facet.is_some() => {}
                // Numbers of the normal.
                _ if self.facet.is_some() && is_number(&word) => {}
                _ if !self.started => return Ok(()),
                _ if self.facet.is_some() || self.open => {
                    return Err(format!("`{}` is no part of a facet", shown(&word)));
                }
                _ => return Err(format!("`{}` is text between solids", shown(&word))),
            }
        }
        Ok(())
    }

    fn vertex<'a>(&mut self, words: &mut impl Iterator<Item = &'a str>) -> Result<(), String> {
        let Some(facet) = &mut self.facet else {
            return Err("a vertex outside of a facet".into());
        };
        let mut place = [0.0; 3];
        for x in &mut place {
            *x = number(words.next().ok_or("a vertex needs three numbers")?)?;
        }
        if facet.len() == 3 {
            return Err("a facet has more than three corners".into());
        }
        facet.push(self.soup.vertex(place));
        Ok(())
    }

    fn end_facet(&mut self) -> Result<(), String> {
        match self.facet.take().as_deref() {
            Some(&[a, b, c]) => self.soup.triangle([a, b, c]),
            Some(corners) => return Err(format!("a facet has {} corners, not 3", corners.len())),
            None => return Err("a facet ends that has not begun".into()),
        }
        Ok(())
    }
}

/// Normals of triangles without area are often not finite.
fn is_number(word: &str) -> bool {
    number(word).is_ok() || word.contains("nan") || word.contains("inf") || word.contains("ind")
}
