//! Lines, words and numbers of mesh files, on bytes: such files are seldom all UTF-8 and need not be.

use std::ops::Range;

use super::error::{Fault, Place};
use crate::parallel::threads;
use crate::surface::{MAX_COORDINATE, is_coordinate};

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The lines of a text, ended by `\n`, `\r\n` or `\r`.
#[derive(Debug, Clone)]
pub(super) struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    number: u64,
    joined: bool,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        let at = if text.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        Self { text, at, number: 0, joined: false }
    }

    /// Lines where a backslash before the line's end continues it on the next one.
    ///
    /// A comment is not continued, whatever the specification says: exporters end comments in Windows folders.
    pub(super) fn joined(text: &'a [u8]) -> Self {
        Self { joined: true, ..Self::new(text) }
    }

    /// The joined lines of one of the [`blocks`](joined_blocks) of a text, numbered from 1.
    pub(super) fn of_block(text: &'a [u8], block: &Range<usize>) -> Self {
        let lines = Self::joined(&text[..block.end]);
        Self { at: block.start.max(lines.at), ..lines }
    }

    /// The lines from byte `at` on, of which `number` came before.
    pub(super) fn after(text: &'a [u8], at: usize, number: u64) -> Self {
        Self { text, at, number, joined: false }
    }

    /// Where the next line starts.
    pub(super) fn position(&self) -> usize {
        self.at
    }

    /// The number of the last line given.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// The next line that has a word on it.
    pub(super) fn next_filled(&mut self) -> Option<Line<'a>> {
        self.find(|line| line.words().next().is_some())
    }

    fn is_continued(&self, start: usize, end: usize) -> bool {
        let line = &self.text[start..end];
        self.joined && line.ends_with(b"\\") && !line.contains(&b'#') && end < self.text.len()
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.at >= self.text.len() {
            return None;
        }
        let (start, number) = (self.at, self.number + 1);
        loop {
            let from = self.at;
            let end = line_end(self.text, from);
            self.at = behind_line_end(self.text, end);
            self.number += 1;
            if !self.is_continued(from, end) || self.at >= self.text.len() {
                let is_last = end == self.text.len();
                return Some(Line { number, start, text: &self.text[start..end], is_last });
            }
        }
    }
}

fn line_end(text: &[u8], from: usize) -> usize {
    let is_end = |&b: &u8| b == b'\n' || b == b'\r';
    // Sixteen bytes are compared at once.
    let (chunks, _) = text[from..].as_chunks::<16>();
    let without = chunks.iter().take_while(|chunk| !chunk.iter().fold(false, |any, b| any | is_end(b))).count();
    let from = from + 16 * without;
    let rest = &text[from..];
    from + rest.iter().position(is_end).unwrap_or(rest.len())
}

/// Where the line after the line end at `end` starts, `\r\n` counting as one.
fn behind_line_end(text: &[u8], end: usize) -> usize {
    let rest = &text[end..];
    end + if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) }
}

/// How large blocks of a text are for the threads that there are: some milliseconds' work, or the whole where there is one thread.
pub(super) fn block_size(text: &[u8]) -> usize {
    const BLOCK: usize = 1 << 20;
    if threads() > 1 { BLOCK } else { text.len() }
}

/// A text cut into blocks of `size` bytes or a little more, each of whole joined lines.
pub(super) fn joined_blocks(text: &[u8], size: usize) -> Vec<Range<usize>> {
    let mut blocks = Vec::new();
    let mut start = 0;
    while start < text.len() {
        let end = joined_line_start(text, start.saturating_add(size));
        blocks.push(start..end);
        start = end;
    }
    blocks
}

/// Where the first line behind byte `at` starts that surely continues none: before its start is no backslash, not even in a comment.
fn joined_line_start(text: &[u8], mut at: usize) -> usize {
    while at < text.len() {
        let end = line_end(text, at);
        at = behind_line_end(text, end);
        // The search may have begun within `\r\n`.
        let line = text[..end].strip_suffix(b"\r").unwrap_or(&text[..end]);
        if !line.ends_with(b"\\") {
            return at;
        }
    }
    text.len()
}

/// A line without its end; a continued one holds the line ends within.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) number: u64,
    /// Where in the text it starts.
    pub(super) start: usize,
    pub(super) text: &'a [u8],
    /// Whether the text ends in it, without a line end.
    pub(super) is_last: bool,
}

impl<'a> Line<'a> {
    pub(super) fn place(&self) -> Place {
        Place::Line(self.number)
    }

