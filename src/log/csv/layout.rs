//! Which column is which joint's angle or speed, of plan, measurement or command.

use std::collections::BTreeSet;

use super::{
    CsvError, CsvOptions, Quantity, Role, Separator,
    by_meaning::plan_by_error,
    column::{find, present},
    head::Head,
    label::{Label, PLACE, QUATERNION, is_place, label},
    offered::offered,
    options::option,
    pairing::{
        Draft, Partners, by_last_part, numbered_apart, plan_beside_measured, remark_filtered,
        without_filtered, without_shared_words, without_speeds,
    },
    repeats::drop_repeats,
    supply::of_supply,
    unit::{Measure, Unit},
    word::{Meaning, words},
};
use crate::{
    log::write::SUPPLY,
    remark::{Code, Remarks},
    suggest::nearest,
};

/// One column in use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Use {
    pub(super) column: usize,
    pub(super) role: Role,
    pub(super) quantity: Quantity,
    /// Index into the joints.
    pub(super) joint: usize,
}

/// One column kept as another quantity of a joint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Interface {
    pub(super) name: String,
    pub(super) column: usize,
    pub(super) joint: usize,
}

/// The use of every column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) joints: Vec<String>,
    pub(super) uses: Vec<Use>,
    pub(super) interfaces: Vec<Interface>,
}

