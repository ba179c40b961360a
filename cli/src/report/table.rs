//! Text in columns.

/// Rows in columns two spaces apart, the first row over a rule; numbers to the right, words to the left.
pub(crate) fn columns(rows: &[Vec<String>]) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count).map(width).collect();
    let numeric = |c: usize| rows.iter().skip(1).filter_map(|r| r.get(c)).all(|s| is_number(s));
    let right: Vec<bool> = (0..count).map(numeric).collect();
    let line = |row: &Vec<String>| {
        let cell = |(c, s): (usize, &String)| {
            if right[c] { format!("{s:>w$}", w = widths[c]) } else { format!("{s:<w$}", w = widths[c]) }
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
    fn thousands_are_set_apart() {
        assert_eq!(thousands(999), "999");
        assert_eq!(thousands(1_234_567), "1,234,567");
    }
}
