//! Units as people write them into a header, and what they are in SI.

use std::f64::consts::{PI, TAU};

use serde::Serialize;

use crate::units::DEGREE_RAD;

/// Joints with end stops stay within one and a half turns to either side, rad.
pub(super) const FARTHEST_RAD: f64 = 3.0 * std::f64::consts::PI;
/// Joints of arms turn no farther; a number above is of other steps, deg.
pub(super) const FARTHEST_DEG: f64 = 1080.0;

/// The quantity that a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Measure {
    Angle,
    AngularSpeed,
    Length,
    LinearSpeed,
    Time,
    Pressure,
    /// Any other unit that a header states.
    Other,
}

/// A unit: SI = value x `factor`; times are in ns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub(super) name: &'static str,
    pub(super) measure: Measure,
    pub(super) factor: f64,
}

const fn unit(name: &'static str, measure: Measure, factor: f64) -> Unit {
    Unit { name, measure, factor }
}

pub(super) const RADIAN: Unit = unit("rad", Measure::Angle, 1.0);
/// Of components of an orientation, which are read as angles are.
pub(super) const UNITLESS: Unit = unit("1", Measure::Angle, 1.0);
pub(super) const DEGREE: Unit = unit("deg", Measure::Angle, DEGREE_RAD);
pub(super) const REVOLUTION: Unit = unit("rev", Measure::Angle, TAU);
const MILLIMETRE: Unit = unit("mm", Measure::Length, 1e-3);
const CENTIMETRE: Unit = unit("cm", Measure::Length, 1e-2);
pub(super) const METRE: Unit = unit("m", Measure::Length, 1.0);

/// Of clocks of Windows.
pub(super) const FILETIME: Unit = unit("100 ns since 1601", Measure::Time, 100.0);
pub(super) const TICKS: Unit = unit("100 ns since year 1", Measure::Time, 100.0);
/// Of spreadsheets.
pub(super) const EXCEL_DAY: Unit = unit("days since 1899-12-30", Measure::Time, 86_400e9);
/// Of MATLAB: day 719529 is 1970-01-01.
pub(super) const DATENUM: Unit = unit("days since year 0", Measure::Time, 86_400e9);
/// Of archives of Siemens, in a column `Time_ms` beside a date.
pub(super) const ARCHIVE_DAY: Unit = unit("millionths of days since 1899-12-30", Measure::Time, 86_400e3);

/// Units before which a number stands, as `[10 ms]` or `0.1mm`.
const SCALED: [Unit; 11] = [
    unit("0.1 deg", Measure::Angle, 0.1 * DEGREE_RAD),
    unit("0.01 deg", Measure::Angle, 0.01 * DEGREE_RAD),
    unit("0.001 deg", Measure::Angle, 0.001 * DEGREE_RAD),
    unit("pi rad", Measure::Angle, PI),
    unit("0.1 mm", Measure::Length, 1e-4),
    unit("0.01 mm", Measure::Length, 1e-5),
    unit("0.1 s", Measure::Time, 1e8),
    unit("0.01 s", Measure::Time, 1e7),
    unit("0.1 ms", Measure::Time, 1e5),
    unit("10 us", Measure::Time, 1e4),
    unit("100 ns", Measure::Time, 100.0),
];

/// The name of a scale that no program is known to write.
const ODD: &str = "another unit";

/// A unit that is not all that a header says.
pub(super) const ANOTHER: Unit = unit(ODD, Measure::Other, 1.0);

/// Units of other quantities, and, from a place on, counts of what only the machine's maker knows.
const FIRST_COUNT: usize = 16;
const OTHERS: [&str; 30] = [
    "nm", "n m", "n*m", "a", "ma", "v", "mv", "n", "kn", "%", "c", "degc", "l/min", "hz", "pct", "percent",
    "count", "counts", "cnt", "inc", "incr", "increments", "tick", "ticks", "steps", "digits", "lsb", "pu",
    "p.u.", "per unit",
];

