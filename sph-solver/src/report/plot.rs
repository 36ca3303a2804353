//! Curves over time as SVG.

use super::colours::{DASHES, LINES};
use super::html::{escape, shorten};
use super::ticks::Ticks;
use std::fmt::Write;

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// What it shows.
    pub name: String,
    /// Times, s.
    pub time: Vec<f64>,
    /// Values; where one is not finite the curve has a gap.
    pub values: Vec<f64>,
}

/// Curves on common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Above it.
    pub title: String,
    /// Unit of the values.
    pub unit: String,
    /// The curves.
    pub lines: Vec<Line>,
}

const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 250.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 38.0;
/// Curves beyond these are left out, and said to be.
const MOST_LINES: usize = 14;

impl Plot {
    /// The plot as a figure of a page; each curve has at most `bins` pairs of points.
    pub fn figure(&self, bins: usize) -> String {
        let mut html = String::new();
        // Writing to a string does not fail.
        let _ = self.draw(&mut html, bins);
        html
    }

    fn draw(&self, html: &mut String, bins: usize) -> std::fmt::Result {
        let shown = &self.lines[..self.lines.len().min(MOST_LINES)];
        let (x, y) = (Axis::of_time(shown), Axis::of_values(shown));
        let across = |t: f64| LEFT + x.share(t) * (WIDTH - LEFT - RIGHT);
        let up = |v: f64| HEIGHT - BOTTOM - y.share(v) * (HEIGHT - TOP - BOTTOM);
        let (left, right, top, bottom) = (LEFT, WIDTH - RIGHT, TOP, HEIGHT - BOTTOM);
        let title = escape(&shorten(&self.title, 90));
        writeln!(
            html,
            "<figure class=\"plot\"><figcaption>{title}</figcaption>\n\
             <svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\">"
        )?;
        for &tick in &y.ticks.values {
            let (at, label) = (up(tick), y.ticks.label(tick));
            let class = if tick == 0.0 { "zero" } else { "grid" };
            writeln!(
                html,
                "<path class=\"{class}\" d=\"M{left} {at:.1}H{right}\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                left - 6.0,
                at + 4.0
            )?;
        }
        for &tick in &x.ticks.values {
            let (at, label) = (across(tick), x.ticks.label(tick));
            writeln!(
                html,
                "<path class=\"grid\" d=\"M{at:.1} {top}V{bottom}\"/>\
                 <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                bottom + 15.0
            )?;
        }
        let unit = y.ticks.unit(&self.unit);
        let unit = if unit.is_empty() { "dimensionless".into() } else { format!("in {unit}") };
        writeln!(
            html,
            "<path class=\"axis\" d=\"M{left} {top}V{bottom}H{right}\"/>\
             <text x=\"2\" y=\"12\">{}</text>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">time in {}</text>",
            escape(&unit),
            right,
            HEIGHT - 6.0,
            x.ticks.unit("s")
        )?;
        for (number, line) in shown.iter().enumerate() {
            let path = path(line, &x, bins, across, up);
            writeln!(html, "<path class=\"line\" {} d=\"{path}\"/>", style(number))?;
        }
        html.push_str("</svg>");
        if shown.len() > 1 || shown[0].name != self.title {
            html.push_str("<ul class=\"legend\">");
            for (number, line) in shown.iter().enumerate() {
                write!(
                    html,
                    "<li><svg viewBox=\"0 0 28 8\"><path class=\"line\" {} d=\"M0 4H28\"/></svg>{}</li>",
                    style(number),
                    escape(&shorten(&line.name, 60))
                )?;
            }
            if self.lines.len() > shown.len() {
                write!(html, "<li>and {} more, not shown</li>", self.lines.len() - shown.len())?;
            }
            html.push_str("</ul>");
        }
        html.push_str("</figure>\n");
        Ok(())
    }
}

fn style(number: usize) -> String {
    let colour = LINES[number % LINES.len()];
    // The second time a colour comes it has other dashes.
    let dashes = DASHES[(number + number / LINES.len()) % DASHES.len()];
    match dashes {
        "" => format!("stroke=\"{colour}\""),
        dashes => format!("stroke=\"{colour}\" stroke-dasharray=\"{dashes}\""),
    }
}

struct Axis {
    low: f64,
    high: f64,
    ticks: Ticks,
}

impl Axis {
    fn of_time(lines: &[Line]) -> Self {
        let (low, high) = range(lines.iter().flat_map(|line| &line.time));
        Self { low, high, ticks: Ticks::new(low, high, 7) }
    }

