//! Numbers by objective: what a plan costs, ceilings, weights.

use std::ops::{Index, IndexMut};

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{IgnoredAny, MapAccess, Visitor},
    ser::SerializeMap,
};

use super::Objective;
use crate::remark::{Code, Remarks};

/// A ceiling this many times above what is needed binds nothing.
const INACTIVE: f64 = 10.0;

/// A number for each objective; infinite where it is not known, or of a ceiling where there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByObjective([f64; Objective::COUNT]);

/// Costs of a plan.
pub type Objectives = ByObjective;

/// Ceilings on the objectives (paper, section V: "f1 must be less than 40, ..."); infinite for none.
pub type Ceilings = ByObjective;

/// Relative weights of the objectives of a plan, each scaled by its range over the front; not negative, not all zero.
pub type Weights = ByObjective;

impl ByObjective {
    /// Nothing known; as ceilings, no ceilings.
    pub const NONE: Self = Self([f64::INFINITY; Objective::COUNT]);

    /// Zero for each.
    pub const ZERO: Self = Self([0.0; Objective::COUNT]);

    /// The same but for one.
    pub const fn with(mut self, objective: Objective, value: f64) -> Self {
        self.0[objective as usize] = value;
        self
    }

    /// The same but for the objectives of a plan.
    pub fn map_plan(mut self, of: impl Fn(Objective) -> f64) -> Self {
        for &objective in Objective::OF_PLAN {
            self[objective] = of(objective);
        }
        self
    }

    /// From the values of the first objectives, in the order of the table; nothing is known of the others.
    pub fn from_slice(values: &[f64]) -> Self {
        let mut all = Self::NONE;
        all.0.iter_mut().zip(values).for_each(|(to, from)| *to = *from);
        all
    }

    /// Values of the objectives of a plan, in the order of the table.
    pub fn plan(&self) -> &[f64] {
        &self.0[..Objective::OF_PLAN.len()]
    }

    /// Those that are known, or set.
    pub fn known(&self) -> impl Iterator<Item = (Objective, f64)> {
        Objective::ALL.into_iter().zip(self.0).filter(|(_, value)| value.is_finite())
    }

    /// Whether these can be weights of a plan: not negative, finite, not all zero.
    pub fn are_weights(&self) -> bool {
        let own = self.plan();
        own.iter().all(|w| w.is_finite() && *w >= 0.0) && own.iter().sum::<f64>() > 0.0
    }

    /// Remarks on ceilings that bind nothing: more than ten times the largest value that any plan of the front has.
    pub fn remark_inactive(&self, largest: &Objectives, remarks: &mut Remarks) {
        for (objective, ceiling) in
            self.known().filter(|(objective, bound)| *bound > INACTIVE * largest[*objective])
        {
            let message = format!(
                "{} is {:.0} times above the largest value of any plan found: it binds nothing; is its unit right?",
                objective.row().ceiling,
                ceiling / largest[objective]
            );
            remarks.add(Code::InactiveBound, 1, message);
        }
    }

    /// Whether none is above its ceiling.
    pub fn within(&self, ceilings: &Ceilings) -> bool {
        self.plan().iter().zip(ceilings.plan()).all(|(value, ceiling)| value <= ceiling)
    }
}

impl Index<Objective> for ByObjective {
    type Output = f64;

    fn index(&self, objective: Objective) -> &f64 {
        &self.0[objective as usize]
    }
}

impl IndexMut<Objective> for ByObjective {
    fn index_mut(&mut self, objective: Objective) -> &mut f64 {
        &mut self.0[objective as usize]
    }
}

impl Serialize for ByObjective {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (objective, value) in self.known() {
            map.serialize_entry(objective.row().key, &value)?;
        }
        map.end()
    }
}

/// Documents may lack an objective that is newer than they are; all but those of the table are left alone.
impl<'de> Deserialize<'de> for ByObjective {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Keys)
    }
}

struct Keys;

impl<'de> Visitor<'de> for Keys {
    type Value = ByObjective;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("objectives by their keys")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<ByObjective, A::Error> {
        let mut all = ByObjective::NONE;
        while let Some(key) = map.next_key::<String>()? {
            match Objective::ALL.into_iter().find(|objective| objective.row().key == key) {
                Some(objective) => all[objective] = map.next_value()?,
                None => drop(map.next_value::<IgnoredAny>()?),
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
impl schemars::JsonSchema for ByObjective {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Objectives".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let mut schema = super::objective::schema(|row| row.key);
        let keys: Vec<&str> = Objective::OF_PLAN.iter().map(|objective| objective.row().key).collect();
        schema.insert("required".into(), keys.into());
        schema
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ceiling_that_binds_nothing_gets_a_remark() {
        let ceilings = Ceilings::NONE.with(Objective::Duration, 40.0).with(Objective::RmsJerk, 17.0);
        let mut remarks = Remarks::default();
        ceilings.remark_inactive(&Objectives::from_slice(&[38.0, 0.03, 100.0]), &mut remarks);
        assert_eq!(remarks.as_slice().len(), 1);
        assert!(remarks.as_slice()[0].message.starts_with("max_rms_jerk_deg_s3 is 567 times"));
    }

    #[test]
    fn known_values_survive_a_document_and_unknown_ones_stay_out_of_it() {
        let values = Objectives::from_slice(&[2.0, 3.0, 4.0]);
        let text = serde_json::to_string(&values).unwrap();
        assert_eq!(text, r#"{"duration_s":2.0,"rms_jerk_rad_s3":3.0,"rms_power_w":4.0}"#);
        assert_eq!(serde_json::from_str::<Objectives>(&text).unwrap(), values);
        assert!(serde_json::from_str::<Objectives>(r#"{"duration_s": "x"}"#).is_err());
    }
}
