//! Circles of imports: in each folder, among its files and folders. A folder's `mod.rs` is the folder itself:
//! it uses its files, and what it holds for all of them they may use.

use std::collections::{BTreeMap, BTreeSet};

use super::imports::uses;

/// Every group of files and folders that use one another in a circle: their folder, and their names.
fn circles(sources: &[(String, String)]) -> Vec<(String, String)> {
    let mut folders: BTreeMap<String, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for (user, used) in uses(sources) {
        for other in used {
            let (user, other): (Vec<&str>, Vec<&str>) =
                (user.split('/').collect(), other.split('/').collect());
            // Where the two paths part; what lies deeper is one member.
            let shared = user.iter().zip(&other).take_while(|(a, b)| a == b).count();
            if user[shared] == "mod.rs" || other[shared] == "mod.rs" {
                continue;
            }
            let folder = folders.entry(user[..shared].join("/")).or_default();
            folder.entry(user[shared].to_owned()).or_default().insert(other[shared].to_owned());
        }
    }
    let mut found = Vec::new();
    for (folder, edges) in &folders {
        let reach: BTreeMap<&String, BTreeSet<&String>> =
            edges.keys().map(|from| (from, reachable(from, edges))).collect();
        let mut seen = BTreeSet::new();
        for member in edges.keys().filter(|member| reach[member].contains(member)) {
            let circle: Vec<&str> = edges
                .keys()
                .filter(|other| reach[member].contains(other) && reach[other].contains(member))
                .map(String::as_str)
                .collect();
            if seen.insert(circle.clone()) {
                found.push((folder.clone(), circle.join(", ")));
            }
        }
    }
    found
}

fn reachable<'a>(from: &'a String, edges: &'a BTreeMap<String, BTreeSet<String>>) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(at) = open.pop() {
        for next in edges.get(at).into_iter().flatten() {
            if reached.insert(next) {
                open.push(next);
            }
        }
    }
    reached
}

#[test]
fn no_two_files_use_one_another() {
    let mut roots = vec!["src".to_owned()];
    for entry in std::fs::read_dir(super::root().join("crates")).unwrap() {
        roots.push(format!("crates/{}/src", entry.unwrap().file_name().to_string_lossy()));
    }
    let found: Vec<(String, String)> = roots
        .iter()
        .flat_map(|root| circles(&super::sources(root)).into_iter().map(move |circle| (root, circle)))
        .map(|(root, (folder, files))| (format!("{root}/{folder}").trim_end_matches('/').to_owned(), files))
        .collect();
    assert!(found.is_empty(), "circles of imports: {found:#?}");
}

#[test]
fn every_kind_of_circle_is_found() {
    let tree = |files: &[(&str, &str)]| -> Vec<String> {
        let files: Vec<_> = files.iter().map(|(f, t)| ((*f).to_owned(), (*t).to_owned())).collect();
        circles(&files).iter().map(|(folder, files)| format!("{folder}: {files}")).collect()
    };
    let lib = ("lib.rs", "mod a;\nmod b;\n");
    for (files, expected) in [
        (&[lib, ("a.rs", "use crate::b::X;"), ("b.rs", "use super::a::Y;")][..], ": a.rs, b.rs"),
        // Nested lists, other names, paths within the code, and not within comments or strings.
        (
            &[
                lib,
                ("a.rs", "use crate::{\n    b::{self as c, X},\n};"),
                ("b.rs", "fn f() { crate::a::g() }"),
            ],
            ": a.rs, b.rs",
        ),
        (&[lib, ("a.rs", "use crate::b::X;"), ("b.rs", "// crate::a::g()\nlet x = \"crate::a::g\";")], ""),
        // Through a re-export to the file that defines the name.
        (
            &[
                lib,
                ("a/mod.rs", "mod deep;\nmod flat;\npub use deep::Deep;"),
                ("a/deep.rs", "use super::flat::Flat;"),
                ("a/flat.rs", "use super::Deep;"),
            ],
            "a: deep.rs, flat.rs",
        ),
        // Between folders, though no two files use one another.
        (
            &[
                lib,
                ("a/mod.rs", "mod x;\nmod y;"),
                ("a/x.rs", "use crate::b::v::V;"),
                ("a/y.rs", ""),
                ("b/mod.rs", "mod v;\nmod w;"),
                ("b/v.rs", ""),
                ("b/w.rs", "use crate::a::y::Y;"),
            ],
            ": a, b",
        ),
        // A folder and its file; what tests import does not count.
        (&[lib, ("a/mod.rs", "mod x;\nfn f() { x::g() }"), ("a/x.rs", "use super::f;")], ""),
        (
            &[
                lib,
                ("a.rs", "use crate::b::X;"),
                ("b.rs", "#[cfg(test)]\nmod tests {\n    use crate::a::Y;\n}"),
            ],
            "",
        ),
    ] {
        assert_eq!(tree(files).join("; "), expected, "{files:?}");
    }
}
