//! A front of plans as pages show it: from a search, or from the document that a log carries.

use serde::Deserialize;

use super::{Planned, Step};
use crate::log::Attachment;

/// Plans by what they cost. Objectives are duration s, root mean square jerk rad/s³ and root mean square power W.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Front {
    /// Title of the task.
    pub title: String,
    /// Objectives of plans of which none is better than another in everything, `[plans]`.
    pub plans: Vec<[f64; 3]>,
    /// Objectives of the fastest (A), the smoothest (B) and that of least power (C).
    pub best: Option<[[f64; 3]; 3]>,
    /// Objectives of the plan to run.
    pub chosen: [f64; 3],
    /// Course of the search; empty where it is not known.
    pub convergence: Vec<Step>,
}

/// The document's format; others are not ours.
const FORMAT: &str = "hydrotrace.plan.v1";
/// Plans of a document beyond this are not shown.
const MOST: usize = 5000;

#[derive(Deserialize)]
struct Document {
    title: String,
    front: Vec<Objectives>,
    best: Option<[usize; 3]>,
    chosen: Objectives,
    #[serde(default)]
    convergence: Vec<Step>,
}

#[derive(Deserialize)]
struct Objectives {
    duration_s: f64,
    rms_jerk_rad_s3: f64,
    rms_power_w: f64,
}

impl Objectives {
    fn array(&self) -> [f64; 3] {
        [self.duration_s, self.rms_jerk_rad_s3, self.rms_power_w]
    }
}

impl Front {
    /// Of a search.
    pub fn of(title: &str, planned: &Planned) -> Self {
        Self {
            title: title.to_owned(),
            plans: planned.front.iter().map(|plan| plan.objectives.as_array()).collect(),
            best: Some([0, 1, 2].map(|k| planned.best[k].objectives.as_array())),
            chosen: planned.chosen.objectives.as_array(),
            convergence: planned.convergence.clone(),
        }
    }

    /// Of a document stored in a log; `None` if it is not one of ours, an error if it is and is broken.
    pub fn read(file: &Attachment) -> Option<Result<Self, serde_json::Error>> {
        let value: serde_json::Value = serde_json::from_slice(&file.data).ok()?;
        (value["format"] == FORMAT).then(|| serde_json::from_value(value).map(Self::of_document))
    }

    fn of_document(document: Document) -> Self {
        let plans: Vec<[f64; 3]> = document.front.iter().take(MOST).map(Objectives::array).collect();
        let [a, b, c] = document.best.unwrap_or([usize::MAX; 3]).map(|place| plans.get(place).copied());
        Self {
            title: document.title,
            best: a.zip(b).zip(c).map(|((a, b), c)| [a, b, c]),
            chosen: document.chosen.array(),
            convergence: document.convergence.into_iter().take(MOST).collect(),
            plans,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> Attachment {
        let data = text.as_bytes().to_vec();
        Attachment { name: "plan.json".into(), media_type: "application/json".into(), data }
    }

    #[test]
    fn the_front_of_a_document_is_read_and_broken_ones_are_told_from_foreign_ones() {
        let plan = r#"{"duration_s": 2, "rms_jerk_rad_s3": 3, "rms_power_w": 4}"#;
        let text = |best: &str| {
            format!(
                r#"{{"format": "{FORMAT}", "title": "t", "front": [{plan}], "best": {best}, "chosen": {plan}}}"#
            )
        };
        let front = Front::read(&file(&text("[0, 0, 0]"))).unwrap().unwrap();
        assert_eq!((front.plans.as_slice(), front.chosen), ([[2.0, 3.0, 4.0]].as_slice(), [2.0, 3.0, 4.0]));
        assert_eq!(front.best, Some([[2.0, 3.0, 4.0]; 3]));
        assert_eq!(Front::read(&file(&text("[0, 9, 0]"))).unwrap().unwrap().best, None);
        assert!(Front::read(&file(&text("\"x\""))).unwrap().is_err());
        assert!(Front::read(&file("{\"plan\": 1}")).is_none());
        assert!(Front::read(&file("no json")).is_none());
    }
}
