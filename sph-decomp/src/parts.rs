//! The order of the particles of a rank: local, inner, outer.

use std::ops::Range;

use crate::HaloPlan;

/// The three parts in which a rank stores its particles.
///
/// * *local*: owned, and no other rank needs them: computed while messages travel;
/// * *inner*: owned, and some other rank needs them: computed first;
/// * *outer*: owned by others, needed here: read only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Parts {
    /// Number of local particles.
    pub local: usize,
    /// Number of inner particles.
    pub inner: usize,
    /// Number of outer particles.
    pub outer: usize,
}

impl Parts {
    /// Sorts the owned particles: local ones first, then inner ones, each part by `key`.
    ///
    /// Returns the parts and the order: the particle at new place `k` was at `order[k]`. Particles
    /// of equal key keep their order. Apply the order to the columns and to the plan
    /// ([`HaloPlan::renumber_owned`]).
    pub fn arrange<K: Ord>(
        owned: usize,
        plan: &HaloPlan,
        mut key: impl FnMut(u32) -> K,
    ) -> (Self, Vec<u32>) {
        let is_inner = plan.is_inner(owned);
        let mut order: Vec<u32> = (0..owned as u32).collect();
        order.sort_by_cached_key(|&i| (is_inner[i as usize], key(i)));
        let inner = is_inner.iter().filter(|&&inner| inner).count();
        (Self { local: owned - inner, inner, outer: plan.outer() }, order)
    }

    /// Number of owned particles.
    pub fn owned(&self) -> usize {
        self.local + self.inner
    }

    /// Number of all particles.
    pub fn total(&self) -> usize {
        self.owned() + self.outer
    }

    /// Places of the local particles.
    pub fn local_range(&self) -> Range<usize> {
        0..self.local
    }

    /// Places of the inner particles.
    pub fn inner_range(&self) -> Range<usize> {
        self.local..self.owned()
    }

    /// Places of the outer particles.
    pub fn outer_range(&self) -> Range<usize> {
        self.owned()..self.total()
    }

    /// The three parts of a column: local, inner, outer.
    pub fn split<'a, T>(&self, column: &'a [T]) -> (&'a [T], &'a [T], &'a [T]) {
        let (owned, outer) = column.split_at(self.owned());
        let (local, inner) = owned.split_at(self.local);
        (local, inner, outer)
    }

    /// The parts of a column that may be written, and the outer part, which may not.
    pub fn split_mut<'a, T>(&self, column: &'a mut [T]) -> (&'a mut [T], &'a mut [T], &'a [T]) {
        let (owned, outer) = column.split_at_mut(self.owned());
        let (local, inner) = owned.split_at_mut(self.local);
        (local, inner, outer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solo;

    #[test]
    fn local_first_then_inner_each_in_order_of_the_key() {
        let plan = HaloPlan::new(&Solo, vec![(0, vec![4, 1])]).unwrap();
        let keys = [5, 3, 1, 0, 2];
        let (parts, order) = Parts::arrange(5, &plan, |i| keys[i as usize]);
        assert_eq!(parts, Parts { local: 3, inner: 2, outer: 2 });
        assert_eq!(order, [3, 2, 0, 4, 1]);
        let mut column = ['a', 'b', 'c', 'd', 'e', 'f', 'g'];
        let (local, inner, outer) = parts.split_mut(&mut column);
        assert_eq!((local.len(), inner.len(), outer.len()), (3, 2, 2));
        assert_eq!(column[parts.inner_range()], ['d', 'e']);
        assert_eq!(column[parts.outer_range()], ['f', 'g']);
    }
}
