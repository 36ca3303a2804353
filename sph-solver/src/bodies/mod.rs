//! Solids that move: prescribed motion and free bodies.
//!
//! Every rank holds the state of every body and all its wall elements, in the axes of the body, and moves
//! them by itself: nothing travels but the loads on free bodies, which are summed as whole numbers, so that
//! all ranks move a body by the same bits. At a rebuild each rank places the elements near its fluid
//! as one more [set of walls](crate::walls); in between it moves them once a step. The fluid feels a body
//! as it feels a wall at rest, in the frame that moves with the body.
//!
//! In time a body goes with the fluid: its velocities are half a step behind its place, and each step
//! kicks them over that place and then drifts.

mod contact;
mod course;
mod frame;
mod free;
mod rigid;
mod spring;

pub use course::{Course, Path, Row};
pub use frame::{Frame, turning};
pub use free::{Free, Wrench};
pub use rigid::Rigid;
pub use spring::Spring;

use crate::error::RunError;
use crate::lio::Extremes;
use crate::model::Model;
use crate::records::Encoder;
use crate::search::Search;
use crate::space::wrapped;
use crate::walls::{WallElements, WallSet};
use contact::{Gap, Obstacles};
use nalgebra::Vector3;
use sph_geometry::{Aabb, Solid};
use sph_kernels::Real;
use std::sync::Arc;

/// What moves a body.
#[derive(Debug, Clone, PartialEq)]
pub enum Guide {
    /// Its course is prescribed.
    Course(Course),
    /// It moves freely.
    Free(Free),
}

/// A solid that moves.
#[derive(Debug, Clone)]
pub struct Body<const D: usize> {
    /// Number of the solid in the scene.
    pub solid: u16,
    /// What moves it.
    pub guide: Guide,
    /// Place and motion at the start.
    pub start: Rigid,
    /// The solid where the scene puts it.
    pub shape: Solid<D>,
    /// Its wall elements where the scene puts them.
    pub elements: WallElements<D>,
}

/// Place and motion of a body at a full step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// Place and motion, all at the same time.
    pub rigid: Rigid,
    /// Acceleration of the reference point, m/s².
    pub acceleration: Vector3<f64>,
}

/// The bodies of a run as every rank knows them.
#[derive(Debug, Clone)]
pub struct Bodies<const D: usize> {
    all: Vec<Moving<D>>,
    obstacles: Arc<Obstacles<D>>,
    /// Lowest corner of the domain, m.
    lower: [f64; D],
    periods: [Option<f64>; D],
}

#[derive(Debug, Clone)]
struct Moving<const D: usize> {
    body: Arc<Body<D>>,
    /// Place now, velocities half a step behind.
    now: Rigid,
    /// Angular momentum of a free body, in the axes of the scene.
    momentum: Vector3<f64>,
    /// What it was in the last full step.
    full: Kinematics,
    /// Distance of the farthest element from the reference point, m.
    radius: f64,
    /// Points on the surface, from the reference point in the axes of the body, m.
    surface: Arc<Vec<Vector3<f64>>>,
    /// Distance of its elements, m.
    spacing: f64,
    /// What is known of it and all it may hit: solids at rest, then bodies.
    gaps: Vec<Gap>,
}

/// A gap narrower than this part of the spacing holds no fluid.
const CLOSED: f64 = 0.25;

impl<const D: usize> Default for Bodies<D> {
    fn default() -> Self {
        Self::new(Vec::new(), Vec::new(), [0.0; D], [None; D])
    }
}

/// A point or vector with the third component 0 in two dimensions.
pub fn in_space<const D: usize>(x: &[f64; D]) -> Vector3<f64> {
    Vector3::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0))
}

/// The first components.
pub fn in_scene<const D: usize>(v: &Vector3<f64>) -> [f64; D] {
    std::array::from_fn(|k| v[k])
}

