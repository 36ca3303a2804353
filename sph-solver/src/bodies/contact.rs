//! Contacts of bodies with solids at rest and with each other.
//!
//! Points on the surface of a body are looked up in the signed distances of what it may hit. Bodies touch
//! when they are a spacing apart, which leaves room for a layer of particles: in a narrower gap fluid can
//! neither be nor leave. Those that start closer, as what stands on a floor, keep the gap that they have
//! until they part.
//!
//! Where bodies touch, sequential impulses (Catto 2005, Iterative Dynamics with Temporal Coherence) end the
//! approach: along the normal with the body's restitution, across it with Coulomb's friction. What is too
//! close is moved out by and by, without a velocity. Distances are asked for again only when what moves may
//! have used up the last known gap.

use super::{Bodies, Guide, Moving, in_scene, in_space};
use nalgebra::Vector3;
use sph_geometry::Solid;

/// Solids at rest.
#[derive(Debug, Clone)]
pub struct Obstacles<const D: usize>(Vec<Solid<D>>);

impl<const D: usize> Obstacles<D> {
    /// Of these solids.
    pub fn new(solids: Vec<Solid<D>>) -> Self {
        Self(solids)
    }

    /// Whether a point is inside one of them.
    pub fn cover(&self, x: &[f64; D]) -> bool {
        self.0.iter().any(|solid| solid.depth_in_solid(x) > 0.0)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }
}

/// What is known of a body and something that it may hit.
#[derive(Debug, Clone, Copy, Default)]
pub struct Gap {
    /// No point of the body is closer to touching, m. Nothing depends on it but the work.
    pub clear: f64,
    /// The distance at which they touch, m: none before it is known.
    pub touching: Option<f64>,
}

/// A point of a body too close to something else.
#[derive(Debug, Clone, Copy)]
struct Touch {
    point: Vector3<f64>,
    /// Out of what is touched.
    normal: Vector3<f64>,
    depth: f64,
}

/// Rounds of impulses over the points of a contact.
const ROUNDS: usize = 20;

/// Share of the depth of a contact that is gone after a step.
const PUSH_OUT: f64 = 0.1;

/// Spacings that a body is moved in a step at the most, to end a contact.
const FARTHEST: f64 = 0.01;

impl<const D: usize> Bodies<D> {
    /// Lets bodies that touch something bounce off, slide or come to rest, before a drift of `dt` (s).
    pub(super) fn meet(&mut self, dt: f64) {
        for a in 0..self.all.len() {
            if self.all[a].is_free() {
                (0..self.obstacles.len()).for_each(|at_rest| self.meet_obstacle(a, at_rest, dt));
            }
            for b in a + 1..self.all.len() {
                match (self.all[a].is_free(), self.all[b].is_free()) {
                    (true, _) => self.meet_body(a, b, dt),
                    (false, true) => self.meet_body(b, a, dt),
                    (false, false) => (),
                }
            }
        }
    }

    fn meet_obstacle(&mut self, a: usize, at_rest: usize, dt: f64) {
        let obstacles = self.obstacles.clone();
        let solid = &obstacles.0[at_rest];
        let moved = self.all[a].fastest() * dt;
        let touches = self.all[a].touches(at_rest, moved, |x| {
            let (depth, normal) = solid.depth_and_normal(&in_scene(x));
            (depth, in_space(&normal))
        });
        self.bounce(a, None, &spread::<D>(&touches));
    }

    /// The body `a` moves freely.
    fn meet_body(&mut self, a: usize, b: usize, dt: f64) {
        let moved = (self.all[a].fastest() + self.all[b].fastest()) * dt;
        let mut touches = Vec::new();
        for (one, two, sign) in [(a, b, 1.0), (b, a, -1.0)] {
            let other = self.all[two].clone();
            let found = self.all[one].touches(self.obstacles.len() + two, moved, |x| {
                let home = other.body.home() + other.now.arm(x);
                let (depth, normal) = other.body.shape.depth_and_normal(&in_scene(&home));
                (depth, other.now.orientation * in_space(&normal))
            });
            touches
                .extend(found.iter().map(|touch| Touch { normal: touch.normal * sign, ..*touch }));
        }
        self.bounce(a, Some(b), &spread::<D>(&touches));
    }

