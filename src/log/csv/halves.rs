//! Numbers with a decimal comma in a table that is separated by commas, unquoted: each is cut in two, and only the header tells how many
//! there are.

use crate::remark::{Code, Remarks};

/// Rows that have to say so.
const ROWS: usize = 50;
const FEWEST: usize = 3;

/// The table with decimal points, where its header has half as many names as every row has cells, and each pair of cells is a number.
pub(super) fn joined(text: &[u8], remarks: &mut Remarks) -> Option<Vec<u8>> {
    let mut lines = text.split(|byte| *byte == b'\n').map(trimmed).filter(|line| !line.is_empty());
    let names: Vec<&[u8]> = lines.next()?.split(|byte| *byte == b',').collect();
    let named = names.len() > 1 && names.iter().all(|name| name.iter().any(u8::is_ascii_alphabetic));
    let mut looked_at = 0;
    for line in lines.by_ref().take(ROWS).filter(|_| named) {
        numbers(line, names.len())?;
        looked_at += 1;
    }
    if looked_at < FEWEST {
        return None;
    }
    let (mut table, mut rows) = (Vec::with_capacity(text.len()), 0);
    for line in text.split_inclusive(|byte| *byte == b'\n') {
        match numbers(trimmed(line), names.len()) {
            Some(joined) => {
                table.extend(joined);
                table.push(b'\n');
                rows += 1;
            }
            None => table.extend_from_slice(line),
        }
    }
    let message = "rows with twice as many cells as the header has names: numbers with a decimal comma in a table that is separated by \
                   commas; each pair is taken as one number";
    remarks.add(Code::Guessed, rows, message);
    Some(table)
}

fn trimmed(line: &[u8]) -> &[u8] {
    line.trim_ascii()
}

/// A row of so many numbers with decimal points; `None` where its pairs of cells are none.
fn numbers(line: &[u8], count: usize) -> Option<Vec<u8>> {
    let cells: Vec<&[u8]> = line.split(|byte| *byte == b',').map(<[u8]>::trim_ascii).collect();
    let digits = |cell: &[u8]| !cell.is_empty() && cell.iter().all(u8::is_ascii_digit);
    let whole = |cell: &[u8]| digits(cell.strip_prefix(b"-").unwrap_or(cell));
    let pairs = || cells.chunks_exact(2);
    let are = cells.len() == 2 * count && pairs().all(|pair| whole(pair[0]) && digits(pair[1]));
    are.then(|| pairs().map(|pair| pair.join(&b'.')).collect::<Vec<Vec<u8>>>().join(&b','))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(table: &str) -> Option<String> {
        let joined = joined(table.as_bytes(), &mut Remarks::default())?;
        Some(String::from_utf8(joined).unwrap())
    }

    #[test]
    fn numbers_that_their_commas_cut_in_two_are_whole_again() {
        let table = "t,j1 [deg]\r\n0,00,-0,50\r\n0,02,-0,75\r\n0,04,12,00\r\n";
        assert_eq!(read(table).unwrap(), "t,j1 [deg]\r\n0.00,-0.50\n0.02,-0.75\n0.04,12.00\n");
        // Twice as many columns of whole numbers than names, but not of digits alone; as many as names; and too few rows.
        assert_eq!(read("t,j1\n0,-1,1,2\n1,-1,1,2\n2,-1,1,2\n"), None);
        assert_eq!(read("t,j1\n0,1\n1,2\n2,3\n"), None);
        assert_eq!(read("t,j1\n0,00,0,50\n"), None);
    }
}
