use crate::error::RunError;
use sph_decomp::Communicator;

/// The particle with the lowest id over all ranks, from the one that each rank names.
pub(crate) fn first_of_all<const D: usize>(
    comm: &dyn Communicator,
    mine: Option<&(u64, [f64; D])>,
) -> Result<Option<(u64, [f64; D])>, RunError> {
    let mut bytes = Vec::new();
    if let Some((id, x)) = mine {
        bytes.extend_from_slice(&id.to_ne_bytes());
        bytes.extend_from_slice(bytemuck::cast_slice(x));
    }
    let all = comm.all_gather(&bytes)?;
    let named = all.iter().filter(|bytes| !bytes.is_empty()).map(|bytes| {
        let (id, x) = bytes.split_at(8);
        (bytemuck::pod_read_unaligned(id), bytemuck::pod_read_unaligned(x))
    });
    Ok(named.min_by_key(|(id, _): &(u64, [f64; D])| *id))
}
