//! Whether the day or the month comes first in dates.

use super::date::DateForm;
use crate::remark::Code;

/// Orders of day and month, as `--time-unit` says them, and how the names of their forms begin.
const ORDERS: [(&str, &str); 2] = [("dmy", "dd/mm"), ("mdy", "mm/dd")];

/// What is said of dates of another form.
const FITS: &str = "would fit as well";

/// Whether a text says the order of day and month.
pub(super) fn is_order(text: &str) -> bool {
    ORDERS.iter().any(|(order, _)| *order == text)
}

/// The order of a form that would be another in the other order, such as "mm/dd/yyyy hh:mm:ss".
pub(super) fn order_of(form: &str) -> Option<&'static str> {
    ORDERS.iter().find(|(_, begins)| form.starts_with(begins)).map(|(order, _)| *order)
}

/// Of forms that fit those of the order that is said, where there are any.
pub(super) fn of_order(mut forms: Vec<DateForm>, said: Option<&str>) -> Vec<DateForm> {
    let is = |form: &DateForm| said.is_some() && order_of(form.name) == said;
    if forms.iter().any(is) {
        forms.retain(is);
    }
    forms
}

/// What is doubtful in the first of the forms that fit.
pub(super) fn doubt(forms: &[DateForm]) -> Option<String> {
    let [form, rest @ ..] = forms else { return None };
    if let Some(other) = rest.first().filter(|other| other.name.len() == form.name.len()) {
        let order =
            order_of(other.name).map_or(String::new(), |order| format!(": --time-unit {order} says so"));
        return Some(format!("is read as {}; {} {FITS}{order}", form.name, other.name));
    }
    let unit = ["ms", "us", "ns"].get((form.counts / 3).checked_sub(1)?)?;
    Some(format!("has whole {unit} behind the seconds, without zeros before: only so does it rise"))
}

/// What kind of doubt that is.
pub(super) fn code(doubt: &str) -> Code {
    if doubt.contains(FITS) { Code::DateOrder } else { Code::Guessed }
}
