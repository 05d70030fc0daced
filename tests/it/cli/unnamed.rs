//! Tables whose rows are in no order, and whose columns have no names.

use std::fs;

use super::forms::{report, rows};
use crate::support::{run_line as hydrotrace, said};

#[test]
fn rows_in_no_order_are_put_in_order() {
    let lines = rows(|t, p, m| format!("{t:.2},{p:.4},{m:.4}\n"));
    let lines: Vec<&str> = lines.split_inclusive('\n').collect();
    let shuffled: String = (0..lines.len()).map(|k| lines[k * 113 % lines.len()]).collect();
    let head = "t_s,boom_set_deg,boom_act_deg\n";
    let (code, text, error) = report("a.csv", &(head.to_owned() + &shuffled));
    assert!(code == 3 && text.contains("in no order of their times; put in order"), "{text}{error}");
    let told = |text: &str| text.lines().find(|line| line.starts_with("Worst start")).map(str::to_owned);
    assert_eq!(told(&text), told(&report("a.csv", &(head.to_owned() + &lines.concat())).1));
}

#[test]
fn a_table_without_names_is_told_the_line_that_names_columns_by_number() {
    let folder = tempfile::tempdir().unwrap();
    let paste = |text: &str| {
        fs::write(folder.path().join("a.csv"), text).unwrap();
        let (code, _, error) = said(&hydrotrace(folder.path(), "report a.csv"));
        assert_eq!(code, 1, "{error}");
        (error.split('`').nth(1).unwrap_or_default().to_owned(), error)
    };
    let (line, error) = paste(&rows(|t, p, m| format!("{:.4},{t:.2},{p:.4},{m:.4}\n", p.sin())));
    assert!(line.contains("--time '#2' --planned 'J1=#3' --measured 'J1=#4'"), "{error}");
    assert!(error.contains("#2 rises from row to row as a time does"), "{error}");
    let line = line.replace('\'', "");
    let (code, text, error) = said(&hydrotrace(folder.path(), &line[11..]));
    assert!(code != 1 && text.contains("one joint, 4.98 s at 50.0 Hz"), "{line} {text}{error}");
    let (line, error) = paste(&rows(|_, p, m| format!("{p:.4},{m:.4}\n")));
    assert!(line.contains("--rate HZ --planned 'J1=#1' --measured 'J1=#2'"), "{error}");
    let mut count = 0;
    let (line, error) =
        paste(&rows(|_, p, m| format!("{p:.4},{m:.4}\n")).lines().fold(String::new(), |all, row| {
            count += 1;
            format!("{all}{count},{row}\n")
        }));
    assert!(line.contains("--rate HZ --planned 'J1=#2' --measured 'J1=#3'"), "{error}");
    // Two joints, their measurement behind their plans; and where no two columns are alike, none is proposed.
    let two = |t: f64, p: f64, m: f64| {
        format!("{t:.2},{p:.4},{:.4},{m:.4},{:.4}\n", (3.0 * t).sin(), (3.0 * t - 0.2).sin())
    };
    let (line, error) = paste(&rows(two));
    assert!(line.contains("--planned 'J1=#2,J2=#3' --measured 'J1=#4,J2=#5'"), "{error}");
    let (line, error) =
        paste(&rows(|t, p, _| format!("{t:.2},{p:.4},{:.4},{:.4}\n", (7.0 * t).sin(), (3.0 * t).cos())));
    assert!(line.contains("--planned 'J1=#COLUMN' --measured 'J1=#COLUMN'"), "{error}");
}
