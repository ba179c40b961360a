//! Text in columns.

/// Rows in columns two spaces apart, the first row over a rule; numbers to the right, words to the left.
pub(crate) fn columns(rows: &[Vec<String>]) -> String {
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(|cell| cut(cell, LONGEST)).collect()).collect();
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count).map(width).collect();
    let numeric = |c: usize| rows.iter().skip(1).filter_map(|r| r.get(c)).all(|s| is_number(s));
    let right: Vec<bool> = (0..count).map(numeric).collect();
    let line = |row: &Vec<String>| {
        let cell = |(c, s): (usize, &String)| {
            let gap = " ".repeat(widths[c] - s.chars().count());
            if right[c] { gap + s } else { s.clone() + &gap }
        };
        row.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    let mut text = String::new();
    for (i, row) in rows.iter().enumerate() {
        text += &line(row);
        if i == 0 {
            text += &("─".repeat(widths.iter().sum::<usize>() + 2 * count.saturating_sub(1)) + "\n");
        }
    }
    text
}

/// The width of a terminal that nobody has made wider.
const WIDTH: usize = 80;

/// A paragraph in lines that fit a terminal, all but the first indented.
pub(crate) fn wrapped(text: &str, indent: usize) -> String {
    wrapped_from(0, text, indent)
}

/// A paragraph that begins behind a label, its lines one under the other.
pub(crate) fn labelled(label: &str, text: &str) -> String {
    const LABEL: usize = 10;
    format!("{label:<LABEL$}{}", wrapped_from(LABEL, text, LABEL))
}

fn wrapped_from(start: usize, text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut column = start;
    for word in text.split_whitespace() {
        let letters = word.chars().count();
        if !lines.is_empty() && column + 1 + letters > WIDTH {
            lines += &format!("\n{}", " ".repeat(indent));
            column = indent;
        } else if !lines.is_empty() {
            lines.push(' ');
            column += 1;
        }
        lines += word;
        column += letters;
    }
    lines + "\n"
}

/// The most letters of a cell: names in files can be of any length.
const LONGEST: usize = 34;

/// A cell on one line and not too long.
pub(crate) fn cut(cell: &str, longest: usize) -> String {
    let mut letters = cell.chars().map(|letter| if letter.is_control() { ' ' } else { letter });
    let mut text: String = letters.by_ref().take(longest).collect();
    if letters.next().is_some() {
        text.pop();
        text.push('…');
    }
    text
}

/// So many things: 1 vertex, 14,290 vertices.
pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", thousands(n), if n == 1 { one } else { many })
}

/// A number with its thousands set apart: 14,290.
pub(crate) fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn is_number(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '–')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_to_the_right_and_words_to_the_left() {
        let rows = [["name", "n"], ["a", "1"], ["bcd", "20"]].map(|r| r.map(String::from).to_vec());
        assert_eq!(columns(&rows), "name   n\n────────\na      1\nbcd   20\n");
    }

    #[test]
    fn cells_of_any_length_fit() {
        let text = columns(&[vec!["name".to_owned()], vec!["x".repeat(70_000)], vec!["two\nlines".to_owned()]]);
        assert_eq!(text.lines().count(), 4);
        assert!(text.lines().all(|line| line.chars().count() <= LONGEST));
    }

    #[test]
    fn paragraphs_fit_a_terminal() {
        let text = wrapped(&"word ".repeat(40), 2);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH) && text.lines().count() == 3, "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("  word")));
        let text = labelled("label", &"word ".repeat(40));
        assert!(text.starts_with("label     word word") && text.contains("\n          word"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
    }

    #[test]
    fn one_thing_is_told_in_the_singular() {
        let told = [0, 1, 2000].map(|n| counted(n, "vertex", "vertices"));
        assert_eq!(told, ["0 vertices", "1 vertex", "2,000 vertices"]);
    }

    #[test]
    fn thousands_are_set_apart() {
        assert_eq!(thousands(999), "999");
        assert_eq!(thousands(1_234_567), "1,234,567");
    }
}
