//! What the tool carries, and when.

use super::PlantError;

/// From an instant on the tool carries another mass, which it takes over within
/// `payload_ramp_s`. Changes at or before the start are over when the run starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PayloadChange {
    /// When, s.
    pub at_s: f64,
    /// Mass, kg.
    pub mass_kg: f64,
}

/// Changes in order of time, all finite.
#[derive(Debug, Clone)]
pub(super) struct Payload<'a> {
    changes: &'a [PayloadChange],
    ramp_s: f64,
}

impl<'a> Payload<'a> {
    pub(super) fn new(changes: &'a [PayloadChange], ramp_s: f64) -> Result<Self, PlantError> {
        let mut before_s = f64::NEG_INFINITY;
        for (index, &PayloadChange { at_s, mass_kg }) in changes.iter().enumerate() {
            if !(at_s.is_finite() && at_s >= before_s && mass_kg.is_finite() && mass_kg >= 0.0) {
                return Err(PlantError::Payload { index, mass_kg, at_s });
            }
            before_s = at_s;
        }
        Ok(Self { changes, ramp_s })
    }

    pub(super) fn mass_kg(&self, t_s: f64) -> f64 {
        let mut mass_kg = 0.0;
        for change in self.changes.iter().take_while(|change| change.at_s <= t_s) {
            let since_s = t_s - change.at_s;
            let over = change.at_s <= 0.0 || since_s >= self.ramp_s;
            let share = if over { 1.0 } else { since_s / self.ramp_s };
            mass_kg += share * (change.mass_kg - mass_kg);
        }
        mass_kg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_payload_is_taken_over_within_the_ramp_and_one_at_the_start_is_there() {
        let changes = [(0.0, 4.0), (10.0, 10.0)].map(|(at_s, mass_kg)| PayloadChange { at_s, mass_kg });
        let payload = Payload::new(&changes, 0.8).unwrap();
        let masses = [0.0, 9.9, 10.4, 10.8, 20.0].map(|t_s| payload.mass_kg(t_s));
        for (found, expected) in masses.iter().zip([4.0, 4.0, 7.0, 10.0, 10.0]) {
            assert!((found - expected).abs() < 1e-9, "{masses:?}");
        }
    }

    #[test]
    fn a_negative_mass_is_refused() {
        let changes = [PayloadChange { at_s: 1.0, mass_kg: -2.0 }];
        assert!(matches!(Payload::new(&changes, 0.8), Err(PlantError::Payload { index: 0, .. })));
    }
}
