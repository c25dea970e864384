//! Matrix games without allocation.

/// The least that the column player can pay for sure, and how both players mix.
pub(crate) struct Solution<const N: usize> {
    pub value: f64,
    pub rows: [f64; N],
    pub columns: [f64; N],
}

/// Solves the game in which the column player pays `payoff[row][column]`, leading `rows` and `columns`.
///
/// With all payments made positive it is `max sum x, P x <= 1, x >= 0`, solved by the simplex method on
/// a condensed table, whose shadow prices are the other player's mix. At most `20 N` exchanges.
///
/// Source: Dantzig 1951.
pub(crate) fn solve<const N: usize>(
    payoff: &[[f64; N]; N],
    rows: usize,
    columns: usize,
) -> Solution<N> {
    let table = payoff
        .iter()
        .take(rows)
        .flat_map(|row| row.iter().take(columns));
    let shift = 1.0 - table.copied().fold(0.0, f64::min);
    let mut table = Table::new(payoff, shift, rows, columns);
    for _ in 0..20 * N {
        let Some((row, column)) = table.next() else {
            break;
        };
        table.exchange(row, column);
    }
    table.solution(shift)
}

/// The table: entries, right sides, costs; whose variable belongs to a row or column. Variables below `N` are
/// the columns' shares, those from `N` on the slacks of the rows.
struct Table<const N: usize> {
    entries: [[f64; N]; N],
    right: [f64; N],
    cost: [f64; N],
    total: f64,
    basic: [usize; N],
    free: [usize; N],
    rows: usize,
    columns: usize,
}

impl<const N: usize> Table<N> {
    fn new(payoff: &[[f64; N]; N], shift: f64, rows: usize, columns: usize) -> Self {
        let mut entries = *payoff;
        entries
            .iter_mut()
            .flatten()
            .for_each(|entry| *entry += shift);
        let count = |first: usize| core::array::from_fn(|k| first + k);
        Self {
            entries,
            right: [1.0; N],
            cost: [-1.0; N],
            total: 0.0,
            basic: count(N),
            free: count(0),
            rows,
            columns,
        }
    }

    /// The exchange of steepest descent; none at the optimum. Payments are of order 1, so that 1e-12 is
    /// rounding.
    fn next(&self) -> Option<(usize, usize)> {
        let column = (0..self.columns)
            .filter(|&k| self.cost[k] < -1e-12)
            .min_by(|&a, &b| self.cost[a].total_cmp(&self.cost[b]))?;
        let ratio = |i: &usize| self.right[*i] / self.entries[*i][column];
        let row = (0..self.rows)
            .filter(|&i| self.entries[i][column] > 1e-12)
            .min_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
        Some((row, column))
    }

    fn exchange(&mut self, row: usize, column: usize) {
        let inverse = 1.0 / self.entries[row][column];
        let leading = self.entries[row];
        let right = self.right[row] * inverse;
        for i in (0..self.rows).filter(|&i| i != row) {
            let factor = self.entries[i][column] * inverse;
            if factor != 0.0 {
                let line = self.entries[i].iter_mut().zip(&leading);
                line.take(self.columns)
                    .for_each(|(entry, above)| *entry -= factor * above);
                self.right[i] -= factor * self.right[row];
            }
            self.entries[i][column] = -factor;
        }
        let factor = self.cost[column] * inverse;
        let costs = self.cost.iter_mut().zip(&leading);
        costs
            .take(self.columns)
            .for_each(|(cost, above)| *cost -= factor * above);
        self.cost[column] = -factor;
        self.total -= factor * self.right[row];
        self.entries[row]
            .iter_mut()
            .for_each(|entry| *entry *= inverse);
        self.entries[row][column] = inverse;
        self.right[row] = right;
        core::mem::swap(&mut self.basic[row], &mut self.free[column]);
    }

    fn solution(&self, shift: f64) -> Solution<N> {
        let mut solution = Solution {
            value: 1.0 / self.total - shift,
            rows: [0.0; N],
            columns: [0.0; N],
        };
        for (&variable, value) in self.basic.iter().zip(self.right).take(self.rows) {
            if variable < N {
                solution.columns[variable] = value.max(0.0) / self.total;
            }
        }
        for (&variable, cost) in self.free.iter().zip(self.cost).take(self.columns) {
            if variable >= N {
                solution.rows[variable - N] = cost.max(0.0) / self.total;
            }
        }
        solution
    }
}