impl<const D: usize> Bodies<D> {
    /// Bodies by the number of their solid, among solids at rest, in a domain with this lowest corner and
    /// these periods (m).
    pub fn new(
        bodies: Vec<Body<D>>,
        at_rest: Vec<Solid<D>>,
        lower: [f64; D],
        periods: [Option<f64>; D],
    ) -> Self {
        let moving = |body: Body<D>| {
            let home = body.home();
            let arms = body.elements.position.iter().map(|x| (in_space(x) - home).norm());
            let radius = arms.fold(0.0, f64::max);
            let surface = Arc::new(body.surface());
            let momentum = match &body.guide {
                Guide::Free(free) => free.angular_momentum(&body.start),
                Guide::Course(_) => Vector3::zeros(),
            };
            Moving {
                radius,
                surface,
                gaps: Vec::new(),
                spacing: body.spacing(),
                now: body.start,
                full: Kinematics { rigid: body.start, acceleration: Vector3::zeros() },
                momentum,
                body: Arc::new(body),
            }
        };
        let all = bodies.into_iter().map(moving).collect();
        Self { all, obstacles: Arc::new(Obstacles::new(at_rest)), lower, periods }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Number of their wall elements.
    pub fn elements(&self) -> usize {
        self.all.iter().map(|moving| moving.body.elements.len()).sum()
    }

    /// Numbers of the solids that move freely, whose loads all ranks must know.
    pub fn free(&self) -> impl Iterator<Item = u16> + '_ {
        let free = |moving: &&Moving<D>| matches!(moving.body.guide, Guide::Free(_));
        self.all.iter().filter(free).map(|moving| moving.body.solid)
    }

    /// Largest speed, velocities and acceleration of any point of a body, for time step and lists.
    pub fn extremes(&self) -> Extremes {
        let of = |moving: &Moving<D>| {
            let turning = moving.now.spin.norm() * moving.radius;
            let velocity = moving.now.velocity;
            let ways = std::array::from_fn(|axis| {
                if axis >= D {
                    return [0.0; 2];
                }
                [(velocity[axis] + turning).max(0.0), (turning - velocity[axis]).max(0.0)]
            });
            Extremes {
                speed2: (velocity.norm() + turning).powi(2),
                acceleration2: moving.full.acceleration.norm_squared(),
                velocity: ways,
                ..Extremes::NONE
            }
        };
        self.all.iter().map(of).fold(Extremes::NONE, Extremes::max)
    }

    /// The frame in which a moving solid rests.
    pub fn frame(&self, solid: u16) -> Option<Frame<D>> {
        let moving = self.all.iter().find(|moving| moving.body.solid == solid)?;
        let Rigid { position, velocity, spin, .. } = &moving.now;
        Some(Frame {
            center: in_scene(position),
            velocity: in_scene(velocity),
            spin: [spin.x, spin.y, spin.z],
            periods: self.periods,
        })
    }

    /// The part of a force by pressure, felt at `x` (m), along the normal of a moving solid there.
    ///
    /// What a wall continues of the pressure gradient also acts along it. That completes the sums of the
    /// fluid and adds up to nothing over a body under water, but it would turn a slippery ball.
    pub fn across(&self, solid: u16, x: &[f64; D], force: [f64; D]) -> [f64; D] {
        let Some(moving) = self.all.iter().find(|moving| moving.body.solid == solid) else {
            return force;
        };
        let home = moving.body.home() + moving.now.arm(&in_space(x));
        let normal = moving.body.shape.normal(&in_scene(&home));
        let normal = moving.now.orientation * in_space(&normal);
        in_scene(&(normal * normal.dot(&in_space(&force))))
    }

