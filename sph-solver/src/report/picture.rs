//! Draws particles as pixels and packs them as a PNG.

use super::colours::{self, Rgb, Scale};
use super::surface::Surface;
use super::view::{Extent, View};

/// A picture of 256 colours being drawn.
#[derive(Debug)]
pub struct Picture {
    width: usize,
    height: usize,
    /// Pixels per metre.
    scale: f64,
    view: View,
    frame: Extent,
    colours: Vec<Rgb>,
    levels: usize,
    shades: usize,
    pixels: Vec<u8>,
    nearness: Vec<f32>,
    /// Place on the scale of the fluid that is seen; NaN where none is.
    shares: Vec<f32>,
}

/// Index of the paper.
const PAPER: u8 = 0;
/// Indices of the walls, from dark to light, follow that of the paper.
const WALLS: usize = 8;
const WALL_COLOUR: Rgb = [214, 214, 218];
/// Light on the darkest visible wall.
const WALL_DIM: f64 = 0.72;
/// Light on the darkest visible side of a particle.
const DIM: f64 = 0.45;

impl Picture {
    /// An empty picture of `extent` with about so many pixels.
    pub fn new(view: View, extent: &Extent, scale: &Scale, pixels: f64) -> Self {
        let frame = view.frame(extent);
        let [across, up] = [0, 1].map(|axis| (frame.max[axis] - frame.min[axis]).max(1e-9));
        let per_metre = (pixels / (across * up)).sqrt();
        let pixels = |length: f64| ((length * per_metre).round() as usize).clamp(1, 4000);
        let (width, height) = (pixels(across), pixels(up));
        // What is flat needs no shades, and gets more levels instead.
        let (levels, shades) = if view.flat { (246, 1) } else { (30, 8) };
        let mut palette = vec![[255, 255, 255]];
        palette.extend((0..WALLS).map(|k| {
            let light = WALL_DIM + (1.0 - WALL_DIM) * k as f64 / (WALLS - 1) as f64;
            colours::lit(WALL_COLOUR, light)
        }));
        for level in 0..levels {
            let colour = colours::at(scale, level as f64 / (levels - 1) as f64);
            palette.extend((0..shades).map(|k| {
                let light = if shades == 1 { 1.0 } else { k as f64 / (shades - 1) as f64 };
                colours::lit(colour, DIM + (1.0 - DIM) * light)
            }));
        }
        Self {
            width,
            height,
            scale: width as f64 / across,
            view,
            frame,
            colours: palette,
            levels,
            shades,
            pixels: vec![PAPER; width * height],
            nearness: vec![f32::NEG_INFINITY; width * height],
            shares: vec![f32::NAN; width * height],
        }
    }

    /// Draws a fluid particle; `share` is its place on the scale from 0 to 1.
    pub fn particle(&mut self, point: &[f64; 3], radius: f64, share: f64) {
        let share = share.clamp(0.0, 1.0);
        let (levels, shades) = (self.levels, self.shades);
        self.ball(point, radius, share as f32, |light| fluid(share, light, levels, shades));
    }

    /// Makes one surface of the particles of a fluid in space, `spacing` apart: their balls are blended and
    /// lit anew. The plane is left as it is.
    pub fn join_fluid(&mut self, spacing: f64) {
        if self.view.flat {
            return;
        }
        let mut surface = Surface {
            width: self.width,
            nearness: &mut self.nearness,
            shares: &mut self.shares,
            pixel: 1.0 / self.scale,
            spacing,
        };
        surface.smooth();
        let (levels, shades) = (self.levels, self.shades);
        for (index, pixel) in self.pixels.iter_mut().enumerate() {
            if let Some((share, [right, up, towards])) = surface.at(index) {
                *pixel = fluid(share, lighting(right, up, towards), levels, shades);
            }
        }
    }

    /// Draws a piece of a wall. In space only those that face the viewer are seen, so that a tank
    /// does not hide what is in it.
    pub fn wall(&mut self, point: &[f64; 3], size: f64, normal: Option<&[f64]>) {
        if self.view.flat {
            return self.square(point, size);
        }
        if let Some(&[a, b, c]) = normal {
            let facing = self.view.project(&[a, b, c]);
            if facing[2] <= 0.05 {
                return;
            }
            // Lit as the face that it is part of: walls look even.
            let light = lighting(facing[0], facing[1], facing[2]);
            let shade = 1 + (light * (WALLS - 1) as f64).round() as usize;
            return self.ball(point, 0.75 * size, f32::NAN, |_| shade as u8);
        }
        let shade = |light: f64| 1 + (light * (WALLS - 1) as f64).round() as u8;
        self.ball(point, 0.6 * size, f32::NAN, shade);
    }

    fn place(&self, point: &[f64; 3]) -> Option<[f64; 3]> {
        let seen = self.view.project(point);
        let x = (seen[0] - self.frame.min[0]) * self.scale;
        let y = (self.frame.max[1] - seen[1]) * self.scale;
        (x.is_finite() && y.is_finite() && x.abs() < 1e6 && y.abs() < 1e6)
            .then_some([x, y, seen[2]])
    }

