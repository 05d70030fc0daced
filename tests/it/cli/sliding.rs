//! Joints that slide from identification run to a better run: all lengths, in mm and m.

use std::fs;

use super::commissioning::{followed, moves};
use crate::support::{clean, json, run_line, said, scratch};

/// The columns of an export, by name.
fn columns<const N: usize>(folder: &std::path::Path, log: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let (_, text, _) = said(&run_line(folder, &format!("export {log} --csv")));
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let places = names.map(|name| {
        header.iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name} of {header:?}"))
    });
    let row = |row: &str| {
        let cells: Vec<&str> = row.split(',').collect();
        places.map(|place| cells[place].parse().unwrap())
    };
    text.lines().skip(1).map(row).collect()
}

/// A mast whose plan goes from 300 to 500 mm and back.
fn mast(rows: impl Iterator<Item = (f64, f64)>) -> String {
    let table = followed(rows, 0.6, 60.0).replace("boom", "mast").replace("_deg", "_mm");
    assert!(table.starts_with("t_s,mast_planned_mm,mast_measured_mm\n"));
    table
}

#[test]
fn a_joint_that_slides_is_fitted_corrected_and_better_for_it() {
    let folder = scratch();
    let folder = folder.path();
    fs::write(folder.join("run.csv"), mast(moves(9.0).map(|(t_s, at)| (t_s, 10.0 * at)))).unwrap();
    let (_, fitted, _) = said(&run_line(folder, "fit run.csv -o limits.toml"));
    assert!(fitted.contains("speed + mm/s") && !fitted.contains("deg"), "{fitted}");
    let (_, next, _) = said(&run_line(folder, "replan run.csv -o next.mcap"));
    assert!(next.contains("mean transition peak mm") && next.contains("correction mm"), "{next}");
    assert!(!next.contains(" deg"), "{next}");
    let sent = columns(folder, "next.mcap", ["time_s", "mast_planned_m", "mast_command_m"]);
    let [first, last] = [sent[0], sent[sent.len() - 1]];
    assert!((first[1] - first[2]).abs() < 1e-6 && (last[1] - last[2]).abs() < 1e-6);
    // A recorder that knows of the command alone: the line that is printed puts the plan into its log.
    let came = mast(sent.iter().map(|[t_s, _, sent]| (*t_s, 1e3 * sent))).replace("planned", "command");
    fs::write(folder.join("came.csv"), came).unwrap();
    let (code, _, error) = said(&run_line(folder, "join came.csv --plan next.mcap -o after.mcap"));
    assert!(code != 1, "{error}");
    let compared = json(folder, "compare run.csv after.mcap");
    let peak =
        compared["summaries"].as_array().unwrap().iter().find(|one| one["measure"] == "peak_error").unwrap();
    let [before, after] = ["mean_before", "mean_after"].map(|key| peak[key].as_f64().unwrap());
    assert!(after < 0.3 * before && before > 0.01, "{peak}");
}

/// What a table calls a command may be the signal to a valve.
#[test]
fn a_command_that_has_nothing_to_do_with_the_plan_is_doubted_and_the_line_reads_the_plan() {
    let folder = scratch();
    let folder = folder.path();
    let table = mast(moves(9.0).map(|(t_s, at)| (t_s, 10.0 * at)));
    // One that moves, and one that does not.
    for (by, expected, told) in [(20.0, 3, "the command of mast is "), (0.0, 1, "what was sent, stands")] {
        let duty = |(k, row): (u32, &str)| {
            let signal = (75.0 + by * (0.02 * f64::from(k)).sin()).to_string();
            format!("{row},{}\n", if k == 0 { "mast_command_mm" } else { &signal })
        };
        fs::write(folder.join("run.csv"), (0..).zip(table.lines()).map(duty).collect::<String>()).unwrap();
        clean(folder, "import run.csv -o run.mcap --force");
        let (code, fitted, error) = said(&run_line(folder, "fit run.mcap"));
        let fitted = fitted + &error;
        assert!(code == expected && fitted.contains(told), "{code} {fitted}");
        let option = fitted.split("--command ").nth(1).unwrap().split(' ').next().unwrap();
        let (code, fitted, _) = said(&run_line(folder, &format!("fit run.mcap --command {option}")));
        assert!(code == 0 && fitted.contains("mast          1.00"), "{code} {fitted}");
    }
}

