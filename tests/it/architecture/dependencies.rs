//! What the packages depend on, as `cargo` resolves it from the lock file.

use std::{collections::BTreeSet, process::Command};

use serde_json::Value;

/// What belongs to the program and not to the library.
const PROGRAM: [&str; 7] = ["clap", "indicatif", "plotters", "comfy-table", "maud", "parquet", "env_logger"];

/// What belongs to arms and the program, and not to evolutionary algorithms.
const ARMS: [&str; 5] = ["mcap", "clap", "toml", "nalgebra", "hydrotrace"];

fn cargo(args: &[&str]) -> String {
    let run = Command::new(env!("CARGO")).args(args).current_dir(super::root()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).unwrap()
}

/// Names of all packages that a package needs without its default features.
fn tree(package: &str) -> BTreeSet<String> {
    let edges =
        ["tree", "--no-default-features", "--edges", "normal", "--prefix", "none", "--package", package];
    cargo(&edges).lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

fn found(package: &str, unwanted: &[&str]) -> Vec<String> {
    let tree = tree(package);
    assert!(tree.contains(package), "{tree:?}");
    unwanted.iter().filter(|name| tree.contains(**name)).map(|name| (*name).to_owned()).collect()
}

#[test]
fn the_library_depends_on_nothing_of_the_program() {
    assert_eq!(found("hydrotrace", &PROGRAM), Vec::<String>::new());
}

#[test]
fn evolutionary_algorithms_depend_on_no_arm() {
    assert_eq!(found("hydrotrace-moea", &ARMS), Vec::<String>::new());
}

#[test]
fn the_declared_compiler_is_new_enough_for_every_dependency_of_the_program() {
    let host = String::from_utf8(Command::new("rustc").arg("-vV").output().unwrap().stdout).unwrap();
    let host = host.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let metadata = cargo(&["metadata", "--format-version", "1", "--filter-platform", host]);
    let metadata: Value = serde_json::from_str(&metadata).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let declared = packages.iter().find(|package| package["name"] == "hydrotrace").unwrap();
    let declared = version(&declared["rust_version"]);
    let needed = cargo(&["tree", "--edges", "normal,build", "--prefix", "none"]);
    let needs = |package: &&Value| {
        let line = format!("{} v{}", package["name"].as_str().unwrap(), package["version"].as_str().unwrap());
        needed.lines().any(|known| known == line || known.starts_with(&format!("{line} ")))
    };
    let newer: Vec<String> = packages
        .iter()
        .filter(needs)
        .filter(|package| version(&package["rust_version"]) > declared)
        .map(|package| format!("{} {}", package["name"], package["rust_version"]))
        .collect();
    assert!(newer.is_empty(), "newer than rust-version {declared:?}: {newer:?}");
}

fn version(text: &Value) -> (u32, u32) {
    let mut parts = text.as_str().unwrap_or("0").split('.').map(|part| part.parse().unwrap_or(0));
    (parts.next().unwrap_or(0), parts.next().unwrap_or(0))
}
