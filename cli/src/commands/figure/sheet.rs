//! Panels in columns and rows with words above and below, as one picture.

use crate::render::{INK, Letters, PAPER, Picture, mix};

/// Empty pixels round panels and words.
const MARGIN: usize = 14;

/// What stands above each other.
#[derive(Clone, Debug)]
pub(super) struct SheetColumn {
    pub(super) head: Vec<String>,
    pub(super) panels: Vec<Picture>,
    pub(super) foot: Vec<String>,
}

/// The picture; each panel fits into a rectangle of the given size.
pub(super) fn sheet(columns: &[SheetColumn], panel: [usize; 2]) -> Picture {
    let line = Letters::Small.height();
    let most = |count: fn(&SheetColumn) -> usize| columns.iter().map(count).max().unwrap_or(0);
    let (heads, rows, feet) = (most(|c| c.head.len()), most(|c| c.panels.len()), most(|c| c.foot.len()));
    let panels: Vec<Vec<Picture>> =
        columns.iter().map(|column| column.panels.iter().map(|picture| picture.fitted(panel)).collect()).collect();
    let heights: Vec<usize> = (0..rows)
        .map(|row| panels.iter().filter_map(|column| column.get(row)).map(|picture| picture.height).max().unwrap_or(0))
        .collect();
    let height = MARGIN * (rows + 3) + line * (heads + feet) + heights.iter().sum::<usize>();
    let mut page = Picture::blank(MARGIN + columns.len() * (panel[0] + MARGIN), height, PAPER);
    for (k, (column, pictures)) in columns.iter().zip(&panels).enumerate() {
        let left = MARGIN + k * (panel[0] + MARGIN);
        let mut top = MARGIN;
        for (i, text) in column.head.iter().enumerate() {
            page.write(&fitting(text, panel[0]), [left, top + i * line], Letters::Small, INK);
        }
        top += heads * line + MARGIN;
        for (picture, height) in pictures.iter().zip(&heights) {
            page.place(picture, [left + (panel[0] - picture.width) / 2, top + (height - picture.height) / 2]);
            top += height + MARGIN;
        }
        let foot = height - MARGIN - feet * line;
        for (i, text) in column.foot.iter().enumerate() {
            page.write(&fitting(text, panel[0]), [left, foot + i * line], Letters::Small, mix(INK, PAPER, 0.15));
        }
    }
    page
}

/// A text cut off at a width.
fn fitting(text: &str, width: usize) -> String {
    let room = width / Letters::Small.width("x").max(1);
    if text.chars().count() <= room {
        return text.to_owned();
    }
    text.chars().take(room.saturating_sub(2)).chain("..".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_beside_each_other_and_words_are_cut_at_their_width() {
        let column = |colour| SheetColumn {
            head: vec!["x".repeat(200)],
            panels: vec![Picture::blank(400, 100, colour)],
            foot: vec![],
        };
        let page = sheet(&[column([1.0, 0.0, 0.0]), column([0.0, 0.0, 1.0])], [200, 200]);
        assert_eq!(page.width, 3 * MARGIN + 400);
        let middle = &page.pixels[(page.height - 3 * MARGIN) * page.width..][..page.width];
        assert_eq!([middle[MARGIN + 100], middle[2 * MARGIN + 300], middle[2]], [[255, 0, 0], [0, 0, 255], [255; 3]]);
        let gap = (0..page.height).all(|y| page.pixels[y * page.width + MARGIN + 204] == [255; 3]);
        assert!(gap, "a head stays above its own column");
    }
}
