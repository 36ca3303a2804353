//! Maps and meshes from the keys that scale, rotate and translate.

use crate::scene::{Placing, Scale, vector};
use sph_geometry::{Affine, TriangleMesh};

/// Where the points of a shape go: scaled, rotated, translated, in this order.
pub fn map<const D: usize>(placing: &Placing<'_>) -> Affine<D> {
    let mut map = Affine::identity();
    if let Some(scale) = placing.scale {
        map = Affine::scaling(match &scale.value {
            Scale::Uniform(factor) => [*factor; D],
            Scale::Axes(factors) => vector(factors),
        });
    }
    if let Some(rotate) = placing.rotate {
        let axis = rotate.axis.as_ref().map_or([0.0, 0.0, 1.0], |axis| vector(axis));
        // The reader has refused axes without a direction.
        map = Affine::rotation(axis, rotate.degrees).unwrap_or(Affine::identity()).after(&map);
    }
    if let Some(translate) = placing.translate {
        map = Affine::translation(vector(translate)).after(&map);
    }
    map
}

/// A mesh in metres, where the scene puts it.
pub fn mesh(mut mesh: TriangleMesh, placing: &Placing<'_>) -> TriangleMesh {
    if let Some(units) = placing.units {
        for x in &mut mesh.vertices {
            *x = x.map(|x| units.to_metres(x));
        }
    }
    let map = map(placing);
    if map.is_identity() { mesh } else { mesh.moved(&map) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{At, Rotation, Units};

    #[test]
    fn the_order_is_unit_scale_rotation_translation() {
        let units = At::default_of(Units::Mm);
        let scale = At::default_of(Scale::Axes(vec![2.0, 1.0, 1.0]));
        let axis = Some(At::default_of(vec![0.0, 0.0, 3.0]));
        let rotate = At::default_of(Rotation { axis, degrees: 90.0 });
        let translate = At::default_of(vec![10.0, 0.0, 0.0]);
        let placing = Placing {
            units: Some(&units),
            scale: Some(&scale),
            rotate: Some(&rotate),
            translate: Some(&translate),
            ..Placing::default()
        };
        let box_ = TriangleMesh::cuboid([0.0; 3], [680.0, 100.0, 50.0]);
        let bounds = mesh(box_, &placing).bounding_box();
        assert_eq!((bounds.min, bounds.max), ([9.9, 0.0, 0.0], [10.0, 1.36, 0.05]));
    }

    #[test]
    fn units_round_once() {
        for (units, length) in [(Units::M, 0.68), (Units::Cm, 68.0), (Units::Mm, 680.0)] {
            assert_eq!(units.to_metres(length), 0.68);
        }
        assert_eq!((Units::In.to_metres(100.0), Units::Ft.to_metres(10.0)), (2.54, 3.048));
    }
}
