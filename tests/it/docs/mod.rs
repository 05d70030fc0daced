//! README and guide say what is so: commands print what is shown, links lead somewhere, every option has its line.

mod links;
mod page;

use std::{
    path::{Path, PathBuf},
    process::Command,
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

macro_rules! pages {
    ($($name:ident: $path:literal)*) => {
        $(#[test]
        fn $name() {
            page::check($path);
        })*

        const PAGES: &[&str] = &[$($path),*];
    };
}

pages! {
    readme: "README.md"
    guide: "docs/guide/README.md"
    answer: "docs/guide/answer.md"
    compare: "docs/guide/compare.md"
    demo: "docs/guide/demo.md"
    excite: "docs/guide/excite.md"
    export: "docs/guide/export.md"
    fit: "docs/guide/fit.md"
    fleet: "docs/guide/fleet.md"
    import: "docs/guide/import.md"
    info: "docs/guide/info.md"
    join: "docs/guide/join.md"
    library: "docs/guide/library.md"
    plan: "docs/guide/plan.md"
    python: "docs/guide/python.md"
    record: "docs/guide/record.md"
    recover: "docs/guide/recover.md"
    replan: "docs/guide/replan.md"
    report: "docs/guide/report.md"
    shell: "docs/guide/shell.md"
    simulate: "docs/guide/simulate.md"
    view: "docs/guide/view.md"
    watch: "docs/guide/watch.md"
}

#[test]
fn every_page_of_the_guide_is_checked() {
    for entry in std::fs::read_dir(root().join("docs/guide")).unwrap() {
        let name = format!("docs/guide/{}", entry.unwrap().file_name().into_string().unwrap());
        assert!(PAGES.contains(&name.as_str()), "{name} is not in the list of pages");
    }
}

#[test]
fn the_readme_is_short_and_has_its_two_commands() {
    let text = read("README.md");
    assert!(text.len() <= 8000, "{} bytes", text.len());
    assert!(text.contains("\ncargo run --release -- demo ") && text.contains("\ncargo test "));
}

/// What stands between two texts.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let after = text.split_once(from).unwrap_or_else(|| panic!("no {from}")).1;
    after.split_once(to).unwrap_or_else(|| panic!("no {to}")).0
}

#[test]
fn the_readmes_first_fact_is_what_the_pages_behind_it_show() {
    let (readme, demo, study) = (read("README.md"), read("docs/guide/demo.md"), read("docs/replan.md"));
    let shown = between(&demo, "    peak error ", " deg in the mean");
    let share = between(&demo, " deg in the mean (", ")");
    let said = format!("from {} deg ({share})", shown.replace("->", "to"));
    assert!(readme.contains(&said), "{said}");
    let median: Vec<&str> = between(&study, "| median of all | ", " |\n").split(" | ").collect();
    let said = format!("{} after the first command, {} after the second", median[0], median[1]);
    assert!(readme.contains(&said), "{said}");
}

fn help(arguments: &[&str]) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_hydrotrace")).args(arguments).arg("--help").output().unwrap();
    String::from_utf8(run.stdout).unwrap()
}

/// Verbs in the list of the program's help.
fn verbs() -> Vec<String> {
    let help = help(&[]);
    let list =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    list.filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|verb| !["", "help"].contains(verb))
        .map(str::to_owned)
        .collect()
}

/// Options that a help text explains: the first `--name` of a line that begins with a dash.
fn options(help: &str) -> Vec<&str> {
    let rows =
        help.lines().map(str::trim_start).filter(|line| line.starts_with('-') && !line.starts_with("- "));
    rows.filter_map(|line| {
        let at = line.find("--")?;
        let end =
            line[at + 2..].find(|c: char| c != '-' && !c.is_ascii_lowercase()).unwrap_or(line.len() - at - 2);
        Some(&line[at..at + 2 + end])
    })
    .collect()
}

#[test]
fn every_verb_has_a_page_and_every_option_a_line() {
    let shared = read("docs/guide/README.md");
    let verbs = verbs();
    assert!(verbs.len() >= 14, "{verbs:?}");
    for verb in verbs {
        let page = match verb.as_str() {
            "completions" | "man" => "docs/guide/shell.md".to_owned(),
            _ => format!("docs/guide/{verb}.md"),
        };
        let text = read(&page);
        assert!(shared.contains(page.trim_start_matches("docs/guide/")), "the guide does not list {page}");
        let help = help(&[&verb]);
        let missing: Vec<&str> = options(&help)
            .into_iter()
            .filter(|option| !text.contains(option) && !shared.contains(option))
            .collect();
        assert!(missing.is_empty(), "{page} does not explain {missing:?}");
    }
}
