//! The README's commands give what the README shows.
//!
//! In a block marked `console` a line `$ hydrotrace ...` is run and the lines after it are what it
//! prints; a line `...` stands for any number of lines.

use std::{path::Path, process::Command};

fn readme() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap()
}

/// Commands and what the README says they print.
fn examples(text: &str) -> Vec<(String, Vec<String>)> {
    let mut examples: Vec<(String, Vec<String>)> = Vec::new();
    let (mut inside, mut demo) = (false, false);
    for line in text.lines() {
        match line {
            "```console" => inside = true,
            "```" => (inside, demo) = (false, false),
            _ if !inside => {}
            // What `demo` prints looks like commands.
            _ if demo && line.starts_with("$ ") => {
                if let Some((_, shown)) = examples.last_mut() {
                    shown.push(line.to_owned());
                }
            }
            _ => match (line.strip_prefix("$ "), examples.last_mut()) {
                (Some(command), _) => {
                    demo = command.starts_with("hydrotrace demo");
                    examples.push((command.to_owned(), Vec::new()));
                }
                (None, Some((_, shown))) => shown.push(line.to_owned()),
                (None, None) => panic!("output before any command: {line}"),
            },
        }
    }
    examples
}

/// Whether printed lines are the shown ones, `...` standing for any.
fn agree(shown: &[String], printed: &[String]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((first, rest)) if first == "..." => {
            (0..=printed.len()).any(|skip| agree(rest, &printed[skip..]))
        }
        Some((first, rest)) => printed.split_first().is_some_and(|(p, left)| p == first && agree(rest, left)),
    }
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

#[test]
fn every_command_prints_what_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    // Outputs go to a scratch folder that sees the sample logs.
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs"), &folder.path().join("sample-logs"));
    let examples = examples(&readme());
    assert!(examples.len() >= 5, "only {} commands found", examples.len());
    for (command, shown) in examples {
        let words: Vec<&str> = command.split_whitespace().collect();
        assert_eq!(words[0], "hydrotrace", "{command}");
        let run = Command::new(env!("CARGO_BIN_EXE_hydrotrace"))
            .current_dir(folder.path())
            .args(&words[1..])
            .output()
            .unwrap();
        let printed = [run.stdout, run.stderr].concat();
        let printed: Vec<String> = String::from_utf8(printed).unwrap().lines().map(str::to_owned).collect();
        assert!(agree(&shown, &printed), "{command} prints\n{}", printed.join("\n"));
    }
}

#[test]
fn the_two_first_commands_are_there() {
    let text = readme();
    let run = text.find("cargo run --release -- demo").unwrap();
    let test = text.find("cargo test").unwrap();
    assert!(run < test && run < 2500, "{run} {test}");
}

#[test]
fn every_local_link_leads_somewhere() {
    let text = readme();
    for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        if !link.contains("://") && !link.starts_with('#') {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(link);
            assert!(path.exists(), "README links to {link}");
        }
    }
}
