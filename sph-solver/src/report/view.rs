//! Where the viewer stands: the plane as it is, space in parallel projection.

/// A box in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Lowest corner, m.
    pub min: [f64; 3],
    /// Highest corner, m.
    pub max: [f64; 3],
}

impl Extent {
    /// A box with nothing in it.
    pub const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.min[axis] > self.max[axis])
    }

    /// Takes in a point; one that is no place is ignored.
    pub fn add(&mut self, point: &[f64; 3]) {
        if point.iter().all(|x| x.is_finite()) {
            self.min = std::array::from_fn(|axis| self.min[axis].min(point[axis]));
            self.max = std::array::from_fn(|axis| self.max[axis].max(point[axis]));
        }
    }

    /// Takes in another box.
    pub fn join(&mut self, other: &Self) {
        if !other.is_empty() {
            self.add(&other.min);
            self.add(&other.max);
        }
    }

    /// A box with this much more room on all sides.
    pub fn grown(&self, by: f64) -> Self {
        Self { min: self.min.map(|x| x - by), max: self.max.map(|x| x + by) }
    }

    /// What two boxes share; this one when they share nothing.
    pub fn within(&self, other: &Self) -> Self {
        let both = Self {
            min: std::array::from_fn(|axis| self.min[axis].max(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].min(other.max[axis])),
        };
        if both.is_empty() { *self } else { both }
    }

    /// Whether a point is in the box.
    pub fn contains(&self, point: &[f64; 3]) -> bool {
        (0..3).all(|axis| (self.min[axis]..=self.max[axis]).contains(&point[axis]))
    }
}

/// A parallel projection. In three dimensions the viewer looks along the depth, from a little to the
/// right and from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The axes of the picture in space: to the right, upwards, towards the viewer.
    pub basis: [[f64; 3]; 3],
    /// The coordinate axes (0 x, 1 y, 2 z) that run across, in depth and upwards, with the direction
    /// of the depth.
    pub across: usize,
    /// See `across`.
    pub depth: (usize, f64),
    /// See `across`.
    pub up: usize,
    /// Whether there is no depth.
    pub flat: bool,
}

const AZIMUTH: f64 = 24.0;
const ELEVATION: f64 = 20.0;

impl View {
    /// The plane as it is.
    pub fn flat() -> Self {
        let basis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { basis, across: 0, depth: (2, -1.0), up: 1, flat: true }
    }

    /// Space, with this axis upwards.
    pub fn of_space(up: usize) -> Self {
        let (across, depth) = match up {
            0 => (1, (2, 1.0)),
            1 => (0, (2, -1.0)),
            _ => (0, (1, 1.0)),
        };
        let (sin_a, cos_a) = AZIMUTH.to_radians().sin_cos();
        let (sin_e, cos_e) = ELEVATION.to_radians().sin_cos();
        // Components across, in depth and upwards.
        let seen = [
            [cos_a, sin_a, 0.0],
            [-sin_e * sin_a, sin_e * cos_a, cos_e],
            [cos_e * sin_a, -cos_e * cos_a, sin_e],
        ];
        let basis = seen.map(|[a, d, u]| {
            let mut axis = [0.0; 3];
            axis[across] = a;
            axis[depth.0] = d * depth.1;
            axis[up] = u;
            axis
        });
        Self { basis, across, depth, up, flat: false }
    }

    /// Place in the picture (right, up) and nearness to the viewer, m.
    pub fn project(&self, point: &[f64; 3]) -> [f64; 3] {
        self.basis.map(|axis| (0..3).map(|k| axis[k] * point[k]).sum())
    }

    /// The picture of a box.
    pub fn frame(&self, extent: &Extent) -> Extent {
        let mut frame = Extent::EMPTY;
        for corner in 0..8 {
            let point = std::array::from_fn(|axis| {
                if corner >> axis & 1 == 0 { extent.min[axis] } else { extent.max[axis] }
            });
            frame.add(&self.project(&point));
        }
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projections_are_rotations() {
        for up in 0..3 {
            let view = View::of_space(up);
            for (i, a) in view.basis.iter().enumerate() {
                for (j, b) in view.basis.iter().enumerate() {
                    let product: f64 = (0..3).map(|k| a[k] * b[k]).sum();
                    assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
                }
            }
            let [r, u, t] = view.basis;
            let cross =
                [r[1] * u[2] - r[2] * u[1], r[2] * u[0] - r[0] * u[2], r[0] * u[1] - r[1] * u[0]];
            assert!((0..3).all(|k| (cross[k] - t[k]).abs() < 1e-12), "mirrored: {view:?}");
            let mut top = [0.0; 3];
            top[up] = 1.0;
            assert!(view.project(&top)[1] > 0.9);
        }
    }

    #[test]
    fn boxes_hold_what_they_are_given() {
        let mut extent = Extent::EMPTY;
        assert!(extent.is_empty());
        extent.add(&[1.0, 2.0, 0.0]);
        extent.add(&[f64::NAN, 9.0, 0.0]);
        extent.join(&Extent::EMPTY);
        assert_eq!(extent, Extent { min: [1.0, 2.0, 0.0], max: [1.0, 2.0, 0.0] });
        assert!(extent.grown(0.1).contains(&[1.05, 1.95, 0.0]));
        assert_eq!(View::flat().frame(&extent), extent);
    }
}
