//! Sums over lists: rows of a sparse matrix.

use rayon::prelude::*;

/// Rows that one thread takes at a time.
const CHUNK: usize = 512;

/// A sparse matrix by rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// Number of the first entry of each row; one more than there are rows.
    first: Vec<u32>,
    columns: Vec<u32>,
    weights: Vec<f64>,
}

impl Rows {
    /// Rows from entries (row, column, weight), which are added up where they meet.
    pub(super) fn new(rows: usize, mut entries: Vec<(u32, u32, f64)>) -> Self {
        entries.par_sort_by_key(|&(row, column, _)| (row, column));
        entries.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        let mut first = vec![0; rows + 1];
        for &(row, ..) in &entries {
            first[row as usize + 1] += 1;
        }
        for row in 0..rows {
            first[row + 1] += first[row];
        }
        Self {
            first,
            columns: entries.iter().map(|&(_, column, _)| column).collect(),
            weights: entries.iter().map(|&(.., weight)| weight).collect(),
        }
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// Columns and weights of a row.
    pub(super) fn of(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let entries = self.first[row] as usize..self.first[row + 1] as usize;
        self.columns[entries.clone()]
            .iter()
            .map(|&column| column as usize)
            .zip(self.weights[entries].iter().copied())
    }

    /// Sum of a row's weights.
    pub(super) fn sum(&self, row: usize) -> f64 {
        self.weights[self.first[row] as usize..self.first[row + 1] as usize].iter().sum()
    }

    /// Rows with other weights, by row and column.
    pub(super) fn with(mut self, weight: impl Fn(usize, usize, f64) -> f64) -> Self {
        for row in 0..self.len() {
            for entry in self.first[row] as usize..self.first[row + 1] as usize {
                self.weights[entry] = weight(row, self.columns[entry] as usize, self.weights[entry]);
            }
        }
        self
    }

    /// The matrix with rows and columns changed.
    pub(super) fn transposed(&self, columns: usize) -> Self {
        let entries = (0..self.len())
            .flat_map(|row| self.of(row).map(move |(column, weight)| (column as u32, row as u32, weight)))
            .collect();
        Self::new(columns, entries)
    }

    /// Product with a list of `N` numbers by column.
    pub(super) fn times<const N: usize>(&self, values: &[[f64; N]]) -> Vec<[f64; N]> {
        let one = |row: usize| {
            let mut sum = [0.0; N];
            for (column, weight) in self.of(row) {
                add(&mut sum, weight, &values[column]);
            }
            sum
        };
        (0..self.len()).into_par_iter().with_min_len(CHUNK).map(one).collect()
    }
}

/// Adds numbers times a weight.
pub(super) fn add<const N: usize>(sum: &mut [f64; N], weight: f64, values: &[f64; N]) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += weight * value;
    }
}
