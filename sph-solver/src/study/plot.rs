//! The work–precision plot: error against core-seconds, as SVG without a library.

use super::curve::Curve;
use super::report::Report;
use crate::report::html::escape;
use std::fmt::Write;

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 480.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 56.0;

/// Colours that the colour-blind can tell apart.
///
/// Source: Okabe & Ito (2008), Color Universal Design.
const COLORS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];

/// Both axes of a plot, logarithmic.
struct Axes {
    x: (f64, f64),
    y: (f64, f64),
}

/// The plot of a study as the text of an SVG file.
pub fn work_precision(report: &Report) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{:.1}\" y=\"26\" text-anchor=\"middle\" font-size=\"15\">{}</text>\n",
        0.5 * WIDTH,
        escape(&format!("{}: {}", report.scene, report.title)),
    );
    let points = report.curves.iter().flat_map(|curve| &curve.points);
    let places: Vec<(f64, f64)> =
        points.filter_map(|p| Some((p.core_seconds?, p.error.filter(|e| *e > 0.0)?))).collect();
    if places.is_empty() {
        let _ = writeln!(svg, "<text x=\"{LEFT}\" y=\"80\">no run has an error</text>");
        return svg + "</svg>\n";
    }
    let axes = Axes {
        x: decades(places.iter().map(|p| p.0)),
        y: decades(places.iter().map(|p| p.1).chain(report.bar)),
    };
    // Writing to a string does not fail.
    let _ = axes.frame(&mut svg);
    if let Some(bar) = report.bar {
        let y = axes.place(axes.x.0, bar).1;
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"#999\" stroke-dasharray=\"2 3\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#666\">bar {bar}</text>",
            WIDTH - RIGHT,
            WIDTH - RIGHT - 4.0,
            y - 4.0
        );
    }
    let _ = axes.front(&mut svg, &report.curves);
    for (number, curve) in report.curves.iter().enumerate() {
        let _ = axes.curve(&mut svg, curve, number);
    }
    svg + "</svg>\n"
}

/// Whole decades around some numbers.
fn decades(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    let ends = numbers.fold((f64::INFINITY, 0.0_f64), |(low, high), n| (low.min(n), high.max(n)));
    let low = ends.0.log10().floor();
    let high = ends.1.log10().ceil().max(low + 1.0);
    (10.0_f64.powf(low), 10.0_f64.powf(high))
}

impl Axes {
    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let share = |value: f64, (low, high): (f64, f64)| (value / low).ln() / (high / low).ln();
        let (across, up) = (share(x, self.x), share(y, self.y));
        (LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM))
    }

    fn frame(&self, svg: &mut String) -> std::fmt::Result {
        let ((x0, y0), (x1, y1)) = (self.place(self.x.0, self.y.0), self.place(self.x.1, self.y.1));
        for (value, main) in ticks(self.x) {
            let x = self.place(value, self.y.0).0;
            let color = if main { "#ccc" } else { "#eee" };
            writeln!(svg, "<path d=\"M{x:.1} {y0:.1}V{y1:.1}\" stroke=\"{color}\"/>")?;
            if main {
                let y = y0 + 16.0;
                writeln!(
                    svg,
                    "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{value}</text>"
                )?;
            }
        }
        for (value, main) in ticks(self.y) {
            let y = self.place(self.x.0, value).1;
            let color = if main { "#ccc" } else { "#eee" };
            writeln!(svg, "<path d=\"M{x0:.1} {y:.1}H{x1:.1}\" stroke=\"{color}\"/>")?;
            if main {
                let (x, y) = (x0 - 6.0, y + 4.0);
                writeln!(
                    svg,
                    "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{value}</text>"
                )?;
            }
        }
        let (across, up) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
        writeln!(
            svg,
            "<path d=\"M{x0:.1} {y0:.1}H{x1:.1}V{y1:.1}H{x0:.1}Z\" fill=\"none\" stroke=\"#333\"/>\n\
             <text x=\"{across:.1}\" y=\"{:.1}\" text-anchor=\"middle\">core-seconds</text>\n\
             <text transform=\"translate(20 {up:.1}) rotate(-90)\" \
             text-anchor=\"middle\">error</text>",
            y0 + 38.0
        )
    }

    /// The Pareto front: steps through the points that none beats.
    fn front(&self, svg: &mut String, curves: &[Curve]) -> std::fmt::Result {
        let points = curves.iter().flat_map(|curve| &curve.points).filter(|point| point.on_front);
        let mut places: Vec<(f64, f64)> = points
            .filter_map(|point| Some((point.core_seconds?, point.error.filter(|e| *e > 0.0)?)))
            .collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut path = String::new();
        for (number, &(cost, error)) in places.iter().enumerate() {
            let (x, y) = self.place(cost, error);
            if number == 0 {
                write!(path, "M{x:.1} {y:.1}")?;
            } else {
                write!(path, "H{x:.1}V{y:.1}")?;
            }
        }
        writeln!(
            svg,
            "<path class=\"front\" d=\"{path}\" fill=\"none\" stroke=\"#bbb\" stroke-width=\"6\" \
             stroke-linejoin=\"round\"><title>Pareto front</title></path>"
        )
    }

    fn curve(&self, svg: &mut String, curve: &Curve, number: usize) -> std::fmt::Result {
        let color = COLORS[number % COLORS.len()];
        let mut path = String::new();
        let mut marks = String::new();
        for point in &curve.points {
            let (Some(cost), Some(error)) = (point.core_seconds, point.error) else { continue };
            if error <= 0.0 {
                continue;
            }
            let (x, y) = self.place(cost, error);
            write!(path, "{}{x:.1} {y:.1}", if path.is_empty() { "M" } else { "L" })?;
            if let Some((low, high)) = point.error_range.filter(|(low, high)| low < high) {
                let ends = [low, high].map(|error| {
                    let error = error.clamp(self.y.0, self.y.1);
                    self.place(cost, error).1
                });
                write!(
                    marks,
                    "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"{color}\"/>",
                    ends[0], ends[1]
                )?;
            }
            let fill = if point.on_front { color } else { "white" };
            writeln!(
                marks,
                "<path d=\"{}\" transform=\"translate({x:.1} {y:.1})\" fill=\"{fill}\" \
                 stroke=\"{color}\" stroke-width=\"1.5\"><title>{}: spacing {}, error {error:.3e}, \
                 {cost:.2} core-s</title></path>",
                mark(number),
                escape(&curve.label),
                point.spacing
            )?;
        }
        writeln!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>\n{marks}"
        )?;
        let (x, y) = (LEFT + 14.0, HEIGHT - BOTTOM - 12.0 - 16.0 * number as f64);
        let label = if curve.label.is_empty() { "as the scene says" } else { &curve.label };
        let order = curve.order.map_or(String::new(), |order| format!(" (order {order:.1})"));
        writeln!(
            svg,
            "<path d=\"{}\" transform=\"translate({x:.1} {:.1})\" fill=\"{color}\"/>\
             <text x=\"{:.1}\" y=\"{y:.1}\">{}</text>",
            mark(number),
            y - 4.0,
            x + 12.0,
            escape(&format!("{label}{order}"))
        )
    }
}