    /// Where in the text it ends.
    pub(super) fn end(&self) -> usize {
        self.start + self.text.len()
    }

    pub(super) fn words(&self) -> Words<'a> {
        Words { text: self.text, at: 0, place: self.place(), is_last: self.is_last }
    }
}

/// The words of a line, separated by white space or by continued line ends, up to one that starts with `#`. Within a word
/// that sign is no comment: some programs write infinity as `1.#INF`, which must not become 1.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    text: &'a [u8],
    at: usize,
    place: Place,
    is_last: bool,
}

impl<'a> Words<'a> {
    /// Where, within the line, the last word given ends.
    pub(super) fn end(&self) -> usize {
        self.at
    }

    pub(super) fn place(&self) -> Place {
        self.place
    }

    /// Whether the text ends in this line, without a line end.
    pub(super) fn is_last(&self) -> bool {
        self.is_last
    }

    /// The next word as a finite number within the range of coordinates; `what` it is goes into the error.
    pub(super) fn coordinate(&mut self, what: &str) -> Result<f64, Fault> {
        let word = self.expect(what)?;
        match number(word) {
            Some(x) if is_coordinate(x) => Ok(x),
            Some(_) => Err(self.unexpected(
                word,
                format!("a finite number of at most {MAX_COORDINATE:e} in absolute value for the {what}"),
            )),
            None => Err(self.unexpected(word, format!("a number for the {what}"))),
        }
    }

    /// Three coordinates.
    pub(super) fn point(&mut self) -> Result<[f64; 3], Fault> {
        Ok([self.coordinate("x coordinate")?, self.coordinate("y coordinate")?, self.coordinate("z coordinate")?])
    }

    /// The next word as a count or index.
    pub(super) fn natural(&mut self, what: &str) -> Result<u64, Fault> {
        let word = self.expect(what)?;
        let count = integer(word).and_then(|n| u64::try_from(n).ok());
        count.ok_or_else(|| self.unexpected(word, format!("the {what}")))
    }

    /// The next word, which must be there.
    pub(super) fn expect(&mut self, what: &str) -> Result<&'a [u8], Fault> {
        self.next().ok_or_else(|| self.ended(format!("the {what}")))
    }

    /// That the words end where another is expected: with the line, or because the file ends within it.
    pub(super) fn ended(&self, expected: String) -> Fault {
        if self.is_last {
            return Fault::cut_short(self.place, expected);
        }
        Fault::unexpected(self.place, "the end of the line", expected)
    }

    pub(super) fn unexpected(&self, word: &[u8], expected: impl Into<String>) -> Fault {
        Fault::unexpected(self.place, quote(word), expected)
    }

    fn at_gap(&self) -> bool {
        match self.text.get(self.at) {
            Some(b'\\') => matches!(self.text.get(self.at + 1), Some(b'\n' | b'\r')),
            // A byte 0 is none of a text's, and must not make two numbers of one.
            Some(&byte) => (1..=b' ').contains(&byte),
            None => false,
        }
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        while self.at_gap() {
            self.at += 1;
        }
        let start = self.at;
        if self.text.get(start) == Some(&b'#') {
            return None;
        }
        while self.at < self.text.len() && !self.at_gap() {
            self.at += 1;
        }
        (self.at > start).then(|| &self.text[start..self.at])
    }
}

/// A word as it appears in a message: in backquotes, escaped, and not endless.
pub(super) fn quote(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&word[..word.len().min(LONGEST)]);
    let dots = if word.len() > LONGEST { "…" } else { "" };
    format!("`{}{dots}`", text.escape_debug())
}

/// The f64 nearest to a decimal number; words for infinities and NaN are numbers too.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    short_decimal(word).or_else(|| std::str::from_utf8(word).ok()?.parse().ok())
}

/// The common case of [`number`]: no exponent, and digits that f64 holds exactly.
///
/// Both the digits, below 2^53, and the power of ten, up to 10^22, are exact, so that one division rounds to the nearest
/// (W. D. Clinger, *How to read floating point numbers accurately*, 1990).
fn short_decimal(word: &[u8]) -> Option<f64> {
    const POWERS: [f64; 19] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18];
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    if digits.len() > POWERS.len() {
        return None;
    }
    let (mut value, mut point) = (0_u64, None);
    for (i, &byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => value = 10 * value + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(i),
            _ => return None,
        }
    }
    let decimals = point.map_or(0, |i| digits.len() - i - 1);
    let any_digit = digits.len() > usize::from(point.is_some());
    if !any_digit || value >= 1 << 53 {
        return None;
    }
    let magnitude = value as f64 / POWERS[decimals];
    Some(if negative { -magnitude } else { magnitude })
}

