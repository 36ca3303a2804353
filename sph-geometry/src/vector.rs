//! Arithmetic on coordinate arrays.

use std::array::from_fn;

pub fn sub<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    from_fn(|k| a[k] - b[k])
}

/// `a + s b`.
pub fn add_scaled<const D: usize>(a: &[f64; D], s: f64, b: &[f64; D]) -> [f64; D] {
    from_fn(|k| a[k] + s * b[k])
}

pub fn scaled<const D: usize>(s: f64, a: &[f64; D]) -> [f64; D] {
    a.map(|x| s * x)
}

pub fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for k in 0..D {
        sum += a[k] * b[k];
    }
    sum
}

pub fn norm<const D: usize>(a: &[f64; D]) -> f64 {
    dot(a, a).sqrt()
}

pub fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    norm(&sub(a, b))
}

pub fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The unit vector along an axis, in its positive or negative direction.
pub fn axis<const D: usize>(along: usize, positive: bool) -> [f64; D] {
    from_fn(|k| {
        if k != along {
            0.0
        } else if positive {
            1.0
        } else {
            -1.0
        }
    })
}

/// Some unit vector at right angles to the unit vector `u`.
pub fn perpendicular<const D: usize>(u: &[f64; D]) -> [f64; D] {
    let mut least = 0;
    for k in 1..D {
        if u[k].abs() < u[least].abs() {
            least = k;
        }
    }
    let e = axis(least, true);
    let across = add_scaled(&e, -dot(&e, u), u);
    scaled(1.0 / norm(&across), &across)
}

/// The first components of a coordinate array, missing ones zero.
pub fn resized<const D: usize, const E: usize>(x: &[f64; D]) -> [f64; E] {
    from_fn(|k| x.get(k).copied().unwrap_or(0.0))
}

pub fn is_finite<const D: usize>(x: &[f64; D]) -> bool {
    x.iter().all(|x| x.is_finite())
}
