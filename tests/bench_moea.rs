//! `bench moea`: what it finds, and the built binary as an operator meets it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::float_cmp)]

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use hydrotrace::{
    math::quantile,
    moea::{
        Budget, Contender, Operators, Population, Settings, benchmark::Benchmark, compare::Yardstick,
        indicator::hypervolume, optimise, silent,
    },
    render::{curve_svg, curves_csv, front_csv, kit::text, moea_document, moea_json},
    workflow::moea::{Inputs, Study, run},
};

fn inputs() -> Inputs {
    Inputs {
        problems: ["DTLZ2", "WFG3"].map(|name| Benchmark::named(name, 3).unwrap()).to_vec(),
        contenders: ["nsga3-fo", "nsga3", "moead"].map(|name| Contender::named(name).unwrap()).to_vec(),
        evaluations: vec![1000, 300],
        first_seed: 5,
        seeds: 3,
        operators: Operators::PLATEMO,
        steps: 4,
        fronts: true,
    }
}

#[test]
fn a_cell_holds_what_its_seeds_reach() {
    let study = run(&inputs(), || ()).unwrap();
    let order: Vec<_> = study.cells.iter().map(|c| (&*c.problem, c.evaluations, c.algorithm)).collect();
    assert_eq!((order.len(), order[0], order[4]), (12, ("DTLZ2", 300, "nsga3-fo"), ("DTLZ2", 1000, "nsga3")));
    let cell = &study.cells[4];
    let problem = Benchmark::named("DTLZ2", 3).unwrap();
    let yardstick = Yardstick::of(&problem, 1000);
    let reached = [5, 6, 7].map(|seed| {
        let settings = Settings {
            algorithm: Contender::named("NSGA3").unwrap().algorithm,
            seed,
            budget: Budget::Evaluations(1000),
            operators: Operators::PLATEMO,
            ..Settings::default()
        };
        yardstick.measure(&optimise(&problem, &settings, silent).unwrap().population).igd
    });
    assert_eq!(cell.igd.median, quantile(reached.to_vec(), 0.5));
    assert_eq!(cell.igd.q3, quantile(reached.to_vec(), 0.75));
    assert_eq!((cell.seeds, cell.members), (3, 92));
}

#[test]
fn a_curve_runs_from_the_first_population_to_the_end_of_the_largest_budget() {
    let study = run(&inputs(), || ()).unwrap();
    assert_eq!(study.curves.len(), 6);
    for curve in &study.curves {
        let at: Vec<u64> = curve.points.iter().map(|point| point.evaluations).collect();
        assert_eq!((at.len(), at[4]), (5, 1000), "{at:?}");
        assert!(at[0] < 100 && at.windows(2).all(|w| w[0] < w[1]), "{at:?}");
        let cell = study.cells.iter().find(|cell| {
            (&cell.problem, cell.algorithm, cell.evaluations) == (&curve.problem, curve.contender.name, 1000)
        });
        let cell = cell.unwrap();
        assert_eq!(curve.points[4].igd, [cell.igd.q1, cell.igd.median, cell.igd.q3]);
    }
}

#[test]
fn a_front_has_the_hypervolume_of_its_run() {
    let inputs = Inputs { seeds: 1, ..inputs() };
    let study = run(&inputs, || ()).unwrap();
    assert_eq!(study.fronts.len(), study.cells.len());
    for (front, cell) in study.fronts.iter().zip(&study.cells) {
        assert_eq!((&front.problem, front.algorithm), (&cell.problem, cell.algorithm));
        let reference = &study.rulers.iter().find(|ruler| ruler.problem == front.problem).unwrap();
        let volume = hypervolume(&front.points, &reference.reference_point)
            / reference.reference_point.iter().product::<f64>();
        assert!((volume - cell.hypervolume.median).abs() < 1e-12, "{volume} {:?}", cell.hypervolume);
        let population = Population::from_objectives(&front.points, 3);
        assert_eq!(population.front().len(), population.len());
    }
}

fn rendered(inputs: &Inputs, study: &Study) -> Vec<String> {
    let mut all =
        vec![text(&moea_document(inputs, study)), moea_json(inputs, study), curves_csv(&study.curves)];
    all.push(curve_svg(&study.curves[..3]).unwrap());
    all.extend(study.fronts.iter().map(front_csv));
    all
}

#[test]
fn findings_are_the_same_bytes_for_any_number_of_threads() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        rendered(&inputs(), &pool.install(|| run(&inputs(), || ())).unwrap())
    };
    let one = with(1);
    for threads in [2, 5] {
        assert!(with(threads) == one, "{threads} threads differ");
    }
}

fn bench(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hydrotrace")).args(["bench", "moea"]).args(args).output().unwrap()
}

const QUICK: [&str; 4] = ["--evaluations", "200,400", "--seeds", "2"];

fn stdout(run: &Output) -> String {
    String::from_utf8(run.stdout.clone()).unwrap()
}

#[test]
fn a_name_that_is_unknown_is_bad_usage_and_brings_the_list_and_a_suggestion() {
    for (args, meant, other) in [
        (["--problem", "DTLZ9"], "DTLZ", "WFG9"),
        (["--problem", "WGF3"], "'WFG3'", "DTLZ1"),
        (["--algorithm", "nsga3-of"], "'nsga3-fo'", "msops2"),
    ] {
        let run = bench(&args);
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), run.stdout.len()), (Some(2), 0), "{said}");
        let tip = said.lines().find(|line| line.contains("tip:")).unwrap_or_default();
        assert!(tip.contains(meant) && said.contains(other), "{said}");
    }
    for args in [["--seeds", "0"], ["--evaluations", "0"], ["--objectives", "1"]] {
        assert_eq!(bench(&args).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn json_holds_what_the_table_holds() {
    let args = [&QUICK[..], &["--problem", "dtlz3", "--operators", "platemo"]].concat();
    let run = bench(&[&args[..], &["--json"]].concat());
    assert_eq!((run.status.code(), run.stderr.len()), (Some(0), 0));
    let document: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert_eq!(document["format"], "hydrotrace.moea.v1");
    let cells = document["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 8);
    assert_eq!(cells[0]["algorithm"], "nsga3-fo");
    assert!(cells[0]["igd"]["against"]["p"].is_f64() && cells[1]["igd"]["against"].is_null());
    assert_eq!(cells[1]["table_1"]["mean"], 343.9);
    let table = stdout(&bench(&args));
    for cell in cells {
        let median = format!("{:.1}", cell["igd"]["median"].as_f64().unwrap());
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
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(said.starts_with("error: cannot create the folder "), "{said}");
}