/// A decimal integer; one too large for i64 becomes the largest or smallest, which no index reaches.
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0_i64;
    for &byte in digits {
        let digit = byte.checked_sub(b'0').filter(|&d| d <= 9)?;
        value = value.saturating_mul(10).saturating_add(i64::from(digit));
    }
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn lines(text: &[u8]) -> Vec<(u64, Vec<&[u8]>)> {
        Lines::joined(text).map(|line| (line.number, line.words().collect())).collect()
    }

    #[test]
    fn all_three_line_ends_count_one_line() {
        for text in [&b"a\nb\n\nc"[..], b"a\r\nb\r\n\r\nc", b"a\rb\r\rc"] {
            let words: [&[&[u8]]; 4] = [&[b"a"], &[b"b"], &[], &[b"c"]];
            for ((number, found), (i, expected)) in lines(text).into_iter().zip(words.into_iter().enumerate()) {
                assert_eq!((number, found.as_slice()), (i as u64 + 1, expected));
            }
        }
    }

    #[test]
    fn a_backslash_joins_lines_but_not_comments() {
        let words: Vec<(u64, Vec<&[u8]>)> =
            vec![(1, vec![b"f", b"1", b"2", b"3"]), (4, vec![]), (5, vec![b"v", b"\\x"])];
        assert_eq!(lines(b"f 1\\\n2 \\\r3\n# C:\\\nv \\x"), words);
        assert_eq!(lines(b"f 1 \\\n"), [(1, vec![&b"f"[..], b"1", b"\\"])]);
    }

    #[test]
    fn blocks_have_the_lines_of_the_whole() {
        let texts: [&[u8]; 5] = [
            b"\xef\xbb\xbfv 1\nv 2 \\\n 3 \\\n\n\xef\xbb\xbfv # C:\\\nf\n\nf 1 \\\n",
            b"v 1\r\nv 2 \\\r\n 3 \\\r\n\r\nv \\x\r\n\\\r\nf 1 2",
            b"v 1\r\rv 2 \\\r 3 \\\r\rv # \\\r4\r\n\n\rf \\",
            b"\\\n\\\n\\\n",
            b"",
        ];
        for text in texts {
            for size in 0..=text.len() + 1 {
                let blocks = joined_blocks(text, size);
                let mut found = Vec::new();
                let mut number = 0;
                for block in &blocks {
                    let mut lines = Lines::of_block(text, block);
                    found
                        .extend(lines.by_ref().map(|line| (number + line.number, line.start, line.text, line.is_last)));
                    number += lines.number();
                }
                let whole = Lines::joined(text).map(|line| (line.number, line.start, line.text, line.is_last));
                assert_eq!(found, whole.collect::<Vec<_>>(), "blocks of {size}: {blocks:?}");
            }
        }
    }

    #[test]
    fn words_end_where_they_say() {
        let line = Lines::new(b"f\t12 3#4 #5").next().unwrap();
        let mut words = line.words();
        while let Some(word) = words.next() {
            assert_eq!(&line.text[words.end() - word.len()..words.end()], word);
        }
        assert_eq!(&line.text[..words.end()], b"f\t12 3#4 ");
    }

    #[test]
    fn words_that_are_no_numbers_are_refused() {
        for word in ["", "-", ".", "-.", "1.2.3", "0.5O1", "1.#INF", "1,5", "0x1", "--1", "1e"] {
            assert_eq!(number(word.as_bytes()), None, "{word}");
        }
        for word in ["", "-", "+", "1.0", "1/", "1-"] {
            assert_eq!(integer(word.as_bytes()), None, "{word}");
        }
        assert_eq!(integer(b"99999999999999999999"), Some(i64::MAX));
    }

    proptest! {
        #[test]
        fn every_decimal_is_read_as_the_standard_library_does(word in r"-?[0-9]{0,19}\.?[0-9]{0,19}(e-?[0-9]{1,3})?") {
            prop_assert_eq!(number(word.as_bytes()).map(f64::to_bits), word.parse().ok().map(f64::to_bits));
        }

        #[test]
        fn every_finite_number_comes_back(x in any::<f64>().prop_filter("finite", |x| x.is_finite())) {
            prop_assert_eq!(number(format!("{x:?}").as_bytes()).map(f64::to_bits), Some(x.to_bits()));
        }
    }
}
