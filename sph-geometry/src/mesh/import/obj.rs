//! Wavefront OBJ: vertices and polygons; everything else in it is of no use here.

use super::number::{number, shown};
use super::soup::Soup;
use super::text::Lines;

/// Adds the polygons of a text, cut into triangles.
pub fn read(text: &[u8], soup: &mut Soup) -> Result<(), String> {
    let mut places: Vec<[f64; 3]> = Vec::new();
    let mut carried = String::new();
    let mut corners = Vec::new();
    for (line, words) in Lines::new(text) {
        let words = words.split('#').next().unwrap_or("");
        // A backslash at the end joins a line with the next.
        if let Some(part) = words.trim_end().strip_suffix('\\') {
            carried.push_str(part);
            carried.push(' ');
            continue;
        }
        carried.push_str(words);
        let mut words = carried.split_whitespace();
        let result = match words.next() {
            Some("v") => place(&mut words).map(|place| places.push(place)),
            Some("f") => polygon(words, &places, soup, &mut corners),
            _ => Ok(()),
        };
        result.map_err(|reason| format!("line {line}: {reason}"))?;
        carried.clear();
    }
    Ok(())
}

fn place<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<[f64; 3], String> {
    let mut place = [0.0; 3];
    for x in &mut place {
        *x = number(words.next().ok_or("a vertex needs three numbers")?)?;
    }
    Ok(place)
}

fn polygon<'a>(
    words: impl Iterator<Item = &'a str>,
    places: &[[f64; 3]],
    soup: &mut Soup,
    corners: &mut Vec<u32>,
) -> Result<(), String> {
    corners.clear();
    for word in words {
        // Vertex, texture and normal: 7, 7/1, 7//3 or 7/1/3.
        let index = word.split('/').next().unwrap_or("");
        let index: i64 =
            index.parse().map_err(|_| format!("`{}` is no corner of a face", shown(word)))?;
        let count = places.len() as i64;
        // From 1, or backwards from the latest vertex by negative numbers.
        let place = if index < 0 { count.saturating_add(index) } else { index - 1 };
        let place = usize::try_from(place).ok().and_then(|place| places.get(place));
        let Some(place) = place else {
            return Err(format!("a face names vertex {index}, but there are {count} so far"));
        };
        corners.push(soup.vertex(*place));
    }
    if corners.len() < 3 {
        return Err(format!("a face has {} corners; it needs three or more", corners.len()));
    }
    soup.polygon(corners);
    Ok(())
}
