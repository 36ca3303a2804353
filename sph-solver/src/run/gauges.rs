//! Gauges: readings that need more of the fluid than what is around one point. The same bits on any
//! ranks.

use super::samples::{Quantity, value};
use crate::error::RunError;
use crate::model::Model;
use crate::simulation::FullStep;
use crate::space;
use sph_decomp::{Communicator, ExactSum, global_sums};

/// The fluid at one moment, to be read at places between its particles.
pub struct Field<'a, const D: usize> {
    /// Ranks.
    pub comm: &'a dyn Communicator,
    /// Constants.
    pub model: &'a Model<D>,
    /// Particles of this rank.
    pub full: &'a FullStep<D>,
    /// The kernel as a function of the distance divided by the support radius, in any unit.
    pub weight: fn(f64) -> f64,
}

/// Points of a column that are looked at together, from the top.
const CHUNK: usize = 32;

/// A level is where this much of the kernel is full of water, as at a calm surface. Drops are not.
const SURFACE: f64 = 0.5;

impl<const D: usize> Field<'_, D> {
    /// At each of `points`: Σ w V, and Σ w V f for each of the `quantities` f. Collective.
    pub fn sums(&self, points: &[[f64; D]], quantities: &[Quantity]) -> Result<Vec<f64>, RunError> {
        let stride = 1 + quantities.len();
        let largest = self.model.support_radius;
        let mut sums = vec![ExactSum::new(); stride * points.len()];
        let periods = &self.model.periods;
        let (middle, half) = around(points, largest);
        for (i, x) in self.full.position.iter().enumerate() {
            let offset = space::offset(x, &middle, periods);
            if (0..D).any(|k| offset[k].abs() > half[k]) {
                continue;
            }
            let volume = self.full.mass[i] / self.full.density[i];
            let radius = self.model.radius_of(self.full.mass[i]);
            let norm = (largest / radius).powi(D as i32);
            for (point, sums) in points.iter().zip(sums.chunks_exact_mut(stride)) {
                let offset = space::offset(x, point, periods);
                let distance = offset.iter().map(|d| d * d).sum::<f64>().sqrt();
                if distance >= radius {
                    continue;
                }
                // The norm of the kernel goes with R^-D; what is left of it cancels in means.
                let weight = (self.weight)(distance / radius) * volume * norm;
                sums[0].add(weight);
                for (sum, quantity) in sums[1..].iter_mut().zip(quantities) {
                    sum.add(weight * value(self.model, self.full, i, *quantity));
                }
            }
        }
        Ok(global_sums(&self.comm, &sums)?)
    }

    /// Means of the `quantities` over those of `points` that are wet, NaN when none is, and the share
    /// of points that are. Collective.
    pub fn means(
        &self,
        points: &[[f64; D]],
        quantities: &[Quantity],
    ) -> Result<Vec<f64>, RunError> {
        let sums = self.sums(points, quantities)?;
        let mut totals = vec![0.0; quantities.len()];
        let mut wet = 0;
        for sums in sums.chunks_exact(1 + quantities.len()).filter(|sums| sums[0] > 0.0) {
            wet += 1;
            for (total, sum) in totals.iter_mut().zip(&sums[1..]) {
                *total += sum / sums[0];
            }
        }
        // 0/0 is NaN: nothing was read.
        let means = totals.into_iter().map(|total| total / f64::from(wet));
        Ok(means.chain([f64::from(wet) / points.len() as f64]).collect())
    }

    /// The highest level of water on the vertical line through `at`, as a coordinate against gravity,
    /// m; NaN when there is none. Collective.
    pub fn level(&self, at: &[f64; D]) -> Result<f64, RunError> {
        let Some(up) = upwards(&self.model.gravity) else { return Ok(f64::NAN) };
        let height = |x: &[f64; D]| (0..D).map(|k| up[k] * x[k]).sum::<f64>();
        let radius = self.model.support_radius;
        // Heights of the fluid near the line: the highest, and the lowest with its sign turned.
        let mut ends = [f64::NEG_INFINITY; 2];
        for x in &self.full.position {
            let offset = space::offset(x, at, &self.model.periods);
            let along = height(&offset);
            let aside = (0..D).map(|k| (offset[k] - along * up[k]).powi(2)).sum::<f64>();
            if aside < radius * radius {
                ends = [ends[0].max(along), ends[1].max(-along)];
            }
        }
        self.comm.max_f64(&mut ends)?;
        let [top, bottom] = [ends[0], -ends[1]];
        if !(top.is_finite() && bottom.is_finite()) {
            return Ok(f64::NAN);
        }
        let (full, step) = (self.full_sum(), 0.5 * self.model.spacing);
        let mut above = 0.0;
        let mut along = top + radius;
        while along >= bottom {
            let places: Vec<f64> = (0..CHUNK).map(|n| along - n as f64 * step).collect();
            let points: Vec<[f64; D]> =
                places.iter().map(|along| std::array::from_fn(|k| at[k] + along * up[k])).collect();
            for (place, sum) in places.iter().zip(self.sums(&points, &[])?) {
                let here = sum / full;
                if here >= SURFACE {
                    // Between this place and the one above.
                    let part = (here - SURFACE) / (here - above);
                    return Ok(height(at) + place + part * step);
                }
                above = here;
            }
            along -= CHUNK as f64 * step;
        }
        Ok(f64::NAN)
    }

    /// Volume that flows through the plane through `at` with this `normal` in a second, m³/s (m²/s in
    /// two dimensions), positive along the normal. A particle counts within one spacing of the plane,
    /// by a weight that falls linearly with its distance, so that every particle of a stream counts as
    /// much in sum while it passes. Collective.
    pub fn flow(&self, at: &[f64; D], normal: &[f64; D]) -> Result<f64, RunError> {
        let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        let dot = |x: &[f64; D]| (0..D).map(|k| x[k] * normal[k]).sum::<f64>() / length;
        let mut sum = ExactSum::new();
        for (i, x) in self.full.position.iter().enumerate() {
            let offset = space::offset(x, at, &self.model.periods);
            let spacing = self.model.spacing_of(self.full.mass[i]);
            let weight = 1.0 - dot(&offset).abs() / spacing;
            if weight > 0.0 {
                let volume = self.full.mass[i] / self.full.density[i];
                sum.add(weight * volume / spacing * dot(&self.full.velocity[i]));
            }
        }
        Ok(global_sums(&self.comm, &[sum])?[0])
    }

    /// Σ w V inside of the fluid: over the lattice that particles begin on.
    fn full_sum(&self) -> f64 {
        let (spacing, radius) = (self.model.spacing, self.model.support_radius);
        let reach = (radius / spacing).ceil() as i64;
        let cells = cells::<D>(reach);
        let distances = cells.map(|cell| {
            cell.iter().map(|&i| (i as f64 * spacing).powi(2)).sum::<f64>().sqrt() / radius
        });
        let sum: f64 = distances.filter(|q| *q < 1.0).map(|q| (self.weight)(q)).sum();
        sum * spacing.powi(D as i32)
    }
}

