//! Whether a surface fits into the memory that the process is allowed (`ulimit -v`), asked before it is worked on.
//!
//! An allocation that fails ends the program by a signal, wherever it is. Where there is a limit and a surface is sure to
//! need more, a sentence comes first.

use crate::failure::Failure;
use std::path::Path;

/// What the program needs by itself.
const BASE: u64 = 24_000_000;
/// What unwrapping takes for a vertex at least: 2600 to 3600 bytes were measured from 20 to 134 thousand vertices.
const PER_VERTEX: u64 = 2000;

/// Refuses a surface of so many vertices where the limit is sure to be too low.
pub(crate) fn check(path: &Path, vertices: usize) -> Result<(), Failure> {
    let needed = BASE + PER_VERTEX * vertices as u64;
    match std::fs::read_to_string("/proc/self/limits").ok().as_deref().and_then(address_space) {
        Some(allowed) if allowed < needed => Err(Failure::Memory { path: path.to_owned(), vertices, needed, allowed }),
        _ => Ok(()),
    }
}

/// The limit of the address space in bytes, as Linux tells it.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_read_where_there_is_one() {
        let text = |limit: &str| format!("Max locked memory 1 1 bytes\nMax address space {limit}  unlimited  bytes\n");
        assert_eq!(address_space(&text("40960000")), Some(40_960_000));
        assert_eq!(address_space(&text("unlimited")), None);
        assert_eq!(address_space(""), None);
    }
}
