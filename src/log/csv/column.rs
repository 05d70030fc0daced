//! Columns as a caller names them.

use std::{collections::BTreeSet, fmt::Write as _};

use super::{CsvError, CsvOptions};
use crate::{suggest::nearest, text::shell_word};

/// The columns of a file, for messages.
pub(super) fn present(names: &[String]) -> String {
    const MOST: usize = 40;
    let mut list = names.iter().take(MOST).map(|name| clip(name)).collect::<Vec<_>>().join(", ");
    if names.len() > MOST {
        // Writing to memory does not fail.
        let _ = write!(list, " and {} more", names.len() - MOST);
    }
    list
}

/// A text short enough for a message.
pub(super) fn clip(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}

/// The column that a caller named: its header, whatever the case, or `#` and its number.
pub(super) fn find(name: &str, option: &str, names: &[String]) -> Result<usize, CsvError> {
    let (name, option) = (name.trim(), option.to_owned());
    for same in [|a: &str, b: &str| a == b, |a: &str, b: &str| a.to_lowercase() == b.to_lowercase()] {
        let places: Vec<usize> = (0..names.len()).filter(|&column| same(&names[column], name)).collect();
        match places.as_slice() {
            [] => {}
            [column] => return Ok(*column),
            [first, ..] => {
                let (count, first) = (places.len(), first + 1);
                return Err(CsvError::SameHeader { column: name.to_owned(), option, count, first });
            }
        }
    }
    let number = name.strip_prefix('#').and_then(|number| number.parse::<usize>().ok());
    if let Some(column) =
        number.and_then(|number| number.checked_sub(1)).filter(|&column| column < names.len())
    {
        return Ok(column);
    }
    Err(CsvError::NoColumn {
        column: name.to_owned(),
        option,
        nearest: nearest(name, names.iter().map(String::as_str)),
        present: present(names),
    })
}

/// The columns that a caller names, alone or in a sum.
pub(super) fn named(options: &CsvOptions, names: &[String]) -> BTreeSet<usize> {
    let given = options.columns.values().chain(options.interfaces.values()).flatten();
    let parts = given.flat_map(|(_, text)| std::iter::once(text.as_str()).chain(text.split(['+', '-', '*'])));
    parts.filter_map(|text| find(text, "", names).ok()).collect()
}

/// A column as a value of an option that [`find`] finds again: by its number where others have the same header.
pub(super) fn pasted(column: usize, names: &[String]) -> String {
    let alone = find(&names[column], "", names).is_ok_and(|found| found == column);
    if alone { shell_word(&names[column]) } else { shell_word(&format!("#{}", column + 1)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_found_by_name_or_number_and_a_near_miss_is_suggested() {
        let names = ["t", "q_soll", "q_ist", "q_ist"].map(str::to_owned);
        assert_eq!(find("Q_SOLL", "--planned", &names).unwrap(), 1);
        assert_eq!(find("#4", "--planned", &names).unwrap(), 3);
        assert_eq!([pasted(1, &names), pasted(3, &names)], ["q_soll", "'#4'"]);
        assert!(matches!(
            find("q_ist", "--measured", &names),
            Err(CsvError::SameHeader { count: 2, first: 3, .. })
        ));
        let missed = find("q_sol", "--planned", &names).unwrap_err().to_string();
        assert!(missed.contains("did you mean \"q_soll\"?"), "{missed}");
        assert!(find("#5", "--planned", &names).is_err() && find("#0", "--planned", &names).is_err());
    }
}