/// The unit vector against gravity, if there is any.
fn upwards<const D: usize>(gravity: &[f64; D]) -> Option<[f64; D]> {
    let strength = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    (strength > 0.0).then(|| gravity.map(|g| -g / strength))
}

/// Points that cover a patch around `at`, a spacing apart: a ball, or with a `normal` the disc across
/// it (a segment in two dimensions). `at` itself is one of them.
pub fn patch<const D: usize>(
    at: &[f64; D],
    radius: f64,
    normal: Option<&[f64; D]>,
    spacing: f64,
) -> Vec<[f64; D]> {
    let reach = (radius / spacing).floor() as i64;
    let axes = axes(normal);
    let flat = normal.is_some();
    let inside = |cell: &[i64; D]| {
        let square = cell.iter().map(|i| i * i).sum::<i64>() as f64;
        square.sqrt() * spacing <= radius && !(flat && cell[0] != 0)
    };
    cells(reach)
        .filter(inside)
        .map(|cell| {
            std::array::from_fn(|k| {
                at[k] + (0..D).map(|a| cell[a] as f64 * spacing * axes[a][k]).sum::<f64>()
            })
        })
        .collect()
}

/// Orthogonal unit vectors, the first along the `normal` (Gram & Schmidt); the coordinate axes without.
fn axes<const D: usize>(normal: Option<&[f64; D]>) -> [[f64; D]; D] {
    let unit =
        |axis: usize| -> [f64; D] { std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 }) };
    let Some(normal) = normal else { return std::array::from_fn(unit) };
    // Those coordinate axes first that the normal is farthest from.
    let mut order: Vec<usize> = (0..D).collect();
    order.sort_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs()));
    let mut axes = [[0.0; D]; D];
    for a in 0..D {
        let mut axis = if a == 0 { *normal } else { unit(order[a - 1]) };
        for before in &axes[..a] {
            let along: f64 = (0..D).map(|k| axis[k] * before[k]).sum();
            axis = std::array::from_fn(|k| axis[k] - along * before[k]);
        }
        let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
        axes[a] = axis.map(|c| c / length);
    }
    axes
}