#[test]
fn an_identification_run_of_a_joint_that_slides_tells_its_speed() {
    let folder = scratch();
    let folder = folder.path();
    let said_of = clean(folder, "excite -o id.mcap --joint mast=400:250:550mm --max-speed-mm-s 300");
    assert!(said_of.contains("+-60.0 mm at 30.0 mm/s; +-100.0 mm at 294.1 mm/s"), "{said_of}");
    let strokes = columns(folder, "id.mcap", ["time_s", "mast_planned_m"]);
    assert!(strokes.iter().all(|[_, at]| (0.3 - 1e-9..=0.5 + 1e-9).contains(at)));
    fs::write(folder.join("id.csv"), mast(strokes.iter().map(|[t_s, at]| (*t_s, 1e3 * at)))).unwrap();
    let found = json(folder, "fit id.csv");
    let joint = &found["joints"][0];
    let limit = &joint["speed_limit_growing_rad_s"];
    assert!(joint["kind"] == "slides" && (limit["value"].as_f64().unwrap() - 0.06).abs() < 0.003, "{limit}");
    let (code, _, error) = said(&run_line(folder, "replan id.csv -o next.mcap"));
    assert!(code == 1 && error.contains("is an identification run"), "{error}");
}

/// Of a boom that turns and a telescope that slides, whose names say it in German.
#[test]
fn an_arm_of_both_kinds_is_told_by_kind_and_no_length_is_an_angle() {
    let folder = scratch();
    let folder = folder.path();
    let boom = followed(moves(9.0), 0.6, 60.0);
    let both = |tele: &dyn Fn(f64) -> f64| -> String {
        let header =
            "t_s,boom_planned_deg,boom_measured_deg,Fahrwerk X Soll [mm],Fahrwerk X Ist [mm]\n".to_owned();
        let row = |row: &str| {
            let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
            format!("{row},{},{}\n", tele(cells[1]), tele(cells[2]))
        };
        header + &boom.lines().skip(1).map(row).collect::<String>()
    };
    fs::write(folder.join("a.csv"), both(&|deg| 10.0 * deg)).unwrap();
    fs::write(folder.join("b.csv"), both(&|deg| 12.0 * deg)).unwrap();
    let (_, text, _) = said(&run_line(folder, "report a.csv"));
    for sentence in ["Joints that turn: ", "Joints that slide: "] {
        for what in [" inside, ", "distance to the planned path"] {
            let found = text.lines().any(|line| line.starts_with(sentence) && line.contains(what));
            assert!(found, "{sentence}{what}: {text}");
        }
    }
    let document = json(folder, "report a.csv");
    let kinds: Vec<&str> =
        document["of_kinds"].as_array().unwrap().iter().map(|of| of["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["turns", "slides"]);
    let rms = |k: usize| document["of_kinds"][k]["tracking_error"]["rms"].as_f64().unwrap();
    let deg = rms(0).to_degrees();
    assert!(
        (rms(1) - 0.01 * deg).abs() < 1e-4 && document["whole_run"]["tracking_error"].is_null(),
        "{document}"
    );
    // A longer way is longer in mm, and as far in deg.
    let (_, text, _) = said(&run_line(folder, "compare a.csv b.csv"));
    let plans = text.lines().find(|line| line.contains("at equal times they differ by at most")).unwrap();
    assert!(plans.contains("at most 0.00") && plans.contains(" deg and 100.00 mm"), "{plans}");
    let (_, page, _) = said(&run_line(folder, "compare a.csv b.csv --html"));
    assert!(
        page.contains("Peak error, joints that slide") && page.contains("Rms error, joints that turn"),
        "page"
    );
    // Two runs of the plan without a correction are as one: the next is a first one.
    fs::copy(folder.join("a.csv"), folder.join("c.csv")).unwrap();
    let made = json(folder, "replan a.csv c.csv --keep-plan");
    let steps = made["command"].as_array().unwrap().iter().map(|joint| joint["step"]["by"].as_str().unwrap());
    assert_eq!(steps.collect::<Vec<_>>(), ["first"; 2], "{}", made["command"]);
    clean(folder, "replan a.csv -o next.mcap");
    let exported = clean(folder, "export next.mcap --csv --joints boom");
    assert!(exported.starts_with("stamp_ns,time_s,boom_planned_rad"), "{exported}");
}

#[test]
fn columns_of_a_map_are_those_of_every_verb() {
    let folder = scratch();
    let folder = folder.path();
    let table =
        followed(moves(9.0), 0.6, 60.0).replace("boom_planned_deg", "A").replace("boom_measured_deg", "B");
    fs::write(folder.join("run.csv"), table).unwrap();
    assert_eq!(said(&run_line(folder, "report run.csv")).0, 1);
    clean(
        folder,
        "import run.csv -o run.mcap --degrees --planned boom=A --measured boom=B --save-map map.toml",
    );
    for verb in ["report run.csv --map map.toml", "info run.csv --map map.toml", "fit run.csv --map map.toml"]
    {
        let (code, text, error) = said(&run_line(folder, verb));
        assert!(code != 1 && text.contains("boom"), "{verb}: {error}");
    }
    let (code, _, error) = said(&run_line(folder, "report run.csv --map none.toml"));
    assert!(code == 1 && error.contains("none.toml"), "{error}");
}
