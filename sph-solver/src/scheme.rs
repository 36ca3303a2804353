//! A scheme: what is summed over which neighbours in the passes of a step.

use crate::energy::Sink;
use crate::groups::{BoxedSum, fluid_sum, wall_sum};
use crate::kernel_shape::KernelShape;
use crate::terms::{
    Acceleration, Crowding, DensityRate, Deviation, PairTerm, Pressure, Slope, SlopeSum, VectorSum,
    WallNormals, WallTerm,
};
use sph_kernels::{Kernel, Real};
use std::marker::PhantomData;

/// The sums of a scheme. What is absent costs nothing.
#[derive(Debug)]
pub struct Scheme<const D: usize, S> {
    /// The kernel that the sums were compiled for.
    pub kernel: KernelShape,
    /// dρ/dt from fluid neighbours.
    pub density: BoxedSum<D, S, DensityRate>,
    /// dv/dt from fluid neighbours.
    pub force: BoxedSum<D, S, Acceleration<D>>,
    /// dρ/dt from walls.
    pub wall_density: Option<BoxedSum<D, S, DensityRate>>,
    /// Where walls look, to tell corners between solids from planes.
    pub wall_normals: Option<BoxedSum<D, S, VectorSum<D>>>,
    /// dv/dt from the pressure of walls.
    pub wall_force: Option<BoxedSum<D, S, Acceleration<D>>>,
    /// dv/dt from the friction of walls that do not let fluid slip.
    pub wall_friction: Option<BoxedSum<D, S, Acceleration<D>>>,
    /// How crowded the fluid is around a particle, if particles are shifted.
    pub shifting: Option<BoxedSum<D, S, VectorSum<D>>>,
    /// The same for the walls around it.
    pub wall_shifting: Option<BoxedSum<D, S, VectorSum<D>>>,
    /// How support radii grow from place to place, if they vary and there are walls.
    pub radius_slope: Option<BoxedSum<D, S, SlopeSum<D>>>,
    /// What an energy budget is made of, if somebody asks for one.
    pub accounts: Option<Accounts<D, S>>,
}

/// Sums of single terms that the sums of a scheme hold too, so that the energy that each takes can be told.
/// They move nothing: the bits of a run with and without them are the same.
#[derive(Debug)]
pub struct Accounts<const D: usize, S> {
    /// dv/dt from the viscosity of the fluid, and what it counts as.
    pub viscosity: Option<(Sink, BoxedSum<D, S, Acceleration<D>>)>,
    /// dρ/dt from the diffusion of the density.
    pub diffusion: Option<BoxedSum<D, S, DensityRate>>,
    /// dv/dt from the pressure of walls without their dissipation.
    pub undamped_walls: Option<BoxedSum<D, S, Acceleration<D>>>,
}

impl<const D: usize, S: Real> Scheme<D, S> {
    /// A scheme for a kernel, from its terms for fluid neighbours.
    pub fn of<K: Kernel>(
        density: impl PairTerm<D, Deviation> + 'static,
        force: impl PairTerm<D, Pressure> + 'static,
    ) -> SchemeBuilder<D, S, K> {
        SchemeBuilder {
            scheme: Self {
                kernel: KernelShape::of::<K>(D),
                density: fluid_sum::<D, S, Deviation, K, _>(density),
                force: fluid_sum::<D, S, Pressure, K, _>(force),
                wall_density: None,
                wall_normals: None,
                wall_force: None,
                wall_friction: None,
                shifting: None,
                wall_shifting: None,
                radius_slope: None,
                accounts: None,
            },
            kernel: PhantomData,
        }
    }

    /// Whether walls matter at all.
    pub fn has_walls(&self) -> bool {
        self.wall_density.is_some() || self.wall_force.is_some() || self.wall_friction.is_some()
    }
}

/// A scheme to which walls are added.
#[derive(Debug)]
pub struct SchemeBuilder<const D: usize, S, K> {
    scheme: Scheme<D, S>,
    kernel: PhantomData<K>,
}

impl<const D: usize, S: Real, K: Kernel> SchemeBuilder<D, S, K> {
    /// Walls with a term in each pass.
    #[must_use]
    pub fn walls(
        mut self,
        density: impl WallTerm<D, Deviation> + 'static,
        force: impl WallTerm<D, Pressure> + 'static,
    ) -> Self {
        self.scheme.wall_density = Some(wall_sum::<D, S, Deviation, K, _>(density));
        self.scheme.wall_force = Some(wall_sum::<D, S, Pressure, K, _>(force));
        self.scheme.wall_normals = Some(wall_sum::<D, S, Crowding, K, _>(WallNormals));
        self
    }

    /// Friction of the walls that do not let fluid slip.
    #[must_use]
    pub fn friction(mut self, friction: impl WallTerm<D, Pressure> + 'static) -> Self {
        self.scheme.wall_friction = Some(wall_sum::<D, S, Pressure, K, _>(friction));
        self
    }

    /// Particles that are shifted to where there are too few of them.
    #[must_use]
    pub fn shifting(mut self, crowding: impl PairTerm<D, Crowding> + 'static) -> Self {
        self.scheme.shifting = Some(fluid_sum::<D, S, Crowding, K, _>(crowding));
        self
    }

    /// The part of walls in that.
    #[must_use]
    pub fn wall_shifting(mut self, crowding: impl WallTerm<D, Crowding> + 'static) -> Self {
        self.scheme.wall_shifting = Some(wall_sum::<D, S, Crowding, K, _>(crowding));
        self
    }

    /// Support radii that vary beside walls.
    #[must_use]
    pub fn radius_slope(mut self, slope: impl PairTerm<D, Slope> + 'static) -> Self {
        self.scheme.radius_slope = Some(fluid_sum::<D, S, Slope, K, _>(slope));
        self
    }

    /// An energy budget, whose terms are named one by one.
    #[must_use]
    pub fn accounts(mut self) -> Self {
        self.scheme.accounts =
            Some(Accounts { viscosity: None, diffusion: None, undamped_walls: None });
        self
    }

    /// The viscosity among the terms of the force, and what its energy counts as.
    #[must_use]
    pub fn account_viscosity(
        mut self,
        sink: Sink,
        term: impl PairTerm<D, Pressure> + 'static,
    ) -> Self {
        if let Some(accounts) = &mut self.scheme.accounts {
            accounts.viscosity = Some((sink, fluid_sum::<D, S, Pressure, K, _>(term)));
        }
        self
    }

    /// The diffusion among the terms of the density.
    #[must_use]
    pub fn account_diffusion(mut self, term: impl PairTerm<D, Deviation> + 'static) -> Self {
        if let Some(accounts) = &mut self.scheme.accounts {
            accounts.diffusion = Some(fluid_sum::<D, S, Deviation, K, _>(term));
        }
        self
    }

    /// The force of walls without their dissipation.
    #[must_use]
    pub fn account_walls(mut self, undamped: impl WallTerm<D, Pressure> + 'static) -> Self {
        if let Some(accounts) = &mut self.scheme.accounts {
            accounts.undamped_walls = Some(wall_sum::<D, S, Pressure, K, _>(undamped));
        }
        self
    }

    /// The scheme.
    pub fn build(self) -> Scheme<D, S> {
        self.scheme
    }
}