    /// The elements of each body that lie within reach of the box around some fluid, as sets of walls.
    /// Elements inside a solid at rest are left out: there are those of that solid. So are sides of thin
    /// bodies so close to one that no fluid is in between.
    pub fn sets<S: Real>(
        &self,
        search: &Search<'_, D>,
        encoder: &Encoder<D, S>,
        fluid: &Aabb<D>,
        model: &Model<D>,
    ) -> Result<Vec<WallSet<D, S>>, RunError> {
        let around = fluid.inflated(search.reach());
        let near = |x: &[f64; D]| {
            (0..D).all(|k| {
                self.periods[k].is_some() || (around.min[k] <= x[k] && x[k] <= around.max[k])
            })
        };
        let set = |moving: &Moving<D>| {
            let elements = &moving.body.elements;
            let frame = self.frame(moving.body.solid)?;
            let thin = model.thin(moving.body.solid);
            let faces_wall = |x: &[f64; D], n: &[f64; D], depth: f64| {
                thin.is_some_and(|thin| {
                    let above = depth + CLOSED * thin.spacing;
                    self.obstacles.cover(&std::array::from_fn(|k| x[k] + above * n[k]))
                })
            };
            let mut kept = Vec::new();
            let (mut position, mut normal) = (Vec::new(), Vec::new());
            for i in 0..elements.len() as u32 {
                let (x, n) = self.in_domain(moving.element(&moving.now, i as usize));
                let depth = elements.depth[i as usize];
                if near(&x) && !self.obstacles.cover(&x) && !faces_wall(&x, &n, depth) {
                    kept.push(i);
                    position.push(x);
                    normal.push(n);
                }
            }
            let first = *elements.id.first()?;
            let placed = WallElements { position, normal, ..elements.some(&kept) };
            (!kept.is_empty()).then(|| WallSet::moving(placed, first, frame, search, encoder, thin))
        };
        self.all.iter().filter_map(set).collect()
    }

    /// Moves the sets of walls of these bodies to where the bodies are now.
    pub fn place<S: Real>(&self, walls: &mut [WallSet<D, S>], encoder: &Encoder<D, S>) {
        for moving in &self.all {
            let solid = moving.body.solid;
            for wall in walls.iter_mut().filter(|wall| wall.solid == solid) {
                let Some(frame) = self.frame(solid) else { continue };
                wall.place(frame, encoder, |element| {
                    self.in_domain(moving.element(&moving.now, element))
                });
            }
        }
    }

    /// An element at its image in the domain.
    fn in_domain(&self, (x, normal): ([f64; D], [f64; D])) -> ([f64; D], [f64; D]) {
        (wrapped(x, &self.lower, &self.periods), normal)
    }

    /// Completes a step: kicks over the present place, half of `dt_before` behind and half of `dt` ahead
    /// (s), and moves on to `time + dt`. `load` tells the load of the fluid on a free body.
    pub fn advance(
        &mut self,
        time: f64,
        [dt_before, dt]: [f64; 2],
        gravity: &[f64; D],
        load: impl Fn(u16) -> Wrench,
    ) {
        let gravity = in_space(gravity);
        let span = 0.5 * (dt_before + dt);
        for moving in &mut self.all {
            let before = moving.now;
            match &moving.body.guide {
                Guide::Course(course) => {
                    let next = course.step(time, dt);
                    (moving.now.velocity, moving.now.spin) = (next.velocity, next.spin);
                }
                Guide::Free(free) => {
                    let wrench = free.wrench(&moving.now, load(moving.body.solid), &gravity);
                    free.kick(&mut moving.now, &mut moving.momentum, &wrench, span, dt);
                }
            }
            moving.finish(&before, dt_before, span);
        }
        self.meet(dt);
        for moving in &mut self.all {
            match &moving.body.guide {
                Guide::Course(course) => moving.now = course.step(time, dt),
                Guide::Free(_) => moving.now.drift(dt),
            }
        }
    }

    /// Place and motion of the bodies in the last full step, by the number of their solid.
    pub fn kinematics(&self) -> Vec<(u16, Kinematics)> {
        self.all.iter().map(|moving| (moving.body.solid, moving.full)).collect()
    }

    /// All elements of all bodies where they were in the last full step.
    pub fn in_full_step(&self) -> WallElements<D> {
        let mut all = WallElements::default();
        for moving in &self.all {
            all.extend(&moving.placed(&moving.full.rigid));
        }
        all
    }

