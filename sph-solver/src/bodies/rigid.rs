//! Place and motion of a rigid body. Two dimensions are the plane z = 0, turned about z.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Place and motion of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Where the reference point is, m: the centre of mass of a body that moves freely.
    pub position: Vector3<f64>,
    /// From the axes of the body, which at the start are those of the scene, to those of the scene.
    pub orientation: UnitQuaternion<f64>,
    /// Velocity of the reference point, m/s.
    pub velocity: Vector3<f64>,
    /// Angular velocity in the axes of the scene, rad/s.
    pub spin: Vector3<f64>,
}

/// Numbers of [`Rigid::to_array`].
pub const NUMBERS: usize = 13;

impl Rigid {
    /// At rest at a point (m).
    pub fn at(position: Vector3<f64>) -> Self {
        let (velocity, spin) = (Vector3::zeros(), Vector3::zeros());
        Self { position, orientation: UnitQuaternion::identity(), velocity, spin }
    }

    /// Rotation from the axes of the body to those of the scene.
    pub fn rotation(&self) -> Matrix3<f64> {
        self.orientation.to_rotation_matrix().into_inner()
    }

    /// Where a point of the body is that lies at `arm` (m) from the reference point in its own axes.
    pub fn place(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        self.position + self.orientation * arm
    }

    /// The point of the body, relative to its reference point in its own axes, that is at `x` (m).
    pub fn arm(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.orientation.inverse_transform_vector(&(x - self.position))
    }

    /// Velocity of the body at the point `x`, m/s.
    pub fn velocity_at(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.velocity + self.spin.cross(&(x - self.position))
    }

    /// Moves on by `dt` (s).
    pub fn drift(&mut self, dt: f64) {
        self.position += self.velocity * dt;
        self.orientation = turned(&self.orientation, &self.spin, dt);
    }

    /// As numbers, for checkpoints.
    pub fn to_array(self) -> [f64; NUMBERS] {
        let (x, v, s, q) = (self.position, self.velocity, self.spin, self.orientation);
        [x.x, x.y, x.z, q.w, q.i, q.j, q.k, v.x, v.y, v.z, s.x, s.y, s.z]
    }

    /// Back from [`to_array`](Self::to_array).
    pub fn from_array(numbers: [f64; NUMBERS]) -> Self {
        let [x, y, z, w, i, j, k, u, v, t, a, b, c] = numbers;
        Self {
            position: Vector3::new(x, y, z),
            // As it was: to normalize again would change its last bits.
            orientation: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
            velocity: Vector3::new(u, v, t),
            spin: Vector3::new(a, b, c),
        }
    }
}

/// Turned with a constant spin for `dt` (s). By Cayley's map: a rotation exactly, its angle right to
/// second order, with nothing but correctly rounded arithmetic, so that all machines agree.
pub fn turned(
    orientation: &UnitQuaternion<f64>,
    spin: &Vector3<f64>,
    dt: f64,
) -> UnitQuaternion<f64> {
    if *spin == Vector3::zeros() {
        return *orientation;
    }
    let half = spin * (0.5 * dt);
    let turn = Quaternion::new(1.0, half.x, half.y, half.z);
    UnitQuaternion::new_normalize(turn * orientation.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_turn_is_right_to_second_order() {
        let error = |steps: usize| {
            let mut wheel = Rigid::at(Vector3::new(1.0, 0.0, 0.0));
            wheel.spin = Vector3::new(0.0, 0.0, 2.0 * PI);
            (0..steps).for_each(|_| wheel.drift(0.25 / steps as f64));
            (wheel.place(&Vector3::x()) - Vector3::new(1.0, 1.0, 0.0)).norm()
        };
        assert!(error(100) < 1e-3 && (error(100) / error(200) - 4.0).abs() < 0.1);
    }

    #[test]
    fn a_body_knows_its_points() {
        let mut body = Rigid::at(Vector3::new(1.0, 2.0, 3.0));
        body.spin = Vector3::new(0.3, -0.2, 0.5);
        body.velocity = Vector3::new(1.0, 0.0, 0.0);
        body.drift(0.7);
        let arm = Vector3::new(0.1, 0.2, -0.3);
        assert!((body.arm(&body.place(&arm)) - arm).norm() < 1e-15);
        assert!((body.rotation() * arm + body.position - body.place(&arm)).norm() < 1e-15);
        assert_eq!(Rigid::from_array(body.to_array()), body);
    }
}
