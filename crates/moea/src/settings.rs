//! What a run is asked to do.

use super::{
    direction::{Directions, MOST_OBJECTIVES},
    error::{MoeaError, Unsound},
    focus::Focus,
    variables::{Space, Variables},
    variation::Operators,
};

/// Which algorithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Algorithm {
    /// Deb and Jain 2014.
    Nsga3,
    /// NSGA-III with tournaments among members of a niche (Seada and Deb 2016), for one objective and
    /// for many.
    UNsga3,
    /// NSGA-III with the paper's focus operator.
    Nsga3Fo {
        /// Reading of the focus operator.
        focus: Focus,
        /// Rates of eq. 8 and 9 in place of fixed ones; harmful, see the module's list.
        adaptive_rates: bool,
    },
    /// Deb, Pratap, Agarwal and Meyarivan 2002.
    Nsga2,
    /// Zhang and Li 2007 with boundary intersection (PBI, theta = 5). As published, units of the objectives matter.
    Moead {
        /// Whether objectives are divided by the intercepts of the front first.
        normalized: bool,
    },
    /// Hughes 2007. Units of the objectives matter.
    Msops2,
    /// Panichella 2022, with the tournament of NSGA-II.
    AgeMoea2,
    /// Beume, Naujoks and Emmerich 2007, with as many children a generation as members; costly beyond five
    /// objectives.
    SmsEmoa,
}

impl Algorithm {
    /// NSGA-III-FO as recommended: local focus, ends and crowding on fronts that meet few directions;
    /// fixed rates.
    pub const NSGA3_FO: Self = Self::Nsga3Fo { focus: Focus::Spread, adaptive_rates: false };
}

/// When a run ends, if no observer ends it before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Budget {
    /// After exactly this many evaluations, one at least.
    Evaluations(u64),
    /// After this many generations, the first population included, which there always is.
    Generations(u64),
    /// Only when the observer says so.
    Observer,
}

/// All that determines a run, beside the problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The algorithm; NSGA-III-FO by default.
    pub algorithm: Algorithm,
    /// Reference directions; NSGA-II, AGE-MOEA-II, SMS-EMOA and MSOPS-II take from them the size of a population that is
    /// not given, and nothing else.
    pub directions: Directions,
    /// Wanted number of members, by default that of directions; rounded up to a multiple of four. NSGA-III, U-NSGA-III
    /// and NSGA-III-FO have no fewer members than directions ([`Directions::FromPopulation`] gives as many as fit),
    /// MOEA/D has one a direction.
    pub population: Option<usize>,
    /// Length of the run; 20 000 evaluations by default.
    pub budget: Budget,
    /// Rates and distribution indices.
    pub operators: Operators,
    /// Seed of every random number drawn.
    pub seed: u64,
    /// Members the archive of feasible, non-dominated solutions holds at most, but one an objective at least; 0 for no
    /// archive.
    pub archive: usize,
    /// First members, as many as the population has at most; the rest are drawn at random. Values outside the bounds are moved to them, those of
    /// integers to the nearest.
    pub initial: Vec<Vec<f64>>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::NSGA3_FO,
            directions: Directions::Usual,
            population: None,
            budget: Budget::Evaluations(20_000),
            operators: Operators::default(),
            seed: 1,
            archive: 0,
            initial: Vec::new(),
        }
    }
}

/// Largest population.
const MOST_MEMBERS: usize = 1_000_000;

/// Settings that fit a problem.
#[derive(Debug, Clone)]
pub(super) struct Checked {
    pub(super) space: Space,
    pub(super) objectives: usize,
    /// `[count][objectives]`.
    pub(super) directions: Vec<f64>,
    pub(super) members: usize,
    pub(super) mutation_rate: f64,
}

pub(super) fn check(
    variables: Variables,
    objectives: usize,
    settings: &Settings,
) -> Result<Checked, MoeaError> {
    let space = Space::new(variables)?;
    if objectives == 0 {
        return Err(MoeaError::NoObjectives);
    }
    if objectives > MOST_OBJECTIVES {
        return Err(MoeaError::TooManyObjectives { objectives, most: MOST_OBJECTIVES });
    }
    for (member, x) in settings.initial.iter().enumerate() {
        if let Some(found) = Unsound::of(x, space.len(), f64::is_finite) {
            return Err(MoeaError::Initial { member, found, wanted: space.len() });
        }
    }
    let operators = &settings.operators;
    let mutation_rate = operators.mutation_rate.unwrap_or(1.0 / space.len() as f64);
    for (name, value, most) in [
        ("crossover rate", operators.crossover_rate, 1.0),
        ("mutation rate", mutation_rate, 1.0),
        ("crossover distribution index", operators.crossover_eta, 1000.0),
        ("mutation distribution index", operators.mutation_eta, 1000.0),
    ] {
        if !(0.0..=most).contains(&value) {
            return Err(MoeaError::Operator { name, value });
        }
    }
    let usual = 92;
    let has_directions = !matches!(
        settings.algorithm,
        Algorithm::Nsga2 | Algorithm::Msops2 | Algorithm::AgeMoea2 | Algorithm::SmsEmoa
    );
    // Without them only the usual size of a population needs directions, and those of the caller's are still checked.
    let own = matches!(settings.directions, Directions::Own(_));
    let directions = if has_directions || own || settings.population.is_none() {
        settings.directions.points(objectives, settings.population.unwrap_or(usual))?
    } else {
        Vec::new()
    };
    let count = directions.len() / objectives;
    let wanted = settings.population.unwrap_or(if objectives == 1 { usual } else { count });
    if wanted > MOST_MEMBERS {
        return Err(MoeaError::TooManyMembers { wanted, most: MOST_MEMBERS });
    }
    let (directions, count) = match settings.algorithm {
        // One member per direction, of which a single objective has but one.
        Algorithm::Moead { .. } if objectives == 1 => (vec![1.0; wanted.max(4)], wanted.max(4)),
        _ => (directions, count),
    };
    let rounded = |members: usize| members.max(4).next_multiple_of(4);
    let members = match settings.algorithm {
        Algorithm::Moead { .. } => count,
        _ if has_directions => rounded(wanted.max(count)),
        _ => rounded(wanted),
    };
    Ok(Checked { space, objectives, directions, members, mutation_rate })
}
