//! Rows of which most were written without the empty cells at their end: a row as wide as the header counts as much.

use ::csv::ByteRecord;

use super::{
    CsvOptions,
    dialect::{detect, head},
    head::are_names,
    number::{Looks, looks},
    rows::{Rows, cell_text, rewritten},
};

/// The table with those cells; `None` where no row is as wide as a header that is wider than most.
pub(super) fn filled(file: &str, text: &[u8], options: &CsvOptions) -> Option<Vec<u8>> {
    let dialect = detect(file, text, options).ok()?;
    let mut rows = Rows::new(head(text), dialect.separator);
    let (mut record, mut header) = (ByteRecord::new(), None);
    let wide = loop {
        let line = rows.next(&mut record)?;
        let cells: Vec<String> = record.iter().map(cell_text).collect();
        if header.is_none() && cells.len() > dialect.width && are_names(&cells) {
            header = Some((line, cells.len()));
        } else if let Some((_, wide)) = header
            && cells.len() == wide
            && is_row(&record)
        {
            break wide;
        }
    };
    let (first, _) = header?;
    rewritten(text, dialect.separator, |line, record, out| {
        out.write_record(record.iter().chain(std::iter::repeat_n(
            &[][..],
            if line > first && record.len() >= dialect.width { wide.saturating_sub(record.len()) } else { 0 },
        )))
    })
}

/// Whether a row has more numbers than words.
fn is_row(record: &ByteRecord) -> bool {
    let words = record.iter().filter(|cell| looks(cell) == Looks::Text).count();
    let empty = record.iter().filter(|cell| looks(cell) == Looks::Empty).count();
    record.len() > 2 * words + empty
}

#[cfg(test)]
mod tests {
    use super::{super::read_csv_bytes, *};

    #[test]
    fn a_row_as_wide_as_the_header_stays_where_the_others_are_shorter() {
        for text in [
            "time [s],J1 target [deg],J1 actual [deg],,Max,Min\n0,1,2,,43,41\n0.1,1,2\n0.2,2,2\n0.3,3,2\n0.4,4,3\n",
            "time_s,J1_target_deg,J1_actual_deg,note\n0,1.5,2.5,start\n0.1,1,2\n0.2,2,2\n0.3,3,2\n0.4,4,3\n",
        ] {
            let run = read_csv_bytes("a.csv", text.as_bytes(), &CsvOptions::default()).unwrap();
            assert_eq!((run.stamp_ns().len(), run.remarks.as_slice()), (5, &[][..]), "{text}");
        }
        for text in
            ["t,q_set,q_act,note\n0,1,2\n1,1,2\n2,1,2\n", "t,q,note\n0,1,a\n1,1,b\n", "t,q\n0,1,2\n", ""]
        {
            assert_eq!(filled("a.csv", text.as_bytes(), &CsvOptions::default()), None, "{text}");
        }
    }
}
