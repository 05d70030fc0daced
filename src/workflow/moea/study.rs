//! Turns runs into findings.

use super::{
    BASELINE, Cell, Curve, Front, Inputs, Point, Ruler, Sample, Study, Tally,
    published::{figure_3, table_1},
    run::Run,
};
use crate::{
    moea::{
        Contender, Operators, Problem,
        benchmark::Benchmark,
        compare::{Quality, Yardstick},
    },
    workflow::sample::{quartiles, tallied},
};

/// The runs of one cell.
#[derive(Debug)]
pub(super) struct Batch<'a> {
    pub(super) problem: &'a Benchmark,
    pub(super) yardstick: &'a Yardstick,
    pub(super) contender: Contender,
    pub(super) evaluations: u64,
    /// Whether the runs give a curve.
    pub(super) watched: bool,
    pub(super) runs: Vec<Run>,
}

/// An indicator, and whether less of it is better.
#[derive(Clone, Copy)]
struct Indicator(fn(&Quality) -> f64, bool);

const IGD: Indicator = Indicator(|quality| quality.igd, true);
const IGD_PLUS: Indicator = Indicator(|quality| quality.igd_plus, true);
const HYPERVOLUME: Indicator = Indicator(|quality| quality.hypervolume, false);

pub(super) fn assemble(inputs: &Inputs, yardsticks: &[Yardstick], batches: &[Batch<'_>]) -> Study {
    let cells: Vec<Cell> = batches
        .iter()
        .map(|batch| {
            let rival = batches.iter().find(|other| {
                other.contender.name == BASELINE
                    && other.problem == batch.problem
                    && other.evaluations == batch.evaluations
            });
            cell(batch, rival.filter(|_| batch.contender.name != BASELINE), inputs.operators)
        })
        .collect();
    Study {
        rulers: inputs.problems.iter().zip(yardsticks).map(|(p, y)| ruler(p, y)).collect(),
        tallies: inputs.contenders.iter().filter_map(|contender| tally(contender.name, &cells)).collect(),
        cells,
        curves: batches.iter().filter(|batch| batch.watched && inputs.steps > 0).map(curve).collect(),
        fronts: batches.iter().filter(|_| inputs.fronts).flat_map(fronts).collect(),
    }
}

fn ruler(problem: &Benchmark, yardstick: &Yardstick) -> Ruler {
    Ruler {
        problem: problem.name(),
        objectives: problem.objectives(),
        variables: problem.bounds().len(),
        front_points: yardstick.points(),
        reference_point: yardstick.reference(),
    }
}

fn cell(batch: &Batch<'_>, rival: Option<&Batch<'_>>, operators: Operators) -> Cell {
    let problem = batch.problem.name();
    let name = batch.contender.name;
    let objectives = batch.problem.objectives();
    let as_there = objectives == 3 && operators == Operators::PLATEMO;
    Cell {
        objectives,
        evaluations: batch.evaluations,
        algorithm: name,
        members: batch.runs.iter().map(|run| run.members).max().unwrap_or(0),
        seeds: batch.runs.len() as u64,
        igd: sample(batch, rival, IGD),
        igd_plus: sample(batch, rival, IGD_PLUS),
        hypervolume: sample(batch, rival, HYPERVOLUME),
        table_1: table_1(&problem, name).filter(|_| objectives == 3),
        figure_3: figure_3(&problem, name, batch.evaluations).filter(|_| as_there),
        problem,
    }
}

fn sample(batch: &Batch<'_>, rival: Option<&Batch<'_>>, Indicator(get, less): Indicator) -> Sample {
    let values = |batch: &Batch<'_>| batch.runs.iter().map(|run| get(&run.quality)).collect::<Vec<_>>();
    Sample::of(&values(batch), rival.map(values).as_deref(), less)
}

fn tally(algorithm: &'static str, cells: &[Cell]) -> Option<Tally> {
    let count =
        |get: fn(&Cell) -> &Sample| tallied(cells.iter().filter(|cell| cell.algorithm == algorithm).map(get));
    let tally = Tally {
        algorithm,
        igd: count(|c| &c.igd),
        igd_plus: count(|c| &c.igd_plus),
        hypervolume: count(|c| &c.hypervolume),
    };
    (tally.igd != [0; 3]).then_some(tally)
}

fn curve(batch: &Batch<'_>) -> Curve {
    let steps = batch.runs.iter().map(|run| run.course.len()).min().unwrap_or(0);
    let point = |step: usize| {
        let at = || batch.runs.iter().map(move |run| &run.course[step]);
        let of = |get: fn(&Quality) -> f64| quartiles(&at().map(|(_, q)| get(q)).collect::<Vec<_>>());
        Point {
            evaluations: at().map(|(evaluations, _)| *evaluations).max().unwrap_or(0),
            igd: of(IGD.0),
            igd_plus: of(IGD_PLUS.0),
            hypervolume: of(HYPERVOLUME.0),
        }
    };
    Curve {
        problem: batch.problem.name(),
        objectives: batch.problem.objectives(),
        contender: batch.contender,
        seeds: batch.runs.len() as u64,
        points: (0..steps).map(point).collect(),
    }
}

fn fronts<'a>(batch: &'a Batch<'_>) -> impl Iterator<Item = Front> + 'a {
    batch.runs.iter().map(|run| Front {
        problem: batch.problem.name(),
        algorithm: batch.contender.name,
        evaluations: batch.evaluations,
        seed: run.seed,
        objectives: batch.problem.objectives(),
        points: run.front.clone(),
    })
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::{super::Verdict, *};

    /// Runs whose distances are `level` and up, and whose volumes fall with them.
    fn runs(level: f64) -> Vec<Run> {
        let quality = |k: u64| {
            let igd = level + 0.001 * k as f64;
            Quality { igd, igd_plus: igd, hypervolume: 1.0 - igd }
        };
        let run =
            |seed| Run { seed, quality: quality(seed), members: 4, course: Vec::new(), front: Vec::new() };
        (1..=11).map(run).collect()
    }

    #[test]
    fn less_distance_and_more_volume_win_and_the_baseline_is_compared_with_nothing() {
        let problem = Benchmark::named("DTLZ2", 3).unwrap();
        let yardstick = Yardstick::of(&problem, 10);
        let contender = |name| Contender::named(name).unwrap();
        let inputs = Inputs {
            problems: vec![problem],
            contenders: ["nsga3-fo", "nsga3", "nsga2"].map(contender).to_vec(),
            evaluations: vec![100],
            first_seed: 1,
            seeds: 11,
            operators: Operators::default(),
            steps: 0,
            fronts: false,
        };
        let levels = [0.1, 0.2, 0.3];
        let batches: Vec<Batch<'_>> = inputs
            .contenders
            .iter()
            .zip(levels)
            .map(|(&contender, level)| Batch {
                problem: &problem,
                yardstick: &yardstick,
                contender,
                evaluations: 100,
                watched: true,
                runs: runs(level),
            })
            .collect();
        let study = assemble(&inputs, std::slice::from_ref(&yardstick), &batches);
        for (cell, expected) in
            study.cells.iter().zip([Some((Verdict::Win, 1.0)), None, Some((Verdict::Loss, 0.0))])
        {
            for sample in [cell.igd, cell.igd_plus, cell.hypervolume] {
                assert_eq!(sample.against.map(|a| (a.verdict, a.a12)), expected, "{}", cell.algorithm);
            }
        }
        let igd = study.cells[0].igd;
        assert_eq!(igd.median, 0.1 + 0.001 * 6.0);
        // The variance of 1 to 11 is 11.
        assert!((igd.mean - igd.median).abs() < 1e-15 && (igd.sd - 0.001 * 11_f64.sqrt()).abs() < 1e-15);
        let tallies: Vec<_> = study.tallies.iter().map(|t| (t.algorithm, t.igd, t.hypervolume)).collect();
        assert_eq!(tallies, [("nsga3-fo", [1, 0, 0], [1, 0, 0]), ("nsga2", [0, 0, 1], [0, 0, 1])]);
    }
}
