//! Solids: shapes with material on one side of their surface.

use crate::aabb::Aabb;
use crate::shape::{Nearest, Shape, SignedDistance};

/// On which side of a surface fluid can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FluidSide {
    /// Fluid inside, material outside: a tank.
    Inside,
    /// Fluid outside, material inside: an obstacle.
    Outside,
}

/// Material on one side of the surface of a shape.
#[derive(Debug, Clone)]
pub struct Solid<const D: usize> {
    /// Name, for messages and output.
    pub name: String,
    /// The shape whose surface is the wall.
    pub shape: Shape<D>,
    /// The other side is material.
    pub fluid_side: FluidSide,
}

impl<const D: usize> Solid<D> {
    /// A solid with a name.
    pub fn new(name: impl Into<String>, shape: Shape<D>, fluid_side: FluidSide) -> Self {
        Self { name: name.into(), shape, fluid_side }
    }

    /// Depth below the surface in m: positive in the material, negative where fluid can be. Exact
    /// where the signed distance of the shape is.
    pub fn depth_in_solid(&self, x: &[f64; D]) -> f64 {
        let distance = self.shape.signed_distance(x);
        match self.fluid_side {
            FluidSide::Inside => distance,
            FluidSide::Outside => -distance,
        }
    }

    /// [`depth_in_solid`](Self::depth_in_solid) where that is more than `least` (m), else a number from
    /// it to `least`: far from the solid, its box says enough and costs nothing.
    pub(crate) fn depth_above(&self, x: &[f64; D], least: f64) -> f64 {
        if self.fluid_side == FluidSide::Outside {
            let beyond = self.shape.bounding_box().signed_distance(x);
            if beyond > 0.0 && -beyond <= least {
                return -beyond;
            }
        }
        self.depth_in_solid(x)
    }

    /// Unit vector out of the material, into the fluid, at the nearest point of the surface.
    pub fn normal(&self, x: &[f64; D]) -> [f64; D] {
        let normal = self.shape.normal(x);
        match self.fluid_side {
            FluidSide::Inside => normal.map(|n| -n),
            FluidSide::Outside => normal,
        }
    }

    /// [`depth_in_solid`](Self::depth_in_solid) and [`normal`](Self::normal) from one search.
    pub fn depth_and_normal(&self, x: &[f64; D]) -> (f64, [f64; D]) {
        let Nearest { distance, normal } = self.shape.nearest(x);
        match self.fluid_side {
            FluidSide::Inside => (distance, normal.map(|n| -n)),
            FluidSide::Outside => (-distance, normal),
        }
    }

    /// The nearest point of the wall.
    pub fn closest_point(&self, x: &[f64; D]) -> [f64; D] {
        self.shape.closest_point(x)
    }
}

/// The material of a solid as a set of points: becomes a shape by [`Shape::custom`].
impl<const D: usize> SignedDistance<D> for Solid<D> {
    fn nearest(&self, x: &[f64; D]) -> Nearest<D> {
        let (depth, normal) = self.depth_and_normal(x);
        Nearest { distance: -depth, normal }
    }

    fn bounding_box(&self) -> Aabb<D> {
        match self.fluid_side {
            FluidSide::Inside => Aabb { min: [f64::NEG_INFINITY; D], max: [f64::INFINITY; D] },
            FluidSide::Outside => self.shape.bounding_box(),
        }
    }

    fn signed_distance(&self, x: &[f64; D]) -> f64 {
        -self.depth_in_solid(x)
    }
}

/// Depth below the surface of all solids together in m: the largest of their depths. Positive in
/// material; at most the distance to free space.
pub fn depth_in_solids<const D: usize>(solids: &[Solid<D>], x: &[f64; D]) -> f64 {
    let deepest = |most: f64, solid: &Solid<D>| most.max(solid.depth_above(x, most));
    solids.iter().fold(f64::NEG_INFINITY, deepest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_tank_with_a_pillar() {
        let tank = Shape::cuboid([0.0, 0.0], [4.0, 2.0]).unwrap();
        let pillar = Shape::sphere([2.0, 1.0], 0.5).unwrap();
        let solids = [
            Solid::new("tank", tank, FluidSide::Inside),
            Solid::new("pillar", pillar, FluidSide::Outside),
        ];
        assert_eq!(solids[0].depth_in_solid(&[1.0, -0.25]), 0.25);
        assert_eq!(solids[0].normal(&[1.0, -0.25]), [0.0, 1.0]);
        assert_eq!(solids[0].depth_and_normal(&[1.0, -0.25]), (0.25, [0.0, 1.0]));
        assert_eq!(solids[0].closest_point(&[1.0, -0.25]), [1.0, 0.0]);
        assert_eq!(solids[1].depth_in_solid(&[2.0, 1.25]), 0.25);
        assert_eq!(solids[1].normal(&[2.0, 1.25]), [0.0, 1.0]);
        assert_eq!(depth_in_solids(&solids, &[2.0, 1.75]), -0.25);
        assert_eq!(depth_in_solids(&solids, &[2.0, 1.25]), 0.25);
        assert_eq!(depth_in_solids::<2>(&[], &[0.0, 0.0]), f64::NEG_INFINITY);
    }

    proptest! {
        #[test]
        fn solids_far_away_change_nothing(
            center in prop::array::uniform2(-2.0..2.0),
            radius in 0.05..1.0,
            x in prop::array::uniform2(-3.0..3.0),
            least in -3.0..1.0_f64,
        ) {
            let tank = Shape::cuboid([-1.0, -1.0], [2.0, 1.0]).unwrap();
            let ball = Shape::sphere(center, radius).unwrap();
            let solids = [
                Solid::new("tank", tank, FluidSide::Inside),
                Solid::new("ball", ball, FluidSide::Outside),
            ];
            let depths = solids.each_ref().map(|solid| solid.depth_in_solid(&x));
            prop_assert_eq!(depth_in_solids(&solids, &x), depths[0].max(depths[1]));
            for (solid, depth) in solids.iter().zip(depths) {
                let found = solid.depth_above(&x, least);
                prop_assert!(found == depth || depth <= found && found <= least);
            }
        }
    }
}
