//! What a plot shows, whatever draws it: the script on a screen, or a picture on paper.

use std::borrow::Cow;

use plotters::style::RGBColor;
use serde::Serialize;

/// Panels above one another that share their horizontal axis.
#[derive(Debug, Clone, Default, Serialize)]
pub(in crate::render) struct Chart {
    pub(in crate::render) title: String,
    /// What to know of it, in a few numbers.
    pub(in crate::render) note: String,
    pub(in crate::render) x_label: Cow<'static, str>,
    /// Horizontal coordinates, which series point into.
    pub(in crate::render) xs: Vec<Vec<f64>>,
    /// Range of the horizontal axis, where several charts are to compare; otherwise that of the coordinates.
    pub(in crate::render) x_range: Option<[f64; 2]>,
    pub(in crate::render) panels: Vec<Panel>,
    /// Stretches that are shaded.
    pub(in crate::render) bands: Vec<Band>,
    /// Plots of one group zoom and point together; those without one stand alone.
    pub(in crate::render) group: Option<&'static str>,
    /// Height on the screen, pixels.
    pub(in crate::render) height: u32,
    pub(in crate::render) size: Size,
}

impl Chart {
    /// Points with names, across and up, over a guide from corner to corner.
    pub(in crate::render) fn against(
        [across, up]: [String; 2],
        [guide, point]: [&str; 2],
        ends: [f64; 2],
        points: Vec<(String, [f64; 2])>,
    ) -> Self {
        let (names, places): (_, Vec<[f64; 2]>) = points.into_iter().unzip();
        let [x, y] = [0, 1].map(|k| places.iter().map(|place| place[k]).collect());
        let points = Series::of(point, Role::Point, 0, y).named(names);
        let series = vec![Series::of(guide, Role::Guide, 1, ends.to_vec()), points];
        Self {
            x_label: across.into(),
            xs: vec![x, ends.to_vec()],
            x_range: Some(ends),
            panels: vec![Panel { range: Some(ends), ..Panel::of(up, 1.0, series) }],
            size: Size::Half,
            ..Self::default()
        }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::render) enum Size {
    #[default]
    Wide,
    /// Two beside each other.
    Half,
    /// Small, one of many: no legend, few ticks, no zoom.
    Tile,
}

/// One vertical axis.
#[derive(Debug, Clone, Default, Serialize)]
pub(in crate::render) struct Panel {
    pub(in crate::render) label: String,
    pub(in crate::render) series: Vec<Series>,
    pub(in crate::render) share: f64,
    /// Range of the axis, where several charts are to compare; otherwise that of the values.
    pub(in crate::render) range: Option<[f64; 2]>,
}

impl Panel {
    /// Whose range is that of the values.
    pub(in crate::render) fn of(label: impl Into<String>, share: f64, series: Vec<Series>) -> Self {
        Self { label: label.into(), series, share, range: None }
    }
}

/// Values over one of the chart's horizontal coordinates; not-a-number lifts the pen.
#[derive(Debug, Clone, Serialize)]
pub(in crate::render) struct Series {
    pub(in crate::render) name: String,
    pub(in crate::render) role: Role,
    /// Which of the chart's horizontal coordinates.
    pub(in crate::render) x: usize,
    pub(in crate::render) y: Vec<f64>,
    /// A name for each point, where points have some.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(in crate::render) names: Vec<String>,
}

impl Series {
    /// Values over one of the chart's horizontal coordinates, whose points have no names.
    pub(in crate::render) fn of(name: impl Into<String>, role: Role, x: usize, y: Vec<f64>) -> Self {
        Self { name: name.into(), role, x, y, names: Vec::new() }
    }

    pub(in crate::render) fn named(self, names: Vec<String>) -> Self {
        Self { names, ..self }
    }
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(in crate::render) struct Band {
    pub(in crate::render) from: f64,
    pub(in crate::render) to: f64,
    pub(in crate::render) shade: Shade,
}

/// What a stretch is shaded for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::render) enum Shade {
    /// The joint has not answered yet.
    Late,
    /// It never does.
    Never,
    /// A transition.
    Window,
}

impl Shade {
    pub(in crate::render) const ALL: [Self; 3] = [Self::Late, Self::Never, Self::Window];

    /// In a legend, and in the sheet of styles.
    pub(in crate::render) fn names(self) -> [&'static str; 2] {
        match self {
            Self::Late => ["not yet answered", "late"],
            Self::Never => ["never answered", "never"],
            Self::Window => ["transition", "window"],
        }
    }

