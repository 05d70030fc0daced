//! The commands of this crate's README give what it shows; a line `...` stands for any number of lines.

use super::{bench, stdout};

fn agree(shown: &[&str], printed: &[&str]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((&"...", rest)) => (0..=printed.len()).any(|skip| agree(rest, &printed[skip..])),
        Some((first, rest)) => printed.split_first().is_some_and(|(p, left)| p == first && agree(rest, left)),
    }
}

#[test]
fn every_command_prints_what_is_shown() {
    let text = include_str!("../../README.md");
    let blocks: Vec<&str> = text.split("```console\n").skip(1).collect();
    assert_eq!(blocks.len(), 3);
    for block in blocks {
        let lines: Vec<&str> = block.split("```").next().unwrap().lines().collect();
        let words: Vec<&str> = lines[0].split_whitespace().collect();
        assert_eq!(words[..2], ["$", "hydrotrace-bench"]);
        let printed = stdout(&bench(&words[2..]));
        assert!(agree(&lines[1..], &printed.lines().collect::<Vec<_>>()), "{} prints\n{printed}", lines[0]);
    }
}
