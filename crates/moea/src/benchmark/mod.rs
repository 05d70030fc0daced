//! Problems with known fronts.

mod dtlz;
mod front;
mod mw;
mod wfg;

use super::{
    direction::MOST_OBJECTIVES,
    problem::{Bounds, Problem},
};

/// A family of problems that share their conventions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// DTLZ1 to DTLZ7.
    Dtlz,
    /// MW1 to MW4, with constraints.
    Mw,
    /// WFG1 to WFG9.
    Wfg,
}

/// One problem with its numbers of objectives and variables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Benchmark {
    family: Family,
    number: u8,
    objectives: usize,
    variables: usize,
    positions: usize,
}

const MOST_VARIABLES: usize = 1_000_000;

/// Every name that [`Benchmark::named`] knows.
pub const NAMES: [&str; 20] = [
    "DTLZ1", "DTLZ2", "DTLZ3", "DTLZ4", "DTLZ5", "DTLZ6", "DTLZ7", "MW1", "MW2", "MW3", "MW4", "WFG1",
    "WFG2", "WFG3", "WFG4", "WFG5", "WFG6", "WFG7", "WFG8", "WFG9",
];

impl Benchmark {
    /// The problem of a name such as "DTLZ3" or "wfg1" for 2 to 1000 objectives, with the
    /// usual number of variables: m + 4 for DTLZ1, m + 19 for DTLZ7, m + 9 for the other DTLZ,
    /// m - 1 positions and 10 distances for WFG. MW1 to MW3 have two objectives, MW4 up to 14; all have 15 variables.
    pub fn named(name: &str, objectives: usize) -> Option<Self> {
        let upper = name.to_ascii_uppercase();
        let (family, digits, last) = if let Some(digits) = upper.strip_prefix("DTLZ") {
            (Family::Dtlz, digits, 7)
        } else if let Some(digits) = upper.strip_prefix("MW") {
            (Family::Mw, digits, 4)
        } else {
            (Family::Wfg, upper.strip_prefix("WFG")?, 9)
        };
        let number: u8 = digits.parse().ok().filter(|number| (1..=last).contains(number))?;
        let most = match (family, number) {
            (Family::Mw, 4) => mw::VARIABLES - 1,
            (Family::Mw, _) => 2,
            _ => MOST_OBJECTIVES,
        };
        let positions = objectives.saturating_sub(1).min(most);
        let distances = match (family, number) {
            (Family::Dtlz, 1) => 5,
            (Family::Dtlz, 7) => 20,
            (Family::Mw, _) => mw::VARIABLES - positions,
            _ => 10,
        };
        (2..=most).contains(&objectives).then_some(Self {
            family,
            number,
            objectives,
            variables: positions + distances,
            positions,
        })
    }

    /// The same problem with other numbers of positions and distances; `None` where the family
    /// does not allow them: DTLZ and MW have m - 1 positions, WFG a multiple of it and an even number
    /// of distances, both at least one distance; there are at most a million variables.
    pub fn with_variables(self, positions: usize, distances: usize) -> Option<Self> {
        let groups = self.objectives - 1;
        let fits = match self.family {
            Family::Dtlz | Family::Mw => positions == groups && distances >= 1,
            Family::Wfg => {
                positions >= 1
                    && positions.is_multiple_of(groups)
                    && distances >= 2
                    && distances.is_multiple_of(2)
            }
        };
        let variables = positions.checked_add(distances).filter(|most| *most <= MOST_VARIABLES)?;
        fits.then_some(Self { variables, positions, ..self })
    }

    /// Name, as "DTLZ3".
    pub fn name(&self) -> String {
        let family = match self.family {
            Family::Dtlz => "DTLZ",
            Family::Mw => "MW",
            Family::Wfg => "WFG",
        };
        format!("{family}{}", self.number)
    }

    /// About `count` points spread over the true front, `[n][objectives]`; over the usual part of it where
    /// [`Self::has_whole_front`] is false. More where its corners alone, or the pieces that it comes in, are more; fewer
    /// where the next finer grid has more: of DTLZ7 half at least, of those that stand on reference directions (DTLZ1 to
    /// 4, WFG4 to 9) as many as the finest set of them that fits; of WFG1 and WFG2 200 000 at most.
    ///
    /// Points of many objectives lie far apart: of WFG1 and WFG2 with five to ten the nearest of 1000 points is on
    /// average .03 of the range of the front from one of it, and up to a quarter where the front is large.
    pub fn front(&self, count: usize) -> Vec<f64> {
        front::points(self, count)
    }

    /// Whether [`Self::front`] covers the whole true front.
    ///
    /// WFG3 from three objectives on, and DTLZ5 and DTLZ6 from four on, were meant to have a curve for a front, and
    /// comparisons measure to this curve. Their true fronts have further parts (Ishibuchi, Masuda and Nojima 2016, on
    /// degenerate test problems): IGD and IGD+ do not reward members there.
    pub fn has_whole_front(&self) -> bool {
        match (self.family, self.number) {
            (Family::Wfg, 3) => self.objectives < 3,
            (Family::Dtlz, 5 | 6) => self.objectives < 4,
            _ => true,
        }
    }

    /// Largest value of each objective on the front, `[objectives]`; the smallest is taken as 0.
    pub fn nadir(&self) -> Vec<f64> {
        let m = self.objectives;
        let front = self.front(2000);
        (0..m).map(|k| front.iter().skip(k).step_by(m).fold(0.0_f64, |most, &f| most.max(f))).collect()
    }
}

impl Problem for Benchmark {
    type Workspace = Vec<f64>;

    fn bounds(&self) -> Vec<Bounds> {
        match self.family {
            Family::Dtlz | Family::Mw => vec![(0.0, 1.0); self.variables],
            Family::Wfg => (0..self.variables).map(|i| (0.0, 2.0 * (i as f64 + 1.0))).collect(),
        }
    }

    fn objectives(&self) -> usize {
        self.objectives
    }

    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Vec<f64>) -> f64 {
        if x.len() != self.variables || objectives.len() != self.objectives {
            return f64::INFINITY;
        }
        match self.family {
            Family::Dtlz => dtlz::evaluate(self.number, x, objectives),
            Family::Mw => return mw::evaluate(self.number, x, objectives),
            Family::Wfg => wfg::evaluate(self.number, self.positions, x, objectives, workspace),
        }
        0.0
    }

    fn is_cheap(&self) -> bool {
        true
    }
}
