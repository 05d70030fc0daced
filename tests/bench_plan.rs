//! `bench plan`: what it finds, and the built binary as an operator meets it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::float_cmp)]

use std::{
    fs,
    ops::ControlFlow,
    process::{Command, Output},
    sync::LazyLock,
};

use hydrotrace::{
    math::quantile,
    moea::{Budget, Contender, Settings, optimise, silent},
    plan::{Reference, Search, TimingProblem, search},
    render::{contest_csv, contest_document, contest_json, contest_svg, kit::text},
    task::Objective,
    workflow::contest::{Inputs, REFERENCE_PLANS, Row, Study, Subject, Whose, run},
};

const REFERENCE: u64 = 2000;

fn three(values: &[f64]) -> [f64; 3] {
    values.try_into().unwrap()
}

fn inputs() -> Inputs {
    Inputs {
        subjects: ["simulation", "TASK-1"].map(|name| Subject::find(name).unwrap()).to_vec(),
        contenders: ["nsga3", "nsga2"].map(|name| Contender::named(name).unwrap()).to_vec(),
        evaluations: vec![600, 200],
        first_seed: 5,
        seeds: 3,
        reference_evaluations: REFERENCE,
        steps: 4,
    }
}

static STUDY: LazyLock<Study> = LazyLock::new(|| run(&inputs(), || ()).unwrap());

#[test]
fn a_cell_holds_what_its_seeds_reach_in_the_box_of_the_reference_front() {
    let order: Vec<_> = STUDY.cells.iter().map(|c| (&*c.task, c.evaluations, c.algorithm)).collect();
    assert_eq!((order.len(), order[2]), (12, ("simulation", 200, "seeded")));
    assert_eq!(order[9], ("task-1", 600, "nsga3"));
    let setup = &inputs().subjects[1].request.setup;
    let long = Search { budget: Budget::Evaluations(REFERENCE), front: REFERENCE_PLANS, ..Search::default() };
    let front = search(setup, &long, |_| ControlFlow::Continue(())).unwrap().front;
    let reference = Reference::of(front.iter().map(|timing| timing.objectives.plan()));
    let ruler = &STUDY.rulers[1];
    assert_eq!((ruler.plans, ruler.ideal), (front.len(), three(reference.ideal().plan())));
    let reached = [5, 6, 7].map(|seed| {
        let algorithm = Contender::named("nsga3").unwrap().algorithm;
        let settings = Settings { algorithm, seed, budget: Budget::Evaluations(600), ..Settings::default() };
        let last = optimise(&TimingProblem::of(setup), &settings, silent).unwrap().population;
        let kept = last.front().into_iter().filter(|&i| last.is_feasible(i));
        reference.measure(kept.map(|i| last.f(i)))
    });
    let cell = &STUDY.cells[9];
    let medians = [0.25, 0.5, 0.75].map(|p| quantile(reached.to_vec(), p));
    let found = [cell.hypervolume.q1, cell.hypervolume.median, cell.hypervolume.q3];
    assert!(medians.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-12), "{medians:?} {found:?}");
    assert_eq!((cell.seeds, cell.feasible, cell.made), (3, 3, 600));
}

#[test]
fn all_that_a_run_found_is_worth_no_less_than_its_last_population() {
    for cell in STUDY.cells.iter().filter(|cell| cell.algorithm != "seeded") {
        assert!(cell.of_all.median >= cell.hypervolume.median - 1e-12, "{cell:?}");
    }
}

#[test]
fn at_equal_budgets_the_seeded_search_beats_random_starts_by_far() {
    for pair in STUDY.cells.chunks_exact(3).filter(|cells| cells[0].evaluations == 600) {
        let [nsga3, _, seeded] = pair else { panic!("three algorithms") };
        let missing = |cell: &hydrotrace::workflow::contest::Cell| 1.0 - cell.share;
        assert!(missing(seeded) < 0.5 * missing(nsga3), "{} {}", missing(seeded), missing(nsga3));
        assert!(seeded.fastest_s.median < nsga3.fastest_s.median);
        assert!(seeded.smoothest_rad_s3.median < nsga3.smoothest_rad_s3.median);
    }
}

#[test]
fn a_curve_runs_from_the_first_population_to_what_the_cell_holds() {
    assert_eq!(STUDY.curves.len(), 6);
    for curve in STUDY.curves.iter().filter(|curve| !curve.entrant.seeded) {
        let last = curve.points.last().unwrap();
        let cell = STUDY.cells.iter().find(|cell| {
            (&cell.task, cell.algorithm, cell.evaluations) == (&curve.task, curve.entrant.name, 600)
        });
        let sample = cell.unwrap().hypervolume;
        assert_eq!((curve.points[0].evaluations, last.evaluations), (92, 600));
        assert_eq!(last.hypervolume, [sample.q1, sample.median, sample.q3]);
    }
}

fn row(whose: Whose) -> &'static Row {
    STUDY.table_3.as_ref().unwrap().rows.iter().find(|row| row.whose == whose).unwrap()
}

