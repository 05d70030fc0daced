//! Writing a run as an MCAP log of ROS 2 messages that the usual tools open.

mod cdr;
mod channel;
mod definition;
mod error;
mod message;
mod options;
mod robot;
mod stamp;

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::{BufWriter, Write},
    path::Path,
};

use mcap::{
    Attachment, Compression, WriteOptions,
    records::Metadata,
    write::{NoSeek, Writer},
};

#[cfg(feature = "sqlite")]
pub(in crate::log) use definition::ros2msg;
pub use error::WriteError;
pub use message::{ControllerState, Point};
pub use options::{Options, Role, Topics};
pub(in crate::log) use options::{SUPPLY, VALVE};
pub use robot::Transform;

use cdr::Cdr;
use channel::{
    CONTROLLER_STATE, Channel, DYNAMIC_JOINT_STATE, JOINT_STATE, JOINT_TRAJECTORY, TEXT, TRANSFORMS,
};
use message::check_length;
use stamp::Stamp;

/// Writes samples of one set of joints, one call a sample.
///
/// Equal calls give equal bytes. Once every topic had its first message and while a chunk lasts,
/// a call allocates nothing but the amortised growth of that chunk's index. Output happens when
/// a chunk ends and in whole chunks: a process killed at any instant leaves a log that reads back
/// up to the last [`flush`](Self::flush). A power failure takes what the operating system has
/// not stored yet; give an output whose `flush` waits for the disk if that matters.
///
/// Times are nanoseconds since 1970; they become the header stamp and, [`Options::log_delay_ns`] later, the
/// log time and the publish time. Values are written as given, NaN and infinities too: a log says what happened.
///
/// Call [`finish`](Self::finish); dropping the writer closes the log too, but hides failures.
///
/// ```
/// use hydrotrace::log::{LogWriter, Role, WriteOptions};
///
/// let mut log = LogWriter::new(Vec::new(), &["boom", "stick"], WriteOptions::default())?;
/// for k in 0..100 {
///     let (stamp_ns, angle_rad) = (1_700_000_000_000_000_000 + k * 10_000_000, 0.001 * k as f64);
///     log.joint_sample(Role::Planned, stamp_ns, &[angle_rad, 0.5], &[0.1, 0.0], &[])?;
///     log.joint_sample(Role::Measured, stamp_ns, &[0.9 * angle_rad, 0.5], &[], &[])?;
/// }
/// let bytes = log.finish()?;
/// assert!(bytes.ends_with(b"\x89MCAP0\r\n"));
/// # Ok::<(), hydrotrace::log::WriteError>(())
/// ```
pub struct LogWriter<W: Write> {
    mcap: Writer<NoSeek<W>>,
    joint_names: Vec<String>,
    cdr: Cdr,
    /// By kind.
    channels: [Channel; 11],
    log_delay_ns: i64,
    flush_interval_ns: Option<u64>,
    unflushed_since_ns: Option<u64>,
}

/// Kinds of messages, each with a topic of its own.
#[derive(Clone, Copy)]
enum Kind {
    Planned,
    Measured,
    Command,
    ControllerState,
    Trajectory,
    Interfaces,
    Description,
    PlannedDescription,
    Transforms,
    FixedTransforms,
    TrackingError,
}

impl LogWriter<BufWriter<File>> {
    /// Creates a file and writes to it as samples come; for logs of a machine that moves.
    /// An existing file is left alone.
    ///
    /// # Errors
    ///
    /// [`WriteError::Create`], or as [`LogWriter::new`].
    pub fn create<S: AsRef<str>>(
        path: impl AsRef<Path>,
        joint_names: &[S],
        options: Options,
    ) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let file =
            File::create_new(path).map_err(|source| WriteError::Create { path: path.to_owned(), source })?;
        let begun = Self::new(BufWriter::new(file), joint_names, options);
        if begun.is_err() {
            // The file is ours and empty; there may be no second try beside it.
            let _ = std::fs::remove_file(path);
        }
        begun
    }
}

