//! Times of day in figures alone, as receivers of satellites and PLCs give them: `142357.3`, which is 14:23:57.3, beside a day or below a
//! header that says so.

use super::{
    CsvOptions,
    head::{Head, looked_at},
    label::label,
    rows::rewritten,
};

/// The table with colons in its times, and marks in its days.
pub(super) fn unpacked(file: &str, text: &[u8], options: &CsvOptions) -> Option<Vec<u8>> {
    let (dialect, head) = looked_at(file, text, options)?;
    if options.time_unit.is_some() || options.rate_hz.is_some() {
        return None;
    }
    let all = |column: usize, of: fn(&str) -> Option<String>| {
        let mut cells = head.sample.iter().filter_map(|row| row.get(column));
        head.sample.len() > 2 && cells.all(|cell| unpack(cell, of).is_some())
    };
    let timely = |column: &usize| label(&head.names[*column], None).is_time;
    let columns = || (0..head.names.len()).filter(timely);
    let day = columns().find(|column| all(*column, calendar_day));
    let time = columns().find(|column| {
        Some(*column) != day && (day.is_some() || says(&head, *column)) && all(*column, time_of_day)
    })?;
    let mut whole = true;
    let table = rewritten(text, dialect.separator, |line, record, out| {
        for (column, cell) in record.iter().enumerate() {
            let of = [(Some(time), time_of_day as fn(&str) -> Option<String>), (day, calendar_day)]
                .into_iter()
                .find(|(own, _)| *own == Some(column) && line >= head.first_line && !cell.is_empty())
                .map(|(_, of)| of);
            match of.map(|of| unpack(cell, of)) {
                None => out.write_field(cell)?,
                Some(plain) => {
                    whole &= plain.is_some();
                    out.write_field(plain.unwrap_or_default())?;
                }
            }
        }
        out.write_record(None::<&[u8]>)
    });
    table.filter(|_| whole)
}

fn says(head: &Head, column: usize) -> bool {
    head.names[column].to_lowercase().contains("hhmmss")
}

fn unpack(cell: &[u8], of: fn(&str) -> Option<String>) -> Option<String> {
    of(std::str::from_utf8(cell).ok()?.trim())
}

/// Two figures each below 60, and below 24 of the hour, which may lack its first; behind the seconds a fraction, or ms.
fn time_of_day(text: &str) -> Option<String> {
    let (whole, fraction) = text.split_at(text.find(['.', ',']).unwrap_or(text.len()));
    if !whole.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (whole, ms) = match (whole.len(), fraction) {
        (5 | 6, _) => (whole, fraction.to_owned()),
        (8 | 9, "") => (&whole[..whole.len() - 3], format!(".{}", &whole[whole.len() - 3..])),
        _ => return None,
    };
    let hour = whole.len() - 4;
    let part = |from: usize, to: usize| whole[from..to].parse::<u32>().ok();
    let parts = [part(0, hour)?, part(hour, hour + 2)?, part(hour + 2, hour + 4)?];
    let fits = parts[0] < 24 && parts[1] < 60 && parts[2] < 60;
    fits.then(|| format!("{:02}:{:02}:{:02}{ms}", parts[0], parts[1], parts[2]))
}

/// Eight figures of a day of these centuries.
fn calendar_day(text: &str) -> Option<String> {
    let digits = text.len() == 8 && text.bytes().all(|byte| byte.is_ascii_digit());
    let [year, month, day] = digits.then(|| [&text[..4], &text[4..6], &text[6..]])?;
    let within =
        |text: &str, least: u32, most: u32| text.parse::<u32>().is_ok_and(|of| (least..=most).contains(&of));
    let fits = within(year, 1970, 2099) && within(month, 1, 12) && within(day, 1, 31);
    fits.then(|| format!("{year}-{month}-{day}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        Some(String::from_utf8(unpacked("a.csv", text.as_bytes(), &CsvOptions::default())?).unwrap())
    }

    #[test]
    fn figures_beside_a_day_or_below_a_header_that_says_so_are_a_time_of_day() {
        let text = "Date,Time,q\n20240312,142359.9,1\n20240312,142400.0,2\n20240312,142400.1,3\n";
        let expected =
            "Date,Time,q\n2024-03-12,14:23:59.9,1\n2024-03-12,14:24:00.0,2\n2024-03-12,14:24:00.1,3\n";
        assert_eq!(of(text).as_deref(), Some(expected));
        let text = "UTC time (hhmmss.sss);q\n093005,2;1\n93005,3;2\n93005,4;3\n";
        assert_eq!(of(text).unwrap().lines().nth(2), Some("09:30:05,3;2"));
        assert_eq!(time_of_day("142357300").as_deref(), Some("14:23:57.300"));
    }

    #[test]
    fn what_counts_seconds_is_left() {
        let rows: Vec<String> = (142_355..142_405).map(|k| format!("20240312,{k}.0,1")).collect();
        assert_eq!(of(&format!("Date,Time,q\n{}\n", rows.join("\n"))), None);
        assert_eq!(of("Time,q\n142357.0,1\n142358.0,2\n142359.0,3\n"), None);
    }
}
