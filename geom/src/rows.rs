//! Rows of different lengths, one after the other in one array (compressed sparse rows).

/// Rows of items.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows<T> {
    /// Row r is `item[start[r]..start[r + 1]]`.
    start: Vec<u32>,
    item: Vec<T>,
}

impl<T: Copy + Default> Rows<T> {
    /// Sorts items into their rows, in the order in which they come. O(rows + items), going through the items twice.
    ///
    /// ```
    /// let rows = geom::Rows::sorted(3, [(2, 'a'), (0, 'b'), (2, 'c')].into_iter());
    /// assert_eq!((rows.row(0), rows.row(1), rows.row(2)), (&['b'][..], &[][..], &['a', 'c'][..]));
    /// ```
    ///
    /// # Panics
    /// If an item names a row that is not there, or there are 2³² items.
    pub fn sorted(row_count: usize, items: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        // The start of row r is counted up at r + 1 while items are filled in.
        let mut start = vec![0u32; row_count + 2];
        // By `for_each`, which takes nested iterators apart into loops.
        items.clone().for_each(|(row, _)| start[row + 2] += 1);
        for row in 0..row_count {
            start[row + 2] = start[row + 2].checked_add(start[row + 1]).expect("rows have fewer than 2³² items");
        }
        let mut item = vec![T::default(); start[row_count + 1] as usize];
        items.for_each(|(row, new)| {
            let end = &mut start[row + 1];
            item[*end as usize] = new;
            *end += 1;
        });
        start.truncate(row_count + 1);
        Self { start, item }
    }
}

impl<T> Rows<T> {
    /// A row.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline]
    pub fn row(&self, r: usize) -> &[T] {
        &self.item[self.start[r] as usize..self.start[r + 1] as usize]
    }

    /// A row, to be changed.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row_mut(&mut self, r: usize) -> &mut [T] {
        &mut self.item[self.start[r] as usize..self.start[r + 1] as usize]
    }

    /// The items of all rows, one row after the other.
    pub fn into_items(self) -> Vec<T> {
        self.item
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.start.len() - 1
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many items there are in all rows.
    pub fn item_count(&self) -> usize {
        self.item.len()
    }
}

/// Row after row.
impl<T, R: IntoIterator<Item = T>> FromIterator<R> for Rows<T> {
    fn from_iter<I: IntoIterator<Item = R>>(rows: I) -> Self {
        let mut all = Self { start: vec![0], item: Vec::new() };
        for row in rows {
            all.item.extend(row);
            all.start.push(u32::try_from(all.item.len()).expect("rows have fewer than 2³² items"));
        }
        all.item.shrink_to_fit();
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorted_items_are_those_of_rows_made_one_by_one() {
        let items: Vec<(usize, u32)> = (0..50).map(|k| ((k * k) as usize % 7, k)).collect();
        let sorted = Rows::sorted(8, items.iter().copied());
        let one_by_one: Rows<u32> =
            (0..8).map(|r| items.iter().filter(move |(row, _)| *row == r).map(|(_, k)| *k)).collect();
        assert_eq!(sorted, one_by_one);
        assert_eq!((sorted.len(), sorted.item_count(), sorted.row(7)), (8, 50, &[][..]));
        assert!(Rows::<u32>::sorted(0, std::iter::empty()).is_empty());
    }
}