#[test]
fn the_papers_plans_have_their_known_worth_and_ours_are_no_worse_in_anything() {
    for (plan, f2_deg_s3, f3_w, broken) in
        [("A", 61.6945, 306.67, false), ("B", 6.815_17, 155.81, false), ("C", 35.8176, 358.99, true)]
    {
        let theirs = row(Whose::Paper(plan)).evaluation.as_ref().unwrap();
        let f = theirs.objectives.plan();
        assert!((f[1].to_degrees() / f2_deg_s3 - 1.0).abs() < 1e-5, "{plan} {f:?}");
        assert!((f[2] / f3_w - 1.0).abs() < 1e-4, "{plan} {f:?}");
        assert_eq!(!theirs.broken().is_empty(), broken, "{plan}");
        let ours = row(Whose::Better(plan)).evaluation.as_ref().unwrap();
        assert!(ours.broken().is_empty());
        let better = ours.objectives.plan();
        assert!(better.iter().zip(f).all(|(ours, theirs)| ours <= theirs), "{plan} {better:?} {f:?}");
        let (smooth, thrifty) = (row(Whose::Smoothest(plan)), row(Whose::Thriftiest(plan)));
        let of = |row: &Row| row.evaluation.as_ref().unwrap().objectives.plan().to_vec();
        assert!(of(smooth)[1] <= better[1] && of(thrifty)[2] <= better[2], "{plan}");
    }
    let stretched = row(Whose::Stretched);
    let duration_s = stretched.evaluation.as_ref().unwrap().objectives[Objective::Duration];
    assert!((duration_s - 18.94).abs() < 1e-9);
    // By the paper's own f2, less than half of its B.
    assert!(stretched.printed.unwrap().f2 < 0.5 * row(Whose::Paper("B")).printed.unwrap().f2);
}

fn rendered(inputs: &Inputs, study: &Study) -> Vec<String> {
    let mut all =
        vec![text(&contest_document(inputs, study)), contest_json(inputs, study), contest_csv(&study.curves)];
    all.extend(study.curves.chunk_by(|a, b| a.task == b.task).map(|same| contest_svg(same).unwrap()));
    all
}

#[test]
fn findings_are_the_same_bytes_for_any_number_of_threads() {
    let inputs = Inputs { seeds: 2, evaluations: vec![200], ..inputs() };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        rendered(&inputs, &pool.install(|| run(&inputs, || ())).unwrap())
    };
    assert!(with(1) == with(4), "threads differ");
}

#[test]
fn the_picture_has_a_name_for_every_search() {
    let svg = contest_svg(&STUDY.curves[..3]).unwrap();
    for curve in &STUDY.curves[..3] {
        assert!(svg.contains(curve.entrant.title) && !svg.contains("NaN"), "{svg}");
    }
    assert!(svg.contains("simulation"), "{svg}");
}

fn bench(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hydrotrace")).args(["bench", "plan"]).args(args).output().unwrap()
}

const QUICK: [&str; 8] =
    ["--reference", "1000", "--evaluations", "200", "--seeds", "2", "--algorithm", "nsga3,nsga2"];

fn stdout(run: &Output) -> String {
    String::from_utf8(run.stdout.clone()).unwrap()
}

#[test]
fn what_is_no_algorithm_is_bad_usage_and_what_is_no_task_is_told_the_tasks() {
    let run = bench(&["--algorithm", "nsga3-of"]);
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!((run.status.code(), run.stdout.len()), (Some(2), 0), "{said}");
    assert!(said.contains("'nsga3-fo'"), "{said}");
    let run = bench(&["--task", "task-9"]);
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0), "{said}");
    assert!(said.contains("task-9") && said.contains("simulation, task-1, task-2"), "{said}");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("task.toml");
    fs::write(&file, "title = 3").unwrap();
    let run = bench(&["--task", file.to_str().unwrap()]);
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
    for args in [["--seeds", "0"], ["--evaluations", "0"], ["--reference", "x"]] {
        assert_eq!(bench(&args).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn json_holds_what_the_table_holds_also_of_a_file() {
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/sample-logs/tasks/task-2.toml");
    let args = [&QUICK[..], &["--task", own]].concat();
    let run = bench(&[&args[..], &["--json"]].concat());
    assert_eq!((run.status.code(), run.stderr.len()), (Some(0), 0));
    let document: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert_eq!(document["format"], "hydrotrace.bench-plan.v1");
    assert_eq!(document["table_3"].as_array().unwrap().len(), 0);
    let cells = document["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 3);
    let table = stdout(&bench(&args));
    for cell in cells {
        let median = format!("{:.4}", cell["hypervolume"]["median"].as_f64().unwrap());
        let name = cell["algorithm"].as_str().unwrap();
        let shown =
            table.lines().any(|line| line.starts_with(&format!("task-2  {name}")) && line.contains(&median));
        assert!(shown, "{name} {median} is not in\n{table}");
    }
    assert!(table.contains("Fewer than 10 seeds"), "{table}");
}

#[test]
fn curves_are_files_of_the_promised_names() {
    let folder = tempfile::tempdir().unwrap();
    let curves = folder.path().join("a/curves");
    let to = ["--task", "simulation", "--curves", curves.to_str().unwrap()];
    let run = bench(&[&QUICK[..], &to].concat());
    assert_eq!(run.status.code(), Some(0));
    assert!(stdout(&run).contains("PAPER'S TABLE 3"));
    let mut names: Vec<_> =
        fs::read_dir(&curves).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["curves.csv", "simulation.svg"]);
    let csv = fs::read_to_string(curves.join("curves.csv")).unwrap();
    assert!(csv.starts_with("task,algorithm,seeds,evaluations,hypervolume_q1,"), "{csv}");
    assert!(csv.contains("\nsimulation,nsga2,2,200,"), "{csv}");
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let run = bench(&[&QUICK[..], &["--curves", file.to_str().unwrap()]].concat());
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
}
