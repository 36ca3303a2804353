//! One surface made of the balls of fluid particles, as a viewer sees it.
//!
//! How near the fluid is in each pixel is averaged with the pixels around that belong to the same piece of
//! water, and the slope of the result is lit. Screen-space rendering of particles does so (van der Laan, Green &
//! Sainz 2009, Symp. Interactive 3D Graphics and Games, who smooth by curvature flow); here it is a mean over a
//! square that stops at jumps of depth.

/// A view of the fluid, row by row from the upper left.
pub struct Surface<'a> {
    /// Pixels in a row.
    pub width: usize,
    /// How near each pixel is, m.
    pub nearness: &'a mut [f32],
    /// Place of the fluid on the scale of colours; NaN where there is none.
    pub shares: &'a mut [f32],
    /// Metres per pixel.
    pub pixel: f64,
    /// Distance of particles, m.
    pub spacing: f64,
}

/// Pixels whose nearness differs by more spacings do not belong to one surface.
const JUMP: f64 = 2.5;
/// Half of the width of the square that is averaged over, in spacings, and its most pixels.
const REACH: f64 = 1.1;
const MOST: usize = 24;
/// How often.
const TIMES: usize = 3;

impl Surface<'_> {
    /// Blends the balls.
    pub fn smooth(&mut self) {
        let reach = ((REACH * self.spacing / self.pixel).round() as usize).min(MOST);
        for _ in 0..TIMES {
            self.blend(reach, 1);
            self.blend(reach, self.width);
        }
    }

    /// Place on the scale and normal (right, up, towards the viewer) of the fluid in a pixel, if there is any.
    pub fn at(&self, index: usize) -> Option<(f64, [f64; 3])> {
        let share = f64::from(self.shares[index]);
        if share.is_nan() {
            return None;
        }
        let (right, down) = (self.slope(index, 1), self.slope(index, self.width));
        let length = (1.0 + right * right + down * down).sqrt();
        Some((share, [-right / length, down / length, 1.0 / length]))
    }

    /// Means along rows (`step` 1) or columns (`step` the width) over up to `reach` pixels on either side: as
    /// many on both, so that slopes are kept, and none beyond an edge of the surface.
    fn blend(&mut self, reach: usize, step: usize) {
        let (near, share) = (self.nearness.to_vec(), self.shares.to_vec());
        let jump = (JUMP * self.spacing) as f32;
        let next = |at: usize, forward: bool| {
            let next = self.neighbour(at, step, forward)?;
            let goes_on = !share[next].is_nan() && (near[next] - near[at]).abs() <= jump;
            goes_on.then_some(next)
        };
        let mut blended = Vec::new();
        for index in (0..near.len()).filter(|&index| !share[index].is_nan()) {
            let (mut sum, mut sum_of_shares, mut count) = (near[index], share[index], 1.0);
            let (mut before, mut after) = (index, index);
            for _ in 0..reach {
                let (Some(one), Some(other)) = (next(before, false), next(after, true)) else {
                    break;
                };
                (before, after) = (one, other);
                sum += near[one] + near[other];
                sum_of_shares += share[one] + share[other];
                count += 2.0;
            }
            blended.push((index, sum / count, sum_of_shares / count));
        }
        for (index, nearness, share) in blended {
            (self.nearness[index], self.shares[index]) = (nearness, share);
        }
    }

    /// The next pixel in a row or column.
    fn neighbour(&self, index: usize, step: usize, forward: bool) -> Option<usize> {
        let column = index % self.width;
        match (forward, step) {
            (true, 1) => (column + 1 < self.width).then_some(index + 1),
            (false, 1) => (column > 0).then(|| index - 1),
            (true, _) => Some(index + step).filter(|&next| next < self.shares.len()),
            (false, _) => index.checked_sub(step),
        }
    }

    /// Change of the nearness per length, to the right or downwards: the smaller one of both sides, so that
    /// edges do not shine; nothing where there is no neighbour.
    fn slope(&self, index: usize, step: usize) -> f64 {
        let side = |forward: bool| {
            let next = self.neighbour(index, step, forward)?;
            let change = f64::from(self.nearness[next] - self.nearness[index]);
            let fits = !self.shares[next].is_nan() && change.abs() < JUMP * self.spacing;
            fits.then_some(if forward { change } else { -change } / self.pixel)
        };
        match (side(false), side(true)) {
            (Some(a), Some(b)) => {
                if a.abs() < b.abs() {
                    a
                } else {
                    b
                }
            }
            (a, b) => a.or(b).unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 40;

    /// A slope with ripples, 0.1 m per pixel, and a hole and a step in it.
    fn rough() -> (Vec<f32>, Vec<f32>) {
        let nearness = |k: usize| {
            let (x, y) = ((k % WIDTH) as f32, (k / WIDTH) as f32);
            let step = if x < 20.0 { 0.0 } else { 50.0 };
            0.05 * x + step + 0.2 * ((1.3 * x).sin() + (1.3 * y).sin())
        };
        let share = |k: usize| if k == 5 * WIDTH + 5 { f32::NAN } else { 0.25 };
        let all = 0..WIDTH * WIDTH;
        (all.clone().map(nearness).collect(), all.map(share).collect())
    }

    #[test]
    fn ripples_vanish_and_steps_stay() {
        let (mut nearness, mut shares) = rough();
        let mut surface = Surface {
            width: WIDTH,
            nearness: &mut nearness,
            shares: &mut shares,
            pixel: 0.1,
            spacing: 1.0,
        };
        surface.smooth();
        assert!(surface.at(5 * WIDTH + 5).is_none());
        let (share, normal) = surface.at(20 * WIDTH + 30).unwrap();
        assert!((share - 0.25).abs() < 1e-6);
        // The slope is 0.05 m per 0.1 m to the right.
        let expected = [-0.5, 0.0, 1.0].map(|x: f64| x / 1.25_f64.sqrt());
        for (have, want) in normal.iter().zip(expected) {
            assert!((have - want).abs() < 0.2, "{normal:?}");
        }
        let [low, high] = [19, 20].map(|x| surface.nearness[20 * WIDTH + x]);
        assert!(high - low > 45.0, "{low} {high}");
    }
}
