//! Lines of text, formatted on all threads and written in their order.

use std::io::{self, Write};

use crate::parallel::{beside, try_each};

/// So many lines are formatted one after the other: about a millisecond.
const LINES: usize = 1 << 12;
/// So many blocks of these are formatted at a time, while as many are written.
const BLOCKS: usize = 8;

/// Writes so many lines; `line` appends one of them, with its end, to the text.
///
/// # Errors
/// With the first error of `line` in the order of the lines, or when writing fails.
pub(super) fn write_lines(
    count: usize,
    out: &mut impl Write,
    line: impl Fn(usize, &mut Vec<u8>) -> io::Result<()> + Sync,
) -> io::Result<()> {
    let format = |first: usize, blocks: &mut [Vec<u8>]| {
        try_each(0, blocks, &|k, text| {
            text.clear();
            let from = (first + k * LINES).min(count);
            (from..(from + LINES).min(count)).try_for_each(|number| line(number, text))
        })
    };
    let mut blocks: Vec<Vec<u8>> = vec![Vec::new(); BLOCKS.min(count.div_ceil(LINES))];
    let mut others = blocks.clone();
    format(0, &mut blocks)?;
    for next in (0..count).step_by(LINES * BLOCKS).map(|first| first + LINES * BLOCKS) {
        let mut write = || blocks.iter().try_for_each(|text| out.write_all(text));
        if next >= count {
            return write();
        }
        let (written, formatted) = beside(write, || format(next, &mut others));
        written.and(formatted)?;
        std::mem::swap(&mut blocks, &mut others);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_in_their_order_however_many_there_are() {
        for count in [0, 1, LINES, LINES + 1, 2 * LINES * BLOCKS + 5] {
            let mut out = Vec::new();
            write_lines(count, &mut out, |number, text| writeln!(text, "{number}")).unwrap();
            let expected: String = (0..count).map(|number| format!("{number}\n")).collect();
            assert!(out == expected.as_bytes(), "{count} lines");
        }
    }

    #[test]
    fn an_error_ends_it() {
        let failed =
            |number: usize, _: &mut Vec<u8>| if number == 9 { Err(io::ErrorKind::Other.into()) } else { Ok(()) };
        assert!(write_lines(20, &mut Vec::new(), failed).is_err());
        // Blocks before that of the error are written; what cannot be written comes before what cannot be formatted.
        let whole = LINES * BLOCKS;
        let late = |number: usize, text: &mut Vec<u8>| if number == whole { failed(9, text) } else { writeln!(text) };
        let mut out = Vec::new();
        assert!(write_lines(2 * whole, &mut out, late).is_err_and(|error| error.kind() == io::ErrorKind::Other));
        assert_eq!(out.len(), whole);
        let full = write_lines(2 * whole, &mut &mut [0; 9][..], late);
        assert!(full.is_err_and(|error| error.kind() == io::ErrorKind::WriteZero));
    }
}