    fn ball(&mut self, point: &[f64; 3], radius: f64, share: f32, colour: impl Fn(f64) -> u8) {
        let Some([x, y, near]) = self.place(point) else { return };
        let r = (radius * self.scale).max(0.8);
        let range = |middle: f64, end: usize| {
            let low = (middle - r - 0.5).ceil().max(0.0) as usize;
            let high = ((middle + r + 0.5).floor().max(0.0) as usize).min(end);
            low..high
        };
        for row in range(y, self.height) {
            let dy = (row as f64 + 0.5 - y) / r;
            for column in range(x, self.width) {
                let dx = (column as f64 + 0.5 - x) / r;
                let square = dx * dx + dy * dy;
                if square > 1.0 {
                    continue;
                }
                let bulge = (1.0 - square).sqrt();
                let near = if self.view.flat { near - square } else { near + radius * bulge };
                let pixel = row * self.width + column;
                if near as f32 > self.nearness[pixel] {
                    self.nearness[pixel] = near as f32;
                    self.shares[pixel] = share;
                    self.pixels[pixel] = colour(lighting(dx, -dy, bulge));
                }
            }
        }
    }

    fn square(&mut self, point: &[f64; 3], size: f64) {
        let Some([x, y, _]) = self.place(point) else { return };
        let half = 0.5 * size * self.scale;
        let range = |middle: f64, end: usize| {
            let low = (middle - half).round().max(0.0) as usize;
            // At least one pixel, whatever its size.
            let high = (middle + half).round().max(0.0) as usize;
            low..high.max(low + 1).min(end)
        };
        for row in range(y, self.height) {
            for column in range(x, self.width) {
                self.pixels[row * self.width + column] = WALLS as u8;
            }
        }
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(self.colours.concat());
        encoder.set_compression(png::Compression::High);
        // Neighbours in a picture of indices have nothing to do with each other.
        encoder.set_filter(png::Filter::NoFilter);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// Index of the fluid at this place on the scale in this much light.
fn fluid(share: f64, light: f64, levels: usize, shades: usize) -> u8 {
    let step =
        |part: f64, steps: usize| (part.clamp(0.0, 1.0) * (steps - 1) as f64).round() as usize;
    (1 + WALLS + step(share, levels) * shades + step(light, shades)) as u8
}

/// Light from the upper left behind the viewer on a surface with this normal, from 0 to 1.
fn lighting(right: f64, up: f64, towards: f64) -> f64 {
    (-0.35 * right + 0.55 * up + 0.76 * towards).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Extent = Extent { min: [0.0; 3], max: [1.0, 0.5, 0.0] };

    #[test]
    fn particles_are_where_they_are() {
        let mut picture = Picture::new(View::flat(), &UNIT, &colours::SPEED, 20_000.0);
        assert_eq!((picture.width, picture.height), (200, 100));
        picture.wall(&[0.9, 0.1, 0.0], 0.1, None);
        picture.particle(&[0.25, 0.4, 0.0], 0.05, 1.0);
        picture.particle(&[f64::NAN, 0.4, 0.0], 0.05, 1.0);
        let pixel = |x: usize, y: usize| picture.colours[picture.pixels[y * 200 + x] as usize];
        assert_eq!(pixel(50, 20), colours::SPEED[8]);
        assert_eq!(pixel(180, 80), WALL_COLOUR);
        assert_eq!(pixel(100, 50), [255, 255, 255]);
        let drawn = picture.pixels.iter().filter(|index| **index > WALLS as u8).count();
        assert!((300..330).contains(&drawn), "a disk of 10 pixels: {drawn}");
    }

    #[test]
    fn the_nearer_particle_hides_the_farther_one() {
        let view = View::of_space(2);
        let towards = view.basis[2];
        let extent = Extent { min: [-1.0; 3], max: [1.0; 3] };
        for shares in [[0.0, 1.0], [1.0, 0.0]] {
            let mut picture = Picture::new(view, &extent, &colours::SPEED, 40_000.0);
            picture.particle(&[0.0; 3], 0.1, shares[0]);
            picture.particle(&towards.map(|x| 0.3 * x), 0.1, shares[1]);
            picture.particle(&[0.0; 3], 0.1, shares[0]);
            let middle = picture.height / 2 * picture.width + picture.width / 2;
            let level = (picture.pixels[middle] as usize - 1 - WALLS) / picture.shades;
            assert_eq!(level, (shares[1] * 29.0) as usize);
        }
    }

    #[test]
    fn walls_that_turn_away_are_not_drawn() {
        let view = View::of_space(2);
        let extent = Extent { min: [-1.0; 3], max: [1.0; 3] };
        let mut picture = Picture::new(view, &extent, &colours::SPEED, 10_000.0);
        picture.wall(&[0.0; 3], 0.2, Some(&[0.0, 1.0, 0.0]));
        assert!(picture.pixels.iter().all(|index| *index == PAPER));
        picture.wall(&[0.0; 3], 0.2, Some(&[0.0, -1.0, 0.0]));
        assert!(picture.pixels.iter().any(|index| (1..=WALLS as u8).contains(index)));
    }

    #[test]
    fn the_file_is_read_back() {
        let mut picture = Picture::new(View::flat(), &UNIT, &colours::PRESSURE, 5000.0);
        picture.particle(&[0.5, 0.25, 0.0], 0.1, 0.5);
        let bytes = picture.png().unwrap();
        let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels, picture.pixels);
    }
}