/// Spellings, in lower case and with `deg` for the degree sign.
const UNITS: [(&[&str], Unit); 41] = [
    (&["rad", "radian", "radians", "弧度"], RADIAN),
    (
        &[
            "deg", "degree", "degrees", "grad", "grd", "grados", "gradi", "degrés", "graden", "graus",
            "grader", "derece", "град", "градусы", "度", "도",
        ],
        DEGREE,
    ),
    (&["mrad"], unit("mrad", Measure::Angle, 1e-3)),
    (&["mdeg", "millideg"], unit("mdeg", Measure::Angle, 1e-3 * DEGREE_RAD)),
    (&["ddeg", "decideg", "zehntelgrad"], unit("0.1 deg", Measure::Angle, 0.1 * DEGREE_RAD)),
    (&["cdeg", "centideg"], unit("0.01 deg", Measure::Angle, 0.01 * DEGREE_RAD)),
    (&["urad", "µrad", "μrad"], unit("urad", Measure::Angle, 1e-6)),
    (&["arcsec"], unit("arcsec", Measure::Angle, DEGREE_RAD / 3600.0)),
    (&["rev", "revs", "turn", "turns", "umdr", "umdrehung", "umdrehungen", "tours"], REVOLUTION),
    (&["gon"], unit("gon", Measure::Angle, TAU / 400.0)),
    (&["arcmin"], unit("arcmin", Measure::Angle, DEGREE_RAD / 60.0)),
    (&["rad/s", "rad_s", "rads", "radps", "rad/sec", "rad s^-1"], unit("rad/s", Measure::AngularSpeed, 1.0)),
    (
        &["deg/s", "deg_s", "degs", "deg/sec", "dps", "degps", "grad/s"],
        unit("deg/s", Measure::AngularSpeed, DEGREE_RAD),
    ),
    (&["mrad/s", "mrad_s"], unit("mrad/s", Measure::AngularSpeed, 1e-3)),
    (&["rpm", "1/min", "u/min"], unit("rpm", Measure::AngularSpeed, TAU / 60.0)),
    (&["mm", "毫米", "millimetre", "millimetres", "millimeter", "millimeters"], MILLIMETRE),
    (&["cm", "centimetre", "centimetres", "centimeter", "centimeters"], CENTIMETRE),
    (&["m", "metre", "metres", "meter", "meters"], METRE),
    (&["dm"], unit("dm", Measure::Length, 0.1)),
    (&["um", "µm", "μm"], unit("um", Measure::Length, 1e-6)),
    (&["in", "inch", "inches"], unit("in", Measure::Length, 0.0254)),
    (&["ft", "foot", "feet"], unit("ft", Measure::Length, 0.3048)),
    (&["mm/s", "mm_s", "mm/sec"], unit("mm/s", Measure::LinearSpeed, 1e-3)),
    (&["cm/s", "cm_s", "cm/sec"], unit("cm/s", Measure::LinearSpeed, 1e-2)),
    (&["m/s", "m_s", "mps", "m/sec"], unit("m/s", Measure::LinearSpeed, 1.0)),
    (&["s", "秒", "sec", "secs", "seconds", "second"], unit("s", Measure::Time, 1e9)),
    (&["ms", "毫秒", "msec", "msecs", "milliseconds", "millis"], unit("ms", Measure::Time, 1e6)),
    (&["us", "µs", "μs", "usec", "usecs", "microseconds", "micros"], unit("us", Measure::Time, 1e3)),
    (&["ns", "nsec", "nsecs", "nanosec", "nanoseconds", "nanos"], unit("ns", Measure::Time, 1.0)),
    (&["min", "minute", "minutes"], unit("min", Measure::Time, 60e9)),
    (&["h", "hr", "hrs", "hour", "hours"], unit("h", Measure::Time, 3600e9)),
    (&["filetime", "100 ns since 1601"], FILETIME),
    (&["dotnet", ".net ticks", "100 ns since year 1"], TICKS),
    (&["excel", "days since 1899-12-30"], EXCEL_DAY),
    (&["datenum", "days since year 0"], DATENUM),
    (&["pa"], unit("Pa", Measure::Pressure, 1.0)),
    (&["kpa"], unit("kPa", Measure::Pressure, 1e3)),
    (&["mpa"], unit("MPa", Measure::Pressure, 1e6)),
    (&["mbar"], unit("mbar", Measure::Pressure, 100.0)),
    (&["bar"], unit("bar", Measure::Pressure, 1e5)),
    (&["psi"], unit("psi", Measure::Pressure, 6_894.757_293_168)),
];

