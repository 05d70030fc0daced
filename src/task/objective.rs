//! The objectives of a plan: one table. A row gives an objective its keys in files, its words in texts, plots and
//! options, and its unit; how it is computed is one arm of [`Evaluator`](crate::plan::Evaluator)'s match.

use crate::{
    text::fixed,
    units::{degrees_from_radians, radians_from_degrees},
};

/// One cost of a plan; less is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Objective {
    /// Total time, dwells included, s (f1).
    Duration,
    /// Sum over joints of the root mean square jerk, rad/s³ (f2).
    RmsJerk,
    /// Sum over joints of the root mean square power, W (f3).
    RmsPower,
    /// Sum of the predicted peak errors of all starts and reversals, rad; only a fitted machine has it.
    StartError,
}

/// Words, keys and unit of an objective.
#[derive(Debug)]
pub struct Row {
    objective: Objective,
    /// Key in documents, with the SI unit.
    pub key: &'static str,
    /// Key of its ceiling in a task file, with the file's unit.
    pub ceiling: &'static str,
    /// Key of its weight in a task file.
    pub weight: &'static str,
    /// Name in sentences.
    pub name: &'static str,
    /// The same in a word or two, for titles of plots.
    pub short: &'static str,
    /// Name of the plan that is best in it.
    pub best: &'static str,
    /// The rule that chooses the plan that is best in it.
    pub rule: &'static str,
    /// Unit as people read it.
    pub unit: &'static str,
    /// Name and unit, for the head of a column.
    pub heading: &'static str,
    /// Name and unit, for an axis.
    pub axis: &'static str,
    /// Decimals as people read it.
    pub decimals: usize,
    /// One sentence.
    pub explanation: &'static str,
    /// Whether it is an angle, or a derivative of one: radians within, degrees for people and in task files.
    angular: bool,
}

const TABLE: [Row; Objective::COUNT] = [
    Row {
        objective: Objective::Duration,
        key: "duration_s",
        ceiling: "max_duration_s",
        weight: "duration",
        name: "time",
        short: "time",
        best: "fastest",
        rule: "fastest",
        unit: "s",
        heading: "time s",
        axis: "Time (s)",
        decimals: 2,
        explanation: "Total time, dwells included.",
        angular: false,
    },
    Row {
        objective: Objective::RmsJerk,
        key: "rms_jerk_rad_s3",
        ceiling: "max_rms_jerk_deg_s3",
        weight: "rms_jerk",
        name: "RMS jerk",
        short: "jerk",
        best: "smoothest",
        rule: "smoothest",
        unit: "deg/s3",
        heading: "RMS jerk deg/s3",
        axis: "RMS jerk (deg/s\u{b3})",
        decimals: 4,
        explanation: "Root mean square jerk, summed over joints.",
        angular: true,
    },
    Row {
        objective: Objective::RmsPower,
        key: "rms_power_w",
        ceiling: "max_rms_power_w",
        weight: "rms_power",
        name: "RMS power",
        short: "power",
        best: "least power",
        rule: "thriftiest",
        unit: "W",
        heading: "RMS power W",
        axis: "RMS power (W)",
        decimals: 2,
        explanation: "Root mean square power, summed over joints.",
        angular: false,
    },
    Row {
        objective: Objective::StartError,
        key: "start_error_rad",
        ceiling: "max_start_error_deg",
        weight: "start_error",
        name: "predicted start error",
        short: "start error",
        best: "least start error",
        rule: "followed",
        unit: "deg",
        heading: "predicted start error deg",
        axis: "Predicted start error (deg)",
        decimals: 2,
        explanation: "Predicted peak errors of all starts and reversals, summed.",
        angular: true,
    },
];

impl Objective {
    /// Number of objectives.
    pub const COUNT: usize = 4;

    /// All of them; those that need a fitted machine come last.
    pub const ALL: [Self; Self::COUNT] = {
        let mut all = [Self::Duration; Self::COUNT];
        let mut k = 0;
        while k < Self::COUNT {
            all[k] = TABLE[k].objective;
            k += 1;
        }
        all
    };

    /// Those that arm and task alone decide.
    pub const OF_PLAN: &[Self] = Self::ALL.split_at(Self::COUNT - 1).0;

    /// Its row of the table.
    pub fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// The letter of the best plan in it: A, B and C as in the paper's table 3.
    pub fn letter(self) -> char {
        char::from(b'A' + self as u8)
    }

    /// A value in the unit of people and task files.
    pub fn shown(self, value: f64) -> f64 {
        if self.row().angular { degrees_from_radians(value) } else { value }
    }

    /// A value in SI from one in the unit of task files.
    pub(super) fn si_of_shown(self, value: f64) -> f64 {
        if self.row().angular { radians_from_degrees(value) } else { value }
    }

    /// A value as people read it, without its unit.
    pub fn number(self, value: f64) -> String {
        fixed(self.shown(value), self.row().decimals)
    }

    /// A value as people read it, with its unit.
    pub fn text(self, value: f64) -> String {
        format!("{} {}", self.number(value), self.row().unit)
    }
}

/// A number for each objective of a plan under some key of its row.
#[cfg(test)]
pub(super) fn schema(key: fn(&Row) -> &'static str) -> schemars::Schema {
    let properties: serde_json::Map<String, serde_json::Value> = Objective::OF_PLAN
        .iter()
        .map(|objective| {
            let row = objective.row();
            let value = schemars::json_schema!({ "type": "number", "description": row.explanation });
            (key(row).to_owned(), value.into())
        })
        .collect();
    schemars::json_schema!({ "type": "object", "properties": properties })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_objective_has_its_row_at_its_place() {
        for objective in Objective::ALL {
            assert_eq!(objective.row().objective, objective);
        }
    }
}
