//! What only the columns together tell: which of two is the plan, and which words of their names are of no joint.

use std::collections::BTreeSet;

use super::{
    Quantity, Role,
    head::Head,
    label::Label,
    word::{Meaning, words},
};
use crate::{
    log::last_part::{alike, pairs},
    remark::{Code, Remarks},
    text::shell_word,
};

/// What a column seems to be.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub(super) column: usize,
    pub(super) role: Role,
    pub(super) quantity: Quantity,
    pub(super) key: String,
    pub(super) joint: String,
    /// Whether the caller or a word of the header says the role.
    pub(super) stated: bool,
}

/// Columns that may be of joints, among which another may be of the other side of the same one.
pub(super) struct Partners<'a> {
    labels: Vec<&'a Label>,
    /// Whether some joint has both sides under one name.
    named_alike: bool,
}

impl<'a> Partners<'a> {
    pub(super) fn of(labels: &'a [Label], columns: Vec<usize>) -> Self {
        let labels: Vec<&Label> = columns.into_iter().map(|column| &labels[column]).collect();
        let both = |a: &Label, b: &Label| a.key == b.key && are_two_sides(a, b);
        let named_alike = labels.iter().any(|a| labels.iter().any(|b| both(a, b)));
        Self { labels, named_alike }
    }

    /// Whether one has the name of `label`, or, where no joint has both sides, the last part of it.
    pub(super) fn has_one(&self, label: &Label) -> bool {
        let same = |other: &Label| other.key == label.key && other.role != label.role;
        let near = |other: &Label| are_two_sides(other, label) && alike(&other.key, &label.key);
        self.labels.iter().any(|other| same(other) || !self.named_alike && near(other))
    }
}

fn are_two_sides(a: &Label, b: &Label) -> bool {
    a.role.is_some() && b.role.is_some() && a.role != b.role
}

/// Words by which the name of a file says that a plan is in it, and that something else is.
const PLANS: [&str; 7] = ["plan", "planned", "soll", "sollwerte", "setpoint", "setpoints", "desired"];
const OTHERS: [&str; 30] = [
    "ist", "istwerte", "actual", "measured", "measurement", "measurements", "meas", "messung", "messungen",
    "messwerte", "gemessen", "run", "log", "trace", "rec", "record", "recorded", "recording", "execution",
    "executed", "response", "state", "states", "test", "sim", "simulated", "result", "results", "feedback",
    "joined",
];

/// Whether a file is called a plan.
pub(super) fn names_a_plan(name: &str) -> bool {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_lowercase();
    let says = |list: &[&str]| stem.split(|c: char| !c.is_alphabetic()).any(|word| list.contains(&word));
    says(&PLANS) && !says(&OTHERS)
}

/// A column that says neither plan nor measurement, beside a measured one of the same joint, is the plan where nothing
/// else is: `Boom.Position` beside `Boom.ActualPosition`.
pub(super) fn plan_beside_measured(head: &Head, drafts: &mut [Draft], remarks: &mut Remarks) {
    let mut found = Vec::new();
    for (at, bare) in drafts.iter().enumerate().filter(|(_, draft)| !draft.stated) {
        let same = |other: &&Draft| other.key == bare.key && other.quantity == bare.quantity;
        let mut others = drafts.iter().enumerate().filter(|(index, other)| *index != at && same(other));
        let measured = others.next().filter(|(_, other)| other.stated && other.role == Role::Measured);
        let Some((_, measured)) = measured.filter(|_| others.next().is_none()) else { continue };
        if head.sample.iter().any(|row| row.get(bare.column) != row.get(measured.column)) {
            found.push((at, measured.column));
        }
    }
    if let Some((bare, measured)) = found.first() {
        let message = format!(
            "columns such as {:?}, taken as the plan because {:?} stands beside; else say --planned JOINT=COLUMN,...",
            head.names[drafts[*bare].column], head.names[*measured]
        );
        remarks.add(Code::Guessed, found.len() as u64, message);
    }
    for (at, _) in found {
        (drafts[at].role, drafts[at].stated) = (Role::Planned, true);
    }
}

/// Letters of a position beside which `v` is the speed of the same joint.
const PLACES: [&str; 3] = ["s", "q", "phi"];

/// Columns that only a letter tells from the positions of a joint, `J1 v_soll` beside `J1 s_soll`, are its speeds, and left out.
pub(super) fn without_speeds(
    head: &Head,
    drafts: &mut Vec<Draft>,
    given: impl Fn(usize) -> bool,
    remarks: &mut Remarks,
) {
    let position = |draft: &Draft| draft.quantity == Quantity::Position;
    let of_speed = |draft: &Draft| -> Option<(usize, String)> {
        let parts: Vec<&str> = draft.key.split('_').collect();
        let at = parts.iter().position(|part| *part == "v")?;
        let beside = |place: &str| {
            let mut own = parts.clone();
            own[at] = place;
            own.retain(|part| !part.is_empty());
            let key = own.join("_");
            let found = drafts
                .iter()
                .find(|other| other.key == key && other.role == draft.role && position(other))?;
            Some((draft.column, found.joint.clone()))
        };
        PLACES.into_iter().chain([""]).find_map(beside)
    };
    let found: Vec<(usize, String)> =
        drafts.iter().filter(|draft| position(draft) && !given(draft.column)).filter_map(of_speed).collect();
    let Some((first, joint)) = found.first() else { return };
    let message = format!(
        "columns such as {:?}, taken for speeds of {joint} and left out; else say what they are with --planned JOINT=COLUMN,... \
         --measured JOINT=COLUMN,..., or --planned-velocity and --measured-velocity",
        head.names[*first]
    );
    remarks.add(Code::Guessed, found.len() as u64, message);
    drafts.retain(|draft| found.iter().all(|(column, _)| draft.column != *column));
}

