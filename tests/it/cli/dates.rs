//! Dates as people write them, stamps of whole seconds, and what is told of a machine at rest.

use std::{fmt::Write as _, fs};

use super::csv::{import, moves, report};
use crate::support::{run_args as hydrotrace, said, timed};

/// A table at 10 Hz of a joint that is 0.1 s late; each row begins with what `stamp` makes of its number.
fn table(head: &str, stamp: impl Fn(u32) -> String) -> String {
    (0..200).fold(format!("{head};boom_set_rad;boom_act_rad\n"), |mut text, k| {
        let [planned, measured] = moves(0.1 * f64::from(k));
        writeln!(text, "{};{planned};{measured}", stamp(k)).unwrap();
        text
    })
}

/// Seconds of the day at a row, as `07:36:11.5`.
fn at(k: u32) -> String {
    format!("07:36:{:02}.{}", 10 + k / 10, k % 10)
}

#[test]
fn a_column_of_dates_is_the_time_whatever_it_is_called() {
    for head in ["Horodatage", "Heure", "Fecha y hora", "Tijd", "Čas", "日時", "Systemzeit", "log_ts"] {
        let (code, out, error) = import(table(head, |k| format!("2026-03-02 {}", at(k))), &[]);
        assert_eq!(code, 0, "{head}: {out}{error}");
        assert!(
            out.contains(&format!("{head}: yyyy-mm-dd hh:mm:ss")) && out.contains("at 10.0 Hz"),
            "{head}: {out}"
        );
    }
}

#[test]
fn the_month_comes_first_beside_am_and_pm_and_an_option_says_the_order() {
    let american = table("Date;Time", |k| format!("03/02/2026;{} AM", at(k)));
    let (code, out, error) = import(&american, &[]);
    assert!(code == 3 && out.contains("2026-03-02 07:36:10"), "{out}{error}");
    assert!(out.contains("dd/mm/yyyy would fit as well: --time-unit dmy says so"), "{out}");
    let (code, out, error) = import(&american, &["--time-unit", "dmy"]);
    assert!(code == 0 && out.contains("2026-02-03 07:36:10"), "{out}{error}");
    let european = table("Date", |k| format!("03/02/2026 {}", at(k)));
    let (code, out, error) = import(&european, &[]);
    assert!(code == 3 && out.contains("2026-02-03") && out.contains("--time-unit mdy"), "{out}{error}");
    // A map keeps what was found, so that the next table of the form is read without a doubt.
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), &european).unwrap();
    for args in [&["--time-unit", "mdy", "--save-map", "m.toml"][..], &["--map", "m.toml", "--force"]] {
        let line = [&["import", "a.csv", "-o", "a.mcap"], args].concat();
        let (code, out, error) = said(&hydrotrace(folder.path(), &line));
        assert!(code == 0 && out.contains("2026-03-02 07:36:10"), "{args:?}: {out}{error}");
    }
    let (code, _, error) = import(&european, &["--time-unit", "ymd"]);
    assert!(code == 1 && error.contains("dmy or mdy"), "{error}");
}

#[test]
fn stamps_of_whole_seconds_are_spread_over_them() {
    let text = table("Zeitstempel", |k| format!("02.03.2026 07:36:{:02}", 10 + (k + 3) / 10));
    for args in [&[][..], &["--time", "Zeitstempel"]] {
        let (code, out, error) = import(&text, args);
        assert!(
            code == 3 && out.contains("at 10.0 Hz") && out.contains("repeats each stamp in 10 rows"),
            "{out}{error}"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), &text).unwrap();
    let peak = report(folder.path(), "a.csv")["joints"][0]["tracking_error"]["peak"].as_f64().unwrap();
    assert!((peak - 0.026).abs() < 0.001, "{peak}");
}

#[test]
fn lines_of_json_that_are_broken_are_counted() {
    let mut text = String::new();
    for k in 0..300 {
        let [planned, measured] = moves(0.02 * f64::from(k));
        let line = format!(
            "{{\"t\": {}, \"boom_set_rad\": {planned}, \"boom_act_rad\": {measured}}}",
            0.02 * f64::from(k)
        );
        writeln!(text, "{}", if k % 50 == 7 { &line[..20] } else { &line }).unwrap();
    }
    let (code, out, error) = import(&text, &[]);
    assert!(code == 3 && out.contains("no JSON object, the first of them line 8"), "{out}{error}");
    assert!(out.contains("x6"), "{out}");
}

#[test]
fn a_joint_that_slips_is_told_where_its_plan_rests() {
    let text = timed("t_s,boom_set_rad,boom_act_rad", (3000, 0.02), |t_s| {
        let [planned, measured] = moves(t_s);
        let slipped = if t_s > 38.0 { 0.026 } else { 0.0 };
        format!("{t_s},{planned},{}", measured + slipped)
    });
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), text).unwrap();
    for args in [&["report", "a.csv"][..], &["a.csv"]] {
        let (_, out, error) = said(&hydrotrace(folder.path(), args));
        assert!(out.contains("boom stays off its plan where that rests: by "), "{out}{error}");
    }
}