impl<W: Write> LogWriter<W> {
    /// Starts a log on any output.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if joint names or topics are missing, unusable or repeated, or if the
    /// output takes nothing.
    pub fn new<S: AsRef<str>>(output: W, joint_names: &[S], options: Options) -> Result<Self, WriteError> {
        let joint_names: Vec<String> = joint_names.iter().map(|name| name.as_ref().to_owned()).collect();
        check_joint_names(&joint_names)?;
        let channels = channels(options.topics);
        check_distinct("topic", channels.iter().map(Channel::topic))?;
        let mcap = WriteOptions::new()
            .profile("ros2")
            .library(concat!("hydrotrace ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_level(options.compression_level)
            .compression_threads(0)
            .chunk_size(Some(options.chunk_bytes.min(Options::MAX_CHUNK_BYTES).into()))
            // A chunk is built in memory and written whole, so a killed writer leaves no torn one.
            .disable_seeking(true)
            .create(NoSeek::new(output))?;
        Ok(Self {
            mcap,
            joint_names,
            cdr: Cdr::default(),
            channels,
            log_delay_ns: options.log_delay_ns,
            flush_interval_ns: options.flush_interval_ns,
            unflushed_since_ns: None,
        })
    }

    /// How much later than their stamps the messages from here on count as received, ns.
    pub(in crate::log) fn receive_after(&mut self, log_delay_ns: i64) {
        self.log_delay_ns = log_delay_ns;
    }

    /// Writes where joints should be, are, or were sent: `sensor_msgs/msg/JointState`. One value
    /// a joint in the order of the joint names, or empty slices where nothing is known.
    ///
    /// # Errors
    ///
    /// [`WriteError::LengthMismatch`], [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn joint_sample(
        &mut self,
        role: Role,
        stamp_ns: i64,
        position_rad: &[f64],
        velocity_rad_s: &[f64],
        effort_n_m: &[f64],
    ) -> Result<(), WriteError> {
        let joints = self.joint_names.len();
        check_length("position", position_rad, joints)?;
        check_length("velocity", velocity_rad_s, joints)?;
        check_length("effort", effort_n_m, joints)?;
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        message::encode_header(&mut self.cdr, stamp, &self.joint_names);
        message::encode_joint_state(&mut self.cdr, [position_rad, velocity_rad_s, effort_n_m]);
        let kind = match role {
            Role::Planned => Kind::Planned,
            Role::Measured => Kind::Measured,
            Role::Command => Kind::Command,
        };
        self.send(kind, stamp)
    }

    /// Writes plan, measurement and error in one message:
    /// `control_msgs/msg/JointTrajectoryControllerState`.
    ///
    /// # Errors
    ///
    /// [`WriteError::LengthMismatch`], [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn controller_state(&mut self, stamp_ns: i64, state: &ControllerState) -> Result<(), WriteError> {
        for point in [&state.reference, &state.feedback, &state.output] {
            point.check(self.joint_names.len())?;
        }
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        message::encode_header(&mut self.cdr, stamp, &self.joint_names);
        message::encode_controller_state(&mut self.cdr, state)?;
        self.send(Kind::ControllerState, stamp)
    }

    /// Writes named quantities of all joints, such as pressures, each with one value a joint in the
    /// order of the joint names: `control_msgs/msg/DynamicJointState`.
    ///
    /// # Errors
    ///
    /// [`WriteError::LengthMismatch`], [`WriteError::Interface`], [`WriteError::TimeRange`] or
    /// [`WriteError::Output`].
    pub fn interfaces(&mut self, stamp_ns: i64, values: &[(&str, &[f64])]) -> Result<(), WriteError> {
        let joints = self.joint_names.len();
        for (name, values) in values {
            if name.is_empty() || name.contains('\0') {
                return Err(WriteError::Interface { name: (*name).to_owned() });
            }
            if values.len() != joints {
                let values = values.len();
                return Err(WriteError::LengthMismatch { quantity: "interface", joints, values });
            }
        }
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        message::encode_header(&mut self.cdr, stamp, &self.joint_names);
        message::encode_interfaces(&mut self.cdr, joints, values);
        self.send(Kind::Interfaces, stamp)
    }

    /// Writes a whole plan that starts at the stamp: `trajectory_msgs/msg/JointTrajectory`. No
    /// points at all cancel the plan before.
    ///
    /// # Errors
    ///
    /// [`WriteError::LengthMismatch`], [`WriteError::NotIncreasing`], [`WriteError::TimeRange`]
    /// or [`WriteError::Output`].
    pub fn trajectory(&mut self, stamp_ns: i64, points: &[Point]) -> Result<(), WriteError> {
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        self.plan(stamp, points)
    }

    /// As [`trajectory`](Self::trajectory), but one that starts when it is received, as its stamp of zero says:
    /// for plans that are yet to be sent. `received_ns` is its place in the log.
    ///
    /// # Errors
    ///
    /// As [`trajectory`](Self::trajectory).
    pub fn trajectory_to_send(&mut self, received_ns: i64, points: &[Point]) -> Result<(), WriteError> {
        self.plan(Stamp::unset(received_ns)?, points)
    }