/// Words of columns that are filtered, and of such that are not.
const FILTERED: [&str; 5] = ["filtered", "filt", "smoothed", "smooth", "gefiltert"];
const RAW: [&str; 3] = ["raw", "unfiltered", "roh"];

fn says(label: &Label, list: &[&str]) -> bool {
    label.words.iter().any(|word| list.contains(&word.as_str()))
}

/// The words of a column besides these.
fn others(label: &Label) -> Vec<&String> {
    let is_other = |word: &&String| !FILTERED.contains(&word.as_str()) && !RAW.contains(&word.as_str());
    label.words.iter().filter(is_other).collect()
}

/// Filtered columns beside measured ones of the same joint in use, `pos_filt1` beside `pos_meas1`, are no joints of their own, and left out.
pub(super) fn without_filtered(
    head: &Head,
    labels: &[Label],
    drafts: &mut Vec<Draft>,
    given: impl Fn(usize) -> bool,
    remarks: &mut Remarks,
) {
    let joint = |column: usize| {
        let says_no_side =
            |word: &&String| !words(word).iter().any(|one| matches!(one.meaning, Meaning::Role(_)));
        others(&labels[column]).into_iter().filter(says_no_side).collect::<Vec<_>>()
    };
    let filtered = |draft: &Draft| says(&labels[draft.column], &FILTERED);
    let of_side = |draft: &Draft, other: &Draft| {
        draft.role == Role::Measured && other.role == Role::Measured && draft.quantity == other.quantity
    };
    let beside = |draft: &Draft| {
        let is = |other: &&Draft| {
            of_side(draft, other) && !filtered(other) && joint(other.column) == joint(draft.column)
        };
        let other = drafts.iter().find(is).filter(|_| filtered(draft) && !given(draft.column))?;
        Some((draft.column, other.column))
    };
    let found: Vec<(usize, usize)> = drafts.iter().filter_map(beside).collect();
    let Some((left, used)) = found.first() else { return };
    let message = format!(
        "columns such as {:?} are filtered, and left out for those such as {:?}: delays would be those of the filter, too",
        head.names[*left], head.names[*used]
    );
    remarks.add(Code::Ambiguous, found.len() as u64, message);
    drafts.retain(|draft| found.iter().all(|(column, _)| draft.column != *column));
}

/// Says that measured columns in use are filtered, where others are not: a filter is a delay.
pub(super) fn remark_filtered(
    head: &Head,
    labels: &[Label],
    measured: &[(usize, &str)],
    remarks: &mut Remarks,
) {
    let says = |column: usize, list: &[&str]| says(&labels[column], list);
    let others = |column: usize| others(&labels[column]);
    let found =
        measured.iter().filter(|(column, _)| says(*column, &FILTERED)).filter_map(|(column, joint)| {
            let is_raw = |raw: &usize| {
                says(*raw, &RAW)
                    && others(*raw) == others(*column)
                    && labels[*raw].unit == labels[*column].unit
            };
            let raw = (0..labels.len()).find(is_raw)?;
            Some((*column, format!("{joint}={}", head.names[raw])))
        });
    let (columns, raw): (Vec<usize>, Vec<String>) = found.unzip();
    let Some(first) = columns.first() else { return };
    let message = format!(
        "measured columns that are filtered, such as {:?}, although others are not: delays are those of the filter, too; import \
         with --measured {}",
        head.names[*first],
        shell_word(&raw.join(","))
    );
    remarks.add(Code::Ambiguous, columns.len() as u64, message);
}

