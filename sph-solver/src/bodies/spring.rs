//! Springs, dampers and moorings between a body and a fixed point.

use super::rigid::Rigid;
use nalgebra::Vector3;

/// A linear spring with a damper beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Its fixed end, m.
    pub anchor: Vector3<f64>,
    /// Its end on the body, from the centre of mass in the axes of the body, m.
    pub arm: Vector3<f64>,
    /// Length without a force, m.
    pub length: f64,
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping along the spring, N s/m.
    pub damping: f64,
    /// Whether it only pulls, as a rope does.
    pub slack: bool,
}

impl Spring {
    /// Where the spring pulls, from the centre of mass in the axes of the scene (m), and its force on the
    /// body (N).
    pub fn pull(&self, body: &Rigid) -> (Vector3<f64>, Vector3<f64>) {
        let arm = body.orientation * self.arm;
        let end = body.position + arm;
        let span = self.anchor - end;
        let length = span.norm();
        let direction = if length > 0.0 { span / length } else { Vector3::zeros() };
        let stretch = length - self.length;
        if self.slack && stretch <= 0.0 {
            return (arm, Vector3::zeros());
        }
        let parting = -direction.dot(&body.velocity_at(&end));
        let tension = self.stiffness * stretch + self.damping * parting;
        (arm, direction * if self.slack { tension.max(0.0) } else { tension })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROPE: Spring = Spring {
        anchor: Vector3::new(0.0, 0.0, 0.0),
        arm: Vector3::new(0.0, 1.0, 0.0),
        length: 2.0,
        stiffness: 10.0,
        damping: 3.0,
        slack: true,
    };

    #[test]
    fn a_rope_pulls_when_it_is_tight() {
        let mut body = Rigid::at(Vector3::new(0.0, -2.5, 0.0));
        assert_eq!(ROPE.pull(&body).1, Vector3::zeros());
        assert_eq!(Spring { slack: false, ..ROPE }.pull(&body).1.y, -5.0);
        body.position.y = -4.0;
        assert_eq!(ROPE.pull(&body), (ROPE.arm, Vector3::new(0.0, 10.0, 0.0)));
        body.velocity.y = -1.0;
        assert_eq!(ROPE.pull(&body).1.y, 13.0);
        body.velocity.y = 9.0;
        assert_eq!(ROPE.pull(&body).1.y, 0.0);
    }
}
