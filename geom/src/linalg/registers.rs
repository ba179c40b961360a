//! Vector registers left as other code expects them.
//!
//! faer's kernels return with the upper halves of the vector registers in use. Until these are cleared, code that is compiled for
//! any x86 processor waits for them at each step: angle sums took 10 to 12 times as long on Xeons of 2023, on each thread that had
//! eliminated a large front. A function that is compiled for wider vectors clears them when it returns.

use std::hint::black_box;

/// Clears the upper halves of the vector registers. A few nanoseconds.
pub(super) fn clear() {
    let mut values = black_box([1.0_f64; 8]);
    pulp::Arch::new().dispatch(|| values.iter_mut().for_each(|value| *value *= 0.5));
    black_box(values);
}
