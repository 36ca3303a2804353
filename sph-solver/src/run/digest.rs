//! A hash of a particle state that does not depend on the order or the owner of the particles.

/// Digest of a set of particles: equal digests mean equal bits, whoever owned the particles.
///
/// Every particle's id and state are hashed to 128 bits; the hashes are added up modulo 2^128, so
/// that ranks can add their parts in any order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Digest(u128);

impl Digest {
    /// Adds a particle.
    pub fn add(&mut self, id: u64, words: impl IntoIterator<Item = f64>) {
        let (mut a, mut b) = (mix(id ^ 0x9e37_79b9_7f4a_7c15), mix(id ^ 0xd1b5_4a32_d192_ed03));
        for word in words {
            a = mix(a ^ word.to_bits());
            b = mix(b.wrapping_add(word.to_bits()));
        }
        self.0 = self.0.wrapping_add(u128::from(a) << 64 | u128::from(b));
    }

    /// Digest of both sets.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// As bytes, to send it.
    pub fn to_bytes(self) -> [u8; 16] {
        self.0.to_le_bytes()
    }

    /// Back from [`to_bytes`](Self::to_bytes).
    pub fn from_bytes(bytes: [u8; 16]) -> Self {
        Self(u128::from_le_bytes(bytes))
    }
}

impl std::fmt::Display for Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// The finaliser of SplitMix64 (Steele, Lea & Flood 2014): every input bit reaches every output bit.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digest(particles: &[(u64, [f64; 2])]) -> Digest {
        let mut digest = Digest::default();
        for (id, words) in particles {
            digest.add(*id, *words);
        }
        digest
    }

    #[test]
    fn order_and_ownership_do_not_matter() {
        let all = [(1, [0.1, 0.2]), (2, [0.3, 0.4]), (3, [0.5, 0.6])];
        let whole = digest(&all);
        assert_eq!(whole, digest(&[all[2], all[0], all[1]]));
        assert_eq!(whole, digest(&all[..1]).merge(digest(&all[1..])));
        assert_eq!(whole, Digest::from_bytes(whole.to_bytes()));
    }

    #[test]
    fn a_single_bit_shows() {
        let base = digest(&[(1, [0.1, 0.2])]);
        let next = f64::from_bits(0.2f64.to_bits() + 1);
        assert_ne!(base, digest(&[(1, [0.1, next])]));
        assert_ne!(base, digest(&[(2, [0.1, 0.2])]));
        assert_ne!(base, digest(&[(1, [0.2, 0.1])]));
    }

    #[test]
    fn swapped_states_of_two_particles_show() {
        let a = digest(&[(1, [0.1, 0.2]), (2, [0.3, 0.4])]);
        let b = digest(&[(2, [0.1, 0.2]), (1, [0.3, 0.4])]);
        assert_ne!(a, b);
    }
}
