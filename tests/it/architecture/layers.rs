//! Which module may use which, where degrees, untyped documents and foreign crates may occur.

use std::path::Path;

/// Modules by layer; a module may use its own layer's ground rules and everything below.
const LAYERS: [&[&str]; 5] = [
    &[
        "units", "rng", "remark", "math", "atomic_file", "input_file", "text", "threads", "suggest",
        "schema", "document",
    ],
    &["arm", "task", "series", "spline"],
    &["log", "replay", "fit", "plan", "plant"],
    &["workflow"],
    &["cli", "render", "viewer"],
];

/// Within these layers modules do not use one another; the ground and the edges may.
const STRANGERS: [usize; 1] = [2];

/// Where documents are still read untyped. This list only shrinks.
const UNTYPED: [&str; 0] = [];

/// Where forms of other programs are written, and nothing is read.
const WRITTEN: [&str; 1] = ["render/export"];

/// Calls that open a file for reading, and where they may stand: elsewhere an output could replace what was read.
const OPENING: [&str; 4] = ["File::open(", "fs::read(", "fs::read_to_string(", "OpenOptions::new().read("];
const OPENERS: [&str; 4] = ["input_file.rs", "atomic_file", "log/contents.rs", "schema.rs"];

/// Where angles may be in degrees.
const DEGREE_EDGES: [&str; 5] = ["units", "task", "cli", "render", "viewer"];

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|modules| modules.contains(&module))
}

/// Faults of one source file; `path` is relative to `src`.
fn faults(path: &Path, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let module =
        path.components().next().map(|c| c.as_os_str().to_string_lossy().into_owned()).unwrap_or_default();
    let module = module.trim_end_matches(".rs").to_owned();
    let shown = path.display();
    if module == "lib" || module == "main" {
        return faults;
    }
    let Some(own) = layer(&module) else {
        return vec![format!("{shown}: module {module:?} has no place in the layers")];
    };
    for (number, line) in text.lines().enumerate() {
        let place = format!("{shown}:{}", number + 1);
        for used in uses(line) {
            let Some(other) = layer(&used) else { continue };
            if other > own {
                faults.push(format!("{place}: {module} uses {used}, which lies above it"));
            }
            if other == own && used != module && STRANGERS.contains(&own) {
                faults.push(format!("{place}: {module} uses {used}; abilities meet in workflow"));
            }
        }
        let code = line.split("//").next().unwrap_or_default();
        let converts =
            ["to_degrees(", "to_radians(", "degrees_from_radians"].iter().any(|word| code.contains(word));
        if converts && !DEGREE_EDGES.contains(&module.as_str()) {
            faults.push(format!("{place}: degrees belong at the edges"));
        }
        let foreign = |name: &str| {
            code.contains(&format!("{name}::")) || code.trim_start().starts_with(&format!("use {name}"))
        };
        if foreign("mcap") && module != "log" {
            faults.push(format!("{place}: only log sees mcap"));
        }
        if foreign("rerun") && module != "viewer" {
            faults.push(format!("{place}: only viewer sees rerun"));
        }
        if foreign("rayon") && module != "threads" {
            faults.push(format!(
                "{place}: only threads sees rayon, or work alone on a thread would not be alone"
            ));
        }
        let untyped = code.contains("serde_json") && code.contains("Value");
        let written = WRITTEN.iter().any(|place| path.starts_with(place));
        if untyped && module != "log" && !written && !tested(path, text, number) {
            faults.push(format!("{place}: a document reads a type, serde_json::Value only a log's JSON"));
        }
        if code.contains("unsafe") {
            faults.push(format!("{place}: nothing is unsafe"));
        }
        let opens = OPENING.iter().any(|call| code.contains(call));
        if opens && !OPENERS.iter().any(|known| path.starts_with(known)) && !tested(path, text, number) {
            faults.push(format!("{place}: input_file opens what is read, so that no output replaces it"));
        }
    }
    faults
}

/// Whether a line lies in the tests of its file, which stand at its end; or is known to break the rule.
fn tested(path: &Path, text: &str, line: usize) -> bool {
    let known = path.ends_with("tests.rs") || UNTYPED.iter().any(|known| path == Path::new(known));
    known || text.lines().take(line).any(|line| line == "#[cfg(test)]")
}

/// Top-level modules that a line names after `crate::`, nested use lists included.
fn uses(line: &str) -> Vec<String> {
    let code = line.split("//").next().unwrap_or_default();
    let ident =
        |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut found = Vec::new();
    for rest in code.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            // `use crate::{log::X, math::Y};` on one line: names at the first level of braces.
            Some(group) => {
                let mut depth = 0_i32;
                let mut start = true;
                for (at, c) in group.char_indices() {
                    if start && depth == 0 && !c.is_whitespace() {
                        found.push(ident(&group[at..]));
                        start = false;
                    }
                    depth += i32::from(c == '{') - i32::from(c == '}');
                    start |= c == ',' && depth == 0;
                    if depth < 0 {
                        break;
                    }
                }
            }
            None => found.push(ident(rest)),
        }
    }
    // Lines inside `use crate::{ ... }` start with the module's name.
    let start = ident(code.trim_start());
    if code.starts_with("    ")
        && code.trim_start()[start.len()..].starts_with("::")
        && code.trim_end().ends_with([',', '{'])
    {
        found.push(start);
    }
    found.retain(|name| !name.is_empty());
    found
}

#[test]
fn dependencies_point_down_and_what_is_foreign_stays_where_it_belongs() {
    let all: Vec<String> =
        super::sources("src").iter().flat_map(|(file, text)| faults(Path::new(file), text)).collect();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn every_rule_finds_its_fault() {
    for ((path, text), expected) in [
        (("series/a.rs", "use crate::log::read;"), "lies above"),
        (("series/a.rs", "use crate::{\n    log::read,\n};"), "lies above"),
        (("replay/a.rs", "use crate::log::Recording;"), "meet in workflow"),
        (("replay/a.rs", "use crate::{series::{A, B}, log::Recording};"), "meet in workflow"),
        (("workflow/a.rs", "crate::cli::run()"), "lies above"),
        (("replay/a.rs", "let deg = x.to_degrees();"), "degrees"),
        (("replay/a.rs", "use mcap::Writer;"), "only log"),
        (("plan/a.rs", "use rayon::prelude::*;"), "only threads"),
        (("render/a.rs", "let x: serde_json::Value = y;"), "reads a type"),
        (("workflow/a.rs", "use serde_json::{Value, json};"), "reads a type"),
        (("log/a.rs", "unsafe { x() }"), "nothing is unsafe"),
        (("plan/a.rs", "std::fs::read_to_string(path)"), "input_file opens"),
        (("log/a.rs", "let file = File::open(path)?;"), "input_file opens"),
        (("stray/a.rs", ""), "no place"),
    ] {
        let found = faults(Path::new(path), text);
        assert!(found.iter().any(|fault| fault.contains(expected)), "{path}: {found:?}");
    }
    assert_eq!(
        faults(Path::new("log/a.rs"), "use crate::series::Track; // crate::cli"),
        Vec::<String>::new()
    );
}
