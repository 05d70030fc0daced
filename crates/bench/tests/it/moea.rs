//! `moea`: what it finds, and the built binary as its user meets it.

use std::{fs, path::Path};

use hydrotrace::{math::quantile, render::kit::text};
use hydrotrace_bench::{
    problems::{self, FORM, FRONT_POINTS, KnownFront},
    study::{Inputs, Study, curve_svg, curves_csv, document, front_csv, run},
};
use moea::{
    Budget, NamedAlgorithm, Operators, Population, Settings, benchmark::Benchmark, compare::Reference,
    indicator::hypervolume, optimise, silent,
};

use super::{bench, is_the_same_on_any_number_of_threads, shared, stderr, stdout};

fn inputs() -> Inputs<KnownFront> {
    let problems = ["DTLZ2", "WFG3"].map(|name| Benchmark::named(name, 3).unwrap());
    problems::inputs(&problems, Operators::PLATEMO, shared(&["nsga3-fo", "nsga3", "moead"], &[1000, 300]))
}

#[test]
fn a_cell_holds_what_its_seeds_reach() {
    let study = run(&inputs(), || ()).unwrap();
    let order: Vec<_> = study.cells.iter().map(|c| (&*c.subject, c.evaluations, &*c.algorithm)).collect();
    assert_eq!((order.len(), order[0], order[4]), (12, ("DTLZ2", 300, "nsga3-fo"), ("DTLZ2", 1000, "nsga3")));
    let cell = &study.cells[4];
    let problem = Benchmark::named("DTLZ2", 3).unwrap();
    let reference = Reference::of(&problem, FRONT_POINTS);
    let reached = [5, 6, 7].map(|seed| {
        let settings = Settings {
            algorithm: NamedAlgorithm::find("NSGA3").unwrap().algorithm,
            seed,
            budget: Budget::Evaluations(1000),
            operators: Operators::PLATEMO,
            ..Settings::default()
        };
        reference.measure(&optimise(&problem, &settings, silent).unwrap().population).igd
    });
    assert_eq!(cell.samples["igd"].median, quantile(reached.to_vec(), 0.5));
    assert_eq!(cell.samples["igd"].q3, quantile(reached.to_vec(), 0.75));
    assert_eq!((cell.seeds, cell.members), (3, 92));
}

#[test]
fn a_curve_runs_from_the_first_population_to_the_end_of_the_largest_budget() {
    let study = run(&inputs(), || ()).unwrap();
    assert_eq!(study.curves.len(), 6);
    for curve in &study.curves {
        let at: Vec<u64> = curve.points.iter().map(|point| point.0).collect();
        assert_eq!((at.len(), at[4]), (5, 1000), "{at:?}");
        assert!(at[0] < 100 && at.windows(2).all(|w| w[0] < w[1]), "{at:?}");
        let cell = study.cells.iter().find(|cell| {
            (&*cell.subject, &*cell.algorithm, cell.evaluations)
                == (&*curve.subject, curve.entrant.name, 1000)
        });
        let igd = cell.unwrap().samples["igd"];
        assert_eq!(curve.points[4].1[0], [igd.q1, igd.median, igd.q3]);
    }
}

#[test]
fn a_front_has_the_hypervolume_of_its_run() {
    let inputs = Inputs { seeds: 1, ..inputs() };
    let study = run(&inputs, || ()).unwrap();
    assert_eq!(study.fronts.len(), study.cells.len());
    for (front, cell) in study.fronts.iter().zip(&study.cells) {
        assert_eq!(
            front.name,
            format!("{}-{}-{}-5", cell.subject.to_lowercase(), cell.algorithm, cell.evaluations)
        );
        let reference = study.references.iter().find(|facts| facts.subject == cell.subject).unwrap();
        let volume = hypervolume(&front.points, &reference.reference_point)
            / reference.reference_point.iter().product::<f64>();
        assert!((volume - cell.samples["hypervolume"].median).abs() < 1e-12, "{volume} {cell:?}");
        let population = Population::from_objectives(&front.points, 3);
        assert_eq!(population.front().len(), population.len());
    }
}

