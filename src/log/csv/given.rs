//! Options of an import as the line that gave them, so that the next line can repeat them.

use super::{AngleUnit, Columns, CsvOptions, options::option};

impl CsvOptions {
    /// Each option that was given and its value; none of a flag. An option that may come several times does.
    pub(super) fn given(&self) -> Vec<(&'static str, Option<String>)> {
        let list = |columns: &Columns| {
            columns.iter().map(|(joint, column)| format!("{joint}={column}")).collect::<Vec<_>>().join(",")
        };
        let value = |name, value: Option<String>| value.map(|value| (name, Some(value)));
        let flag = |name, is_given: bool| is_given.then_some((name, None));
        let slides: Vec<String> =
            self.slides.iter().map(|(joint, unit)| format!("{joint}={}", unit.name())).collect();
        let form = [
            value("--only", self.only.as_ref().map(|(column, value)| format!("{column}={value}"))),
            value("--time", self.time.clone()),
            value("--time-unit", self.time_unit.clone()),
            value("--rate", self.rate_hz.map(|hz| hz.to_string())),
            flag("--degrees", self.angle_unit == Some(AngleUnit::Degrees)),
            flag("--radians", self.angle_unit == Some(AngleUnit::Radians)),
            value("--slides", (!slides.is_empty()).then(|| slides.join(","))),
            value("--separator", self.separator.map(super::Separator::name)),
            flag("--decimal-comma", self.decimal_comma == Some(true)),
            flag("--decimal-point", self.decimal_comma == Some(false)),
        ];
        let columns =
            self.columns.iter().map(|((role, quantity), all)| (option(*role, *quantity), Some(list(all))));
        let interfaces =
            self.interfaces.iter().map(|(name, all)| ("--interface", Some(format!("{name}:{}", list(all)))));
        form.into_iter().flatten().chain(columns).chain(interfaces).collect()
    }
}