/// Middle and half sides of the box that holds everything within `radius` of the points.
fn around<const D: usize>(points: &[[f64; D]], radius: f64) -> ([f64; D], [f64; D]) {
    let along = |k: usize| points.iter().map(move |point| point[k]);
    let lower = |k: usize| along(k).fold(f64::INFINITY, f64::min);
    let upper = |k: usize| along(k).fold(f64::NEG_INFINITY, f64::max);
    (
        std::array::from_fn(|k| 0.5 * (lower(k) + upper(k))),
        // More by what the middle is rounded.
        std::array::from_fn(|k| 0.5 * (upper(k) - lower(k)) + 1.001 * radius),
    )
}

/// All indices from −reach to reach.
fn cells<const D: usize>(reach: i64) -> impl Iterator<Item = [i64; D]> {
    let side = (2 * reach + 1) as usize;
    (0..side.pow(D as u32)).map(move |number| {
        let mut rest = number;
        std::array::from_fn(|_| {
            let index = rest % side;
            rest /= side;
            index as i64 - reach
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_patch_is_a_ball_or_a_disc() {
        let ball = patch(&[1.0, 2.0, 3.0], 0.1, None, 0.1);
        assert_eq!(ball.len(), 7);
        let disc = patch(&[1.0, 2.0, 3.0], 0.1, Some(&[0.0, 0.0, 5.0]), 0.1);
        assert_eq!(disc.len(), 5);
        assert!(disc.iter().all(|x| x[2] == 3.0), "{disc:?}");
        assert_eq!(patch(&[1.0, 2.0], 0.01, None, 0.1), [[1.0, 2.0]]);
    }

    proptest! {
        #[test]
        fn a_disc_lies_across_its_normal(
            normal in prop::array::uniform3(-1.0..1.0_f64),
            radius in 0.0..0.5,
        ) {
            let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            prop_assume!(length > 1e-3);
            let at = [0.3, -0.2, 5.0];
            let disc = patch(&at, radius, Some(&normal), 0.1);
            let flat = patch(&[0.0; 2], radius, None, 0.1);
            prop_assert_eq!(disc.len(), flat.len());
            for x in disc {
                let offset: [f64; 3] = std::array::from_fn(|k| x[k] - at[k]);
                let along: f64 = (0..3).map(|k| offset[k] * normal[k]).sum::<f64>() / length;
                let distance = offset.iter().map(|d| d * d).sum::<f64>().sqrt();
                prop_assert!(along.abs() < 1e-9 && distance < radius + 1e-9, "{x:?}");
            }
        }
    }
}
