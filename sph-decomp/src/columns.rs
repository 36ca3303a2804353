//! Columns of particle data that can be reordered and can travel.

use bytemuck::{Pod, Zeroable};

/// One or several arrays with one element per particle.
///
/// A term that owns state of its own (a strain rate, an accumulated displacement, a material
/// label) implements this for its arrays, and that state then follows the particles when they are
/// sorted, migrated and restarted. All methods are required, none has a default: a column that
/// forgets one of them goes stale silently.
///
/// It is implemented for `Vec<T>` of plain data, for mutable references, for tuples, and for `()`,
/// which is the state of a term that has none: it takes no memory and no message bytes.
///
/// ```
/// use sph_decomp::Columns;
///
/// let mut ids = vec![7_u64, 8, 9];
/// let mut positions = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.5]];
/// let mut columns = (&mut ids, &mut positions, ());
/// columns.permute(&[2, 0]);
///
/// let mut bytes = Vec::new();
/// columns.pack(&[0], &mut bytes);
/// assert_eq!(bytes.len(), columns.stride());
/// assert_eq!(columns.unpack(&bytes), Ok(1));
/// assert_eq!(ids, [9, 7, 9]);
/// assert_eq!(positions, [[2.0, 0.5], [0.0, 0.0], [2.0, 0.5]]);
/// ```
pub trait Columns {
    /// Number of particles. Zero for columns without data.
    fn len(&self) -> usize;

    /// Whether there are no particles.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes per particle in a message. Zero means that there is no data, and any length fits.
    fn stride(&self) -> usize;

    /// Makes room for `len` particles: cuts the end off, or appends zeros.
    fn resize(&mut self, len: usize);

    /// Puts old element `order[k]` at place `k`. `order` may leave elements out; those are gone.
    ///
    /// # Panics
    /// If an index is out of range.
    fn permute(&mut self, order: &[u32]);

    /// Appends the elements named by `index` to a message, in that order.
    ///
    /// # Panics
    /// If an index is out of range.
    fn pack(&self, index: &[u32], out: &mut Vec<u8>);

    /// Appends the particles of a message that [`Columns::pack`] wrote, and returns how many there
    /// were. On an error nothing is changed.
    fn unpack(&mut self, bytes: &[u8]) -> Result<usize, ColumnError>;
}

/// A message that does not fit the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a message of {bytes} bytes does not hold whole particles of {stride} bytes: sender and \
     receiver must have the same columns"
)]
pub struct ColumnError {
    /// Length of the message.
    pub bytes: usize,
    /// Bytes per particle of the receiver.
    pub stride: usize,
}

/// How many particles a message of `bytes` bytes holds.
fn whole(bytes: usize, stride: usize) -> Result<usize, ColumnError> {
    match stride {
        0 if bytes == 0 => Ok(0),
        0 => Err(ColumnError { bytes, stride }),
        _ if bytes.is_multiple_of(stride) => Ok(bytes / stride),
        _ => Err(ColumnError { bytes, stride }),
    }
}

impl<T: Pod> Columns for Vec<T> {
    fn len(&self) -> usize {
        self.len()
    }

    fn stride(&self) -> usize {
        const { assert!(size_of::<T>() > 0, "a column needs elements of at least one byte") };
        size_of::<T>()
    }

    fn resize(&mut self, len: usize) {
        self.resize(len, Zeroable::zeroed());
    }

    fn permute(&mut self, order: &[u32]) {
        *self = order.iter().map(|&old| self[old as usize]).collect();
    }

    fn pack(&self, index: &[u32], out: &mut Vec<u8>) {
        out.reserve(index.len() * size_of::<T>());
        for &i in index {
            out.extend_from_slice(bytemuck::bytes_of(&self[i as usize]));
        }
    }

    fn unpack(&mut self, bytes: &[u8]) -> Result<usize, ColumnError> {
        let stride = Columns::stride(self);
        let count = whole(bytes.len(), stride)?;
        // A message need not be aligned for T.
        self.extend(bytes.chunks_exact(stride).map(bytemuck::pod_read_unaligned::<T>));
        Ok(count)
    }
}

impl<C: Columns + ?Sized> Columns for &mut C {
    fn len(&self) -> usize {
        (**self).len()
    }

    fn stride(&self) -> usize {
        (**self).stride()
    }

    fn resize(&mut self, len: usize) {
        (**self).resize(len);
    }

    fn permute(&mut self, order: &[u32]) {
        (**self).permute(order);
    }

    fn pack(&self, index: &[u32], out: &mut Vec<u8>) {
        (**self).pack(index, out);
    }

