//! Lines that can be pasted though the files that they would write are there already.

use super::{Block, Document};

impl Document {
    /// Its commands with other names for logs that they would write and that are there: no line is refused for what an
    /// earlier one wrote. Lines after it that read such a log follow.
    pub fn sparing(mut self, is_there: &dyn Fn(&str) -> bool) -> Self {
        let mut renamed: Vec<(String, String)> = Vec::new();
        for block in self.sections.iter_mut().flat_map(|section| &mut section.blocks) {
            let Block::Command(line) = block else { continue };
            let mut words: Vec<String> = line.split(' ').map(str::to_owned).collect();
            for word in &mut words {
                if let Some((_, to)) = renamed.iter().find(|(from, _)| from == word) {
                    word.clone_from(to);
                }
            }
            let written = words.iter().position(|word| word == "-o").map(|at| at + 1);
            if let Some(written) = written.and_then(|at| words.get_mut(at)).filter(|word| is_there(word)) {
                let taken = |name: &str| is_there(name) || renamed.iter().any(|(_, to)| to == name);
                if let Some(free) = free(written, &taken) {
                    renamed.push((std::mem::replace(written, free.clone()), free));
                }
            }
            *line = words.join(" ");
        }
        self
    }
}

/// The next name of a log with a number behind it.
fn free(name: &str, taken: &dyn Fn(&str) -> bool) -> Option<String> {
    let stem = name.strip_suffix(".mcap")?;
    let counted = |(stem, number): (&str, &str)| Some((stem.to_owned(), number.parse::<u32>().ok()?));
    let (stem, last) = stem.rsplit_once('-').and_then(counted).unwrap_or((stem.to_owned(), 1));
    (1..1000).map(|more| format!("{stem}-{}.mcap", last.saturating_add(more))).find(|name| !taken(name))
}

#[cfg(test)]
mod tests {
    use super::super::*;

    #[test]
    fn a_line_writes_no_log_that_is_there_and_later_ones_read_what_it_writes() {
        let lines = [
            "hydrotrace join RUN.mcap --plan next.mcap -o after.mcap",
            "hydrotrace compare run.mcap after.mcap",
            "hydrotrace replan run.mcap after.mcap -o next-2.mcap",
            "hydrotrace fit run.mcap -o limits.toml",
        ];
        let section = Section::plain(Id::NEXT, lines.map(|line| Block::Command(line.to_owned())));
        let there = ["next.mcap", "after.mcap", "after-2.mcap", "next-2.mcap", "limits.toml", "run.mcap"];
        let spared = Document::default().with(section).sparing(&|name| there.contains(&name));
        let said: Vec<&str> = (spared.sections[0].blocks.iter())
            .filter_map(|block| if let Block::Command(line) = block { Some(line.as_str()) } else { None })
            .collect();
        let expected = [
            "hydrotrace join RUN.mcap --plan next.mcap -o after-3.mcap",
            "hydrotrace compare run.mcap after-3.mcap",
            "hydrotrace replan run.mcap after-3.mcap -o next-3.mcap",
            lines[3],
        ];
        assert_eq!(said, expected);
    }
}
