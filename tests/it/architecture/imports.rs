//! Which file uses which: `use` statements with nested lists, and paths within the code, followed through
//! re-exports to the file that defines the name.

use std::collections::{BTreeMap, BTreeSet};

type Path = Vec<String>;

/// One source file: its module and what its text names.
struct Module {
    file: String,
    /// Every name that a `use` brings, with where it comes from and whether it is a mere re-export.
    names: Vec<(String, Path, bool)>,
    /// Paths within the code.
    inline: Vec<Path>,
}

/// Files by the files that they use. `sources` holds paths below `src` and their texts.
pub(super) fn uses(sources: &[(String, String)]) -> BTreeMap<String, BTreeSet<String>> {
    let known: BTreeSet<Path> = sources.iter().map(|(file, _)| module_of(file)).collect();
    let modules: BTreeMap<Path, Module> = sources
        .iter()
        .map(|(file, text)| (module_of(file), parse(file, &without_tests(text), &known)))
        .collect();
    let mut found = BTreeMap::new();
    for (path, module) in modules.iter().filter(|(path, _)| !path.is_empty()) {
        let named = module.names.iter().filter(|(.., re_export)| !re_export).map(|(_, from, _)| from);
        let files = named.chain(&module.inline).filter_map(|from| defined_in(from, &modules, 8));
        let own = &modules[path].file;
        found.insert(own.clone(), files.filter(|file| file != own && file != "lib.rs").collect());
    }
    found
}

/// `a/b.rs` and `a/b/mod.rs` are the module `a::b`.
fn module_of(file: &str) -> Path {
    let stem = file.trim_end_matches(".rs");
    let stem = stem.strip_suffix("/mod").unwrap_or(stem);
    stem.split('/').filter(|part| *part != "lib").map(str::to_owned).collect()
}

/// The file with the definition that a path leads to; through at most so many re-exports.
fn defined_in(path: &[String], modules: &BTreeMap<Path, Module>, depth: usize) -> Option<String> {
    let length = (0..=path.len()).rev().find(|&length| modules.contains_key(&path[..length]))?;
    let module = &modules[&path[..length]];
    let Some(name) = path.get(length).filter(|_| depth > 0) else { return Some(module.file.clone()) };
    let source = module.names.iter().find(|(known, ..)| known == name);
    match source {
        Some((_, from, _)) if from[..] != path[..] => defined_in(from, modules, depth - 1),
        _ => Some(module.file.clone()),
    }
}

/// The text without comments, strings and modules of tests.
fn without_tests(text: &str) -> String {
    let mut kept = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line == "#[cfg(test)]" {
            let next = lines.next().unwrap_or_default();
            if next.ends_with('{') {
                lines.by_ref().find(|line| *line == "}");
            }
            continue;
        }
        let code = line.split("//").next().unwrap_or_default();
        // Odd parts are within quotes.
        for outside in code.split('"').step_by(2) {
            kept.push_str(outside);
            kept.push(' ');
        }
        kept.push('\n');
    }
    kept
}

/// Identifiers and single signs; `::` is one sign.
fn tokens(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let word = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let length = if word > 0 {
            word
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        found.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    found
}

fn parse(file: &str, text: &str, known: &BTreeSet<Path>) -> Module {
    let own = module_of(file);
    let mut module = Module { file: file.to_owned(), names: Vec::new(), inline: Vec::new() };
    let words = tokens(text);
    let mut at = 0;
    while at < words.len() {
        if words[at] == "use" {
            let end = at + words[at..].iter().position(|word| *word == ";").unwrap_or(words.len() - at);
            let public = at > 0 && matches!(words[at - 1], "pub" | ")");
            let mut tree = Vec::new();
            expand(&words[at + 1..end], &[], &mut tree);
            for (name, path) in tree {
                let Some(path) = absolute(&path, &own, known) else { continue };
                module.names.push((name, path, public && file.ends_with("mod.rs")));
            }
            at = end;
        } else if words.get(at + 1) == Some(&"::") && (at == 0 || words[at - 1] != "::") {
            let mut path = vec![words[at].to_owned()];
            while words.get(at + 1) == Some(&"::") && words.get(at + 2).is_some_and(|word| is_name(word)) {
                path.push(words[at + 2].to_owned());
                at += 2;
            }
            module.inline.extend(absolute(&path, &own, known));
        }
        at += 1;
    }
    module
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The leaves of a tree of imports: the name that each brings, and its path.
fn expand(words: &[&str], prefix: &[String], found: &mut Vec<(String, Path)>) {
    let mut path = prefix.to_vec();
    let mut name = String::new();
    let mut at = 0;
    while at < words.len() {
        match words[at] {
            "{" => {
                let mut depth = 0;
                let mut start = at + 1;
                for (k, word) in words.iter().enumerate().skip(at) {
                    depth += i32::from(*word == "{") - i32::from(*word == "}");
                    if depth == 0 || (depth == 1 && *word == ",") {
                        expand(&words[start..k], &path, found);
                        start = k + 1;
                    }
                    if depth == 0 {
                        return;
                    }
                }
            }
            "as" => {
                found.push((words.get(at + 1).copied().unwrap_or_default().to_owned(), path));
                return;
            }
            "self" if !path.is_empty() => {}
            word if is_name(word) => {
                path.push(word.to_owned());
                word.clone_into(&mut name);
            }
            _ => {}
        }
        at += 1;
    }
    if !words.is_empty() {
        found.push((name, path));
    }
}

/// A path from the crate's root; none if it leads out of the crate.
fn absolute(path: &[String], own: &[String], known: &BTreeSet<Path>) -> Option<Path> {
    let mut base = own.to_vec();
    let mut rest = path;
    match path.first()?.as_str() {
        "crate" => {
            base.clear();
            rest = &path[1..];
        }
        "self" => rest = &path[1..],
        "super" => {
            while rest.first().is_some_and(|word| word == "super") {
                base.pop()?;
                rest = &rest[1..];
            }
        }
        child => {
            base.push(child.to_owned());
            if !known.contains(&base) {
                return None;
            }
            rest = &path[1..];
        }
    }
    base.extend_from_slice(rest);
    Some(base)
}
