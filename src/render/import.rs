//! How a CSV file was read.

use super::kit::{Block, Document, Id, NONE, Section, Sentence, Table, counted, fact};
use crate::{log::Understood, workflow::import::Imported};

pub(crate) fn document(output: &str, imported: &Imported) -> Document {
    let Understood { file, time, joints, columns, unused, .. } = &imported.understood;
    let u = &imported.understood;
    let written = format!(
        "{} rows of {file} written to {output}: {}, {:.2} s at {:.1} Hz.",
        u.rows,
        counted(joints.len(), "joint"),
        time.duration_s,
        time.rate_hz
    );
    let header = match (u.header_line, u.unit_row) {
        (0, _) => "none; columns are named by their number".to_owned(),
        (line, false) => format!("line {line}"),
        (line, true) => format!("line {line}, units below it"),
    };
    let above =
        if u.rows_above > 0 { format!("; {} above it", counted(u.rows_above, "row")) } else { String::new() };
    let clock = if time.columns.is_empty() {
        time.form.clone()
    } else {
        format!("{}: {}", time.columns.join(" and "), time.form)
    };
    let counts = if time.absolute {
        let begins = chrono::DateTime::from_timestamp_nanos(time.first_ns);
        format!("; begins {} UTC", begins.format("%Y-%m-%d %H:%M:%S"))
    } else {
        "; no date in the file: second 0 becomes 2025-10-09 08:53:20 UTC".to_owned()
    };
    let read_as = vec![
        fact("cells", format!("separated by {}, decimal {}", u.separator, u.decimal)),
        fact("header", format!("{header}{above}")),
        fact("time", format!("{clock}{counts}")),
    ];
    let rows = columns.iter().map(|column| {
        let unit = match &column.unit {
            Some(unit) if column.unit_from == "file" => unit.clone(),
            Some(unit) => format!("{unit} ({})", column.unit_from),
            None => NONE.to_owned(),
        };
        vec![
            column.header.clone(),
            column.becomes.clone(),
            column.joint.clone(),
            unit,
            column.numbers.to_string(),
            column.empty.to_string(),
        ]
    });
    let table = Table::new(&["column", "became", "of joint", "unit"], &["numbers", "empty"], rows);
    let unused = (!unused.is_empty()).then(|| Sentence::finding(format!("Not used: {}", unused.join(", "))));
    Document::default()
        .with(Section::plain(Id::SUMMARY, [Sentence::finding(written)]))
        .with(Section::new(Id::OTHER, "Read as", [Block::Facts(read_as)]).with(table).with_all(unused))
        .remarked(&imported.remarks)
}
