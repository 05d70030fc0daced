//! Convex quadratic programmes with inequalities, solved by Clarabel.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT},
};

/// A sparse matrix in the making, column by column.
#[derive(Default)]
pub struct Columns {
    start: Vec<usize>,
    row: Vec<usize>,
    value: Vec<f64>,
}

impl Columns {
    /// Adds a column: entries by row, in order.
    pub fn column(&mut self, entries: impl Iterator<Item = (usize, f64)>) {
        self.start.push(self.row.len());
        for (row, value) in entries {
            self.row.push(row);
            self.value.push(value);
        }
    }

    fn matrix(mut self, rows: usize) -> CscMatrix<f64> {
        let columns = self.start.len();
        self.start.push(self.row.len());
        CscMatrix::new(rows, columns, self.start, self.row, self.value)
    }
}

/// The x that lessens 1/2 x'Px + q'x with Ax <= b, and the multipliers of its rows; `None` if none is found.
///
/// `upper`: the upper triangle of P, which is positive semidefinite; columns of both as many as q has elements.
pub fn quadratic_programme(upper: Columns, q: &[f64], a: Columns, b: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let settings = DefaultSettingsBuilder::default().verbose(false).build().ok()?;
    let cones = [SupportedConeT::NonnegativeConeT(b.len())];
    let (p, a) = (upper.matrix(q.len()), a.matrix(b.len()));
    let mut solver = DefaultSolver::new(&p, q, &a, b, &cones, settings).ok()?;
    solver.solve();
    let found = solver.solution;
    let solved = matches!(found.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    (solved && found.x.iter().all(|x| x.is_finite())).then_some((found.x, found.z))
}
