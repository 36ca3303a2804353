//! The section with the pictures of the flow.

use super::colours::{PRESSURE, SPEED};
use super::frame::{Framing, colour_bar, figure};
use super::html::escape;
use super::results::Results;
use super::scan::{Field, Scan, moving, range, walls};
use super::view::Extent;
use sph_io::{Snapshot, read_vtu};

/// Moments that are shown of each run.
pub fn moments_for(runs: usize) -> usize {
    match runs {
        1 => 6,
        2 => 4,
        _ => 3,
    }
}

/// Runs of which there are pictures; curves show all.
pub const MOST_RUNS: usize = 6;

/// The pictures of all runs, with common colours and, among runs of one dimension, a common view.
/// `pixels` is what all pictures may have together.
pub fn section(
    runs: &[Results],
    scans: &[Scan],
    pixels: f64,
    problems: &mut Vec<String>,
) -> String {
    let count: usize =
        scans.iter().map(|scan| scan.moments.len()).sum::<usize>() * Field::ALL.len();
    if count == 0 {
        return String::new();
    }
    let pixels = (pixels / count as f64).min(320_000.0);
    let mut html = String::new();
    for field in Field::ALL {
        if !scans.iter().any(|scan| scan.has(field)) {
            continue;
        }
        let (id, title, name, unit, scale) = match field {
            Field::Speed => ("colours-of-speed", "Flow by speed", "Speed", "m/s", &SPEED),
            Field::Pressure => {
                ("colours-of-pressure", "Flow by pressure", "Pressure", "Pa", &PRESSURE)
            }
        };
        let range = range(scans, field);
        html += &format!("<h2>{title}</h2>\n{}", colour_bar(id, name, unit, scale, range));
        for (run, scan) in runs.iter().zip(scans) {
            if runs.len() > 1 {
                html += &format!("<h3>{}</h3>\n", escape(&run.label));
            }
            let mut extent = Extent::EMPTY;
            for other in scans.iter().filter(|other| other.flat == scan.flat) {
                extent.join(&other.extent());
            }
            let view = scan.view(&run.record.gravity);
            let framing = Framing { view, extent, scale, range, pixels };
            let at_rest = walls(run, problems);
            html += "<div class=\"grid\">\n";
            for moment in &scan.moments {
                let moving = moving(run, moment.time, problems);
                let walls: Vec<&Snapshot> = at_rest.iter().chain(&moving).collect();
                let drawn = read_vtu(run.folder.join(&moment.file)).map_err(|e| e.to_string());
                let drawn = drawn.and_then(|fluid| {
                    let values = fluid.magnitudes(field.column()).unwrap_or_default();
                    let caption = format!("t = {} s", rounded(moment.time));
                    figure(&framing, &caption, &fluid, &values, &walls, scan.spacing)
                        .map_err(|error| error.to_string())
                });
                match drawn {
                    Ok(figure) => html += &figure,
                    Err(problem) => problems.push(problem),
                }
            }
            html += "</div>\n";
        }
    }
    html
}

/// A number with four significant digits.
pub fn rounded(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return format!("{number}");
    }
    let decimals = (3 - number.abs().log10().floor() as i32).clamp(0, 12) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn numbers_have_four_digits() {
        for (number, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (0.123_456, "0.1235"),
            (98_765.4, "98765"),
            (-2.5e-4, "-0.00025"),
        ] {
            assert_eq!(rounded(number), text);
        }
    }
}
