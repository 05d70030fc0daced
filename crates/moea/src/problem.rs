//! What is to be optimised.

/// Lower and upper bound of one variable; equal bounds fix it.
pub type Bounds = (f64, f64);

/// What values a variable takes within its bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Kind {
    /// All.
    #[default]
    Real,
    /// Whole numbers, each as likely as any other at the start.
    Integer,
}

/// Several objectives, all minimised, over a box of real variables and integers.
///
/// An evaluation must be a function of `x` alone: the workspace is for scratch memory, handed
/// out to whichever thread comes next, and may carry something from [`Problem::evaluate`] to the
/// [`Problem::violations`] after it, but from no member to the next.
pub trait Problem: Sync {
    /// Scratch memory of one thread; `()` if none is needed.
    type Workspace: Default + Send;

    /// Bounds of each variable, `[variables]`.
    fn bounds(&self) -> Vec<Bounds>;

    /// Kind of each variable, `[variables]`; empty if all are real.
    ///
    /// An integer is a whole number within its bounds whenever `x` is evaluated. Mutation of an integer always
    /// changes it, and any value of it may come of any other.
    ///
    /// ```
    /// use moea::{Bounds, Kind, Problem, Settings, optimise, silent};
    ///
    /// /// Cost and loss of a bundle of 1 to 8 wires, each of some cross-section in mm².
    /// struct Bundle;
    ///
    /// impl Problem for Bundle {
    ///     type Workspace = ();
    ///     fn bounds(&self) -> Vec<Bounds> { vec![(1.0, 8.0), (0.5, 4.0)] }
    ///     fn kinds(&self) -> Vec<Kind> { vec![Kind::Integer, Kind::Real] }
    ///     fn objectives(&self) -> usize { 2 }
    ///     fn evaluate(&self, x: &[f64], f: &mut [f64], _: &mut ()) -> f64 {
    ///         (f[0], f[1]) = (x[0] * (1.0 + x[1]), 1.0 / (x[0] * x[1]));
    ///         0.0
    ///     }
    /// }
    ///
    /// let found = optimise(&Bundle, &Settings::default(), silent)?.population;
    /// assert!((0..found.len()).all(|i| found.x(i)[0].fract() == 0.0));
    /// # Ok::<(), moea::MoeaError>(())
    /// ```
    fn kinds(&self) -> Vec<Kind> {
        Vec::new()
    }

    /// Number of objectives.
    fn objectives(&self) -> usize;

    /// Writes the objectives of `x` (`[variables]`) into `objectives` (`[objectives]`) and
    /// returns the total violation of constraints: 0 when `x` is feasible, else the sum of the
    /// violations, each divided by what its constraint allows.
    ///
    /// An objective or a violation that is NaN, infinite or beyond 1e100 makes `x` the worst
    /// there is.
    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Self::Workspace) -> f64;

    /// Number of constraints whose violations are told one by one; 0 if `evaluate` returns all of
    /// their total.
    fn constraints(&self) -> usize {
        0
    }

    /// Writes by how much `x` violates each constraint into `violations` (`[constraints]`, 0 at
    /// first), each in a unit of its own; what is not above 0 is kept. Called after every `evaluate`
    /// with its `x`, `objectives` and workspace if there are [`Problem::constraints`].
    ///
    /// Each violation is divided by the scale of its constraint and added to what `evaluate` returned, so that the unit
    /// does not matter. The scale is the upper quartile of the violations above 0 of this generation, or four fifths of
    /// the scale before, whichever is larger (MOEA/D, which evaluates one child at a time, takes half a generation at
    /// once): neither a few that are far larger set it, nor first members that nearly keep the constraint. Totals of all
    /// members are in the present scales, and so change in a run. A violation that is NaN, infinite or beyond
    /// 1e100 makes `x` the worst there is.
    ///
    /// ```
    /// use moea::{Bounds, Problem, Settings, optimise, silent};
    ///
    /// /// The nearest points of a triangle to two others; by axis a length in m and one in mm.
    /// struct Nearest;
    ///
    /// impl Problem for Nearest {
    ///     type Workspace = ();
    ///     fn bounds(&self) -> Vec<Bounds> { vec![(0.0, 2.0), (0.0, 2000.0)] }
    ///     fn objectives(&self) -> usize { 2 }
    ///     fn evaluate(&self, x: &[f64], f: &mut [f64], _: &mut ()) -> f64 {
    ///         (f[0], f[1]) = (x[0].hypot(x[1] / 1e3), (x[0] - 2.0).hypot(x[1] / 1e3));
    ///         0.0
    ///     }
    ///     fn constraints(&self) -> usize { 2 }
    ///     fn violations(&self, x: &[f64], _: &[f64], violations: &mut [f64], _: &mut ()) {
    ///         violations[0] = 1.0 - x[0] - x[1] / 1e3; // m
    ///         violations[1] = 300.0 - x[1]; // mm
    ///     }
    /// }
    ///
    /// let found = optimise(&Nearest, &Settings::default(), silent)?.population;
    /// assert!(found.front().iter().all(|&i| found.x(i)[1] >= 300.0));
    /// # Ok::<(), moea::MoeaError>(())
    /// ```
    fn violations(
        &self,
        x: &[f64],
        objectives: &[f64],
        violations: &mut [f64],
        workspace: &mut Self::Workspace,
    ) {
        let _ = (x, objectives, violations, workspace);
    }

    /// Whether an evaluation takes less than a few microseconds, so that threads cost more
    /// than they bring. The result does not depend on it.
    fn is_cheap(&self) -> bool {
        false
    }
}

/// A problem behind a reference is the same problem.
impl<P: Problem> Problem for &P {
    type Workspace = P::Workspace;

    fn bounds(&self) -> Vec<Bounds> {
        (*self).bounds()
    }

    fn kinds(&self) -> Vec<Kind> {
        (*self).kinds()
    }

    fn objectives(&self) -> usize {
        (*self).objectives()
    }

    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Self::Workspace) -> f64 {
        (*self).evaluate(x, objectives, workspace)
    }

    fn constraints(&self) -> usize {
        (*self).constraints()
    }

    fn violations(
        &self,
        x: &[f64],
        objectives: &[f64],
        violations: &mut [f64],
        workspace: &mut Self::Workspace,
    ) {
        (*self).violations(x, objectives, violations, workspace);
    }

    fn is_cheap(&self) -> bool {
        (*self).is_cheap()
    }
}
