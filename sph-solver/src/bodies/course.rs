//! Prescribed motion: where a solid is at a given time, whatever the fluid does.

use super::rigid::Rigid;
use crate::scene::TimedFormula;
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// A prescribed motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// The point that the solid turns about, at the start, m.
    pub about: Vector3<f64>,
    /// The axis that it turns about.
    pub axis: Unit<Vector3<f64>>,
    /// How far it has gone.
    pub path: Path,
}

/// Displacement (m) and angle (rad) over time.
#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    /// A constant velocity (m/s) and spin (rad/s).
    Steady {
        /// Velocity, m/s.
        velocity: Vector3<f64>,
        /// Angular velocity about the axis, rad/s.
        spin: f64,
    },
    /// Formulas in t, relative to the place at t = 0.
    Formulas {
        /// Displacement along x, y and z, m.
        displacement: Box<[TimedFormula; 3]>,
        /// Angle about the axis, rad.
        angle: TimedFormula,
    },
    /// Rows of a table.
    Table(Vec<Row>),
}

/// A row of a table of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Displacement (m) along x, y, z and angle about the axis (rad).
    pub place: [f64; 4],
}

impl Course {
    /// Place and orientation at a time (s), at rest.
    pub fn at(&self, time: f64) -> Rigid {
        let [x, y, z, angle] = self.path.at(time);
        Rigid {
            orientation: UnitQuaternion::from_axis_angle(&self.axis, angle),
            ..Rigid::at(self.about + Vector3::new(x, y, z))
        }
    }

    /// Where the solid is at `time + dt` (s), with the constant velocity and spin that lead there from
    /// `time`: the walls sweep exactly the volume that the fluid must make room for.
    pub fn step(&self, time: f64, dt: f64) -> Rigid {
        let (before, after) = (self.path.at(time), self.path.at(time + dt));
        let rate = |k: usize| (after[k] - before[k]) / dt;
        Rigid {
            velocity: Vector3::new(rate(0), rate(1), rate(2)),
            spin: self.axis.into_inner() * rate(3),
            ..self.at(time + dt)
        }
    }
}

impl Path {
    /// Displacement (m) along x, y and z and angle (rad) at a time (s).
    pub fn at(&self, time: f64) -> [f64; 4] {
        match self {
            Self::Steady { velocity, spin } => {
                [velocity.x * time, velocity.y * time, velocity.z * time, spin * time]
            }
            Self::Formulas { displacement, angle } => {
                let [x, y, z] = &**displacement;
                // Where the solid is at the start is where the scene puts it.
                [x, y, z, angle].map(|formula| formula.at_time(time) - formula.at_time(0.0))
            }
            Self::Table(rows) => interpolated(rows, time),
        }
    }
}

/// Between the rows by cubic polynomials whose slopes at a row are those of the parabola through it and the
/// rows beside, so that the velocity has no jumps; before the first row and after the last one as there.
fn interpolated(rows: &[Row], time: f64) -> [f64; 4] {
    let next = rows.partition_point(|row| row.time <= time);
    let (Some(before), Some(after)) = (next.checked_sub(1).map(|k| rows[k]), rows.get(next)) else {
        let end = if next == 0 { rows.first() } else { rows.last() };
        return end.map_or([0.0; 4], |row| row.place);
    };
    let chord = |a: &Row, b: &Row, k: usize| (b.place[k] - a.place[k]) / (b.time - a.time);
    let slope = |at: usize, k: usize| {
        let before = at.checked_sub(1).map(|before| &rows[before]);
        match (before, &rows[at], rows.get(at + 1)) {
            (Some(a), row, Some(b)) => {
                let (back, ahead) = (row.time - a.time, b.time - row.time);
                (chord(a, row, k) * ahead + chord(row, b, k) * back) / (back + ahead)
            }
            (Some(a), row, None) => chord(a, row, k),
            (None, row, Some(b)) => chord(row, b, k),
            (None, _, None) => 0.0,
        }
    };
    let width = after.time - before.time;
    let s = (time - before.time) / width;
    std::array::from_fn(|k| {
        let (a, b) = (before.place[k], after.place[k]);
        let (m, n) = (width * slope(next - 1, k), width * slope(next, k));
        let rise = b - a;
        a + s * (m + s * (3.0 * rise - 2.0 * m - n + s * (m + n - 2.0 * rise)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(path: Path) -> Course {
        Course { about: Vector3::new(1.0, 0.0, 0.0), axis: Vector3::z_axis(), path }
    }

    #[test]
    fn formulas_are_relative_to_the_start() {
        let displacement = Box::new(["cos(t)", "0", "0"].map(TimedFormula::new));
        let course = course(Path::Formulas { displacement, angle: TimedFormula::new("2*t") });
        assert_eq!(course.at(0.0), Rigid::at(Vector3::new(1.0, 0.0, 0.0)));
        assert!((course.at(1.0).position.x - 1.0_f64.cos()).abs() < 1e-15);
        let step = course.step(1.0, 1e-4);
        assert!((step.spin.z - 2.0).abs() < 1e-9);
        assert!((step.velocity.x + 1.00005_f64.sin()).abs() < 1e-8);
    }

    #[test]
    fn steps_lead_along_the_course() {
        let velocity = Vector3::new(1.0, -2.0, 0.0);
        let course = course(Path::Steady { velocity, spin: 3.0 });
        let mut body = course.at(0.3);
        let step = course.step(0.3, 0.01);
        (body.velocity, body.spin) = (step.velocity, step.spin);
        body.drift(0.01);
        assert!((body.position - step.position).norm() < 1e-12);
        assert!(body.orientation.angle_to(&step.orientation) < 1e-5);
    }

    #[test]
    fn tables_are_met_at_their_rows_and_smooth_between() {
        let row = |time: f64| Row { time, place: [time * time, 0.0, 0.0, -time] };
        let rows: Vec<Row> = [0.5, 1.0, 1.5, 2.5].map(row).to_vec();
        let path = Path::Table(rows.clone());
        for row in &rows {
            assert_eq!(path.at(row.time), row.place);
        }
        assert_eq!((path.at(0.0), path.at(9.0)), (rows[0].place, rows[3].place));
        assert!((path.at(1.2)[0] - 1.44).abs() < 1e-12 && (path.at(1.2)[3] + 1.2).abs() < 1e-12);
        let speed = |t: f64| (path.at(t + 1e-7)[0] - path.at(t - 1e-7)[0]) / 2e-7;
        assert!((speed(1.5 - 1e-6) - speed(1.5 + 1e-6)).abs() < 1e-4);
    }
}