/// The lines of an axis: multiples of powers of ten, and whether it is a power itself.
fn ticks((low, high): (f64, f64)) -> Vec<(f64, bool)> {
    let (first, last) = (low.log10().round() as i32, high.log10().round() as i32);
    let decade = |power: i32| {
        let ten = if power < 0 { 1.0 / 10.0_f64.powi(-power) } else { 10.0_f64.powi(power) };
        (1..10).map(move |n| (f64::from(n) * ten, n == 1))
    };
    let within = |(value, _): &(f64, bool)| *value <= high * (1.0 + 1e-9);
    (first..=last).flat_map(decade).filter(within).collect()
}

/// The outline of the mark of curve `number`.
fn mark(number: usize) -> &'static str {
    match number % 4 {
        0 => "M-5 0A5 5 0 1 0 5 0A5 5 0 1 0 -5 0Z",
        1 => "M-4.5 -4.5H4.5V4.5H-4.5Z",
        2 => "M0 -6L5.5 4.5H-5.5Z",
        _ => "M0 -6L6 0L0 6L-6 0Z",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::curve::Point;

    fn report(points: &[(f64, f64)]) -> Report {
        let point = |&(cost, error): &(f64, f64)| Point {
            spacing: 0.1,
            particles: None,
            error: Some(error),
            error_range: None,
            core_seconds: Some(cost),
            runs: (1, 1),
            on_front: true,
        };
        Report {
            scene: "a < b".into(),
            title: "t".into(),
            bar: Some(0.01),
            remark: None,
            version: "0",
            rows: vec![],
            curves: vec![Curve {
                label: "scheme = delta".into(),
                points: points.iter().map(point).collect(),
                order: Some(2.0),
                last_order: None,
                costs: vec![],
            }],
        }
    }

    #[test]
    fn points_are_where_the_axes_say() {
        let axes = Axes { x: (0.1, 10.0), y: (1e-3, 1e-1) };
        assert_eq!(axes.place(0.1, 1e-3), (LEFT, HEIGHT - BOTTOM));
        let (x, y) = axes.place(1.0, 1e-2);
        assert!((x - 0.5 * (LEFT + WIDTH - RIGHT)).abs() < 1e-9);
        assert!((y - 0.5 * (TOP + HEIGHT - BOTTOM)).abs() < 1e-9);
        assert_eq!(decades([0.2, 3.0].into_iter()), (0.1, 10.0));
        assert_eq!(ticks((0.1, 10.0)).iter().filter(|(_, main)| *main).count(), 3);
    }

    #[test]
    fn a_plot_has_its_points_front_and_names() {
        let svg = work_precision(&report(&[(0.5, 0.1), (4.0, 0.02)]));
        for part in ["a &lt; b", "class=\"front\"", "scheme = delta (order 2.0)", "bar 0.01"] {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        assert_eq!(svg.matches("core-s</title>").count(), 2);
        assert!(svg.ends_with("</svg>\n"));
        assert!(work_precision(&report(&[])).contains("no run has an error"));
    }
}
