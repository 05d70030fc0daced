//! How long files are, and how much there is of them.

use super::sources;

/// Lines of the longest file; of half the files of `src` at most; of `src` and of all Rust together.
const LONGEST: usize = 400;
const MEDIAN: usize = 125;
const LIBRARY: usize = 117_550;
const ALL: usize = 162_200;

const FOLDERS: [&str; 6] = ["src", "crates", "tests", "benches", "examples", "fuzz"];

fn lines(folder: &str) -> Vec<(String, usize)> {
    let files = sources(folder).into_iter();
    files.map(|(file, text)| (format!("{folder}/{file}"), text.lines().count())).collect()
}

/// Files that are longer than a reader keeps in the head.
fn too_long(files: &[(String, usize)]) -> Vec<String> {
    let long = files.iter().filter(|(_, lines)| *lines > LONGEST);
    long.map(|(file, lines)| format!("{file} has {lines} lines, {LONGEST} are allowed: split it")).collect()
}

#[test]
fn files_fit_in_the_head_and_the_whole_stays_small() {
    let library = lines("src");
    let all: Vec<(String, usize)> = FOLDERS.iter().flat_map(|folder| lines(folder)).collect();
    let long = too_long(&all);
    assert!(long.is_empty(), "{}", long.join("\n"));
    let mut sorted: Vec<usize> = library.iter().map(|(_, lines)| *lines).collect();
    sorted.sort_unstable();
    let median = sorted[sorted.len() / 2];
    assert!(median <= MEDIAN, "half the files of src have {median} lines or more");
    let sum = |files: &[(String, usize)]| files.iter().map(|(_, lines)| lines).sum::<usize>();
    let (library, all) = (sum(&library), sum(&all));
    println!("src has {library} lines, all Rust {all}, half the files of src at most {median}");
    assert!(library <= LIBRARY, "src has {library} lines, {LIBRARY} are allowed: delete more than you add");
    assert!(all <= ALL, "there are {all} lines of Rust, {ALL} are allowed: delete more than you add");
}

#[test]
fn a_file_that_is_too_long_is_found() {
    let files = [("a.rs".to_owned(), LONGEST), ("b.rs".to_owned(), LONGEST + 1)];
    assert_eq!(too_long(&files), ["b.rs has 401 lines, 400 are allowed: split it"]);
}
