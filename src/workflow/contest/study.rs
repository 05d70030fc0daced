//! Turns runs into findings.

use super::{
    BASELINE, Cell, Curve, Entrant, Point, Ruler, Sample, Study, Table3, Tally,
    run::{Batch, Run},
};
use crate::workflow::sample::{quartiles, tallied};

pub(super) fn assemble(
    rulers: Vec<Ruler>,
    entrants: &[Entrant],
    batches: &[Batch<'_>],
    table_3: Option<Table3>,
) -> Study {
    let cells: Vec<Cell> = batches
        .iter()
        .map(|batch| {
            let rival = batches.iter().find(|other| {
                other.entrant.name == BASELINE
                    && std::ptr::eq(other.ruler, batch.ruler)
                    && other.evaluations == batch.evaluations
            });
            cell(batch, rival.filter(|_| batch.entrant.name != BASELINE))
        })
        .collect();
    Study {
        rulers,
        tallies: entrants.iter().filter_map(|entrant| tally(entrant.name, &cells)).collect(),
        cells,
        table_3,
        curves: batches.iter().filter(|batch| batch.watched).map(curve).collect(),
    }
}

fn cell(batch: &Batch<'_>, rival: Option<&Batch<'_>>) -> Cell {
    let sample = |get: fn(&Run) -> f64, less| {
        let values = |batch: &Batch<'_>| batch.runs.iter().map(get).collect::<Vec<_>>();
        Sample::of(&values(batch), rival.map(values).as_deref(), less)
    };
    let of_all = sample(|run| run.hypervolume[1], false);
    Cell {
        task: batch.ruler.task.clone(),
        evaluations: batch.evaluations,
        algorithm: batch.entrant.name,
        made: batch.runs.iter().map(|run| run.made).max().unwrap_or(0),
        members: batch.runs.iter().map(|run| run.members).max().unwrap_or(0),
        seeds: batch.runs.len() as u64,
        feasible: batch.runs.iter().filter(|run| run.members > 0).count() as u64,
        hypervolume: sample(|run| run.hypervolume[0], false),
        of_all,
        share: of_all.median / batch.ruler.hypervolume,
        fastest_s: sample(|run| run.best[0], true),
        smoothest_rad_s3: sample(|run| run.best[1], true),
    }
}

fn tally(algorithm: &'static str, cells: &[Cell]) -> Option<Tally> {
    let count =
        |get: fn(&Cell) -> &Sample| tallied(cells.iter().filter(|cell| cell.algorithm == algorithm).map(get));
    let tally = Tally {
        algorithm,
        hypervolume: count(|cell| &cell.hypervolume),
        of_all: count(|cell| &cell.of_all),
        fastest: count(|cell| &cell.fastest_s),
        smoothest: count(|cell| &cell.smoothest_rad_s3),
    };
    (tally.hypervolume != [0; 3]).then_some(tally)
}

fn curve(batch: &Batch<'_>) -> Curve {
    let steps = batch.runs.iter().map(|run| run.course.len()).min().unwrap_or(0);
    let point = |step: usize| {
        let at = || batch.runs.iter().filter_map(move |run| run.course.get(step));
        let of = |k: usize| quartiles(&at().map(|(_, hypervolume)| hypervolume[k]).collect::<Vec<_>>());
        Point {
            evaluations: at().map(|(evaluations, _)| *evaluations).max().unwrap_or(0),
            hypervolume: of(0),
            of_all: of(1),
        }
    };
    Curve {
        task: batch.ruler.task.clone(),
        entrant: batch.entrant,
        seeds: batch.runs.len() as u64,
        reference: batch.ruler.hypervolume,
        points: (0..steps).map(point).collect(),
    }
}
