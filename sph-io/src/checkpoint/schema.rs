//! Where each part of a state lies in the file, whatever library writes it.

/// Version of the layout that this crate writes and reads.
pub const FORMAT_VERSION: u64 = 1;

pub(super) const VTK: &str = "VTKHDF";
pub(super) const POINT_DATA: &str = "VTKHDF/PointData";
pub(super) const FIELD_DATA: &str = "VTKHDF/FieldData";
pub(super) const PRIVATE: &str = "sph";
pub(super) const ID: &str = "id";

/// Attributes of the private group that the layout itself uses.
pub(super) const RESERVED: [&str; 7] =
    ["format_version", "dimension", "particles", "time", "step", "columns", "components"];

/// Version of VTKHDF: the first one that has unstructured grids, which every reader knows.
pub(super) const VTKHDF_VERSION: [u64; 2] = [1, 0];
