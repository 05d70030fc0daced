//! Columns of dates.

use super::{
    clock::{Found, Look},
    date::{DateForm, Part},
    order::{doubt, of_order, order_of},
    time::TimeSource,
};

impl Look<'_> {
    /// The forms in which the cells of a column are written, in the order of day and month that the caller says.
    pub(super) fn forms(&self, column: usize) -> Vec<DateForm> {
        of_order(DateForm::fitting(&self.cells(column)), self.options.time_unit.as_deref())
    }

    /// Columns that are not called a time, and hold nothing but dates or times of day.
    pub(super) fn dates(&self) -> Vec<Found> {
        let is = |column: &usize| {
            let forms = self.forms(*column);
            !self.labels[*column].is_time
                && forms.first().is_some_and(|form| !matches!(form.part, Part::Elapsed | Part::Minutes))
        };
        let columns = (0..self.labels.len()).filter(is);
        columns.filter_map(|column| self.column(column).ok()).filter(Found::steady).collect()
    }

    /// A day in one column and a time of day in another are one time. Beside `AM` and `PM` the month comes first.
    pub(super) fn join_day_and_time(&self, usable: &mut Vec<Found>) {
        let of = |part: Part| {
            usable.iter().find_map(|found| match &found.source {
                TimeSource::Date { column, form } if form.part == part => Some((*column, form.clone())),
                _ => None,
            })
        };
        let (Some((day, _)), Some(time)) = (of(Part::Day), of(Part::TimeOfDay)) else { return };
        let mut forms = self.forms(day);
        if time.1.name.ends_with("am/pm") {
            forms.sort_by_key(|form| order_of(form.name) != Some("mdy"));
        }
        let doubt = doubt(&forms);
        if let Some(form) = forms.into_iter().next() {
            let joined = self.found(TimeSource::DayAndTime { day: (day, form), time }, doubt);
            usable.insert(0, joined);
        }
    }
}