    fn unpack(&mut self, bytes: &[u8]) -> Result<usize, ColumnError> {
        (**self).unpack(bytes)
    }
}

impl Columns for () {
    fn len(&self) -> usize {
        0
    }

    fn stride(&self) -> usize {
        0
    }

    fn resize(&mut self, _len: usize) {}

    fn permute(&mut self, _order: &[u32]) {}

    fn pack(&self, _index: &[u32], _out: &mut Vec<u8>) {}

    fn unpack(&mut self, bytes: &[u8]) -> Result<usize, ColumnError> {
        whole(bytes.len(), 0)
    }
}

/// A message of a tuple holds the columns one after the other.
macro_rules! tuples {
    ($($name:ident $index:tt),+) => {
        impl<$($name: Columns),+> Columns for ($($name,)+) {
            fn len(&self) -> usize {
                let mut len = None;
                $(if self.$index.stride() > 0 {
                    let this = self.$index.len();
                    debug_assert!(len.is_none_or(|len| len == this), "columns of unequal length");
                    len.get_or_insert(this);
                })+
                len.unwrap_or(0)
            }

            fn stride(&self) -> usize {
                0 $(+ self.$index.stride())+
            }

            fn resize(&mut self, len: usize) {
                $(self.$index.resize(len);)+
            }

            fn permute(&mut self, order: &[u32]) {
                $(self.$index.permute(order);)+
            }

            fn pack(&self, index: &[u32], out: &mut Vec<u8>) {
                $(self.$index.pack(index, out);)+
            }

            fn unpack(&mut self, bytes: &[u8]) -> Result<usize, ColumnError> {
                let count = whole(bytes.len(), self.stride())?;
                let mut rest = bytes;
                $(
                    let (mine, after) = rest.split_at(count * self.$index.stride());
                    self.$index.unpack(mine)?;
                    rest = after;
                )+
                debug_assert!(rest.is_empty());
                Ok(count)
            }
        }
    };
}

tuples!(A 0);
tuples!(A 0, B 1);
tuples!(A 0, B 1, C 2);
tuples!(A 0, B 1, C 2, E 3);
tuples!(A 0, B 1, C 2, E 3, F 4);
tuples!(A 0, B 1, C 2, E 3, F 4, G 5);
tuples!(A 0, B 1, C 2, E 3, F 4, G 5, H 6);
tuples!(A 0, B 1, C 2, E 3, F 4, G 5, H 6, I 7);
tuples!(A 0, B 1, C 2, E 3, F 4, G 5, H 6, I 7, J 8);
tuples!(A 0, B 1, C 2, E 3, F 4, G 5, H 6, I 7, J 8, K 9);
tuples!(A 0, B 1, C 2, E 3, F 4, G 5, H 6, I 7, J 8, K 9, L 10);
tuples!(A 0, B 1, C 2, E 3, F 4, G 5, H 6, I 7, J 8, K 9, L 10, M 11);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_message_that_does_not_fit_changes_nothing() {
        let mut columns = (vec![1_u64], vec![2.0_f32]);
        assert_eq!(columns.unpack(&[0; 13]), Err(ColumnError { bytes: 13, stride: 12 }));
        assert_eq!(columns, (vec![1], vec![2.0]));
        assert_eq!(().unpack(&[1]), Err(ColumnError { bytes: 1, stride: 0 }));
    }

    #[test]
    fn absent_state_is_free() {
        let mut columns = ((), vec![1_u32, 2, 3], ((), ()));
        assert_eq!((columns.len(), columns.stride()), (3, 4));
        columns.resize(5);
        assert_eq!(columns.1, [1, 2, 3, 0, 0]);
    }

    proptest! {
        #[test]
        fn unpacking_what_was_packed_appends_the_same(
            ids in prop::collection::vec(any::<u64>(), 1..40),
            picks in prop::collection::vec(any::<prop::sample::Index>(), 0..60),
        ) {
            let flags: Vec<u8> = ids.iter().map(|id| *id as u8).collect();
            let mut columns = (ids.clone(), flags, ());
            let index: Vec<u32> = picks.iter().map(|p| p.index(ids.len()) as u32).collect();
            let mut bytes = Vec::new();
            columns.pack(&index, &mut bytes);
            prop_assert_eq!(columns.unpack(&bytes), Ok(index.len()));
            let expected: Vec<u64> =
                ids.iter().copied().chain(index.iter().map(|&i| ids[i as usize])).collect();
            prop_assert!(columns.1.iter().zip(&expected).all(|(f, id)| *f == *id as u8));
            prop_assert_eq!(columns.0, expected);
        }
    }
}
