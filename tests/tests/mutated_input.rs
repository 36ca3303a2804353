//! Spoilt input is refused, and nothing worse: scenes, formulas, meshes, checkpoints, snapshots and tables whose
//! bytes were changed at random. `PROPTEST_CASES=1000000 cargo test -p sph-tests --test mutated_input` goes on for
//! long; with a nightly compiler, `cargo fuzz` does better (`fuzz/README.md`).

use proptest::prelude::*;
use proptest::sample::Index;
use sph_tests::Input;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Nothing this small takes that long, even on a busy machine.
const LONGEST: Duration = Duration::from_secs(20);

/// One change: where, what, and how much.
#[derive(Debug, Clone)]
enum Change {
    Set(Index, u8),
    Cut(Index, usize),
    Insert(Index, Vec<u8>),
    /// A piece of the file once more, somewhere else.
    Repeat(Index, usize, Index),
    End(Index),
}

fn word() -> impl Strategy<Value = Vec<u8>> {
    let words = [
        "0",
        "-1",
        "1e308",
        "nan",
        "inf",
        "4294967295",
        "-",
        "\n",
        "\"",
        "[",
        "]",
        "{",
        "}",
        "(",
        ")",
        "=",
        ",",
        "^",
        "[[",
        "\u{0}",
        "\u{feff}",
        "\u{ff}\u{ff}\u{ff}\u{7f}",
        "9223372036854775807",
        "[solid",
        "3 ",
    ];
    prop_oneof![
        prop::sample::select(words.map(|word| word.as_bytes().to_vec()).to_vec()),
        prop::collection::vec(any::<u8>(), 1..9),
    ]
}

fn change() -> impl Strategy<Value = Change> {
    let at = any::<Index>;
    prop_oneof![
        4 => (at(), any::<u8>()).prop_map(|(at, byte)| Change::Set(at, byte)),
        2 => (at(), 1..40_usize).prop_map(|(at, length)| Change::Cut(at, length)),
        4 => (at(), word()).prop_map(|(at, word)| Change::Insert(at, word)),
        2 => (at(), 1..200_usize, at()).prop_map(|(from, length, to)| Change::Repeat(from, length, to)),
        1 => at().prop_map(Change::End),
    ]
}

fn changed(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for change in changes {
        if bytes.is_empty() {
            break;
        }
        let size = bytes.len();
        match change {
            Change::Set(at, byte) => bytes[at.index(size)] = *byte,
            Change::Cut(at, length) => {
                let at = at.index(size);
                bytes.drain(at..(at + length).min(size));
            }
            Change::Insert(at, word) => {
                let at = at.index(size);
                bytes.splice(at..at, word.iter().copied());
            }
            Change::Repeat(from, length, to) => {
                let from = from.index(size);
                let piece = bytes[from..(from + length).min(size)].to_vec();
                let to = to.index(size);
                bytes.splice(to..to, piece);
            }
            Change::End(at) => bytes.truncate(at.index(size)),
        }
    }
    bytes
}

fn seeds(input: Input) -> &'static [Vec<u8>] {
    static SEEDS: [OnceLock<Vec<Vec<u8>>>; 6] = [const { OnceLock::new() }; 6];
    SEEDS[input as usize].get_or_init(|| input.seeds())
}

#[test]
fn seeds_are_in_order() {
    for input in Input::ALL {
        for (number, seed) in seeds(input).iter().enumerate() {
            // A formula may speak of what only another kind of formula knows.
            let exempt = input == Input::Formula && String::from_utf8_lossy(seed).contains('t');
            assert!(exempt || input.read(seed), "{input:?} {number}");
        }
    }
}

fn spoilt(input: Input) -> impl Strategy<Value = Vec<u8>> {
    let changes = prop::collection::vec(change(), 1..8);
    let seed = prop::sample::select(seeds(input).to_vec());
    (seed, changes).prop_map(|(seed, changes)| changed(seed, &changes))
}

#[track_caller]
fn assert_survives(input: Input, bytes: &[u8]) {
    let start = Instant::now();
    input.read(bytes);
    let elapsed = start.elapsed();
    assert!(elapsed < LONGEST, "{elapsed:?} for {} bytes", bytes.len());
}

proptest! {
    #[test]
    fn scenes(bytes in spoilt(Input::Scene)) {
        assert_survives(Input::Scene, &bytes);
    }

    #[test]
    fn formulas(bytes in spoilt(Input::Formula)) {
        assert_survives(Input::Formula, &bytes);
    }

    #[test]
    fn meshes(bytes in spoilt(Input::Mesh)) {
        assert_survives(Input::Mesh, &bytes);
    }

    #[test]
    fn checkpoints(bytes in spoilt(Input::Checkpoint)) {
        assert_survives(Input::Checkpoint, &bytes);
    }

    #[test]
    fn snapshots(bytes in spoilt(Input::Snapshot)) {
        assert_survives(Input::Snapshot, &bytes);
    }

    #[test]
    fn tables(bytes in spoilt(Input::Table)) {
        assert_survives(Input::Table, &bytes);
    }
}
