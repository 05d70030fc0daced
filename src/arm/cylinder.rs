//! A hydraulic cylinder that turns a joint through a triangle of two mounts and the joint, or slides one along itself.

use std::f64::consts::PI;

use super::Linkage;

/// How a cylinder moves its joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// It turns it through a triangle.
    Turns(Linkage),
    /// It slides it: the rod travels so much of what the joint does, negative where it retracts as the joint's position
    /// grows.
    Slides(f64),
}

/// One or several like cylinders side by side, with the pressures they work between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    drive: Drive,
    /// The triangle's sides, m: zero without one.
    sides_m: [f64; 2],
    sense: f64,
    /// Sine and cosine of the triangle's offset.
    offset: (f64, f64),
    /// Travel of the rod by that of a joint that slides: zero with a triangle.
    straight: f64,
    push_area_m2: f64,
    pull_area_m2: f64,
    push_n: f64,
    pull_n: f64,
    /// One over them, 1/N.
    per_push: f64,
    per_pull: f64,
}

/// What is wrong with a cylinder: quantity, what was found, what is expected.
pub(super) type Flaw = (&'static str, String, &'static str);

/// What a joint's state means for its cylinders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuation {
    /// Change of length by joint angle, m/rad, or by the position of a joint that slides; its size is the lever arm,
    /// negative where the joint's positive sense retracts the cylinder.
    pub lever_m: f64,
    /// Speed of the rod, positive while it extends, m/s.
    pub rod_speed_m_s: f64,
    /// What all cylinders of the joint take from the pump, m³/s; not negative.
    pub flow_m3_s: f64,
    /// Force of all cylinders together, positive where they push, N.
    pub force_n: f64,
    /// Force as a share of what supply pressure gives in that direction; not negative.
    pub force_share: f64,
}

impl Cylinder {
    /// Checks the numbers and the triangle over the joint's range.
    pub(super) fn new(
        drive: Drive,
        (bore_m, rod_m, count): (f64, f64, u32),
        (supply_pa, return_pa, efficiency): (f64, f64, f64),
        (lower_rad, upper_rad): (f64, f64),
    ) -> Result<Self, Flaw> {
        let is_length = |(name, value): (&'static str, f64)| {
            let flaw = || (name, value.to_string(), "a length above 0, m");
            if (1e-6..1e3).contains(&value) { Ok(()) } else { Err(flaw()) }
        };
        is_length(("bore_m", bore_m))?;
        if !(rod_m >= 0.0 && rod_m < bore_m) {
            return Err(("rod_m", format!("{rod_m}"), "a diameter below the bore's, m"));
        }
        if !(1..=64).contains(&count) {
            return Err(("cylinders", count.to_string(), "1 to 64"));
        }
        let (sides_m, sense, offset, straight) = match drive {
            Drive::Turns(linkage) => {
                [("a_m", linkage.inner_m), ("b_m", linkage.outer_m)].into_iter().try_for_each(is_length)?;
                if ![-1.0, 1.0].contains(&linkage.sense) {
                    return Err(("angle_sign", linkage.sense.to_string(), "1 or -1"));
                }
                let ends = [lower_rad, upper_rad].map(|q| linkage.offset_rad + linkage.sense * q);
                if !ends.iter().all(|&angle| angle > 1e-3 && angle < PI - 1e-3) {
                    let found = format!("{:.4} to {:.4} rad over the joint's range", ends[0], ends[1]);
                    let expected = "an angle between the mounts within 0 and pi: no dead centre";
                    return Err(("delta_rad", found, expected));
                }
                ([linkage.inner_m, linkage.outer_m], linkage.sense, linkage.offset_rad.sin_cos(), 0.0)
            }
            Drive::Slides(straight) => {
                if !(1e-3..1e3).contains(&straight.abs()) {
                    let expected = "travel of the rod by that of the joint: 1 where it moves it directly";
                    return Err(("rod_per_travel", straight.to_string(), expected));
                }
                ([0.0; 2], 0.0, (0.0, 1.0), straight)
            }
        };
        let area = |diameter: f64| 0.25 * PI * diameter * diameter * f64::from(count);
        let (push_area_m2, pull_area_m2) = (area(bore_m), area(bore_m) - area(rod_m));
        let push_n = efficiency * (supply_pa * push_area_m2 - return_pa * pull_area_m2);
        let pull_n = efficiency * (supply_pa * pull_area_m2 - return_pa * push_area_m2);
        if pull_n.is_nan() || pull_n <= 0.0 {
            return Err(("rod_m", format!("{rod_m}"), "a rod so thin that supply pressure can pull it in"));
        }
        let [per_push, per_pull] = [push_n, pull_n].map(f64::recip);
        Ok(Self {
            drive,
            sides_m,
            sense,
            offset,
            straight,
            push_area_m2,
            pull_area_m2,
            push_n,
            pull_n,
            per_push,
            per_pull,
        })
    }

    /// Length from mount to mount, m, and its change by joint angle, m/rad, from the sine and cosine
    /// of the joint's angle. Of a joint that slides the change by its position alone, the length means nothing.
    /// Without branches, for use in lanes.
    #[inline(always)]
    pub fn length_and_lever(&self, sin: f64, cos: f64) -> (f64, f64) {
        let ([a, b], sense) = (self.sides_m, self.sense);
        let (sin_offset, cos_offset) = self.offset;
        let sin_angle = sin_offset * cos + sense * cos_offset * sin;
        let cos_angle = cos_offset * cos - sense * sin_offset * sin;
        // Equal arms meet in a point; a micrometre keeps the quotient finite there.
        let length_m = (a * a + b * b - 2.0 * a * b * cos_angle).max(1e-12).sqrt();
        (length_m, sense * a * b * sin_angle / length_m + self.straight)
    }

    /// Everything at once, from the sine and cosine of the joint's angle, its speed, rad/s, and its torque, N m.
    ///
    /// A lever below a micrometre, which no posture within the joint's range has, counts as one.
    #[inline(always)]
    pub fn actuation(&self, (sin, cos): (f64, f64), speed_rad_s: f64, torque_nm: f64) -> Actuation {
        let (_, lever_m) = self.length_and_lever(sin, cos);
        let rod_speed_m_s = lever_m * speed_rad_s;
        let area_m2 = if rod_speed_m_s > 0.0 { self.push_area_m2 } else { self.pull_area_m2 };
        let force_n = torque_nm / lever_m.abs().max(1e-6).copysign(lever_m);
        let force_share = force_n.abs() * if force_n > 0.0 { self.per_push } else { self.per_pull };
        let flow_m3_s = area_m2 * rod_speed_m_s.abs();
        Actuation { lever_m, rod_speed_m_s, flow_m3_s, force_n, force_share }
    }

    /// How it moves its joint.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Area of all pistons together on the side without a rod, m².
    pub fn push_area_m2(&self) -> f64 {
        self.push_area_m2
    }

    /// Area of all pistons together on the side of the rod, m².
    pub fn pull_area_m2(&self) -> f64 {
        self.pull_area_m2
    }

    /// Largest push of all cylinders together, N.
    pub fn push_n(&self) -> f64 {
        self.push_n
    }

    /// Largest pull of all cylinders together, N.
    pub fn pull_n(&self) -> f64 {
        self.pull_n
    }
}
