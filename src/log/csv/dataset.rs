//! Data sets as Ignition exports them: names, types and the number of rows, each below a line that says so.

/// The first data set with its names as the header; `None` of what is none.
pub(super) fn as_table(text: &[u8]) -> Option<Vec<u8>> {
    let is = |line: &[u8], mark: &[u8]| line.strip_prefix(b"\"").unwrap_or(line).starts_with(mark);
    let mut lines = text.split_inclusive(|byte| *byte == b'\n');
    if !is(lines.next()?, b"#NAMES") {
        return None;
    }
    let names = lines.next()?;
    let types = lines.next().filter(|line| is(line, b"#TYPES")).and_then(|_| lines.next());
    let count = lines.next().filter(|line| is(line, b"#ROWS"));
    let rows = lines.take_while(|line| !is(line, b"#"));
    types.and(count)?;
    // The lines below keep their numbers.
    Some([b"\n\n\n\n", names].into_iter().chain(rows).collect::<Vec<_>>().concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_data_set_is_a_table() {
        let text = |mark: &str| {
            format!(
                "{mark}#NAMES{mark}\nt,a\n{mark}#TYPES{mark}\ndate,D\n{mark}#ROWS{mark},2\n1,2\n3,4\n{mark}#NAMES{mark}\nb\n"
            )
        };
        for mark in ["", "\""] {
            let table = as_table(text(mark).as_bytes());
            assert_eq!(table.as_deref(), Some(&b"\n\n\n\nt,a\n1,2\n3,4\n"[..]), "{mark}");
        }
        for text in ["#NAMES\nt,a\n1,2\n", "t,a\n1,2\n", ""] {
            assert_eq!(as_table(text.as_bytes()), None, "{text}");
        }
    }
}