    /// On paper, and how much of it.
    pub(in crate::render) fn colour(self) -> (RGBColor, f64) {
        match self {
            Self::Late => (RGBColor(232, 160, 32), 0.45),
            Self::Never => (RGBColor(178, 58, 0), 0.3),
            Self::Window => (RGBColor(232, 160, 32), 0.13),
        }
    }
}

/// What a series is, and so how it looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::render) enum Role {
    /// A broad pale line under the others.
    Planned,
    Measured,
    Error,
    /// Before a change; after it, errors look as measured.
    Before,
    /// What was sent to the machine: dashed.
    Command,
    /// Many points.
    Point,
    /// Few points that are named beside them.
    Named,
    /// A line that only helps to compare.
    Guide,
    /// An edge of a shaded area, which lies between two of them in one panel.
    Band,
}

impl Role {
    /// Whether points are drawn, not lines.
    pub(in crate::render) fn dots(self) -> bool {
        matches!(self, Self::Point | Self::Named)
    }

    /// On paper; the sheet of styles has those of screens. Blue, orange and greys are told apart by colour-blind
    /// readers (Okabe and Ito 2008).
    pub(in crate::render) fn colour(self) -> RGBColor {
        match self {
            Self::Planned => RGBColor(185, 190, 197),
            Self::Measured | Self::Point => RGBColor(0, 98, 166),
            Self::Error | Self::Named => RGBColor(196, 78, 0),
            Self::Before => RGBColor(140, 146, 154),
            Self::Command => RGBColor(138, 79, 176),
            Self::Guide => RGBColor(160, 165, 171),
            Self::Band => RGBColor(197, 219, 236),
        }
    }

    /// Width of its line on paper, or radius of its points.
    pub(in crate::render) fn width_mm(self) -> f64 {
        match self {
            Self::Planned => 0.8,
            Self::Named => 0.9,
            Self::Before | Self::Command => 0.4,
            Self::Point => 0.45,
            Self::Guide => 0.2,
            Self::Band => 2.0,
            Self::Measured | Self::Error => 0.25,
        }
    }
}

impl Chart {
    pub(in crate::render) fn is_tile(&self) -> bool {
        self.size == Size::Tile
    }

    pub(in crate::render) fn span(&self) -> [f64; 2] {
        self.x_range.unwrap_or_else(|| self.extent())
    }

    fn extent(&self) -> [f64; 2] {
        span(self.xs.iter().flatten().copied())
    }
}

impl Panel {
    /// Range of the vertical axis, with room at both ends.
    pub(in crate::render) fn span(&self) -> [f64; 2] {
        if let Some(range) = self.range {
            return range;
        }
        let [low, high] = span(self.series.iter().flat_map(|series| &series.y).copied());
        let room = 0.06 * (high - low);
        [low - room, high + room]
    }
}

/// Least and largest finite value, apart from each other even where there is only one.
pub(in crate::render) fn span(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = crate::math::range(values.filter(|value| value.is_finite()));
    match low.partial_cmp(&high) {
        Some(std::cmp::Ordering::Less) => [low, high],
        Some(std::cmp::Ordering::Equal) => [low - 0.5, high + 0.5],
        _ => [0.0, 1.0],
    }
}

/// Decimal places that a plot cannot show more of.
pub(in crate::render) fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

/// Decimals that a plot of speeds, shares and pressures shows, and one of a plan.
pub(in crate::render) fn hundredths(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

/// Millimetres with one decimal.
pub(in crate::render) fn millimetres(m: f64) -> f64 {
    (1e4 * m).round() / 10.0
}

/// Values at places; where the pen is lifted, not-a-number.
pub(in crate::render) fn at<'a>(
    values: &'a [f64],
    places: &'a [Option<usize>],
) -> impl Iterator<Item = f64> + 'a {
    places.iter().map(|place| place.and_then(|i| values.get(i)).copied().unwrap_or(f64::NAN))
}

/// Times at places; where the pen is lifted, that before, so that times ascend.
pub(in crate::render) fn times(t_s: &[f64], places: &[Option<usize>]) -> Vec<f64> {
    let mut last = f64::NAN;
    let time = |place: &Option<usize>| {
        if let Some(t_s) = place.and_then(|i| t_s.get(i)) {
            last = rounded(*t_s);
        }
        last
    };
    places.iter().map(time).collect()
}

/// Charts as JSON that no markup can end: it stands inside a script element.
pub(in crate::render) fn embedded(charts: &[Chart]) -> String {
    // Not-a-number becomes null.
    serde_json::to_string(charts).unwrap_or_else(|_| "[]".to_owned()).replace('<', "\\u003c")
}
