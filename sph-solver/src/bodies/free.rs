//! A body that moves freely: Newton's and Euler's equations under the loads on it.
//!
//! m dV/dt = F, dL/dt = M, L = I Ω about the centre of mass, in step with the kicks and drifts of the
//! fluid. The spin follows from L with the inertia of the orientation half a step on, as in Fincham
//! (1981), CCP5 Quarterly 2, so that a body that nothing turns keeps its angular momentum exactly.

use super::rigid::{Rigid, turned};
use super::spring::Spring;
use crate::loads::NUMBERS;
use nalgebra::{Matrix3, Vector3};

/// What a body is made of and what holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Mass, kg.
    pub mass: f64,
    /// Inertia about the centre of mass in the axes of the body, kg m².
    pub inertia: Matrix3<f64>,
    /// Axes along which the centre of mass moves.
    pub moves: [bool; 3],
    /// Axes of the scene about which the body turns.
    pub turns: [bool; 3],
    /// Springs, dampers and moorings.
    pub springs: Vec<Spring>,
    /// Share of the speed of approach with which it leaves a contact.
    pub restitution: f64,
    /// Coulomb's coefficient of friction in contacts.
    pub friction: f64,
}

/// Force (N) and moment about the centre of mass (N m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force: Vector3<f64>,
    /// Moment, N m.
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// Nothing acts.
    pub const NONE: Self =
        Self { force: Vector3::new(0.0, 0.0, 0.0), moment: Vector3::new(0.0, 0.0, 0.0) };

    /// That of a load on a solid, pressure and friction together.
    pub fn of(load: &[f64; NUMBERS]) -> Self {
        let both = |k: usize| Vector3::from_fn(|i, _| load[k + i] + load[6 + k + i]);
        Self { force: both(0), moment: both(3) }
    }
}

impl Free {
    /// The angular momentum of a body, kg m²/s, in the axes of the scene.
    pub fn angular_momentum(&self, body: &Rigid) -> Vector3<f64> {
        self.inertia_of(&body.rotation()) * body.spin
    }

    /// All that acts on the body besides contacts, from the load of the fluid on it.
    pub fn wrench(&self, body: &Rigid, fluid: Wrench, gravity: &Vector3<f64>) -> Wrench {
        let mut all = Wrench { force: fluid.force + gravity * self.mass, ..fluid };
        for spring in &self.springs {
            let (arm, force) = spring.pull(body);
            all.force += force;
            all.moment += arm.cross(&force);
        }
        all
    }

    /// Changes velocity and spin by what acts for `dt` (s), where `momentum` is the angular momentum that
    /// the body carries from kick to kick and `ahead` (s) is the coming drift.
    pub fn kick(
        &self,
        body: &mut Rigid,
        momentum: &mut Vector3<f64>,
        wrench: &Wrench,
        dt: f64,
        ahead: f64,
    ) {
        body.velocity += self.masked(wrench.force, self.moves) * (dt / self.mass);
        *momentum += self.masked(wrench.moment, self.turns) * dt;
        let halfway = turned(&body.orientation, &body.spin, 0.5 * ahead);
        let rotation = halfway.to_rotation_matrix().into_inner();
        body.spin = self.respond(&rotation, momentum);
    }

    /// How an impulse (N s) at `arm` (m) from the centre of mass changes velocity and spin at once.
    pub fn hit(
        &self,
        body: &mut Rigid,
        momentum: &mut Vector3<f64>,
        arm: &Vector3<f64>,
        impulse: &Vector3<f64>,
    ) {
        body.velocity += self.masked(*impulse, self.moves) / self.mass;
        let turn = self.masked(arm.cross(impulse), self.turns);
        *momentum += turn;
        body.spin += self.respond(&body.rotation(), &turn);
    }

    /// The part of a displacement that is not held.
    pub fn movable(&self, way: Vector3<f64>) -> Vector3<f64> {
        self.masked(way, self.moves)
    }

    /// Inverse of the mass that a contact at `arm` (m) feels along the unit vector `direction`, 1/kg.
    pub fn yielding(&self, body: &Rigid, arm: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
        let along = self.masked(*direction, self.moves).norm_squared() / self.mass;
        let turn = self.masked(arm.cross(direction), self.turns);
        along + turn.dot(&self.respond(&body.rotation(), &turn))
    }

    fn inertia_of(&self, rotation: &Matrix3<f64>) -> Matrix3<f64> {
        rotation * self.inertia * rotation.transpose()
    }

    /// The spin of an angular momentum. About axes that are held there is none: constraints take
    /// whatever momentum that needs.
    fn respond(&self, rotation: &Matrix3<f64>, momentum: &Vector3<f64>) -> Vector3<f64> {
        let mut inertia = self.inertia_of(rotation);
        for k in (0..3).filter(|&k| !self.turns[k]) {
            inertia.row_mut(k).fill(0.0);
            inertia.column_mut(k).fill(0.0);
            inertia[(k, k)] = 1.0;
        }
        let free = self.masked(*momentum, self.turns);
        // Inertias are checked to be positive when the scene is read.
        inertia.try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * free)
    }

    fn masked(&self, v: Vector3<f64>, free: [bool; 3]) -> Vector3<f64> {
        Vector3::from_fn(|k, _| if free[k] { v[k] } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn brick(turns: [bool; 3]) -> Free {
        Free {
            mass: 2.0,
            inertia: Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.0)),
            moves: [true; 3],
            turns,
            springs: vec![],
            restitution: 0.0,
            friction: 0.0,
        }
    }

    /// Turns about the middle axis are unstable: the body tumbles, and keeps momentum and energy.
    #[test]
    fn a_tumbling_brick_keeps_what_it_has() {
        let brick = brick([true; 3]);
        let mut body = Rigid::at(Vector3::zeros());
        body.spin = Vector3::new(0.01, 2.0, 0.0);
        let mut momentum = brick.angular_momentum(&body);
        let (start, energy) = (momentum, 0.5 * momentum.dot(&body.spin));
        let mut lowest = body.spin.y;
        for _ in 0..20_000 {
            brick.kick(&mut body, &mut momentum, &Wrench::NONE, 1e-3, 1e-3);
            body.drift(1e-3);
            let own = body.orientation.inverse_transform_vector(&body.spin);
            lowest = lowest.min(own.y);
        }
        assert!(lowest < -1.9, "it turns over: {lowest}");
        assert_eq!(momentum, start);
        let now = 0.5 * momentum.dot(&body.spin);
        assert!((now / energy - 1.0).abs() < 1e-3, "{now} {energy}");
    }

    #[test]
    fn what_is_held_does_not_move() {
        let mut brick = brick([false, false, true]);
        brick.moves = [true, false, true];
        let mut body = Rigid::at(Vector3::zeros());
        let mut momentum = Vector3::zeros();
        let push =
            Wrench { force: Vector3::new(4.0, 4.0, 0.0), moment: Vector3::new(1.0, 1.0, 6.0) };
        brick.kick(&mut body, &mut momentum, &push, 0.5, 0.0);
        assert_eq!(body.velocity, Vector3::new(1.0, 0.0, 0.0));
        assert_eq!(body.spin, Vector3::new(0.0, 0.0, 1.0));
        let arm = Vector3::new(1.0, 0.0, 0.0);
        assert!((brick.yielding(&body, &arm, &Vector3::y()) - 1.0 / 3.0).abs() < 1e-15);
        brick.hit(&mut body, &mut momentum, &arm, &Vector3::new(0.0, 3.0, 0.0));
        assert_eq!((body.velocity.y, body.spin.z), (0.0, 2.0));
    }
}
