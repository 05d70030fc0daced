//! Limits in words: which are kept, which not, and which are not known.

use crate::{
    plan::Limit,
    render::{
        kit::{counted, share},
        metric::position,
        plan,
    },
    workflow::{
        plan::MarginEntry,
        replan::{Finding, Outside},
    },
};

/// Of a finding on limits; of another nothing.
pub(super) fn words(finding: &Finding) -> String {
    let Finding::Limits { broken, between, nearest, unlimited, unchecked, steep, fastest, sharpest, outside } =
        finding
    else {
        return String::new();
    };
    let names = |of: &[Limit]| of.iter().map(|limit| limit.name()).collect::<Vec<_>>().join(", ");
    let steep = steep.as_ref().map_or(String::new(), |of| {
        let [own, most] = [of.acceleration_rad_s2, of.limit_rad_s2].map(|value| position(of.kind, value));
        format!(" By its samples {} is accelerated to about {own}/s2, and its limit is {most}/s2.", of.joint)
    });
    let by_samples = if unchecked.is_empty() {
        String::new()
    } else {
        format!(" Not checked, for the plan is known by its samples alone: {}.", names(unchecked))
    };
    let none = match (unlimited.is_empty(), nearest.is_empty()) {
        (true, _) => String::new(),
        (false, true) => format!(" Not checked: {}.", names(unlimited)),
        (false, false) => format!(" No limit is known of: {}.", names(unlimited)),
    };
    let fast = fastest.as_ref().map_or(String::new(), |fast| {
        format!(
            " {} is sent up to {}/s, {:.1} times as fast as its plan.",
            fast.joint,
            position(fast.kind, fast.speed_rad_s),
            fast.ratio
        )
    });
    let sharp = sharpest.as_ref().map_or(String::new(), |sharp| {
        format!(" {} is accelerated up to {:.1} times as much as its plan.", sharp.joint, sharp.ratio)
    });
    kept([*broken, *between], nearest) + &steep + &fast + &sharp + &beyond(outside) + &by_samples + &none
}

/// Which joints are sent beyond the range of their plan.
fn beyond(outside: &[Outside]) -> String {
    let one = |of: &Outside| {
        let [reaches, by] = [of.reaches_rad, of.beyond_rad].map(|rad| position(of.kind, rad));
        format!("{} to {reaches} ({by} beyond)", of.joint)
    };
    match outside.iter().map(one).collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => none,
        all => format!(" Sent beyond the range of their plan, keep that free: {all}."),
    }
}

fn kept([broken, between]: [usize; 2], nearest: &[MarginEntry]) -> String {
    let Some(worst) = nearest.first() else {
        return "Without a task the limits of the arm are unknown: check the command against yours."
            .to_owned();
    };
    let joint = worst.joint.as_ref().map_or(String::new(), |name| format!("{name} "));
    // A position counts from the middle of its range.
    let (by, [value, allowed]) = match worst.limit {
        Limit::Position => ("of the way from the middle of its range", [worst.value, worst.allowed]),
        _ => ("used", [worst.value, worst.allowed].map(f64::abs)),
    };
    let [value, allowed] = [value, allowed].map(|value| plan::shown(worst.limit, worst.kind, value));
    let of = if worst.limit == Limit::Position { ", the range ends at" } else { " of" };
    let worst = format!(
        "{joint}{}: {} {by}, {value}{of} {allowed} at {:.1} s",
        worst.limit.name_of(worst.kind),
        share(worst.share),
        worst.t_s
    );
    let mut kinds: Vec<Limit> = nearest.iter().map(|margin| margin.limit).collect();
    kinds.sort_unstable();
    let kinds: Vec<&str> = kinds.into_iter().map(Limit::name).collect();
    match (broken, between) {
        (0, 0) => {
            let within = if nearest[0].share > 1.0 { ", within 0.2 %" } else { "" };
            format!("All kept{within} ({}). The nearest is {worst}.", kinds.join(", "))
        }
        (0, between) => format!(
            "The plan lies at its limits, and between two points a controller's curve goes beyond {} by less than 1 %. The worst is \
             {worst}.",
            counted(between, "limit")
        ),
        (broken, _) => format!("NOT kept: {}. The worst is {worst}.", counted(broken, "limit")),
    }
}
