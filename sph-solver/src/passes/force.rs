use crate::block::Block;
use crate::bodies::Bodies;
use crate::energy::{Sink, open_books};
use crate::lio::{Effects, Extremes, Pass};
use crate::loads::{LoadScale, Loads, Part, moment};
use crate::model::Model;
use crate::passes::accounts::Share;
use crate::passes::{Surroundings, add};
use crate::records::{Encoder, QUANTITY, Record, WEIGHT, record};
use crate::scheme::Scheme;
use crate::space;
use crate::terms::Acceleration;
use crate::walls::WallSet;
use bytemuck::Pod;
use sph_kernels::Real;
use sph_neighbors::Clusters;

/// Forces, the kicks on both sides of them and the drift to the next positions.
#[derive(Debug)]
pub struct ForcePass<'a, const D: usize, S> {
    /// Neighbours.
    pub around: Surroundings<'a, D, S>,
    /// What is summed over them.
    pub scheme: &'a Scheme<D, S>,
    /// Writes records.
    pub encoder: Encoder<D, S>,
    /// Constants.
    pub model: &'a Model<D>,
    /// How loads on solids are counted; none when nobody asks for them.
    pub loads: Option<LoadScale>,
    /// Step that ends here, s.
    pub dt_before: f64,
    /// Step that begins here, s.
    pub dt: f64,
    /// Largest speed that the flow has had, m/s: what shifts are shares of.
    pub speed: f64,
    /// Solids that move.
    pub bodies: &'a Bodies<D>,
}

/// `v + dt (a + g)`: one kick, used for every half step so that all of them round alike.
#[inline]
pub fn kicked<const D: usize>(v: [f64; D], dt: f64, a: [f64; D], g: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| v[k] + dt * (a[k] + g[k]))
}

/// Share of the newest step in the pressure gradient that walls continue.
const NEWEST: f64 = 0.02;

/// ∇p/ρ as walls continue it, m/s²: by Euler's equation the acceleration by pair forces with the sign
/// turned, smoothed over some fifty steps and limited to the magnitude of gravity. Smoothed and limited,
/// because what impacts and sound do to single particles in single steps is no gradient of the flow.
fn felt_gradient<const D: usize>(
    before: &[f64; D],
    acceleration: &[f64; D],
    gravity: &[f64; D],
) -> [f64; D] {
    let smooth: [f64; D] =
        std::array::from_fn(|k| before[k] - NEWEST * (acceleration[k] + before[k]));
    let (length2, most2) = (square(smooth), square(*gravity));
    if length2 > most2 { smooth.map(|g| g * (most2 / length2).sqrt()) } else { smooth }
}

impl<const D: usize, S: Real + Pod> ForcePass<'_, D, S> {
    /// Adds a part of the accelerations by walls, and of the loads on them. Walls along which the fluid
    /// slips have no friction. `shares` are for the energy budget, if there is one.
    fn add_walls(
        &self,
        part: Part,
        old: &[Record<S>],
        block: &mut Block<'_, D, S, Acceleration<D>>,
        loads: &mut Loads,
        shares: &mut Vec<Share<D>>,
    ) {
        let (sum, sink) = match part {
            Part::Pressure => (&self.scheme.wall_force, Sink::WallDamping),
            Part::Friction => (&self.scheme.wall_friction, Sink::WallFriction),
        };
        let keeps_books = self.scheme.accounts.is_some();
        let Some(sum) = sum else { return };
        let acts = |wall: &WallSet<D, S>| match part {
            Part::Pressure => true,
            Part::Friction => self.model.solid(wall.solid).is_none_or(|solid| !solid.slips),
        };
        let (targets, rates) = block.targets();
        self.around.of_walls(&**sum, old, &targets, acts, |wall, own| {
            add(rates, own);
            if keeps_books {
                shares.push(Share { sink, frame: wall.frame().copied(), rates: own.to_vec() });
            }
            let (Some(scale), Some(solid)) = (&self.loads, self.model.solid(wall.solid)) else {
                return;
            };
            // Moments are about a point that goes with the solid.
            let center = wall.frame().map_or(&solid.center, |frame| &frame.center);
            for (k, Acceleration(a)) in own.iter().enumerate() {
                if a.iter().all(|a| *a == 0.0) {
                    continue;
                }
                let force = a.map(|a| -targets.mass[k] * a);
                let periods = &self.around.scale.periods;
                let arm = space::offset(&targets.position[k], center, periods);
                let turning = match (part, wall.frame()) {
                    (Part::Pressure, Some(_)) => {
                        self.bodies.across(wall.solid, &targets.position[k], force)
                    }
                    _ => force,
                };
                loads.add(wall.solid, part, force, moment(&arm, &turning), scale);
            }
        });
    }
}

