//! Options on what to read, shared by the verbs that read logs.

use std::path::PathBuf;

use clap::{ValueEnum, builder::PossibleValue};

use super::number;
use crate::{
    log::{Cylinders, LengthUnit, ReadOptions, Selector, SignalRole, TimeBase, TimeRange, WantedSignal},
    render::kit::word,
    series::JointKind,
};

/// Which topics, joints and clock to read.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Reading")]
pub(super) struct ReadArgs {
    /// Topic of the plan, and its field if the topic has several; repeat for several topics
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector)]
    planned: Vec<Selector>,

    /// Topic of the measurement, and its field if the topic has several; repeat for several topics
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector)]
    measured: Vec<Selector>,

    /// Joints to use, in this order; for a topic without names of joints, the names of its joints in their order
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    joints: Vec<String>,

    /// Clock of the samples [default: header stamps, if they advance]
    #[arg(long, value_enum, value_name = "CLOCK")]
    time: Option<Time>,

    /// Leave out what lies before this time, in seconds from the first sample of the run
    #[arg(long, value_name = "SECONDS", value_parser = number::seconds)]
    from: Option<f64>,

    /// Leave out what lies after this time, in seconds from the first sample of the run
    #[arg(long, value_name = "SECONDS", value_parser = number::seconds)]
    to: Option<f64>,

    /// The plan is in degrees
    #[arg(long)]
    planned_degrees: bool,

    /// The measurement is in degrees
    #[arg(long)]
    measured_degrees: bool,

    /// By how much the stamps of the measurement are later than its samples were taken (slow recorder or bus); they are moved back by that; 0 says that plan and measurement are of one clock
    #[arg(long = "measured-delay-ms", value_name = "MS", value_parser = number::delay_ns, allow_negative_numbers = true)]
    measured_delay_ns: Option<i64>,

    /// Joints that slide: their positions are lengths in m, or in the unit behind the name: m, cm or mm
    #[arg(long, value_name = "NAME[=UNIT],...", value_delimiter = ',', value_parser = slides)]
    slides: Vec<(String, LengthUnit)>,

    /// Joints without end stops, whose angles wrap at full turns
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    continuous: Vec<String>,

    /// How tables are read (TOML), as `import --save-map` wrote it
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,

    /// Cylinders of the arm (TOML): joints that are logged as lengths of their cylinders become angles
    #[arg(long, value_name = "FILE")]
    hydraulics: Option<PathBuf>,

    /// What joints with a cylinder are read as [default: angles]
    #[arg(long = "as", value_enum, value_name = "WHAT", requires = "hydraulics")]
    joints_as: Option<JointsAs>,
}

/// What joints with a cylinder are read as.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum JointsAs {
    /// Angles of the joints
    Angles,
    /// Lengths of the cylinders
    Cylinders,
}

/// Clocks of a message.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Time {
    /// When the sample was taken
    Header,
    /// When the message was published
    Publish,
    /// When the recorder received it
    Log,
}

impl ReadArgs {
    pub(super) fn options(&self) -> ReadOptions {
        ReadOptions {
            planned: self.planned.clone(),
            measured: self.measured.clone(),
            joints: self.joints.clone(),
            time_base: self.time.map(|time| match time {
                Time::Header => TimeBase::Header,
                Time::Publish => TimeBase::Publish,
                Time::Log => TimeBase::Log,
            }),
            range: TimeRange::of_seconds(self.from, self.to),
            planned_in_degrees: self.planned_degrees,
            measured_in_degrees: self.measured_degrees,
            measured_delay_ns: self.measured_delay_ns,
            slides: self.slides.iter().cloned().collect(),
            continuous: self.continuous.clone(),
            map: self.map.clone(),
            cylinders: self.hydraulics.clone().map(|file| Cylinders {
                file,
                into: match self.joints_as {
                    Some(JointsAs::Cylinders) => JointKind::Slides,
                    _ => JointKind::Turns,
                },
            }),
            ..ReadOptions::default()
        }
    }

    /// The options as they are typed, words of a shell: what a command that reads the same logs needs.
    pub(super) fn words(&self) -> Vec<String> {
        self.words_of(true)
    }

    /// The same for a log that was joined, all of it; unless it keeps its plan that is one of ours.
    pub(super) fn words_of_joined(&self, keeps_plan: bool) -> Vec<String> {
        let of_plan = |option: &String| option.starts_with("--planned") && !keeps_plan;
        self.words_of(false).into_iter().filter(|option| !of_plan(option)).collect()
    }

    fn words_of(&self, ranged: bool) -> Vec<String> {
        let all = |names: &[String]| (!names.is_empty()).then(|| names.join(","));
        let named = |value: Option<PossibleValue>| value.map(|value| value.get_name().to_owned());
        let end = |end_s: Option<f64>| end_s.filter(|_| ranged).map(|s| s.to_string());
        let file = |file: Option<&PathBuf>| file.map(|file| file.to_string_lossy().into_owned());
        let topics = self.planned.iter().map(|one| ("--planned", one));
        let topics = topics.chain(self.measured.iter().map(|one| ("--measured", one)));
        let valued = [
            ("--joints", all(&self.joints)),
            ("--time", named(self.time.and_then(|time| time.to_possible_value()))),
            ("--from", end(self.from)),
            ("--to", end(self.to)),
            ("--measured-delay-ms", self.measured_delay_ns.map(|ns| (ns as f64 / 1e6).to_string())),
            ("--slides", all(&self.slides.iter().map(length).collect::<Vec<_>>())),
            ("--continuous", all(&self.continuous)),
            ("--map", file(self.map.as_ref())),
            ("--hydraulics", file(self.hydraulics.as_ref())),
            ("--as", named(self.joints_as.and_then(|what| what.to_possible_value()))),
        ];
        let flags =
            [("--planned-degrees", self.planned_degrees), ("--measured-degrees", self.measured_degrees)];
        let flags = flags.into_iter().filter(|(_, set)| *set).map(|(option, _)| option.to_owned());
        let valued = valued.into_iter().filter_map(|(option, value)| Some(typed(option, &value?)));
        topics.map(|(option, one)| typed(option, &one.to_string())).chain(valued).chain(flags).collect()
    }
}

