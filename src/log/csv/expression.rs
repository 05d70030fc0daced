//! Columns that are sums of others: a plan as measured plus error, an offset, a scale.

use super::{
    CsvError, CsvOptions,
    by_meaning::{by_meaning, named_as},
    column::find,
    head::Head,
    label::Label,
    options::option,
    read::{Cells, Column},
};

/// A column that no cell of the file holds: the sum of factors times columns, and a constant in their unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Derived {
    /// Its index, behind those of the file.
    pub(super) column: usize,
    /// Factor and column of the file.
    pub(super) terms: Vec<(f64, usize)>,
    constant: f64,
}

/// Turns what the options name by a sum into columns behind those of the file: `head` and `labels` get one more
/// each, the options name them by number.
pub(super) fn derive(
    head: &mut Head,
    labels: &mut Vec<Label>,
    options: &mut CsvOptions,
) -> Result<Vec<Derived>, CsvError> {
    let mut all = Vec::new();
    let width = labels.len();
    let given = options.columns.clone();
    let sides =
        options.columns.iter_mut().map(|((role, quantity), columns)| (option(*role, *quantity), columns));
    let beside = options.interfaces.values_mut().map(|columns| ("--interface", columns));
    for (flag, columns) in sides.chain(beside) {
        for (joint, text) in columns {
            if find(text, flag, &head.names[..width]).is_ok() {
                continue;
            }
            let Some(parts) = split(text) else { continue };
            let column = head.names.len();
            let mut derived = Derived { column, terms: Vec::new(), constant: 0.0 };
            for part in parts {
                match part {
                    Part::Constant(value) => derived.constant += value,
                    Part::Column(factor, name) => {
                        let names = &head.names[..width];
                        let named = || find(named_as(name, joint, &given)?, flag, names).ok();
                        let near = || named().or_else(|| by_meaning(name, joint, &labels[..width]));
                        let found = find(name, flag, names).or_else(|error| near().ok_or(error))?;
                        derived.terms.push((factor, found));
                    }
                }
            }
            let units: Vec<_> = derived.terms.iter().map(|(_, column)| labels[*column].unit).collect();
            let unit = units.iter().find_map(|unit| *unit);
            if let Some(other) = units.iter().flatten().find(|other| Some(**other) != unit) {
                let unit = unit.map_or_else(String::new, |unit| unit.name.to_owned());
                let (text, other) = (text.clone(), other.name.to_owned());
                return Err(CsvError::MixedUnits { text, units: [unit, other] });
            }
            // The number counts from 1, so it is that of the new last column.
            labels.push(Label { unit, stated: unit, ..Label::default() });
            head.names.push(std::mem::replace(text, format!("#{}", column + 1)));
            all.push(derived);
        }
    }
    Ok(all)
}

/// Computes the columns; a cell without a number makes the sum none.
pub(super) fn compute(derived: &[Derived], cells: &mut Cells) {
    for one in derived {
        let mut values = vec![one.constant; cells.stamp_ns.len()];
        for (factor, column) in &one.terms {
            let of = cells.columns.get(column).map(|column| column.values.as_slice()).unwrap_or_default();
            values.iter_mut().zip(of).for_each(|(sum, value)| *sum += factor * value);
        }
        cells.columns.insert(one.column, Column::of(values));
    }
}

#[derive(Debug, PartialEq)]
enum Part<'a> {
    Constant(f64),
    Column(f64, &'a str),
}

/// The parts of a sum; `None` of a text that is none.
fn split(text: &str) -> Option<Vec<Part<'_>>> {
    let mut parts = Vec::new();
    let (mut start, mut sign) = (0, 1.0);
    let ends = text.match_indices(['+', '-']).map(|(at, mark)| (at, mark == "-"));
    for (at, negative) in ends.chain([(text.len(), false)]) {
        let part = text[start..at].trim();
        // A sign at the start, or after a sign, belongs to what follows.
        if !part.is_empty() {
            parts.push(term(part, sign)?);
            sign = 1.0;
        }
        sign *= if negative { -1.0 } else { 1.0 };
        start = at + 1;
    }
    let plain = matches!(parts.as_slice(), [Part::Column(_, name)] if *name == text.trim());
    (!plain && parts.iter().any(|part| matches!(part, Part::Column(..)))).then_some(parts)
}

/// `3*name`, `name*3`, `name/3`, `name` or `3`.
fn term(text: &str, sign: f64) -> Option<Part<'_>> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    if let Some(value) = number(text) {
        return Some(Part::Constant(sign * value));
    }
    if let Some((left, right)) = text.split_once('*') {
        return match (number(left), number(right)) {
            (Some(factor), None) => Some(Part::Column(sign * factor, right.trim())),
            (None, Some(factor)) => Some(Part::Column(sign * factor, left.trim())),
            _ => None,
        };
    }
    if let Some((name, divisor)) = text.rsplit_once('/')
        && let Some(divisor) = number(divisor).filter(|divisor| *divisor != 0.0)
    {
        return Some(Part::Column(sign / divisor, name.trim()));
    }
    Some(Part::Column(sign, text))
}

#[cfg(test)]
mod tests {
    use super::{
        super::{AngleUnit, Quantity, Role, read_csv_bytes},
        *,
    };

    #[test]
    fn a_sum_is_split_at_its_signs_and_a_name_is_none() {
        let column = |factor, name| Part::Column(factor, name);
        assert_eq!(split("measured+error"), Some(vec![column(1.0, "measured"), column(1.0, "error")]));
        assert_eq!(
            split("a - 2*b + 0.5"),
            Some(vec![column(1.0, "a"), column(-2.0, "b"), Part::Constant(0.5)])
        );
        assert_eq!(split("-#3"), Some(vec![column(-1.0, "#3")]));
        assert_eq!(split("#3/1000"), Some(vec![column(1e-3, "#3")]));
        assert_eq!((split("boom"), split("3.5"), split("2*3"), split("")), (None, None, None, None));
    }

    #[test]
    fn what_an_option_names_as_measured_is_the_measured_of_a_sum() {
        let column = |role, text: &str| ((role, Quantity::Position), vec![("J".into(), text.into())]);
        let options = CsvOptions {
            columns: [column(Role::Planned, "measured+Error"), column(Role::Measured, "Output")].into(),
            angle_unit: Some(AngleUnit::Degrees),
            ..CsvOptions::default()
        };
        let row = |table: String, k: u32| format!("{table}{:.2},{k},1\n", 0.02 * f64::from(k));
        let table = (0..20).fold("t,Output,Error\n".to_owned(), row);
        let run = read_csv_bytes("a.csv", table.as_bytes(), &options).unwrap();
        assert_eq!(run.understood.columns.len(), 2, "{:?}", run.understood);
    }
}
