//! An outer particle on its way: what its records are made of, as plain words.

use crate::state::State;

/// Bytes of one particle: eight-byte words of id, mass, density, position and velocity.
pub type Traveller = [u64; 9];

/// Packs owned particle `i`.
pub fn depart<const D: usize>(state: &State<D>, i: usize) -> Traveller {
    const { assert!(D <= 3, "a traveller has room for three dimensions") };
    let mut words = [0; 9];
    words[0] = state.id[i];
    words[1] = state.mass[i].to_bits();
    words[2] = state.density[i].to_bits();
    for k in 0..D {
        words[3 + k] = state.position[i][k].to_bits();
        words[6 + k] = state.velocity[i][k].to_bits();
    }
    words
}

/// Id and position of a packed particle: what its place in the order depends on.
pub fn place<const D: usize>(words: &Traveller) -> (u64, [f64; D]) {
    (words[0], std::array::from_fn(|k| f64::from_bits(words[3 + k])))
}

/// Appends a packed particle.
pub fn arrive<const D: usize>(words: &Traveller, state: &mut State<D>) {
    let (id, position) = place(words);
    state.id.push(id);
    state.mass.push(f64::from_bits(words[1]));
    state.density.push(f64::from_bits(words[2]));
    state.position.push(position);
    state.velocity.push(std::array::from_fn(|k| f64::from_bits(words[6 + k])));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_particle_arrives_as_it_left() {
        let state = State {
            id: vec![7],
            mass: vec![0.5],
            density: vec![-0.0],
            position: vec![[1.0, 2.0]],
            velocity: vec![[3.0, f64::MIN_POSITIVE]],
            pressure_gradient: vec![],
        };
        let mut other = State::default();
        arrive(&depart(&state, 0), &mut other);
        assert_eq!(state, other);
    }
}