/// Where no joint has plan and measurement, words that all columns of a side share are of that side, not of a joint:
/// `Boom S-0-0047 value`, `Boom S-0-0051 value 1`.
pub(super) fn without_shared_words(drafts: &mut [Draft]) {
    // A command counts as the plan's, as in the names of its columns.
    let of_plan = |draft: &Draft| draft.role != Role::Measured;
    let positions = |plan: bool| {
        let wanted = move |draft: &&Draft| draft.quantity == Quantity::Position && of_plan(draft) == plan;
        drafts.iter().filter(wanted).map(|draft| draft.key.as_str())
    };
    let [plan, measured] = [true, false].map(|plan| positions(plan).collect::<Vec<_>>());
    let paired = plan.iter().any(|key| measured.contains(key));
    if plan.len() < 2 || measured.len() < 2 || paired {
        return;
    }
    let shared = [&measured, &plan].map(|keys| shared_parts(keys));
    let short = |name: &str, plan: bool| {
        let own = |part: &&str| !shared[usize::from(plan)].contains(&part.to_lowercase());
        let left = name.split('_').filter(own).collect::<Vec<_>>().join("_");
        let counts = !left.is_empty() && left.bytes().all(|byte| byte.is_ascii_digit());
        if counts { format!("joint_{left}") } else { left }
    };
    let names = |keys: &[&str], plan: bool| keys.iter().map(|key| short(key, plan)).collect::<BTreeSet<_>>();
    let [plan_names, measured_names] = [names(&plan, true), names(&measured, false)];
    let distinct = plan_names.len() == plan.len() && measured_names.len() == measured.len();
    if distinct && plan_names.is_subset(&measured_names) && !measured_names.contains("") {
        let renamed: Vec<[String; 2]> = drafts
            .iter()
            .map(|draft| [&draft.key, &draft.joint].map(|name| short(name, of_plan(draft))))
            .collect();
        for (draft, [key, joint]) in drafts.iter_mut().zip(renamed) {
            (draft.key, draft.joint) = (key, joint);
        }
    }
}

/// Where no joint has plan and measurement, names that differ only by what stands before or after are of one joint, if each
/// of one side has exactly one such partner; the plan says what it is called.
pub(super) fn by_last_part(drafts: &mut [Draft], remarks: &mut Remarks) {
    let of = |measured: bool| {
        let side = drafts.iter().filter(move |draft| {
            draft.quantity == Quantity::Position && (draft.role == Role::Measured) == measured
        });
        let keys: BTreeSet<&str> = side.map(|draft| draft.key.as_str()).collect();
        keys.into_iter().collect::<Vec<_>>()
    };
    let [plan, measured] = [of(false), of(true)];
    if plan.iter().any(|key| measured.contains(key)) {
        return;
    }
    let Some(names) = pairs(&plan, &measured) else { return };
    let called = |key: &str| drafts.iter().find(|draft| draft.key == key).map(|draft| draft.joint.clone());
    let names: Vec<(String, String, String)> =
        names.into_iter().filter_map(|(came, plan)| Some((called(&plan)?, plan, came))).collect();
    let told: Vec<String> = names.iter().map(|(joint, _, came)| format!("{joint} with {came}")).collect();
    for draft in drafts.iter_mut().filter(|draft| draft.role == Role::Measured) {
        if let Some((joint, key, _)) = names.iter().find(|(_, _, came)| *came == draft.key) {
            (draft.key, draft.joint) = (key.clone(), joint.clone());
        }
    }
    let message = format!(
        "columns of plan and measurement have no name of a joint in common; paired by the last part of their names: {}; else \
         say --planned JOINT=COLUMN,... and --measured JOINT=COLUMN,...",
        told.join(", ")
    );
    remarks.add(Code::Guessed, told.len() as u64, message);
}

/// Options that pair plan and measurement in the order of their numbers, if those of one side begin one later than of the other:
/// `des_q0` to `des_q2` beside `q1` to `q3`. By their names all but one would be paired, and each with its neighbour.
pub(super) fn numbered_apart(head: &Head, [plan, measured]: [&[&Draft]; 2]) -> Option<Vec<String>> {
    let numbered = |side: &[&Draft]| {
        let parts = side.iter().map(|draft| {
            let name = draft.key.trim_end_matches(|c: char| c.is_ascii_digit());
            Some((draft.key[name.len()..].parse::<u32>().ok()?, name.to_owned(), draft.column))
        });
        let mut parts = parts.collect::<Option<Vec<_>>>()?;
        parts.sort_unstable();
        let follows = |two: &[(u32, String, usize)]| two[1].0 == two[0].0 + 1 && two[1].1 == two[0].1;
        parts.windows(2).all(follows).then_some(parts)
    };
    let [plan, measured] = [numbered(plan)?, numbered(measured)?];
    let apart = plan.len() == measured.len()
        && plan.len() > 1
        && plan[0].1 == measured[0].1
        && plan[0].0.abs_diff(measured[0].0) == 1;
    let named = |(option, side): (&str, Vec<(u32, String, usize)>)| {
        let names = side.iter().map(|(.., column)| &head.names[*column]);
        let pairs = names.enumerate().map(|(k, name)| format!("joint_{}={name}", k + 1));
        format!("{option} {}", shell_word(&pairs.collect::<Vec<_>>().join(",")))
    };
    apart.then(|| [("--planned", plan), ("--measured", measured)].map(named).to_vec())
}

/// Parts between underscores that all names have.
fn shared_parts(names: &[&str]) -> BTreeSet<String> {
    let parts = |name: &&str| name.split('_').map(str::to_lowercase).collect::<BTreeSet<_>>();
    let shared = names.iter().map(parts).reduce(|shared, parts| &shared & &parts);
    shared.unwrap_or_default()
}