impl Unit {
    /// The instant from which it counts, ns since 1970; 0 for a unit that says none.
    pub(super) fn zero_ns(self) -> i128 {
        match self {
            FILETIME => -11_644_473_600_000_000_000,
            TICKS => -62_135_596_800_000_000_000,
            EXCEL_DAY | ARCHIVE_DAY => -2_209_161_600_000_000_000,
            DATENUM => -62_167_305_600_000_000_000,
            _ => 0,
        }
    }

    /// Whether a joint may be counted in it, but how far one is only its maker knows: counts, increments, odd scales.
    pub(super) fn is_odd(self) -> bool {
        self.measure == Measure::Other && (self.name == ODD || OTHERS[FIRST_COUNT..].contains(&self.name))
    }

    /// The unit of a speed: this one a second.
    pub(super) fn per_second(self) -> Self {
        parse_unit(&format!("{}/s", self.name)).unwrap_or(self)
    }
}

/// The unit that a text names, if it is one.
pub(super) fn parse_unit(text: &str) -> Option<Unit> {
    let text = text.trim().trim_matches(['[', ']', '(', ')']).trim().to_lowercase();
    // The sign in UTF-8 that was read as an older encoding.
    let text = text.replace("â°", "°").replace(['°', 'º'], "deg");
    let known = UNITS.iter().find(|(spellings, _)| spellings.contains(&text.as_str())).map(|(_, unit)| *unit);
    let other = || OTHERS.iter().find(|other| **other == text).map(|name| unit(name, Measure::Other, 1.0));
    // Values that are so many times the unit.
    let times = || {
        let (name, number) = text.split_once(['*', 'x', '·', '×', ':', '/'])?;
        scale_of((&format!("1/{}", number.trim()), name.trim()))
    };
    known.or_else(other).or_else(|| scaled(&text)).or_else(times)
}

/// A unit behind a number or a fraction of one; one that no program is known to write is another unit.
fn scaled(text: &str) -> Option<Unit> {
    if let Some((power, name)) = power_of_ten(text) {
        return scale_of((&power, name));
    }
    let name = text.find(|c: char| !(c.is_ascii_digit() || ".,/".contains(c))).filter(|at| *at > 0)?;
    scale_of(text.split_at(name))
}

/// A power of ten before a unit, `1e-3 rad` or `10^-3 rad`, as a number, and the unit.
fn power_of_ten(text: &str) -> Option<(String, &str)> {
    let behind = text.strip_prefix("1e").or_else(|| text.strip_prefix("10^"))?;
    let ends = behind.find(|c: char| !(c.is_ascii_digit() || "+-".contains(c)))?;
    let power: i32 = behind.get(..ends)?.parse().ok()?;
    (-9..=9)
        .contains(&power)
        .then(|| (10_f64.powi(power).to_string(), behind.get(ends..).unwrap_or_default()))
}

/// The unit that a number and a unit's name make.
fn scale_of((number, name): (&str, &str)) -> Option<Unit> {
    let (above, below) = number.split_once('/').unwrap_or((number, "1"));
    let [above, below] = [above, below].map(|text| text.replace(',', ".").parse::<f64>().ok());
    scale_by(above? / below?, name.trim_start_matches([' ', '*', 'x', '·']))
}

/// So many of a unit by its name in lower case; what no program is known to write is another unit.
pub(super) fn scale_by(factor: f64, name: &str) -> Option<Unit> {
    let (_, base) = UNITS.iter().find(|(spellings, _)| spellings.contains(&name))?;
    let alike =
        |one: &&Unit| one.measure == base.measure && (one.factor / (factor * base.factor) - 1.0).abs() < 1e-9;
    let bases = UNITS.iter().map(|(_, unit)| unit);
    let mut all = SCALED.iter().chain(bases);
    Some(all.find(alike).copied().unwrap_or(unit(ODD, Measure::Other, 1.0)))
}