    /// Everything that a checkpoint must hold.
    pub fn save(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        for moving in &self.all {
            numbers.extend(moving.now.to_array());
            numbers.extend(moving.momentum.iter().chain(moving.full.acceleration.iter()));
            let gaps =
                (0..self.partners()).map(|k| moving.gaps.get(k).and_then(|gap| gap.touching));
            numbers.extend(gaps.map(|touching| touching.unwrap_or(-1.0)));
        }
        numbers
    }

    /// Goes on from what [`save`](Self::save) gave. Returns whether it fits these bodies.
    pub fn restore(&mut self, numbers: &[f64]) -> bool {
        let stride = rigid::NUMBERS + 6 + self.partners();
        if numbers.len() != stride * self.all.len() {
            return false;
        }
        for (moving, numbers) in self.all.iter_mut().zip(numbers.chunks_exact(stride)) {
            moving.now = Rigid::from_array(std::array::from_fn(|k| numbers[k]));
            let vector = |first: usize| Vector3::from_fn(|k, _| numbers[first + k]);
            moving.momentum = vector(rigid::NUMBERS);
            let acceleration = vector(rigid::NUMBERS + 3);
            moving.full = Kinematics { rigid: moving.now, acceleration };
            let touching = |distance: &f64| Some(*distance).filter(|distance| *distance >= 0.0);
            let gap = |distance| Gap { touching: touching(distance), ..Gap::default() };
            moving.gaps = numbers[rigid::NUMBERS + 6..].iter().map(gap).collect();
        }
        true
    }

    /// How much a body may hit.
    fn partners(&self) -> usize {
        self.obstacles.len() + self.all.len()
    }
}

impl<const D: usize> Body<D> {
    /// Where the reference point is while the body is where the scene puts it, m.
    fn home(&self) -> Vector3<f64> {
        match &self.guide {
            Guide::Course(course) => course.about,
            Guide::Free(_) => self.start.position,
        }
    }

    /// Distance of the elements, m.
    fn spacing(&self) -> f64 {
        self.elements.volume.iter().copied().fold(0.0, f64::max).powf(1.0 / D as f64)
    }

    /// Points on the surface, from the reference point, m: above every element next to it.
    fn surface(&self) -> Vec<Vector3<f64>> {
        let WallElements { position, normal, depth, .. } = &self.elements;
        let spacing = self.spacing();
        let near = (0..depth.len()).filter(|&i| depth[i] < spacing);
        near.map(|i| in_space(&position[i]) + in_space(&normal[i]) * depth[i] - self.home())
            .collect()
    }
}

impl<const D: usize> Moving<D> {
    /// Place and normal of an element.
    fn element(&self, rigid: &Rigid, index: usize) -> ([f64; D], [f64; D]) {
        let elements = &self.body.elements;
        let arm = in_space(&elements.position[index]) - self.body.home();
        let normal = rigid.orientation * in_space(&elements.normal[index]);
        (in_scene(&rigid.place(&arm)), in_scene(&normal))
    }

    fn placed(&self, rigid: &Rigid) -> WallElements<D> {
        let mut placed = self.body.elements.clone();
        for index in 0..placed.len() {
            (placed.position[index], placed.normal[index]) = self.element(rigid, index);
        }
        placed
    }

    /// Notes what the body was in the full step between the velocities `before` and those now.
    fn finish(&mut self, before: &Rigid, dt_before: f64, span: f64) {
        let share = if span > 0.0 { 0.5 * dt_before / span } else { 0.0 };
        let between = |a: &Vector3<f64>, b: &Vector3<f64>| a + (b - a) * share;
        let change = self.now.velocity - before.velocity;
        self.full = Kinematics {
            rigid: Rigid {
                velocity: between(&before.velocity, &self.now.velocity),
                spin: between(&before.spin, &self.now.spin),
                ..*before
            },
            acceleration: if span > 0.0 { change / span } else { Vector3::zeros() },
        };
    }
}