#[test]
fn findings_are_the_same_bytes_for_any_number_of_threads() {
    is_the_same_on_any_number_of_threads(|| {
        let study = run(&inputs(), || ()).unwrap();
        let mut all = vec![text(&document(&FORM, &study)), study.json(), curves_csv(&FORM, &study.curves)];
        all.push(curve_svg(&FORM, &study.curves[..3]));
        all.extend(study.fronts.iter().map(front_csv));
        all
    });
}

#[test]
fn the_document_is_read_back() {
    let written = run(&Inputs { seeds: 1, ..inputs() }, || ()).unwrap().json();
    let read: Study = serde_json::from_str(&written).unwrap();
    assert_eq!(read.json(), written);
}

const QUICK: [&str; 5] = ["moea", "--evaluations", "200,400", "--seeds", "2"];

#[test]
fn a_name_that_is_unknown_is_bad_usage_and_brings_the_list_and_a_suggestion() {
    for (args, meant, other) in [
        (["--problem", "DTLZ9"], "DTLZ", "WFG9"),
        (["--problem", "WGF3"], "'WFG3'", "DTLZ1"),
        (["--algorithm", "nsga3-of"], "'nsga3-fo'", "msops2"),
    ] {
        let run = bench(&[&["moea"], &args[..]].concat());
        let said = stderr(&run);
        assert_eq!((run.status.code(), run.stdout.len()), (Some(2), 0), "{said}");
        let tip = said.lines().find(|line| line.contains("tip:")).unwrap_or_default();
        assert!(tip.contains(meant) && said.contains(other), "{said}");
    }
    for args in [["--seeds", "0"], ["--evaluations", "0"], ["--objectives", "1"]] {
        assert_eq!(bench(&[&["moea"], &args[..]].concat()).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn json_holds_what_the_table_holds() {
    let args = [&QUICK[..], &["--problem", "dtlz3", "--operators", "platemo"]].concat();
    let run = bench(&[&args[..], &["--json"]].concat());
    assert_eq!((run.status.code(), run.stderr.len()), (Some(0), 0));
    let document: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert_eq!(document["format"], "hydrotrace.study.v1");
    let cells = document["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 8);
    assert_eq!(cells[0]["algorithm"], "nsga3-fo");
    assert!(
        cells[0]["samples"]["igd"]["against"]["p"].is_f64()
            && cells[1]["samples"]["igd"]["against"].is_null()
    );
    assert_eq!(cells[1]["published"][0]["table1"]["mean"], 343.9);
    let table = stdout(&bench(&args));
    for cell in cells {
        let median = format!("{:.1}", cell["samples"]["igd"]["median"].as_f64().unwrap());
        let row = ["DTLZ3", cell["algorithm"].as_str().unwrap(), &cell["evaluations"].to_string(), &median];
        let shown = table.lines().any(|line| line.split_whitespace().take(4).eq(row));
        assert!(shown, "{row:?} is not in\n{table}");
    }
    assert!(table.contains("Fewer than 10 seeds"), "{table}");
}

fn rows(path: &Path) -> usize {
    fs::read_to_string(path).unwrap().lines().count() - 1
}

#[test]
fn fronts_and_curves_are_files_of_the_promised_names() {
    let folder = tempfile::tempdir().unwrap();
    let (fronts, curves) = (folder.path().join("a/fronts"), folder.path().join("curves"));
    let to = ["--front", fronts.to_str().unwrap(), "--curves", curves.to_str().unwrap()];
    let run = bench(&[&QUICK[..], &["--algorithm", "nsga3,nsga2", "--objectives", "2"], &to].concat());
    assert_eq!(run.status.code(), Some(0));
    assert_eq!(fs::read_dir(&fronts).unwrap().count(), 2 * 2 * 2 * 2);
    let front = fs::read_to_string(fronts.join("wfg3-nsga2-400-2.csv")).unwrap();
    assert!(front.starts_with("f1,f2\n") && front.lines().count() > 5, "{front}");
    let mut names: Vec<_> =
        fs::read_dir(&curves).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["curves.csv", "dtlz3.svg", "wfg3.svg"]);
    // 100 members and 400 evaluations: the first population and three generations.
    assert!(rows(&curves.join("curves.csv")) >= 2 * 2 * 4);
}

#[test]
fn a_folder_that_cannot_be_made_is_said_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let run = bench(&[&QUICK[..], &["--front", file.to_str().unwrap()]].concat());
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
    let said = stderr(&run);
    assert!(said.starts_with("error: cannot create the folder "), "{said}");
}
