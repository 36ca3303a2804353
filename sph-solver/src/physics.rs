//! The terms of a scene, as types: what is summed over fluid and over wall neighbours in each pass.

use crate::terms::{Deviation, PairTerm, Pressure};

/// The four groups of pair terms of a scheme. `()` stands for none and leaves no instruction.
pub trait Physics<const D: usize>: Copy + Send + Sync + 'static {
    /// dρ/dt from fluid neighbours.
    type FluidDensity: PairTerm<D, Deviation>;
    /// dv/dt from fluid neighbours.
    type FluidForce: PairTerm<D, Pressure>;
    /// dρ/dt from wall neighbours.
    type WallDensity: PairTerm<D, Deviation>;
    /// dv/dt from wall neighbours.
    type WallForce: PairTerm<D, Pressure>;

    /// Terms of the density pass: fluid, walls.
    fn density(&self) -> (Self::FluidDensity, Self::WallDensity);
    /// Terms of the force pass: fluid, walls.
    fn force(&self) -> (Self::FluidForce, Self::WallForce);

    /// Whether wall neighbours matter at all.
    fn has_walls() -> bool {
        !(Self::WallDensity::EMPTY && Self::WallForce::EMPTY)
    }
}

/// Physics put together from terms and tuples of terms.
#[derive(Debug, Clone, Copy)]
pub struct Terms<FD, FF, WD, WF> {
    /// dρ/dt from fluid neighbours.
    pub fluid_density: FD,
    /// dv/dt from fluid neighbours.
    pub fluid_force: FF,
    /// dρ/dt from wall neighbours.
    pub wall_density: WD,
    /// dv/dt from wall neighbours.
    pub wall_force: WF,
}

impl<const D: usize, FD, FF, WD, WF> Physics<D> for Terms<FD, FF, WD, WF>
where
    FD: PairTerm<D, Deviation> + 'static,
    FF: PairTerm<D, Pressure> + 'static,
    WD: PairTerm<D, Deviation> + 'static,
    WF: PairTerm<D, Pressure> + 'static,
{
    type FluidDensity = FD;
    type FluidForce = FF;
    type WallDensity = WD;
    type WallForce = WF;

    fn density(&self) -> (FD, WD) {
        (self.fluid_density, self.wall_density)
    }

    fn force(&self) -> (FF, WF) {
        (self.fluid_force, self.wall_force)
    }
}
