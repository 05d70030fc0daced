//! The variables of a problem, and the values they may take.

use super::{
    MoeaError, Problem,
    bounds::{FARTHEST, LARGEST_INTEGER},
    problem::{Bounds, Kind},
    random::Random,
};

/// Bounds and kinds of the variables of a problem. Bounds alone are of real variables.
///
/// ```
/// use moea::{Kind, Run, Settings, Variables};
///
/// let variables = Variables::new(vec![(0.0, 1.0), (1.0, 6.0)], vec![Kind::Real, Kind::Integer]);
/// let run = Run::new(variables, 2, &Settings::default())?;
/// assert!(run.ask().iter().all(|x| [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].contains(&x[1])));
/// # Ok::<(), moea::MoeaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Variables {
    bounds: Vec<Bounds>,
    kinds: Vec<Kind>,
}

impl Variables {
    /// Variables of `bounds` and `kinds`, `[variables]` each; no kinds if all are real.
    pub fn new(bounds: Vec<Bounds>, kinds: Vec<Kind>) -> Self {
        Self { bounds, kinds }
    }

    /// The variables of a problem.
    pub fn of(problem: &impl Problem) -> Self {
        Self::new(problem.bounds(), problem.kinds())
    }
}

impl From<Vec<Bounds>> for Variables {
    fn from(bounds: Vec<Bounds>) -> Self {
        Self::new(bounds, Vec::new())
    }
}

impl<const N: usize> From<[Bounds; N]> for Variables {
    fn from(bounds: [Bounds; N]) -> Self {
        bounds.to_vec().into()
    }
}

impl From<&[Bounds]> for Variables {
    fn from(bounds: &[Bounds]) -> Self {
        Self::new(bounds.to_vec(), Vec::new())
    }
}

impl<const N: usize> From<&[Bounds; N]> for Variables {
    fn from(bounds: &[Bounds; N]) -> Self {
        bounds.as_slice().into()
    }
}

impl From<&Vec<Bounds>> for Variables {
    fn from(bounds: &Vec<Bounds>) -> Self {
        bounds.as_slice().into()
    }
}

/// The values that variables may take, none of them without any.
#[derive(Debug, Clone)]
pub(super) struct Space {
    /// Least and largest value; whole numbers if the variable is an integer.
    pub(super) bounds: Vec<Bounds>,
    /// Where values are drawn and varied before they settle: of an integer half beyond its bounds, so that
    /// as much of it belongs to the ends as to others.
    pub(super) reach: Vec<Bounds>,
    /// Whether each variable is an integer.
    pub(super) whole: Vec<bool>,
}

impl Space {
    pub(super) fn new(variables: Variables) -> Result<Self, MoeaError> {
        let Variables { mut bounds, kinds } = variables;
        if bounds.is_empty() {
            return Err(MoeaError::NoVariables);
        }
        if !kinds.is_empty() && kinds.len() != bounds.len() {
            return Err(MoeaError::Kinds { given: kinds.len(), wanted: bounds.len() });
        }
        let mut whole: Vec<bool> = kinds.iter().map(|kind| *kind == Kind::Integer).collect();
        whole.resize(bounds.len(), false);
        for (index, (bounds, whole)) in bounds.iter_mut().zip(&whole).enumerate() {
            let (lower, upper) = *bounds;
            if !(lower.abs() <= FARTHEST && upper.abs() <= FARTHEST && lower <= upper) {
                return Err(MoeaError::Bounds { index, lower, upper });
            }
            if *whole {
                // A zero without its sign.
                *bounds = (lower.ceil() + 0.0, upper.floor() + 0.0);
                if bounds.0 > bounds.1 || bounds.0 < -LARGEST_INTEGER || bounds.1 > LARGEST_INTEGER {
                    return Err(MoeaError::Integer { index, lower, upper });
                }
            }
        }
        let reach = bounds.iter().zip(&whole);
        let reach = reach.map(|(&(a, b), whole)| if *whole { (a - 0.5, b + 0.5) } else { (a, b) }).collect();
        Ok(Self { bounds, reach, whole })
    }

    /// Number of variables.
    pub(super) fn len(&self) -> usize {
        self.bounds.len()
    }

    /// Moves values to the nearest that the variables may take.
    pub(super) fn settle(&self, x: &mut [f64]) {
        for (k, x) in x.iter_mut().enumerate() {
            *x = self.settled(k, *x);
        }
    }

    /// The value of variable `k` nearest to another.
    pub(super) fn settled(&self, k: usize, value: f64) -> f64 {
        let (lower, upper) = self.bounds[k];
        if self.whole[k] { value.round().clamp(lower, upper) + 0.0 } else { value.clamp(lower, upper) }
    }

    /// Draws values, each as likely as any other.
    pub(super) fn draw(&self, x: &mut [f64], rng: &mut Random) {
        for (x, &(lower, upper)) in x.iter_mut().zip(&self.reach) {
            *x = lower + rng.unit() * (upper - lower);
        }
        self.settle(x);
    }
}
