//! Collects particles of all ranks on rank 0, ordered by id.

use crate::error::RunError;
use sph_decomp::{Columns, Communicator};

/// Brings the particles of all ranks to rank 0. There, `columns` then holds all of them, in the
/// order that `ids` gives; on the other ranks it stays as it is. Collective.
pub fn gather_by_id<C: Columns>(
    comm: &dyn Communicator,
    columns: &mut C,
    ids: impl Fn(&C) -> Vec<u64>,
) -> Result<(), RunError> {
    let mut sends = Vec::new();
    if comm.rank() != 0 {
        let all: Vec<u32> = (0..columns.len() as u32).collect();
        let mut bytes = Vec::new();
        columns.pack(&all, &mut bytes);
        sends.push((0, bytes));
    }
    for (_, bytes) in comm.exchange_some(sends)? {
        columns.unpack(&bytes)?;
    }
    if comm.rank() == 0 {
        let ids = ids(columns);
        let mut order: Vec<u32> = (0..ids.len() as u32).collect();
        order.sort_unstable_by_key(|&i| ids[i as usize]);
        columns.permute(&order);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sph_decomp::ThreadRanks;

    #[test]
    fn rank_0_gets_everything_in_order() {
        let results = ThreadRanks::run(3, |comm| {
            let rank = comm.rank() as u64;
            let mut columns = (vec![7 - rank, rank], vec![rank as f64; 2]);
            gather_by_id(&comm, &mut columns, |c| c.0.clone()).map(|()| columns)
        });
        let (ids, ranks) = &results.unwrap()[0];
        assert_eq!(*ids, [0, 1, 2, 5, 6, 7]);
        assert_eq!(*ranks, [0.0, 1.0, 2.0, 2.0, 1.0, 0.0]);
    }
}