/// The unit that ends a name, as in `q1_deg` or `J1_planned_rad_s`, and the name without it.
pub(super) fn split_suffix(name: &str) -> Option<(&str, Unit)> {
    const SUFFIXES: [&str; 71] = [
        "arcsec", "arcmin", "millideg", "centideg", "decideg", "cdeg", "ddeg", "urad", "µrad", "μrad", "um",
        "µm", "μm", "0.1deg", "0.01deg", "0.001deg", "0.1mm", "0.01mm", "rad_s", "deg_s", "mrad_s", "mm_s",
        "cm_s", "m_s", "rad", "deg", "mrad", "mdeg", "mm", "cm", "m", "ms", "us", "ns", "s", "bar", "mbar",
        "pa", "kpa", "mpa", "psi", "°", "º", "min", "minutes", "h", "hours", "sec", "msec", "usec", "nsec",
        "nanosec", "gon", "pct", "percent", "counts", "ticks", "rpm", "dps", "degps", "radps", "mps", "grad",
        "rev", "revs", "turns", "degrees", "radians", "inch", "inches", "ft",
    ];
    let lower = name.to_lowercase();
    let suffix = SUFFIXES.iter().find(|suffix| {
        let stem = lower.strip_suffix(**suffix);
        stem.is_some_and(|stem| {
            ["°", "º"].contains(*suffix) || stem.ends_with(['_', ' ', '.']) && stem.len() > 1
        })
    })?;
    // Lower case may be longer or shorter than the name in some scripts.
    let stem = name.get(..name.len().checked_sub(suffix.len())?)?;
    Some((stem.trim_end_matches(['_', ' ', '.']), parse_unit(suffix)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_a_unit_are_one_unit() {
        for text in ["deg", "[deg]", "(°)", " Degrees ", "[Grad]", "[º]", "graus", "град"] {
            assert_eq!(parse_unit(text), Some(DEGREE), "{text}");
        }
        assert_eq!(parse_unit("°/s").map(|unit| unit.name), Some("deg/s"));
        assert_eq!(parse_unit("soll"), None);
        for (text, name) in [
            ("[1/10 mm]", "0.1 mm"),
            ("0.1deg", "0.1 deg"),
            ("[0,1 ms]", "0.1 ms"),
            ("(1/100 s)", "0.01 s"),
            ("10 ms", "0.01 s"),
            ("[100ns]", "100 ns"),
            ("[deg*10]", "0.1 deg"),
            ("mm x 100", "0.01 mm"),
            ("[deg·10]", "0.1 deg"),
            ("deg × 100", "0.01 deg"),
            ("deg/10", "0.1 deg"),
            ("[1e-3 deg]", "0.001 deg"),
            ("[1E-03 rad]", "mrad"),
            ("10^-3 rad", "mrad"),
            ("1e-2 mm", "0.01 mm"),
            ("1 mm", "mm"),
            ("[7 mm]", "another unit"),
            ("[counts]", "counts"),
            ("1000 ms", "s"),
            ("[ft]", "ft"),
        ] {
            assert_eq!(parse_unit(text).map(|unit| unit.name), Some(name), "{text}");
        }
        assert_eq!(
            (parse_unit("12"), parse_unit("1/0 mm").map(|unit| unit.name)),
            (None, Some("another unit"))
        );
    }

    #[test]
    fn a_unit_may_end_a_name() {
        let split = |name| split_suffix(name).map(|(stem, unit)| (stem, unit.name));
        assert_eq!(split("q1_deg"), Some(("q1", "deg")));
        assert_eq!(split("J1_planned_rad_s"), Some(("J1_planned", "rad/s")));
        assert_eq!(split("stamp_ns"), Some(("stamp", "ns")));
        assert_eq!(split("boom_set_mm"), Some(("boom_set", "mm")));
        assert_eq!(split("boom_measured_m_s"), Some(("boom_measured", "m/s")));
        assert_eq!(split("setpoint_rpm"), Some(("setpoint", "rpm")));
        assert_eq!(split("boom_degps"), Some(("boom", "deg/s")));
        assert_eq!(split("boom_mps"), Some(("boom", "m/s")));
        assert_eq!(split("boom_PV_0.1deg"), Some(("boom_PV", "0.1 deg")));
        assert_eq!(split("boom_set_centideg"), Some(("boom_set", "0.01 deg")));
        assert_eq!(split("boom_set_µrad"), Some(("boom_set", "urad")));
        assert_eq!(split("Drehwerk_Grad"), Some(("Drehwerk", "deg")));
        assert_eq!(split("axes"), None);
        assert_eq!(split("İ_deg").map(|(stem, _)| stem), Some("İ"));
    }
}
