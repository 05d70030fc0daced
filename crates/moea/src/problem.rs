//! What is to be optimised.

/// Lower and upper bound of one variable; equal bounds fix it.
pub type Bounds = (f64, f64);

/// Several objectives, all minimised, over a box of real variables.
///
/// An evaluation must be a function of `x` alone: the workspace is for scratch memory, handed
/// out to whichever thread comes next, and may not carry anything from call to call.
pub trait Problem: Sync {
    /// Scratch memory of one thread; `()` if none is needed.
    type Workspace: Default + Send;

    /// Bounds of each variable, `[variables]`.
    fn bounds(&self) -> Vec<Bounds>;

    /// Number of objectives.
    fn objectives(&self) -> usize;

    /// Writes the objectives of `x` (`[variables]`) into `objectives` (`[objectives]`) and
    /// returns the total violation of constraints: 0 when `x` is feasible, else the sum of the
    /// violations, each divided by what its constraint allows.
    ///
    /// An objective or a violation that is NaN, infinite or beyond 1e100 makes `x` the worst
    /// there is.
    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Self::Workspace) -> f64;

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

    fn objectives(&self) -> usize {
        (*self).objectives()
    }

    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Self::Workspace) -> f64 {
        (*self).evaluate(x, objectives, workspace)
    }

    fn is_cheap(&self) -> bool {
        (*self).is_cheap()
    }
}
