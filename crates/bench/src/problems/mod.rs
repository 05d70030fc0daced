//! `moea`: what the algorithms reach on problems with known fronts.

mod paper;
mod published;

use std::{collections::BTreeMap, ops::ControlFlow};

use hydrotrace::render::kit::significant;
use moea::{
    Budget, MoeaError, Operators, Population, Problem, Settings, benchmark::Benchmark, compare::Reference,
    optimise,
};
use rayon::prelude::*;

use crate::study::{
    Column, Entrant, Form, Inputs, Measure, Panel, Published, ReferenceFacts, Run, Subject, Watch, decimals,
};

/// Points of the true front that are asked for; a problem gives about as many.
pub const FRONT_POINTS: usize = 1000;

const fn measure(
    key: &'static str,
    heading: &'static str,
    less: bool,
    show: fn(f64, u8) -> String,
) -> Measure {
    Measure { key, heading, less, show, column: Column::Compared, tally: heading }
}

/// The study.
pub const FORM: Form = Form {
    name: "moea",
    title: "Evolutionary algorithms on problems with known fronts",
    subject: "problem",
    measures: &[
        measure("igd", "IGD", true, significant),
        measure("igd_plus", "IGD+", true, significant),
        measure("hypervolume", "HV", false, decimals),
    ],
    heading: "Medians (quartiles), and against the baseline",
    reference: (&["problem", "HV reference point"], &["objectives", "variables", "front points"], |facts| {
        let point: Vec<String> = facts.reference_point.iter().map(|&f| significant(f, 3)).collect();
        vec![
            facts.subject.clone(),
            format!("({})", point.join(", ")),
            facts.objectives.to_string(),
            facts.variables.to_string(),
            facts.members.to_string(),
        ]
    }),
    paper: paper::sections,
    panels: [
        Panel {
            heading: "hypervolume (more is better)",
            logarithmic: false,
            measure: 2,
            drawn: |value| value,
        },
        Panel {
            heading: "IGD, logarithmic scale (less is better)",
            logarithmic: true,
            measure: 0,
            drawn: |value| value,
        },
    ],
};

/// A problem with a known front.
#[derive(Debug, Clone)]
pub struct KnownFront {
    problem: Benchmark,
    operators: Operators,
    reference: Reference,
    facts: ReferenceFacts,
}

impl KnownFront {
    /// Computes the front.
    pub fn new(problem: Benchmark, operators: Operators) -> Self {
        let reference = Reference::of(&problem, FRONT_POINTS);
        let facts = ReferenceFacts {
            subject: problem.name(),
            objectives: problem.objectives(),
            variables: problem.bounds().len(),
            members: reference.points(),
            ideal: vec![0.0; problem.objectives()],
            reference_point: reference.reference_point(),
            searched: None,
        };
        Self { problem, operators, reference, facts }
    }

    fn values(&self, population: &Population) -> Vec<f64> {
        let quality = self.reference.measure(population);
        vec![quality.igd, quality.igd_plus, quality.hypervolume]
    }
}

/// Problems, settings and notes of the study; budgets, seeds and algorithms are the caller's.
pub fn inputs(problems: &[Benchmark], operators: Operators, study: Inputs<()>) -> Inputs<KnownFront> {
    let settings = [
        ("crossover_rate", operators.crossover_rate),
        ("crossover_eta", operators.crossover_eta),
        ("mutation_eta", operators.mutation_eta),
    ];
    let notes = vec![
        format!(
            "Simulated binary crossover with rate {} and eta {}, polynomial mutation with eta {}.",
            operators.crossover_rate, operators.crossover_eta, operators.mutation_eta
        ),
        "Less IGD and IGD+ is better, more hypervolume (HV) is better; HV is a share of the box from 0 to the \
         reference point, which is 1.1 times the front's largest objectives."
            .to_owned(),
    ];
    study.of(
        problems.par_iter().map(|&problem| KnownFront::new(problem, operators)).collect(),
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect::<BTreeMap<_, _>>(),
        notes,
    )
}

impl Subject for KnownFront {
    type Failure = MoeaError;

    const FORM: Form = FORM;

    fn reference(&self) -> &ReferenceFacts {
        &self.facts
    }

    fn run(
        &self,
        entrant: &Entrant,
        evaluations: u64,
        seed: u64,
        mut watch: Watch,
    ) -> Result<Run, MoeaError> {
        let settings = Settings {
            algorithm: entrant.algorithm,
            seed,
            budget: Budget::Evaluations(evaluations),
            operators: self.operators,
            ..Settings::default()
        };
        let mut course = Vec::new();
        let outcome = optimise(&self.problem, &settings, |progress| {
            if watch.is_due(progress.evaluations) {
                course.push((progress.evaluations, self.values(progress.population)));
            }
            ControlFlow::Continue(())
        })?;
        let population = &outcome.population;
        Ok(Run {
            values: self.values(population),
            members: population.len(),
            made: outcome.evaluations,
            course,
            front: population.front().into_iter().flat_map(|i| population.f(i).iter().copied()).collect(),
        })
    }

    fn published(&self, algorithm: &str, evaluations: u64) -> Vec<Published> {
        let name = &self.facts.subject;
        if self.facts.objectives != 3 {
            return Vec::new();
        }
        let figure_3 = published::figure_3(name, algorithm, evaluations);
        // The paper's Figure 3 fits the defaults of PlatEMO.
        let figure_3 = figure_3.filter(|_| self.operators == Operators::PLATEMO);
        published::table_1(name, algorithm).into_iter().chain(figure_3).collect()
    }
}