    fn bounce(&mut self, a: usize, b: Option<usize>, touches: &[Touch]) {
        let Guide::Free(free) = &self.all[a].body.guide else { return };
        let (restitution, friction) = (free.restitution, free.friction);
        let approach = |bodies: &Self, touch: &Touch| {
            let of = |k: usize| bodies.all[k].now.velocity_at(&touch.point);
            of(a) - b.map_or_else(Vector3::zeros, of)
        };
        // The speed that each point shall leave with.
        let bounce = |touch: &Touch| -restitution * touch.normal.dot(&approach(self, touch));
        let leave: Vec<f64> = touches.iter().map(|touch| bounce(touch).max(0.0)).collect();
        let mut given = vec![(0.0, Vector3::zeros()); touches.len()];
        for _ in 0..ROUNDS {
            for ((touch, leave), given) in touches.iter().zip(&leave).zip(&mut given) {
                let yielding = self.yielding(a, b, &touch.point, &touch.normal);
                if yielding <= 0.0 {
                    continue;
                }
                let speed = touch.normal.dot(&approach(self, touch));
                let normal = (given.0 + (leave - speed) / yielding).max(0.0);
                self.hit(a, b, &touch.point, &(touch.normal * (normal - given.0)));
                given.0 = normal;
                let slide = approach(self, touch);
                let slide = slide - touch.normal * touch.normal.dot(&slide);
                let length = slide.norm();
                if friction > 0.0 && length > 0.0 {
                    let across = self.yielding(a, b, &touch.point, &(slide / length));
                    let wanted = if across > 0.0 { given.1 - slide / across } else { given.1 };
                    let most = friction * given.0;
                    let size = wanted.norm();
                    let allowed = if size > most { wanted * (most / size) } else { wanted };
                    self.hit(a, b, &touch.point, &(allowed - given.1));
                    given.1 = allowed;
                }
            }
        }
        for touch in touches {
            self.part(a, b, touch);
        }
    }

    /// Moves bodies apart that are too close.
    fn part(&mut self, a: usize, b: Option<usize>, touch: &Touch) {
        let way = (PUSH_OUT * touch.depth).min(FARTHEST * self.all[a].spacing);
        let b = b.filter(|&b| self.all[b].is_free());
        // Half each, where both can move.
        let share = if b.is_some() { 0.5 } else { 1.0 };
        for (k, sign) in [(Some(a), 1.0), (b, -1.0)] {
            let Some(Moving { body, now, .. }) = k.map(|k| &mut self.all[k]) else { continue };
            if let Guide::Free(free) = &body.guide {
                now.position += free.movable(touch.normal * (sign * share * way));
            }
        }
    }

    fn yielding(&self, a: usize, b: Option<usize>, x: &Vector3<f64>, along: &Vector3<f64>) -> f64 {
        let of = |k: usize| match &self.all[k].body.guide {
            Guide::Free(free) => {
                free.yielding(&self.all[k].now, &(x - self.all[k].now.position), along)
            }
            Guide::Course(_) => 0.0,
        };
        of(a) + b.map_or(0.0, of)
    }

    fn hit(&mut self, a: usize, b: Option<usize>, x: &Vector3<f64>, impulse: &Vector3<f64>) {
        for (k, impulse) in [(Some(a), *impulse), (b, -impulse)] {
            let Some(Moving { body, now, momentum, .. }) = k.map(|k| &mut self.all[k]) else {
                continue;
            };
            if let Guide::Free(free) = &body.guide {
                let arm = x - now.position;
                free.hit(now, momentum, &arm, &impulse);
            }
        }
    }
}

impl<const D: usize> Moving<D> {
    /// Largest speed of any of its points, m/s.
    fn fastest(&self) -> f64 {
        self.now.velocity.norm() + self.now.spin.norm() * self.radius
    }

    fn is_free(&self) -> bool {
        matches!(self.body.guide, Guide::Free(_))
    }

    /// Points of the surface that touch something, whose `depth` tells with its normal how far a point is
    /// inside. `moved` (m) is how far the two may have come closer in a step.
    fn touches(
        &mut self,
        partner: usize,
        moved: f64,
        depth: impl Fn(&Vector3<f64>) -> (f64, Vector3<f64>),
    ) -> Vec<Touch> {
        if self.gaps.len() <= partner {
            self.gaps.resize(partner + 1, Gap::default());
        }
        self.gaps[partner].clear -= moved;
        if self.gaps[partner].clear > 0.0 {
            return Vec::new();
        }
        // No point is farther from the middle than the radius.
        let far = -depth(&self.now.position).0 - self.radius;
        if far > self.spacing {
            self.gaps[partner] = Gap { clear: far - self.spacing, touching: Some(self.spacing) };
            return Vec::new();
        }
        let point = |arm| {
            let point = self.now.place(arm);
            let (depth, normal) = depth(&point);
            Touch { point, normal, depth }
        };
        let mut points: Vec<Touch> = self.surface.iter().map(point).collect();
        let gap = points.iter().map(|touch| -touch.depth).fold(f64::INFINITY, f64::min);
        let before = self.gaps[partner].touching.unwrap_or(gap);
        let touching = before.max(gap).clamp(0.0, self.spacing);
        // While bodies part, every step must look: which steps do must not matter.
        let clear = if touching < self.spacing { 0.0 } else { gap - touching };
        self.gaps[partner] = Gap { clear, touching: Some(touching) };
        points.iter_mut().for_each(|touch| touch.depth += touching);
        points.retain(|touch| touch.depth > 0.0);
        points
    }
}