/// `NAME`, of a joint in m, or `NAME=UNIT`.
fn slides(text: &str) -> Result<(String, LengthUnit), String> {
    let found = LengthUnit::of_joint(text);
    found.ok_or_else(|| {
        format!("{text:?} is neither NAME nor NAME=UNIT with m, cm or mm, such as telescope=mm")
    })
}

/// As [`slides`] reads it.
fn length((joint, unit): &(String, LengthUnit)) -> String {
    let unit = Some(unit.name()).filter(|_| *unit != LengthUnit::Metres);
    unit.map_or_else(|| joint.clone(), |unit| format!("{joint}={unit}"))
}

/// An option with its value, as words of a shell; a value that begins with a dash would be an option of its own.
fn typed(option: &str, value: &str) -> String {
    let between = if value.starts_with('-') { '=' } else { ' ' };
    format!("{option}{between}{}", word(value))
}

/// What to read of a run that is to be fitted.
#[derive(Debug, clap::Args)]
pub(super) struct SentArgs {
    /// Topic of the command that was sent, if it differs from the plan
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector, help_heading = "Reading")]
    command: Option<Selector>,

    /// Topic of the valve signals, as shares of the full signal
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector, help_heading = "Reading")]
    valve: Option<Selector>,

    #[command(flatten)]
    read: ReadArgs,
}

impl SentArgs {
    /// The options as they are typed, for the same logs.
    pub(super) fn words(&self) -> Vec<String> {
        let named = [("--command", &self.command), ("--valve", &self.valve)];
        let named =
            named.into_iter().filter_map(|(option, one)| Some(typed(option, &one.as_ref()?.to_string())));
        self.read.words().into_iter().chain(named).collect()
    }

    /// The same for a log of the next run: what is cut from the last one is its own.
    pub(super) fn words_of_next(&self) -> Vec<String> {
        self.read.words_of(false)
    }

    pub(super) fn options(&self) -> ReadOptions {
        let signals = [(SignalRole::Command, &self.command), (SignalRole::Valve, &self.valve)]
            .map(|(role, topic)| WantedSignal { role, topic: topic.clone() });
        ReadOptions { signals: signals.into(), ..self.read.options() }
    }
}

#[expect(clippy::unnecessary_wraps, reason = "the form of a clap parser")]
pub(super) fn selector(text: &str) -> Result<Selector, String> {
    Ok(Selector::parse(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::kit::READERS;

    #[derive(Debug, clap::Parser)]
    struct Line {
        #[command(flatten)]
        sent: SentArgs,
    }

    const EVERY: &str = "--planned /a:b --measured /c --joints x,y --time publish --from 1.5 --to 9 \
                         --measured-delay-ms=-2 --slides y,z=mm --continuous x --map m.toml --hydraulics h.toml --as cylinders \
                         --planned-degrees --measured-degrees --command /d --valve /e";

    /// An option that is added and not typed again would be lost from the next command.
    #[test]
    fn every_option_is_typed_again() {
        use clap::{CommandFactory as _, Parser as _};
        let read = Line::parse_from(std::iter::once("hydrotrace").chain(EVERY.split_whitespace()));
        assert_eq!(read.sent.words().join(" "), EVERY.split_whitespace().collect::<Vec<_>>().join(" "));
        for option in Line::command().get_arguments().filter_map(|arg| arg.get_long()) {
            assert!(EVERY.contains(&format!("--{option}")), "--{option}");
        }
        assert_eq!(read.sent.words_of_next().len() + 4, read.sent.words().len(), "neither ends nor signals");
        let joined = read.sent.read.words_of_joined(false);
        assert_eq!(joined.len() + 2, read.sent.words_of_next().len(), "nor the plan: {joined:?}");
    }

    #[test]
    fn the_verbs_whose_commands_get_them_are_those_that_take_them() {
        use clap::CommandFactory as _;
        let command = crate::cli::Args::command();
        let takes = |verb: &clap::Command| verb.get_arguments().any(|arg| arg.get_long() == Some("measured"));
        // The others read what a recorder wrote, by options of their own.
        let reads = |verb: &str| !["join", "import", "record"].contains(&verb);
        let verbs = command.get_subcommands().filter(|verb| takes(verb) && reads(verb.get_name()));
        let mut verbs: Vec<&str> = verbs.map(clap::Command::get_name).collect();
        verbs.sort_unstable();
        assert_eq!(verbs, READERS);
    }

    #[test]
    fn a_topic_is_split_from_its_field_at_the_colon() {
        let selector = selector("/arm/state:output.positions").unwrap();
        let Selector { topic, field } = selector;
        assert_eq!((topic.as_str(), field.as_deref()), ("/arm/state", Some("output.positions")));
    }
}