    fn plan(&mut self, stamp: Stamp, points: &[Point]) -> Result<(), WriteError> {
        let mut previous_ns = None;
        for (index, point) in points.iter().enumerate() {
            point.check(self.joint_names.len())?;
            let next_ns = point.time_from_start_ns;
            if let Some(previous_ns) = previous_ns.replace(next_ns).filter(|&previous| next_ns <= previous) {
                return Err(WriteError::NotIncreasing { index, previous_ns, next_ns });
            }
        }
        message::encode_header(&mut self.cdr, stamp, &self.joint_names);
        message::encode_trajectory(&mut self.cdr, points)?;
        self.send(Kind::Trajectory, stamp)
    }

    /// Writes named texts, outside the messages. Ends the chunk.
    ///
    /// # Errors
    ///
    /// [`WriteError::Output`].
    pub fn metadata(&mut self, name: &str, entries: &BTreeMap<String, String>) -> Result<(), WriteError> {
        Ok(self.mcap.write_metadata(&Metadata { name: name.to_owned(), metadata: entries.clone() })?)
    }

    /// Writes a file into the log, outside the messages. Ends the chunk.
    ///
    /// # Errors
    ///
    /// [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn attach(
        &mut self,
        name: &str,
        media_type: &str,
        data: &[u8],
        stamp_ns: i64,
    ) -> Result<(), WriteError> {
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        Ok(self.mcap.attach(&Attachment {
            log_time: stamp.log_time_ns,
            create_time: stamp.log_time_ns,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Borrowed(data),
        })?)
    }

    /// Ends the chunk and flushes the output: from here on a killed process loses nothing of what
    /// was written so far.
    ///
    /// # Errors
    ///
    /// [`WriteError::Output`].
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.unflushed_since_ns = None;
        Ok(self.mcap.flush()?)
    }

    /// The writer underneath, for messages that are copied.
    pub(in crate::log) fn raw(&mut self) -> &mut Writer<NoSeek<W>> {
        &mut self.mcap
    }

    /// Closes the log and hands back its output, flushed.
    ///
    /// # Errors
    ///
    /// [`WriteError::Output`].
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.mcap.finish()?;
        Ok(self.mcap.into_inner().into_inner())
    }

    /// Sends the message that was encoded last, and flushes if that is due.
    fn send(&mut self, kind: Kind, stamp: Stamp) -> Result<(), WriteError> {
        self.channels[kind as usize].send(&mut self.mcap, stamp, self.cdr.bytes())?;
        let since_ns = *self.unflushed_since_ns.get_or_insert(stamp.log_time_ns);
        match self.flush_interval_ns {
            Some(interval_ns) if stamp.log_time_ns.abs_diff(since_ns) >= interval_ns => self.flush(),
            _ => Ok(()),
        }
    }
}

/// In the order of [`Kind`].
fn channels(topics: Topics) -> [Channel; 11] {
    [
        Channel::new(topics.planned, &JOINT_STATE),
        Channel::new(topics.measured, &JOINT_STATE),
        Channel::new(topics.command, &JOINT_STATE),
        Channel::new(topics.controller_state, &CONTROLLER_STATE),
        Channel::new(topics.trajectory, &JOINT_TRAJECTORY),
        Channel::new(topics.interfaces, &DYNAMIC_JOINT_STATE),
        Channel::latched(topics.description, &TEXT),
        Channel::latched(topics.planned_description, &TEXT),
        Channel::new(topics.transforms, &TRANSFORMS),
        Channel::latched(topics.fixed_transforms, &TRANSFORMS),
        Channel::new(topics.tracking_error, &JOINT_STATE),
    ]
}

fn check_joint_names(joint_names: &[String]) -> Result<(), WriteError> {
    if joint_names.is_empty() {
        return Err(WriteError::NoJoints);
    }
    if let Some(index) = joint_names.iter().position(|name| name.is_empty() || name.contains('\0')) {
        return Err(WriteError::BadJointName { index, name: joint_names[index].clone() });
    }
    check_distinct("joint", joint_names.iter().map(String::as_str))
}

fn check_distinct<'a>(
    kind: &'static str,
    names: impl IntoIterator<Item = &'a str>,
) -> Result<(), WriteError> {
    let mut seen = BTreeSet::new();
    match names.into_iter().find(|name| !seen.insert(*name)) {
        Some(name) => Err(WriteError::Duplicate { kind, name: name.to_owned() }),
        None => Ok(()),
    }
}
