//! `plan`: what it finds, and the built binary as its user meets it.

use std::{fs, ops::ControlFlow, sync::LazyLock};

use hydrotrace::{
    math::quantile,
    plan::{Reference, Search, TimingProblem, search},
    render::kit::text,
};
use hydrotrace_bench::{
    study::{Cell, Inputs, PaperPlan, Study, curve_svg, curves_csv, document},
    tasks::{ArmTask, FORM, REFERENCE_PLANS, find, inputs, run},
};
use moea::{Budget, NamedAlgorithm, Settings, optimise, silent};

use super::{bench, is_the_same_on_any_number_of_threads, shared, stderr, stdout};

const REFERENCE: u64 = 2000;

fn study(seeds: u64, evaluations: &[u64]) -> Inputs<ArmTask> {
    let tasks = ["simulation", "TASK-1"].map(|name| find(name).unwrap()).to_vec();
    let shared = Inputs { seeds, ..shared(&["nsga3", "nsga2"], evaluations) };
    inputs(tasks, REFERENCE, shared, || ()).unwrap()
}

static STUDY: LazyLock<Study> = LazyLock::new(|| run(&study(3, &[600, 200]), || ()).unwrap());

#[test]
fn a_cell_holds_what_its_seeds_reach_in_the_box_of_the_reference_front() {
    let order: Vec<_> = STUDY.cells.iter().map(|c| (&*c.subject, c.evaluations, &*c.algorithm)).collect();
    assert_eq!((order.len(), order[2]), (12, ("simulation", 200, "seeded")));
    assert_eq!(order[9], ("task-1", 600, "nsga3"));
    let setup = &find("task-1").unwrap().1.setup;
    let long = Search { budget: Budget::Evaluations(REFERENCE), front: REFERENCE_PLANS, ..Search::default() };
    let front = search(setup, &long, |_| ControlFlow::Continue(())).unwrap().front;
    let reference = Reference::of(front.iter().map(|timing| timing.objectives.plan()));
    let facts = &STUDY.references[1];
    assert_eq!((facts.members, &facts.ideal[..]), (front.len(), reference.ideal().plan()));
    let reached = [5, 6, 7].map(|seed| {
        let algorithm = NamedAlgorithm::find("nsga3").unwrap().algorithm;
        let settings = Settings { algorithm, seed, budget: Budget::Evaluations(600), ..Settings::default() };
        let last = optimise(&TimingProblem::of(setup), &settings, silent).unwrap().population;
        let kept = last.front().into_iter().filter(|&i| last.is_feasible(i));
        reference.measure(kept.map(|i| last.f(i)))
    });
    let cell = &STUDY.cells[9];
    let medians = [0.25, 0.5, 0.75].map(|p| quantile(reached.to_vec(), p));
    let sample = cell.samples["hypervolume"];
    let found = [sample.q1, sample.median, sample.q3];
    assert!(medians.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-12), "{medians:?} {found:?}");
    assert_eq!((cell.seeds, cell.feasible, cell.made), (3, 3, 600));
}

fn median(cell: &Cell, key: &str) -> f64 {
    cell.samples[key].median
}

#[test]
fn all_that_a_run_found_is_worth_no_less_than_its_last_population() {
    for cell in STUDY.cells.iter().filter(|cell| cell.algorithm != "seeded") {
        assert!(median(cell, "of_all") >= median(cell, "hypervolume") - 1e-12, "{cell:?}");
    }
}

#[test]
fn at_equal_budgets_the_seeded_search_beats_random_starts_by_far() {
    for pair in STUDY.cells.chunks_exact(3).filter(|cells| cells[0].evaluations == 600) {
        let [nsga3, _, seeded] = pair else { panic!("three algorithms") };
        let missing = |cell: &Cell| 1.0 - median(cell, "share");
        assert!(missing(seeded) < 0.5 * missing(nsga3), "{} {}", missing(seeded), missing(nsga3));
        for key in ["fastest_s", "smoothest_rad_s3"] {
            assert!(median(seeded, key) < median(nsga3, key), "{key}");
        }
    }
}

#[test]
fn a_curve_runs_from_the_first_population_to_what_the_cell_holds() {
    assert_eq!(STUDY.curves.len(), 6);
    for curve in STUDY.curves.iter().filter(|curve| !curve.entrant.seeded) {
        let last = curve.points.last().unwrap();
        let cell = STUDY.cells.iter().find(|cell| {
            (&*cell.subject, &*cell.algorithm, cell.evaluations) == (&*curve.subject, curve.entrant.name, 600)
        });
        let sample = cell.unwrap().samples["hypervolume"];
        assert_eq!((curve.points[0].0, last.0), (92, 600));
        assert_eq!(last.1[0], [sample.q1, sample.median, sample.q3]);
    }
}

