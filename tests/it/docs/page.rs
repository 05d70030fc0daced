//! A page of documentation as commands and the lines they print.

use std::{
    path::Path,
    process::{Command, Output},
};

use super::root;

/// One line of text, or a command with its output.
enum Piece {
    Text(String),
    /// In a `console` block: `$ command` and the lines shown below it; `...` stands for any number of lines.
    Shown {
        command: String,
        lines: Vec<String>,
    },
    /// In a block `sh run`: a command whose output is not shown.
    Silent(String),
}

fn parse(text: &str) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut block = "";
    for line in text.lines() {
        if line.starts_with("```") {
            block = if block.is_empty() { line } else { "" };
            pieces.push(Piece::Text(line.to_owned()));
            continue;
        }
        // The output of `demo` lists commands: in its block only the first `$` is ours.
        let of_demo = matches!(pieces.last(), Some(Piece::Shown { command, .. }) if command.starts_with("hydrotrace demo"));
        let command = line.strip_prefix("$ ").filter(|_| block == "```console" && !of_demo);
        match (command, pieces.last_mut()) {
            (Some(command), _) => {
                pieces.push(Piece::Shown { command: command.to_owned(), lines: Vec::new() });
            }
            (None, Some(Piece::Shown { lines, .. })) if block == "```console" => lines.push(line.to_owned()),
            _ if block == "```sh run" => pieces.push(Piece::Silent(line.to_owned())),
            _ => pieces.push(Piece::Text(line.to_owned())),
        }
    }
    pieces
}

fn print(pieces: &[Piece]) -> String {
    let mut text = String::new();
    for piece in pieces {
        match piece {
            Piece::Text(line) | Piece::Silent(line) => text.extend([line, "\n"]),
            Piece::Shown { command, lines } => {
                text.extend(["$ ", command, "\n"]);
                text.extend(lines.iter().flat_map(|line| [line.as_str(), "\n"]));
            }
        }
    }
    text
}

/// Runs every command of a page in a folder of its own that holds the sample logs, and compares what is printed with what
/// is shown. With `UPDATE_DOCS` set it writes the page anew instead.
pub(super) fn check(name: &str) {
    let path = root().join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    let folder = tempfile::tempdir().unwrap();
    copy(&root().join("sample-logs"), &folder.path().join("sample-logs"));
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    let mut pieces = parse(&text);
    let (mut code, mut faults) = (Some(0), Vec::new());
    for at in 0..pieces.len() {
        let expected =
            matches!(pieces.get(at + 1), Some(Piece::Shown { command, .. }) if command == "echo $?");
        let (command, lines) = match &mut pieces[at] {
            Piece::Text(_) => continue,
            Piece::Silent(command) => (command, None),
            Piece::Shown { command, lines } => (command, Some(lines)),
        };
        let printed = if command == "echo $?" {
            vec![code.map_or_else(|| "killed".to_owned(), |code| code.to_string())]
        } else {
            let run = shell(folder.path(), command);
            code = run.status.code();
            let printed = String::from_utf8([run.stdout, run.stderr].concat()).unwrap();
            if !expected && !matches!(code, Some(0 | 3 | 4)) {
                faults.push(format!("$ {command}\n{printed}ends with {code:?}"));
            }
            printed.lines().map(str::to_owned).collect()
        };
        if let Some(lines) = lines.filter(|lines| !agree(lines, &printed)) {
            if update {
                *lines = renewed(lines, &printed);
            } else {
                faults.push(format!("$ {command}\n{}", printed.join("\n")));
            }
        }
    }
    assert!(
        faults.is_empty(),
        "{name} shows something else (UPDATE_DOCS=1 rewrites it):\n{}",
        faults.join("\n\n")
    );
    if update {
        std::fs::write(&path, print(&pieces)).unwrap();
    }
}

fn shell(folder: &Path, command: &str) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_hydrotrace")).parent().unwrap();
    let others = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(program.to_owned()).chain(std::env::split_paths(&others));
    Command::new("sh")
        .args(["-c", command])
        .current_dir(folder)
        .env("PATH", std::env::join_paths(paths).unwrap())
        .output()
        .unwrap()
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::copy(&path, target).unwrap();
        }
    }
}

/// Whether printed lines are the shown ones.
fn agree(shown: &[String], printed: &[String]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((first, rest)) if first == "..." => {
            (0..=printed.len()).any(|skip| agree(rest, &printed[skip..]))
        }
        Some((first, rest)) => printed.split_first().is_some_and(|(p, left)| p == first && agree(rest, left)),
    }
}

/// The shown lines as they are printed now: each stretch between two `...` keeps its length and moves to where the
/// printed lines are most like it.
fn renewed(shown: &[String], printed: &[String]) -> Vec<String> {
    let stretches: Vec<&[String]> = shown.split(|line| line == "...").collect();
    if stretches.len() < 2 {
        return printed.to_vec();
    }
    let mut found: Vec<String> = Vec::new();
    let mut from = 0;
    for (k, stretch) in stretches.iter().enumerate() {
        if k > 0 {
            found.push("...".to_owned());
        }
        let last = printed.len().saturating_sub(stretch.len()).max(from);
        let likeness = |start: usize| -> f64 {
            stretch.iter().zip(&printed[start.min(printed.len())..]).map(|(a, b)| alike(a, b)).sum()
        };
        let at = match k {
            0 => 0,
            _ if k + 1 == stretches.len() => last,
            // The first of the best.
            _ => (from..=last).rev().max_by(|&a, &b| likeness(a).total_cmp(&likeness(b))).unwrap_or(last),
        };
        let end = (at + stretch.len()).min(printed.len());
        found.extend_from_slice(&printed[at.min(end)..end]);
        from = end;
    }
    found
}

/// Share of words that two lines have in common.
fn alike(a: &str, b: &str) -> f64 {
    let (a, b): (Vec<&str>, Vec<&str>) = (a.split_whitespace().collect(), b.split_whitespace().collect());
    let common = a.iter().filter(|word| b.contains(word)).count();
    if a.is_empty() && b.is_empty() { 1.0 } else { common as f64 / a.len().max(b.len()) as f64 }
}

#[test]
fn dots_stand_for_any_lines_and_stretches_find_their_place_again() {
    let lines = |text: &str| text.split(' ').map(|word| word.replace('_', " ")).collect::<Vec<String>>();
    assert!(agree(&lines("a ... d"), &lines("a b c d")));
    assert!(agree(&lines("... a ..."), &lines("a")));
    assert!(!agree(&lines("a ... c"), &lines("a b c d")));
    let printed = lines("new head table x_1_2 y_3_4 end");
    assert_eq!(renewed(&lines("old ... x_1_5 ..."), &printed), lines("new ... x_1_2 ..."));
    assert_eq!(renewed(&lines("old"), &printed), printed);
}

#[test]
fn a_page_that_is_parsed_and_printed_is_the_same() {
    let text = "a\n```sh run\nhydrotrace x\n```\n```console\n$ hydrotrace demo\n$ not ours\n```\n```\n$ no block\n```\n";
    let pieces = parse(text);
    assert_eq!(print(&pieces), text);
    assert_eq!(pieces.iter().filter(|piece| !matches!(piece, Piece::Text(_))).count(), 2);
}