/// The deepest point and those farthest from the ones before: two in two dimensions, four in three.
fn spread<const D: usize>(all: &[Touch]) -> Vec<Touch> {
    let Some(first) = all.iter().reduce(|a, b| if b.depth > a.depth { b } else { a }) else {
        return Vec::new();
    };
    let mut chosen = vec![*first];
    let most = if D == 2 { 2 } else { 4 };
    while chosen.len() < most {
        let away = |touch: &Touch| {
            let squares = chosen.iter().map(|other| (other.point - touch.point).norm_squared());
            squares.fold(f64::INFINITY, f64::min)
        };
        let farthest = all.iter().map(|touch| (away(touch), touch));
        let farthest = farthest.reduce(|a, b| if b.0 > a.0 { b } else { a });
        match farthest {
            Some((square, touch)) if square > 0.0 => chosen.push(*touch),
            _ => break,
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::super::{Body, Free, Rigid, Wrench};
    use super::*;
    use crate::walls::WallElements;
    use nalgebra::Matrix3;
    use sph_geometry::{FluidSide, Lattice, Shape, body_elements};

    fn solid(name: &str, shape: Shape<2>) -> Solid<2> {
        Solid::new(name, shape, FluidSide::Outside)
    }

    fn floor() -> Vec<Solid<2>> {
        vec![solid("floor", Shape::half_space([0.0; 2], [0.0, 1.0]).unwrap())]
    }

    fn brick(low: [f64; 2], restitution: f64, friction: f64, velocity: [f64; 2]) -> Body<2> {
        let high = [low[0] + 0.4, low[1] + 0.2];
        let shape = solid("brick", Shape::cuboid(low, high).unwrap());
        let lattice = Lattice::new(low, 0.02).unwrap();
        let mut start = Rigid::at(Vector3::new(low[0] + 0.2, low[1] + 0.1, 0.0));
        start.velocity = in_space(&velocity);
        Body {
            solid: 1,
            guide: Guide::Free(Free {
                mass: 3.0,
                inertia: Matrix3::identity() * 0.05,
                moves: [true, true, false],
                turns: [false, false, true],
                springs: vec![],
                restitution,
                friction,
            }),
            start,
            elements: WallElements::of_body(&body_elements(&shape, &lattice, 0.06).unwrap(), 1, 0),
            shape,
        }
    }

    fn run(bodies: &mut Bodies<2>, seconds: f64, gravity: [f64; 2], mut watch: impl FnMut(&Rigid)) {
        let dt = 1e-3;
        for step in 0..(seconds / dt) as usize {
            bodies.advance(step as f64 * dt, [dt, dt], &gravity, |_| Wrench::NONE);
            watch(&bodies.all[0].now);
        }
    }

    #[test]
    fn a_brick_falls_and_comes_to_rest() {
        let brick = brick([0.0, 0.3], 0.0, 0.5, [0.0; 2]);
        let mut bodies = Bodies::new(vec![brick], floor(), [0.0; 2], [None; 2]);
        run(&mut bodies, 2.0, [0.0, -9.81], |_| ());
        let now = bodies.all[0].now;
        // A spacing of 0.02 m above the floor.
        assert!((now.position.y - 0.12).abs() < 2e-3, "{now:?}");
        assert!(now.velocity.norm() < 0.02 && now.spin.norm() < 0.05, "{now:?}");
    }

    #[test]
    fn a_bounce_leaves_with_its_share_of_the_speed() {
        let brick = brick([0.0, 0.3], 0.5, 0.0, [0.7, -2.0]);
        let mut bodies = Bodies::new(vec![brick], floor(), [0.0; 2], [None; 2]);
        let mut highest = f64::MIN;
        run(&mut bodies, 0.3, [0.0; 2], |now| highest = highest.max(now.velocity.y));
        assert!((highest - 1.0).abs() < 1e-9, "{highest}");
        assert!((bodies.all[0].now.velocity.x - 0.7).abs() < 1e-12);
    }

    #[test]
    fn friction_ends_a_slide_when_it_should() {
        let brick = brick([0.0, 0.0], 0.0, 0.2, [1.0, 0.0]);
        let mut bodies = Bodies::new(vec![brick], floor(), [0.0; 2], [None; 2]);
        let mut way = 0.0;
        run(&mut bodies, 1.0, [0.0, -9.81], |now| way = now.position.x - 0.2);
        // v²/(2 μ g), without the torque of the friction tipping the brick over.
        assert!((way / (0.5 / (0.2 * 9.81)) - 1.0).abs() < 0.1, "{way}");
    }

    #[test]
    fn bodies_that_hit_each_other_keep_their_momentum() {
        let one = brick([0.0, 0.0], 0.0, 0.3, [1.0, 0.0]);
        let two = Body { solid: 2, ..brick([0.6, 0.05], 0.0, 0.3, [-0.5, 0.0]) };
        let mut bodies = Bodies::new(vec![one, two], vec![], [0.0; 2], [None; 2]);
        run(&mut bodies, 1.0, [0.0; 2], |_| ());
        let [a, b] = [bodies.all[0].now, bodies.all[1].now];
        let total = (a.velocity + b.velocity) * 3.0;
        assert!((total - Vector3::new(1.5, 0.0, 0.0)).norm() < 1e-12, "{total}");
        assert!(a.velocity.x < b.velocity.x + 0.1, "{a:?} {b:?}");
        // They turn, so that corners meet sides.
        assert!(b.position.x - a.position.x > 0.3, "{a:?} {b:?}");
    }
}