impl<const D: usize, S: Real + Pod> Pass<D, S> for ForcePass<'_, D, S> {
    type Rate = Acceleration<D>;
    /// Place and motion.
    type Message = [S; 6];

    fn clusters(&self) -> &Clusters {
        self.around.near_fluid.clusters()
    }

    fn flux(&self, old: &[Record<S>], block: &mut Block<'_, D, S, Acceleration<D>>) -> Effects {
        let (mut loads, mut shares) = (Loads::NONE, Vec::new());
        self.around.sum_fluid(&*self.scheme.force, old, block);
        self.add_walls(Part::Pressure, old, block, &mut loads, &mut shares);
        self.add_walls(Part::Friction, old, block, &mut loads, &mut shares);
        let mut books = open_books(self.model, self.scheme);
        if let (Some(accounts), Some(taken)) = (&self.scheme.accounts, &mut books) {
            self.book(accounts, shares, old, block, taken);
        }
        Effects { loads, energy: books.map(Box::new) }
    }

    fn update(&self, old: &[Record<S>], block: &mut Block<'_, D, S, Acceleration<D>>) -> Extremes {
        let mut extremes = Extremes::NONE;
        let (gravity, encoder) = (self.model.gravity, &self.encoder);
        let density0 = self.model.equation_of_state.density0();
        let limit2 = self.model.speed_limit().powi(2);
        let old = &old[block.first..][..block.len()];
        for (k, old) in old.iter().enumerate() {
            let Acceleration(a) = block.rates[k];
            let now = kicked(block.velocity[k], 0.5 * self.dt_before, a, gravity);
            let velocity = kicked(now, 0.5 * self.dt, a, gravity);
            let drift = match block.shift.get(k) {
                Some(shift) => std::array::from_fn(|d| velocity[d] + self.speed * shift[d]),
                None => velocity,
            };
            let position: [f64; D] =
                std::array::from_fn(|d| block.position[k][d] + self.dt * drift[d]);
            let speed2 = square(velocity);
            let acceleration2 = square::<D>(std::array::from_fn(|d| a[d] + gravity[d]));
            // Written so that NaN is a fault too: `max` alone would drop it.
            let fault = f64::from(!(speed2 <= limit2 && acceleration2 < f64::MAX));
            let ways = Extremes::ways(&drift);
            extremes = extremes.max(Extremes { speed2, acceleration2, fault, velocity: ways });
            block.pressure_gradient[k] = felt_gradient(&block.pressure_gradient[k], &a, &gravity);
            block.velocity[k] = velocity;
            block.position[k] = position;
            block.new[k] = record(
                encoder.motion(&position, &velocity),
                S::from_f64(block.density[k] - density0),
                old[WEIGHT],
            );
        }
        extremes
    }

    fn message(&self, new: &Record<S>, _: f64) -> [S; 6] {
        crate::records::motion(new)
    }

    fn receive(&self, message: &[S; 6], _: &mut Record<S>, new: &mut Record<S>) {
        *new = record(*message, new[QUANTITY], new[WEIGHT]);
    }
}

/// |v|².
pub fn square<const D: usize>(v: [f64; D]) -> f64 {
    v.iter().map(|c| c * c).sum()
}
