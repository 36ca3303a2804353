#!/bin/sh
# Counts the instructions of the solver's sweep with absent terms (no viscosity, no walls) and of the
# same sums written out by hand, in both passes. Fails when composition costs more than 1 %.
# Needs valgrind. Run it anywhere in the workspace.
set -eu

cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
cargo build --quiet --release --package sph-benches --bin composition

# Instructions of one pass: ten passes more, less the set-up, which is the same.
pass() {
    few=$(instructions "$1" 2)
    many=$(instructions "$1" 12)
    echo $(((many - few) / 10))
}

instructions() {
    # One thread, so that nobody spins.
    RAYON_NUM_THREADS=1 valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        "$target/release/composition" "$1" "$2" 2>&1 >/dev/null | sed -n 's/.*Collected : //p'
}

failed=0
for sweep in density force; do
    composed=$(pass "$sweep")
    by_hand=$(pass "$sweep-by-hand")
    awk -v name="$sweep" -v a="$composed" -v b="$by_hand" 'BEGIN {
        printf "%-8s composed %9d  by hand %9d  ratio %.4f\n", name, a, b, a / b
        exit a > 1.01 * b
    }' || failed=1
done
printf "%-8s composed %9d  with viscosity, which must show\n" force "$(pass force-viscous)"
exit $failed
