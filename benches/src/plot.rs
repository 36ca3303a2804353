//! Plots with logarithmic axes as SVG, without a library.

use std::fmt::Write;

/// A line of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it shows.
    pub name: String,
    /// Colour, as SVG names it.
    pub color: &'static str,
    /// Whether it is dashed.
    pub dashed: bool,
    /// Points, in the order of x.
    pub points: Vec<(f64, f64)>,
}

/// A plot. The x axis is logarithmic with base 2.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Above it.
    pub title: String,
    /// Below the x axis.
    pub x_name: &'static str,
    /// Beside the y axis.
    pub y_name: &'static str,
    /// Whether the y axis is logarithmic as well.
    pub log_y: bool,
    /// Ends of the axes.
    pub x: (f64, f64),
    /// Ends of the axes.
    pub y: (f64, f64),
    /// Lines.
    pub series: Vec<Series>,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 460.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 55.0;

impl Plot {
    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let share = |value: f64, (low, high): (f64, f64), log: bool| {
            if log { (value / low).ln() / (high / low).ln() } else { (value - low) / (high - low) }
        };
        let across = share(x, self.x, true);
        let up = share(y, self.y, self.log_y);
        (LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM))
    }

    fn ticks(&self) -> (Vec<f64>, Vec<f64>) {
        let powers = |(low, high): (f64, f64)| {
            let mut tick = 2.0_f64.powf(low.log2().ceil());
            let mut ticks = Vec::new();
            while tick <= high * 1.000_001 {
                ticks.push(tick);
                tick *= 4.0;
            }
            ticks
        };
        let (low, high) = self.y;
        let y = if self.log_y {
            powers(self.y)
        } else {
            (0..=5).map(|k| low + f64::from(k) * (high - low) / 5.0).collect()
        };
        (powers(self.x), y)
    }

    fn draw(&self, svg: &mut String) -> std::fmt::Result {
        let (x_ticks, y_ticks) = self.ticks();
        let (x0, y0) = self.place(self.x.0, self.y.0);
        let (x1, y1) = self.place(self.x.1, self.y.1);
        for tick in x_ticks {
            let x = self.place(tick, self.y.0).0;
            writeln!(svg, "<path d=\"M{x:.1} {y0:.1}V{y1:.1}\" stroke=\"#ddd\"/>")?;
            let y = y0 + 16.0;
            writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{tick}</text>")?;
        }
        for tick in y_ticks {
            let y = self.place(self.x.0, tick).1;
            writeln!(svg, "<path d=\"M{x0:.1} {y:.1}H{x1:.1}\" stroke=\"#ddd\"/>")?;
            let (x, y) = (x0 - 6.0, y + 4.0);
            writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{tick}</text>")?;
        }
        writeln!(
            svg,
            "<path d=\"M{x0:.1} {y0:.1}H{x1:.1}V{y1:.1}H{x0:.1}Z\" fill=\"none\" stroke=\"#333\"/>"
        )?;
        let middle = 0.5 * (x0 + x1);
        writeln!(
            svg,
            "<text x=\"{middle:.1}\" y=\"24\" text-anchor=\"middle\" font-size=\"15\">{}</text>",
            self.title
        )?;
        let below = y0 + 38.0;
        writeln!(
            svg,
            "<text x=\"{middle:.1}\" y=\"{below:.1}\" text-anchor=\"middle\">{}</text>",
            self.x_name
        )?;
        let middle = 0.5 * (y0 + y1);
        writeln!(
            svg,
            "<text transform=\"translate(18 {middle:.1}) rotate(-90)\" \
             text-anchor=\"middle\">{}</text>",
            self.y_name
        )?;
        for (number, series) in self.series.iter().enumerate() {
            self.line(svg, series)?;
            let y = TOP + 16.0 + 16.0 * number as f64;
            let dash = if series.dashed { " stroke-dasharray=\"5 4\"" } else { "" };
            writeln!(
                svg,
                "<path d=\"M{:.1} {:.1}h24\" stroke=\"{}\" stroke-width=\"2\"{dash}/>\
                 <text x=\"{:.1}\" y=\"{y:.1}\">{}</text>",
                x0 + 10.0,
                y - 4.0,
                series.color,
                x0 + 40.0,
                series.name
            )?;
        }
        Ok(())
    }

    fn line(&self, svg: &mut String, series: &Series) -> std::fmt::Result {
        let dash = if series.dashed { " stroke-dasharray=\"5 4\"" } else { "" };
        let mut path = String::new();
        for (number, &(x, y)) in series.points.iter().enumerate() {
            let (x, y) = self.place(x, y);
            write!(path, "{}{x:.1} {y:.1}", if number == 0 { "M" } else { "L" })?;
        }
        writeln!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{dash}/>",
            series.color
        )
    }
}

/// Plots side by side as the text of an SVG file. `note` says where they come from; it is no XML
/// comment, in which the two hyphens of an option would be an error.
pub fn side_by_side(plots: &[Plot], note: &str) -> String {
    let width = WIDTH * plots.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<desc>{note}</desc>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (number, plot) in plots.iter().enumerate() {
        svg += &format!("<g transform=\"translate({} 0)\">\n", WIDTH * number as f64);
        // Writing to a string does not fail.
        let _ = plot.draw(&mut svg);
        svg += "</g>\n";
    }
    svg + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_where_the_axes_say() {
        let plot = Plot {
            title: "t".into(),
            x_name: "x",
            y_name: "y",
            log_y: true,
            x: (1.0, 16.0),
            y: (1.0, 16.0),
            series: vec![Series {
                name: "one".into(),
                color: "red",
                dashed: true,
                points: vec![(1.0, 1.0), (4.0, 4.0), (16.0, 16.0)],
            }],
        };
        assert_eq!(plot.place(1.0, 1.0), (LEFT, HEIGHT - BOTTOM));
        assert_eq!(plot.place(4.0, 16.0), (0.5 * (LEFT + WIDTH - RIGHT), TOP));
        assert_eq!(plot.ticks().0, [1.0, 4.0, 16.0]);
        let svg = side_by_side(&[plot.clone(), plot], "a command --option");
        assert!(svg.contains("<desc>a command --option</desc>"));
        assert_eq!(svg.matches("stroke=\"red\"").count(), 4);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    }
}