    fn of_values(lines: &[Line]) -> Self {
        let (low, high) = range(lines.iter().flat_map(|line| &line.values));
        // From zero where that does not flatten the curves.
        let (low, high) = if low > 0.0 && low < 0.5 * high {
            (0.0, high)
        } else if high < 0.0 && high > 0.5 * low {
            (low, 0.0)
        } else {
            (low, high)
        };
        let room = 0.04 * (high - low);
        let (below, above) = (low - room, high + room);
        let low = if low == 0.0 { 0.0 } else { below };
        let high = if high == 0.0 { 0.0 } else { above };
        Self { low, high, ticks: Ticks::new(low, high, 5) }
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// Smallest and largest finite number, apart from each other.
fn range<'a>(numbers: impl Iterator<Item = &'a f64>) -> (f64, f64) {
    let finite = numbers.filter(|number| number.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &number| {
        (low.min(number), high.max(number))
    });
    match high - low {
        width if width > 0.0 && width.is_finite() => (low, high),
        _ if low.is_finite() && high.is_finite() => {
            let room = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            (low - room, high + room)
        }
        _ => (0.0, 1.0),
    }
}

/// The curve as an SVG path. Of many points, the lowest and highest of each bin are kept, so that no
/// peak is lost.
fn path(
    line: &Line,
    x: &Axis,
    bins: usize,
    across: impl Fn(f64) -> f64,
    up: impl Fn(f64) -> f64,
) -> String {
    let mut path = String::new();
    let mut pen_down = false;
    for point in thinned(&line.time, &line.values, (x.low, x.high), bins) {
        match point {
            Some((time, value)) => {
                let _ = write!(
                    path,
                    "{}{:.1} {:.1}",
                    if pen_down { 'L' } else { 'M' },
                    across(time),
                    up(value)
                );
                pen_down = true;
            }
            None => pen_down = false,
        }
    }
    path
}

/// Points in the order of time; `None` is a gap.
fn thinned(
    time: &[f64],
    values: &[f64],
    (start, end): (f64, f64),
    bins: usize,
) -> Vec<Option<(f64, f64)>> {
    let points =
        time.iter().zip(values).map(|(t, v)| (t.is_finite() && v.is_finite()).then_some((*t, *v)));
    if time.len() <= 2 * bins {
        return points.collect();
    }
    let bin = |t: f64| (((t - start) / (end - start)) * bins as f64) as usize;
    let mut kept: Vec<Option<(f64, f64)>> = Vec::new();
    let mut held: Option<Extremes> = None;
    for point in points {
        match point {
            None => {
                kept.extend(held.take().into_iter().flat_map(Extremes::points));
                if kept.last().is_some_and(Option::is_some) {
                    kept.push(None);
                }
            }
            Some(point) => {
                let bin = bin(point.0);
                match &mut held {
                    Some(held) if held.bin == bin => held.add(point),
                    _ => {
                        let next = Extremes { bin, low: point, high: point };
                        let before = held.replace(next);
                        kept.extend(before.into_iter().flat_map(Extremes::points));
                    }
                }
            }
        }
    }
    kept.extend(held.into_iter().flat_map(Extremes::points));
    kept
}

/// The lowest and the highest point of a bin.
struct Extremes {
    bin: usize,
    low: (f64, f64),
    high: (f64, f64),
}

impl Extremes {
    fn add(&mut self, point: (f64, f64)) {
        if point.1 < self.low.1 {
            self.low = point;
        }
        if point.1 > self.high.1 {
            self.high = point;
        }
    }

    /// Both in the order of time, or one that is both.
    fn points(self) -> impl Iterator<Item = Option<(f64, f64)>> {
        let (low, high) = (self.low, self.high);
        let (first, second) = if low.0 <= high.0 { (low, high) } else { (high, low) };
        [Some(first), Some(second).filter(|second| *second != first)]
            .into_iter()
            .flatten()
            .map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_peak() {
        let time: Vec<f64> = (0..100_000).map(|k| f64::from(k) * 1e-5).collect();
        let mut values = vec![0.0; time.len()];
        values[54_321] = 7.0;
        values[54_322] = -3.0;
        values[80_000] = f64::NAN;
        let kept = thinned(&time, &values, (0.0, 1.0), 200);
        assert!(kept.len() < 410, "{}", kept.len());
        let peaks: Vec<f64> = kept.iter().flatten().map(|p| p.1).filter(|v| *v != 0.0).collect();
        assert_eq!(peaks, [7.0, -3.0]);
        assert_eq!(kept.iter().filter(|p| p.is_none()).count(), 1);
        let times: Vec<f64> = kept.iter().flatten().map(|p| p.0).collect();
        assert!(times.is_sorted());
    }

    #[test]
    fn axes_hold_the_curves() {
        let line = |values: Vec<f64>| Line { name: "a".into(), time: vec![0.0, 1.0, 2.0], values };
        for values in [
            vec![0.0, 1.0, f64::NAN],
            vec![5.0, 5.0, 5.0],
            vec![0.0, 0.0, 0.0],
            vec![-2e6, 3e6, 0.0],
            vec![f64::NAN; 3],
        ] {
            let axis = Axis::of_values(&[line(values.clone())]);
            let inside = |v: &f64| (0.0..=1.0).contains(&axis.share(*v));
            assert!(values.iter().filter(|v| v.is_finite()).all(inside), "{values:?}");
            assert!(!axis.ticks.values.is_empty(), "{values:?}");
            let plot = Plot { title: "t".into(), unit: "Pa".into(), lines: vec![line(values)] };
            assert!(!plot.figure(100).contains("NaN"));
        }
    }

    #[test]
    fn more_curves_than_fit_are_said_to_be() {
        let line = Line { name: "<a>".into(), time: vec![0.0, 1.0], values: vec![0.0, 1.0] };
        let plot = Plot { title: "t".into(), unit: "1".into(), lines: vec![line; 20] };
        let html = plot.figure(100);
        assert!(html.contains("and 6 more") && html.contains("&lt;a&gt;"));
        assert!(html.contains("dimensionless"));
    }
}
