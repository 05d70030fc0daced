//! The limits of a report, an option for each row of the tables of metrics that has one.

use clap::{Arg, ArgAction, ArgMatches, Command, Error};

use super::number::{degrees, millimetres, milliseconds};
use crate::{
    replay::{Dimension, Limit, limits},
    series::JointKind,
    workflow::report::Gates,
};

/// Limits; exit code 4 if one is not kept.
#[derive(Debug, Default)]
pub(super) struct GateArgs {
    /// In SI units; the parsers have converted already.
    pub(super) gates: Gates,
}

const HEADING: &str = "Limits (exit code 4 if not kept)";
const ALLOW_EMPTY: &str = "allow-empty";

/// Every option with its limit and the joints it judges.
fn options() -> impl Iterator<Item = (&'static str, &'static Limit, JointKind)> {
    limits().flat_map(|limit| {
        let sliding = limit.sliding_option.map(|option| (option, limit, JointKind::Slides));
        std::iter::once((limit.option, limit, JointKind::Turns)).chain(sliding)
    })
}

impl clap::Args for GateArgs {
    fn augment_args(command: Command) -> Command {
        let option = |(option, limit, kind): (&'static str, &'static Limit, JointKind)| {
            let option = Arg::new(option).long(option).help_heading(HEADING).allow_negative_numbers(true);
            let help = limit.help.to_owned();
            match (limit.dimension, kind) {
                (Dimension::Position, JointKind::Turns) => {
                    option.help(help).value_name("DEG").value_parser(degrees)
                }
                (Dimension::Position, JointKind::Slides) => {
                    option.help(help + ", of joints that slide").value_name("MM").value_parser(millimetres)
                }
                (Dimension::Distance, _) => option.help(help).value_name("MM").value_parser(millimetres),
                _ => option.help(help).value_name("MS").value_parser(milliseconds),
            }
        };
        let allow_empty = Arg::new(ALLOW_EMPTY)
            .long(ALLOW_EMPTY)
            .help_heading(HEADING)
            .help("Count a limit as kept where the run has nothing to judge it by; without this it counts as not kept")
            .action(ArgAction::SetTrue);
        command.args(options().map(option)).arg(allow_empty)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for GateArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let set = options().filter_map(|(option, limit, kind)| {
            matches.get_one::<f64>(option).map(|value| (limit, kind, *value))
        });
        let gates = set.fold(Gates::default(), |gates, (limit, kind, value)| gates.with(limit, kind, value));
        Ok(Self { gates: gates.with_empty_kept(matches.get_flag(ALLOW_EMPTY)) })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Whether an argument, with its dashes, sets a limit.
pub(super) fn is_limit(arg: &str) -> bool {
    options().any(|(option, ..)| arg.strip_prefix("--") == Some(option))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::FromArgMatches;

    #[test]
    fn degrees_millimetres_and_milliseconds_become_si_at_the_edge() {
        let words = ["a", "--max-rms-deg", "180", "--max-rms-mm", "2", "--max-start-delay-ms", "250"];
        let command = <GateArgs as clap::Args>::augment_args(Command::new("a"));
        let found = GateArgs::from_arg_matches(&command.try_get_matches_from(words).unwrap()).unwrap();
        let limit = |key: &str| crate::replay::Row::<Limit>::find(key).unwrap().0;
        let wanted = Gates::default()
            .with(limit("onset-delay"), JointKind::Turns, 0.25)
            .with(limit("rms"), JointKind::Turns, std::f64::consts::PI)
            .with(limit("rms"), JointKind::Slides, 0.002);
        assert_eq!(found.gates, wanted);
    }
}