pub(super) fn lay_out(
    (text, separator): (&[u8], Separator),
    head: &Head,
    labels: &[Label],
    taken: &[usize],
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Result<Layout, CsvError> {
    let mut drafts = Vec::new();
    for ((role, quantity), columns) in &options.columns {
        for (joint, name) in columns {
            let column = find(name, option(*role, *quantity), &head.names)?;
            let (key, joint) = (joint.to_lowercase(), joint.clone());
            drafts.push(Draft { column, role: *role, quantity: *quantity, key, joint, stated: true });
        }
    }
    let explicit: BTreeSet<usize> =
        drafts.iter().map(|draft| draft.column).chain(taken.iter().copied()).collect();
    let free = |column: &usize| head.named && labels[*column].is_joint && !explicit.contains(column);
    let partners = Partners::of(labels, (0..labels.len()).filter(free).collect());
    for column in (0..labels.len()).filter(free) {
        let label = &labels[column];
        let (role, quantity) =
            (label.role.unwrap_or(Role::Measured), label.quantity.unwrap_or(Quantity::Position));
        // What turns at a speed may move what slides: a spindle.
        let drives = |other: &Label| other.key == label.key && measures(other, Measure::Length);
        if measures(label, Measure::AngularSpeed) && labels.iter().any(drives) {
            continue;
        }
        let paired = drafts.iter().any(|draft| draft.key == label.key) || partners.has_one(label);
        if options.columns.contains_key(&(role, quantity)) || label.is_weak && !paired {
            continue;
        }
        let (key, joint) = (label.key.clone(), label.joint.clone());
        drafts.push(Draft { column, role, quantity, key, joint, stated: label.role.is_some() });
    }
    if options.as_plan && drafts.iter().all(|draft| !draft.stated) {
        for draft in &mut drafts {
            draft.role = Role::Planned;
        }
    }
    without_orientation(head, &mut drafts, remarks)?;
    plan_beside_measured(head, &mut drafts, remarks);
    drop_repeats((text, separator), head, labels, &mut drafts, remarks)?;
    without_speeds(head, &mut drafts, |column| explicit.contains(&column), remarks);
    without_filtered(head, labels, &mut drafts, |column| explicit.contains(&column), remarks);
    without_shared_words(&mut drafts);
    by_last_part(&mut drafts, remarks);
    let joints = joints(head, labels, &drafts, remarks)?;
    let place = |key: &str| joints.iter().position(|(known, _)| known == key);
    let uses = drafts.iter().filter_map(|draft| {
        let Draft { column, role, quantity, .. } = *draft;
        Some(Use { column, role, quantity, joint: place(&draft.key)? })
    });
    let uses: Vec<Use> = uses.collect();
    let is_free = |one: &&Use| {
        one.role == Role::Measured && one.quantity == Quantity::Position && !explicit.contains(&one.column)
    };
    let measured: Vec<(usize, &str)> =
        uses.iter().filter(is_free).map(|one| (one.column, joints[one.joint].1.as_str())).collect();
    remark_filtered(head, labels, &measured, remarks);
    let mut interfaces = Vec::new();
    for (name, columns) in &options.interfaces {
        for (joint, column) in columns {
            let column = find(column, &format!("interface {name}"), &head.names)?;
            let known = place(joint).or_else(|| {
                let joint = joint.to_lowercase();
                joints.iter().position(|(key, _)| key.to_lowercase() == joint)
            });
            let joint = known.ok_or_else(|| CsvError::NoJoint {
                what: format!("interface {name:?}"),
                joint: joint.clone(),
                nearest: nearest(joint, joints.iter().map(|(_, name)| name.as_str())),
                present: joints.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>().join(", "),
            })?;
            interfaces.push(Interface { name: name.clone(), column, joint });
        }
    }
    let taken = |column: &usize| uses.iter().any(|one| one.column == *column);
    if !joints.is_empty() && !options.interfaces.contains_key(SUPPLY) {
        let supply = of_supply(labels, |column| !taken(&column) && !explicit.contains(&column));
        interfaces.extend(supply.map(|column| Interface { name: SUPPLY.to_owned(), column, joint: 0 }));
    }
    let left: Vec<usize> =
        (0..labels.len()).filter(|column| odd(&labels[*column]).is_some() && !taken(column)).collect();
    if let Some(first) = left.first() {
        let message = format!(
            "columns in a unit that is no angle or length, such as {:?}, left out; say what one is with --planned \
             JOINT=FACTOR*COLUMN,... and --measured",
            head.names[*first]
        );
        remarks.add(Code::NotSupported, left.len() as u64, message);
    }
    without_axes(head, labels, |column| taken(column) || explicit.contains(column), remarks);
    if drafts.iter().all(|draft| !draft.stated) {
        without_lengths(head, labels, |column| taken(column) || explicit.contains(column), remarks);
    }
    let mut used = BTreeSet::new();
    let mut all = uses.iter().map(|one| one.column).chain(interfaces.iter().map(|one| one.column));
    if let Some(column) = all.find(|column| !used.insert(*column)) {
        return Err(CsvError::SameColumn { column: head.names[column].clone(), number: column + 1 });
    }
    Ok(Layout { joints: joints.into_iter().map(|(_, name)| name).collect(), uses, interfaces })
}

/// The orientation of a tool whose position says no unit is left out: its components are no angles of joints.
fn without_orientation(head: &Head, drafts: &mut Vec<Draft>, remarks: &mut Remarks) -> Result<(), CsvError> {
    let has = |names: &[&str]| names.iter().all(|name| drafts.iter().any(|draft| draft.key == *name));
    if !has(&QUATERNION) || has(&PLACE) {
        return Ok(());
    }
    drafts.retain(|draft| !QUATERNION.contains(&draft.key.as_str()));
    if drafts.is_empty() {
        let has_place = head.names.iter().any(|name| PLACE.contains(&label(name, None).key.as_str()));
        return Err(if has_place { CsvError::PoseUnit } else { CsvError::OrientationAlone });
    }
    let message = "the orientation of a tool (qx, qy, qz, qw) is left out, for its position says no unit: x, y and z need one in their \
                   headers, such as x_m";
    remarks.add(Code::Guessed, 1, message);
    Ok(())
}

/// In a table whose columns say no side, lengths may be joints that slide or anything else: what is left out is said.
fn without_lengths(head: &Head, labels: &[Label], taken: impl Fn(&usize) -> bool, remarks: &mut Remarks) {
    let may_slide =
        |label: &Label| label.is_joint && measures(label, Measure::Length) && !is_place(&label.joint);
    let left = || (0..labels.len()).filter(|column| may_slide(&labels[*column]) && !taken(column));
    let Some((column, label)) = left().next().map(|column| (column, &labels[column])) else { return };
    let message = format!(
        "columns of lengths whose names are none of joints that slide, such as {:?}, left out; import takes one with \
         --slides {}={}",
        head.names[column],
        label.joint,
        label.unit.map_or("mm", |unit| unit.name)
    );
    remarks.add(Code::Guessed, left().count() as u64, message);
}

/// Axes of a machine in capitals, set and actual, are left out beside joints if their headers say no unit: what is left out is said.
/// In small letters they are places of a tool.
fn without_axes(head: &Head, labels: &[Label], taken: impl Fn(&usize) -> bool, remarks: &mut Remarks) {
    let is_axis = |label: &Label| {
        let upper = label.joint.chars().all(char::is_uppercase);
        !label.is_joint && is_place(&label.joint) && upper && label.quantity != Some(Quantity::Velocity)
    };
    let left = || (0..labels.len()).filter(|column| is_axis(&labels[*column]) && !taken(column));
    let of = |key: &str, role: Role| {
        left().find(|column| labels[*column].key == key && labels[*column].role == Some(role))
    };
    let pair = |column: usize| {
        let label = &labels[column];
        let planned = label.role == Some(Role::Planned);
        Some((label, column, of(&label.key, Role::Measured).filter(|_| planned)?))
    };
    let pairs: Vec<(&Label, usize, usize)> = left().filter_map(pair).collect();
    let Some((_, planned, measured)) = pairs.first() else { return };
    let slides: Vec<String> = pairs.iter().map(|(label, ..)| format!("{}=mm", label.joint)).collect();
    let message = format!(
        "columns of axes that say no unit, such as {:?} and {:?}, left out; `hydrotrace import` takes them with --slides {} if \
         they are in mm",
        head.names[*planned],
        head.names[*measured],
        slides.join(",")
    );
    remarks.add(Code::Guessed, 2 * pairs.len() as u64, message);
}

fn measures(label: &Label, measure: Measure) -> bool {
    label.unit.is_some_and(|unit| unit.measure == measure)
}

/// The unit of a column that would be a joint's, if one knew what one of it is.
fn odd(label: &Label) -> Option<Unit> {
    label.stated.filter(|unit| unit.is_odd() && label.role.is_some())
}

/// Key and name of the joints that have plan and measurement; all of one side if the file has no other.
/// The command stands in for a plan that a joint has not.
fn joints(
    head: &Head,
    labels: &[Label],
    drafts: &[Draft],
    remarks: &mut Remarks,
) -> Result<Vec<(String, String)>, CsvError> {
    let side = |role: Role| {
        let mut list: Vec<&Draft> = Vec::new();
        for draft in drafts.iter().filter(|d| d.role == role && d.quantity == Quantity::Position) {
            list.push(draft);
        }
        list.sort_by_key(|draft| draft.column);
        list
    };
    let (planned, measured, sent) = (side(Role::Planned), side(Role::Measured), side(Role::Command));
    let list = |side: &[&Draft]| side.iter().map(|draft| draft.joint.as_str()).collect::<Vec<_>>().join(", ");
    let pair = |draft: &&Draft| (draft.key.clone(), draft.joint.clone());
    let commanded = planned.is_empty() && !sent.is_empty();
    let asked = if commanded { sent.clone() } else { planned };
    let (all, missing, flag) = match (asked.is_empty(), measured.is_empty()) {
        (true, true) => {
            let odd = labels.iter().zip(&head.names).find_map(|(label, name)| Some((odd(label)?, name)));
            if let Some((unit, name)) = odd {
                return Err(CsvError::OddUnit { column: name.clone(), unit: unit.name });
            }
            let speed = drafts.iter().find(|draft| draft.quantity == Quantity::Velocity);
            let others = || {
                let how = || offered(&head.names).map(|how| format!("; {how}, takes some of them"));
                passed_over(head, labels).or_else(how).unwrap_or_default()
            };
            let why = speed
                .map_or_else(others, |draft| format!(" (column {:?} is a speed)", head.names[draft.column]));
            return Err(CsvError::NoJoints { why, present: present(&head.names) });
        }
        (true, false) => (&measured, "plan", "--planned"),
        (false, true) => (&asked, "measurement", "--measured"),
        (false, false) => {
            let both = |draft: &&&Draft| measured.iter().any(|other| other.key == draft.key);
            let mut found: Vec<(String, String)> = asked.iter().filter(both).map(pair).collect();
            let planned = |key: &str| asked.iter().any(|draft| draft.key == key);
            found.extend(sent.iter().filter(both).filter(|draft| !planned(&draft.key)).map(pair));
            if found.is_empty() {
                return Err(CsvError::NoPair { planned: list(&asked), measured: list(&measured) });
            }
            if let Some(options) = numbered_apart(head, [&asked, &measured]) {
                let (planned, measured) = (list(&asked), list(&measured));
                return Err(CsvError::NumberedApart { planned, measured, options });
            }
            for draft in asked.iter().chain(&measured).filter(|draft| draft.stated) {
                if !found.iter().any(|(key, _)| *key == draft.key) {
                    let message = format!(
                        "{} has no partner for its column {:?}; left out",
                        draft.joint, head.names[draft.column]
                    );
                    remarks.add(Code::UnpairedJoint, 1, message);
                }
            }
            if commanded {
                let message = "no column looks like a plan, only like the command: a report gives the error against \
                               what was sent, not against what was wanted; `hydrotrace join LOG --plan next.mcap -o with-plan.mcap` \
                               puts the plan beside it, or name its columns with --planned JOINT=COLUMN,...";
                remarks.add(Code::PlanIsCommand, found.len() as u64, message);
            }
            return Ok(found);
        }
    };
    let names: Vec<&str> = all.iter().map(|draft| draft.joint.as_str()).collect();
    let message = one_side(&names, labels, missing, flag);
    remarks.add(Code::OneSide, all.len() as u64, message);
    Ok(all.iter().map(pair).collect())
}

/// Why a column of an angle that is set or measured is of no joint.
fn passed_over(head: &Head, labels: &[Label]) -> Option<String> {
    let of_angle = |(_, label): &(&String, &Label)| {
        !label.is_joint && label.role.is_some() && measures(label, Measure::Angle)
    };
    let (name, _) = head.names.iter().zip(labels).find(of_angle)?;
    let word = words(name).into_iter().find(|word| word.meaning == Meaning::Foreign)?.text;
    Some(format!(" (column {name:?} is passed over for its word {word:?})"))
}

/// What a table without a plan, or without a measurement, of these joints needs.
pub(super) fn one_side(joints: &[&str], labels: &[Label], missing: &str, flag: &str) -> String {
    let errors = plan_by_error(joints.iter().copied(), labels);
    let by_error = match errors.filter(|_| missing == "plan") {
        Some(sums) => format!("say {flag} {sums} if the error is plan less measurement, else "),
        None => String::new(),
    };
    format!(
        "no column looks like a {missing}, and a report needs one: {by_error}name its columns with {flag} \
         {}, or, if it is in a file of its own with the same zero of time, import that too and \
         give both logs: `hydrotrace report THIS.mcap OTHER.mcap`",
        joints.iter().map(|joint| format!("{joint}=COLUMN")).collect::<Vec<_>>().join(",")
    )
}
