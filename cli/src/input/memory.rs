//! Whether a field fits into memory, asked before it is read.

use super::error::Problem;

/// What computing the pairs of an array takes for each vertex beyond its value, at most.
const WORK_PER_VERTEX: u64 = 24;

/// Vertices are numbered in 31 bits.
const MOST: u64 = (1 << 31) - 2;

/// Refuses more values than can be numbered, or than fit into the memory that is free.
pub(super) fn check(vertices: u64, bytes_per_value: usize) -> Result<(), Problem> {
    check_against(vertices, bytes_per_value, free())
}

/// Refuses more bytes than are free, of a picture of so many pixels that takes so many bytes each.
pub(super) fn check_picture(pixels: u64, bytes_per_pixel: usize) -> Result<(), Problem> {
    let needed = pixels.saturating_mul(bytes_per_pixel as u64);
    match free() {
        Some(free) if needed > free => Err(Problem::PictureMemory { needed, free }),
        _ => Ok(()),
    }
}

fn check_against(vertices: u64, bytes_per_value: usize, free: Option<u64>) -> Result<(), Problem> {
    let needed = vertices.saturating_mul(bytes_per_value as u64 + WORK_PER_VERTEX);
    match free {
        Some(free) if needed > free => Err(Problem::Memory { vertices, needed, free }),
        _ if vertices > MOST => Err(Problem::TooMany(vertices)),
        _ => Ok(()),
    }
}

/// The bytes that a program can still have, where the system tells: Linux does.
fn free() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_its_size() {
        let refused = check_against(1_000_000, 8, Some(1_000_000)).expect_err("32 MB do not fit into 1 MB");
        assert!(refused.to_string().contains("32.0 MB"), "{refused}");
        assert!(check_against(1_000_000, 8, Some(32_000_000)).is_ok());
        assert!(matches!(check_against(1 << 31, 4, None), Err(Problem::TooMany(_))));
    }
}
