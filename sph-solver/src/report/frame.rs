//! A picture of the flow with axes in metres, as a figure of a page.

use super::colours::{self, Scale};
use super::html::escape;
use super::picture::Picture;
use super::ticks::Ticks;
use super::view::{Extent, View};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sph_io::Snapshot;
use std::fmt::Write;

/// What all pictures of a field have in common.
#[derive(Debug, Clone, Copy)]
pub struct Framing<'a> {
    /// Where the viewer stands.
    pub view: View,
    /// What is seen.
    pub extent: Extent,
    /// Colours of the field.
    pub scale: &'a Scale,
    /// Values at the ends of the scale.
    pub range: (f64, f64),
    /// Pixels of a picture.
    pub pixels: f64,
}

const WIDTH: f64 = 440.0;
const LEFT: f64 = 40.0;
const RIGHT: f64 = 12.0;
/// In space there are labels on the right too.
const RIGHT_OF_BOX: f64 = 56.0;
const TOP: f64 = 18.0;
const BOTTOM: f64 = 36.0;
const TALLEST: f64 = 330.0;

/// The figure of a moment: the fluid coloured by `values`, one per particle.
pub fn figure(
    framing: &Framing<'_>,
    caption: &str,
    fluid: &Snapshot,
    values: &[f64],
    walls: &[&Snapshot],
    spacing: f64,
) -> Result<String, png::EncodingError> {
    let Framing { view, extent, scale, range: (low, high), pixels } = *framing;
    let mut picture = Picture::new(view, &extent, scale, pixels);
    // A little more than what is seen, for what reaches into it.
    let seen = extent.grown(spacing);
    for walls in walls {
        let normals = walls.column("normal").filter(|normal| normal.components == 3);
        for (index, point) in walls.positions.iter().enumerate() {
            if seen.contains(point) {
                let normal = normals.and_then(|column| column.values.get(3 * index..3 * index + 3));
                picture.wall(point, spacing, normal);
            }
        }
    }
    // Disks of the plane reach beyond the corners of their cells, so that the fluid has no holes.
    // Balls of space overlap, so that they make one surface.
    let radius = if view.flat { 0.8 } else { 0.7 };
    for (point, value) in fluid.positions.iter().zip(values) {
        if seen.contains(point) {
            picture.particle(point, radius * spacing, (value - low) / (high - low));
        }
    }
    picture.join_fluid(spacing);
    let data = STANDARD.encode(picture.png()?);
    let place = Placing::new(&view, &extent);
    let (width, height) = place.size();
    let caption = escape(caption);
    let mut html = format!(
        "<figure class=\"frame\"><figcaption>{caption}</figcaption>\n\
         <svg viewBox=\"0 0 {WIDTH} {:.1}\" role=\"img\" aria-label=\"{caption}\">\n\
         <image x=\"{LEFT}\" y=\"{TOP}\" width=\"{width:.1}\" height=\"{height:.1}\" \
         preserveAspectRatio=\"none\" href=\"data:image/png;base64,{data}\"/>\n",
        height + TOP + BOTTOM,
    );
    // Writing to a string does not fail.
    let _ = if view.flat { place.flat_axes(&mut html) } else { place.box_axes(&mut html) };
    html.push_str("</svg></figure>\n");
    Ok(html)
}

/// Where points of space are in the figure.
struct Placing<'a> {
    view: &'a View,
    extent: &'a Extent,
    frame: Extent,
    scale: f64,
}

impl<'a> Placing<'a> {
    fn new(view: &'a View, extent: &'a Extent) -> Self {
        let frame = view.frame(extent);
        let [across, up] = [0, 1].map(|axis| (frame.max[axis] - frame.min[axis]).max(1e-9));
        let right = if view.flat { RIGHT } else { RIGHT_OF_BOX };
        let scale = ((WIDTH - LEFT - right) / across).min(TALLEST / up);
        Self { view, extent, frame, scale }
    }

    fn size(&self) -> (f64, f64) {
        let [width, height] = [0, 1].map(|a| (self.frame.max[a] - self.frame.min[a]) * self.scale);
        (width, height)
    }

    fn place(&self, point: &[f64; 3]) -> (f64, f64) {
        let [right, up, _] = self.view.project(point);
        (
            LEFT + (right - self.frame.min[0]) * self.scale,
            TOP + (self.frame.max[1] - up) * self.scale,
        )
    }