fn row(name: &str) -> &'static PaperPlan {
    STUDY.table_3.iter().find(|row| row.plan == name).unwrap()
}

fn objectives(plan: &PaperPlan) -> [f64; 3] {
    [plan.duration_s, plan.rms_jerk_rad_s3, plan.rms_power_w].map(Option::unwrap)
}

#[test]
fn the_papers_plans_have_their_known_worth_and_ours_are_no_worse_in_anything() {
    for (plan, f2_deg_s3, f3_w, broken) in
        [("A", 61.6945, 306.67, false), ("B", 6.815_17, 155.81, false), ("C", 35.8176, 358.99, true)]
    {
        let theirs = row(&format!("paper's {plan}"));
        let f = objectives(theirs);
        assert!((f[1].to_degrees() / f2_deg_s3 - 1.0).abs() < 1e-5, "{plan} {f:?}");
        assert!((f[2] / f3_w - 1.0).abs() < 1e-4, "{plan} {f:?}");
        assert_eq!(theirs.limits_broken != Some(0), broken, "{plan}");
        let ours = row(&format!("ours, no worse than {plan} in f1, f2, f3"));
        assert_eq!(ours.limits_broken, Some(0));
        let better = objectives(ours);
        assert!(better.iter().zip(f).all(|(ours, theirs)| *ours <= theirs), "{plan} {better:?} {f:?}");
        let [smooth, thrifty] = [2, 3].map(|k| row(&format!("ours, as fast as {plan}: least f{k}")));
        assert!(objectives(smooth)[1] <= better[1] && objectives(thrifty)[2] <= better[2], "{plan}");
    }
    let stretched = row("paper's A as long as B");
    assert!((stretched.duration_s.unwrap() - 18.94).abs() < 1e-9);
    // By the paper's own f2, less than half of its B.
    assert!(stretched.printed_f2.unwrap() < 0.5 * row("paper's B").printed_f2.unwrap());
}

#[test]
fn findings_are_the_same_bytes_for_any_number_of_threads() {
    is_the_same_on_any_number_of_threads(|| {
        let study = run(&study(2, &[200]), || ()).unwrap();
        let mut all = vec![text(&document(&FORM, &study)), study.json(), curves_csv(&FORM, &study.curves)];
        all.extend(study.curves.chunk_by(|a, b| a.subject == b.subject).map(|same| curve_svg(&FORM, same)));
        all
    });
}

#[test]
fn the_picture_has_a_name_for_every_search() {
    let svg = curve_svg(&FORM, &STUDY.curves[..3]);
    for curve in &STUDY.curves[..3] {
        assert!(svg.contains(curve.entrant.title) && !svg.contains("NaN"), "{svg}");
    }
    assert!(svg.contains("simulation"), "{svg}");
}

const QUICK: [&str; 9] =
    ["plan", "--reference", "1000", "--evaluations", "200", "--seeds", "2", "--algorithm", "nsga3,nsga2"];

#[test]
fn what_is_no_algorithm_is_bad_usage_and_what_is_no_task_is_told_the_tasks() {
    let run = bench(&["plan", "--algorithm", "nsga3-of"]);
    let said = stderr(&run);
    assert_eq!((run.status.code(), run.stdout.len()), (Some(2), 0), "{said}");
    assert!(said.contains("'nsga3-fo'"), "{said}");
    let run = bench(&["plan", "--task", "task-9"]);
    let said = stderr(&run);
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0), "{said}");
    assert!(said.contains("task-9") && said.contains("simulation, task-1, task-2"), "{said}");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("task.toml");
    fs::write(&file, "title = 3").unwrap();
    let run = bench(&["plan", "--task", file.to_str().unwrap()]);
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
    for args in [["--seeds", "0"], ["--evaluations", "0"], ["--reference", "x"]] {
        assert_eq!(bench(&[&["plan"], &args[..]].concat()).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn json_holds_what_the_table_holds_also_of_a_file() {
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/../../sample-logs/tasks/task-2.toml");
    let args = [&QUICK[..], &["--task", own]].concat();
    let run = bench(&[&args[..], &["--json"]].concat());
    assert_eq!((run.status.code(), run.stderr.len()), (Some(0), 0));
    let document: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert_eq!(document["format"], "hydrotrace.study.v1");
    assert_eq!(document["table_3"].as_array().unwrap().len(), 0);
    let cells = document["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 3);
    let table = stdout(&bench(&args));
    for cell in cells {
        let median = format!("{:.4}", cell["samples"]["hypervolume"]["median"].as_f64().unwrap());
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
    assert!(csv.starts_with("task,objectives,algorithm,seeds,evaluations,hypervolume_q1,"), "{csv}");
    assert!(csv.contains("\nsimulation,3,nsga2,2,200,"), "{csv}");
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let run = bench(&[&QUICK[..], &["--curves", file.to_str().unwrap()]].concat());
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
}
