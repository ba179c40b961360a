//! Blocks of whole lines, read at the same time.
//!
//! What indices that are counted back mean in a block, and the numbers of its lines, depends on those before. That is counted only
//! where it is asked for: most files have absolute indices and no errors.

use std::ops::Range;
use std::sync::OnceLock;

use super::super::text::{Lines, joined_blocks};

/// How much there is of what is counted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) lines: u64,
    pub(super) points: usize,
    pub(super) uv_points: usize,
    pub(super) normals: usize,
}

/// The blocks of a text.
pub(super) struct Blocks<'a> {
    text: &'a [u8],
    blocks: Vec<Range<usize>>,
    /// What comes before each block, once any has asked.
    before: OnceLock<Vec<Counts>>,
}

impl<'a> Blocks<'a> {
    /// Blocks of `size` bytes or a little more.
    pub(super) fn new(text: &'a [u8], size: usize) -> Self {
        Self { text, blocks: joined_blocks(text, size), before: OnceLock::new() }
    }

    pub(super) fn len(&self) -> usize {
        self.blocks.len()
    }

    /// The lines of a block, numbered from 1.
    pub(super) fn lines(&self, block: usize) -> Lines<'a> {
        Lines::of_block(self.text, &self.blocks[block])
    }

    /// What comes before a block.
    pub(super) fn before(&self, block: usize) -> Counts {
        if block == 0 { Counts::default() } else { self.before.get_or_init(|| self.counted())[block] }
    }

    fn counted(&self) -> Vec<Counts> {
        let mut all = vec![Counts::default()];
        for block in 0..self.len() {
            all.push(self.behind(block, all[block]));
        }
        all
    }

    /// What comes before the end of a block that so much comes before.
    fn behind(&self, block: usize, mut counts: Counts) -> Counts {
        let mut lines = self.lines(block);
        for line in lines.by_ref() {
            match line.words().next() {
                Some(b"v") => counts.points += 1,
                Some(b"vt") => counts.uv_points += 1,
                Some(b"vn") => counts.normals += 1,
                _ => {}
            }
        }
        counts.lines += lines.number();
        counts
    }
}