    fn flat_axes(&self, svg: &mut String) -> std::fmt::Result {
        let Extent { min, max } = self.extent;
        let (width, height) = self.size();
        let (bottom, room) = (TOP + height, |length: f64| (length / 45.0).clamp(2.0, 6.0) as usize);
        writeln!(
            svg,
            "<path class=\"axis\" d=\"M{LEFT} {TOP}h{width:.1}v{height:.1}h-{width:.1}z\"/>"
        )?;
        let ticks = Ticks::new(min[0], max[0], room(width));
        for &tick in &ticks.values {
            let (at, _) = self.place(&[tick, min[1], 0.0]);
            writeln!(
                svg,
                "<path class=\"axis\" d=\"M{at:.1} {bottom:.1}v4\"/>\
                 <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 16.0,
                ticks.label(tick)
            )?;
        }
        writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">x in {}</text>",
            LEFT + width,
            bottom + 31.0,
            ticks.unit("m")
        )?;
        let ticks = Ticks::new(min[1], max[1], room(height));
        for &tick in &ticks.values {
            let (_, at) = self.place(&[min[0], tick, 0.0]);
            writeln!(
                svg,
                "<path class=\"axis\" d=\"M{LEFT} {at:.1}h-4\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT - 6.0,
                at + 4.0,
                ticks.label(tick)
            )?;
        }
        writeln!(svg, "<text x=\"2\" y=\"{:.1}\">y in {}</text>", TOP - 6.0, ticks.unit("m"))
    }

    /// Ticks along the three edges of the box that nothing hides: in front below, on the right below,
    /// on the left.
    fn box_axes(&self, svg: &mut String) -> std::fmt::Result {
        let View { across, depth: (depth, sign), up, .. } = *self.view;
        let Extent { min, max } = *self.extent;
        let (front, back) =
            if sign > 0.0 { (min[depth], max[depth]) } else { (max[depth], min[depth]) };
        let corner = |a: f64, d: f64, u: f64| {
            let mut point = [0.0; 3];
            (point[across], point[depth], point[up]) = (a, d, u);
            point
        };
        let edges = [
            (across, corner(min[across], front, min[up]), corner(max[across], front, min[up])),
            (depth, corner(max[across], front, min[up]), corner(max[across], back, min[up])),
            (up, corner(min[across], front, min[up]), corner(min[across], front, max[up])),
        ];
        for (edge, (axis, from, to)) in edges.into_iter().enumerate() {
            let ((x0, y0), (x1, y1)) = (self.place(&from), self.place(&to));
            writeln!(svg, "<path class=\"axis\" d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\"/>")?;
            let wanted =
                ((x1 - x0).hypot(y1 - y0) / [45.0, 25.0, 25.0][edge]).clamp(1.0, 6.0) as usize;
            let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
            let ticks = Ticks::new(low, high, wanted);
            // Away from the box: down, to the lower right, to the left.
            let ((dx, dy), anchor) =
                [((-1.0, 4.0), "middle"), ((4.0, 2.0), "start"), ((-4.0, 0.0), "end")][edge];
            for &tick in &ticks.values {
                let mut point = from;
                point[axis] = tick;
                let (x, y) = self.place(&point);
                let below = if edge == 0 { 12.0 } else { 4.0 };
                writeln!(
                    svg,
                    "<path class=\"axis\" d=\"M{x:.1} {y:.1}l{dx} {dy}\"/>\
                     <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
                    x + 1.6 * dx,
                    y + dy + below,
                    ticks.label(tick)
                )?;
            }
            let name = ["x", "y", "z"][axis];
            let (x, y, anchor) = match edge {
                0 => (0.45 * (x0 + x1), 0.5 * (y0 + y1) + 32.0, "middle"),
                1 => (0.5 * (x0 + x1) + 30.0, 0.5 * (y0 + y1) + 18.0, "start"),
                _ => (2.0, y1 - 6.0, "start"),
            };
            writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{name} in {}</text>",
                y.max(10.0),
                ticks.unit("m")
            )?;
        }
        Ok(())
    }
}

/// The bar that explains the colours of a field.
pub fn colour_bar(id: &str, name: &str, unit: &str, scale: &Scale, range: (f64, f64)) -> String {
    const LEFT: f64 = 16.0;
    const LENGTH: f64 = 400.0;
    let ticks = Ticks::new(range.0, range.1, 6);
    let mut svg = format!(
        "<figure class=\"bar\"><svg viewBox=\"0 0 440 48\" role=\"img\" aria-label=\"{name}\">\
         <defs><linearGradient id=\"{id}\">"
    );
    for step in 0..=16 {
        let share = f64::from(step) / 16.0;
        let [r, g, b] = colours::at(scale, share);
        let _ = write!(svg, "<stop offset=\"{share}\" stop-color=\"rgb({r},{g},{b})\"/>");
    }
    let _ = write!(
        svg,
        "</linearGradient></defs><text x=\"{LEFT}\" y=\"11\">{name} in {}, cut off at the ends</text><rect x=\"{LEFT}\" y=\"16\" width=\"{LENGTH}\" \
         height=\"12\" fill=\"url(#{id})\"/>",
        ticks.unit(unit)
    );
    for &tick in &ticks.values {
        let x = LEFT + LENGTH * (tick - range.0) / (range.1 - range.0);
        let _ = write!(
            svg,
            "<path class=\"axis\" d=\"M{x:.1} 28v4\"/>\
             <text x=\"{x:.1}\" y=\"44\" text-anchor=\"middle\">{}</text>",
            ticks.label(tick)
        );
    }
    svg + "</svg></figure>\n"
}
