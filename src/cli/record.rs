//! `record`

use std::{
    io::BufRead,
    net::UdpSocket,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, RecvTimeoutError, sync_channel},
    },
    thread,
    time::{Duration, Instant},
};

use clap::Parser as _;

use super::{
    CliError, Outcome, Run,
    columns::ColumnArgs,
    console::{Console, Target, progress, spare_for_log},
    number::seconds,
    report,
};
use crate::{
    document::pretty,
    log::ReadOptions,
    render::record as words,
    workflow::{
        join,
        record::{Inputs, Part, Progress, Senders, run},
    },
};

const EXAMPLES: &str = "\
Examples:
  your_controller | hydrotrace record -o run.mcap
  hydrotrace record -o run.mcap --udp 0.0.0.0:5005 --degrees
  your_controller | hydrotrace record -o run.mcap --plan next.mcap --report

A header and rows (CSV) or an object a line (JSON) come on standard input or by UDP, a packet being one or more whole
lines. Columns are understood as by `import`, from the first lines; a unit is not guessed. Each second what came is
put on the disk. The recording ends with its input, after --seconds, or with Ctrl-C.";

/// Lines wait for the disk up to this many.
const WAITING: usize = 1 << 16;
/// The longest packet.
const PACKET: usize = 1 << 16;

/// Write what a controller sends, line by line, to a log
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Write the log to LOG
    #[arg(short, long, value_name = "LOG")]
    output: PathBuf,

    /// Receive packets at ADDRESS:PORT instead of reading standard input
    #[arg(long, value_name = "ADDRESS:PORT")]
    udp: Option<String>,

    /// End after SECONDS
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<f64>,

    /// Begin a new file, LOG-2 and on, after so many megabytes
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u32).range(1..), conflicts_with = "part_minutes")]
    part_mb: Option<u32>,

    /// Begin a new file after so many minutes
    #[arg(long, value_name = "MINUTES", value_parser = clap::value_parser!(u32).range(1..))]
    part_minutes: Option<u32>,

    /// At the end put the plan of FILE beside the run, found by what was sent, into LOG-with-plan
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,

    /// At the end print the report
    #[arg(long, conflicts_with = "json")]
    report: bool,

    /// Print what was recorded as one JSON document
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    columns: ColumnArgs,
}

/// The arguments of a report.
#[derive(clap::Parser)]
struct Report {
    #[command(flatten)]
    args: report::Args,
}

/// Lines from a thread that waits for them, a moment without one each tenth of a second, until they end.
struct Lines {
    from: Receiver<Vec<u8>>,
    until: Option<Instant>,
    /// Lines that are still taken after the end: those that wait.
    left: usize,
}

impl Iterator for Lines {
    type Item = Option<Vec<u8>>;

    fn next(&mut self) -> Option<Self::Item> {
        if super::interrupt::is_asked() || self.until.is_some_and(|until| Instant::now() >= until) {
            self.left = self.left.checked_sub(1)?;
            return self.from.try_recv().ok().map(Some);
        }
        match self.from.recv_timeout(Duration::from_millis(100)) {
            Ok(line) => Some(Some(line)),
            Err(RecvTimeoutError::Timeout) => Some(None),
            Err(RecvTimeoutError::Disconnected) => None,
        }
    }
}

/// Lines, those in UTF-16 behind its byte order mark as UTF-8.
fn lines_of(mut input: impl BufRead + 'static) -> Box<dyn Iterator<Item = Vec<u8>>> {
    let unit: fn([u8; 2]) -> u16 = match input.fill_buf() {
        Ok([0xff, 0xfe, ..]) => u16::from_le_bytes,
        Ok([0xfe, 0xff, ..]) => u16::from_be_bytes,
        _ => return Box::new(input.split(b'\n').map_while(Result::ok)),
    };
    let mut next = move || {
        let mut pair = [0; 2];
        input.read_exact(&mut pair).ok().map(|()| unit(pair))
    };
    next();
    Box::new(std::iter::from_fn(move || {
        let first = next()?;
        let end = u16::from(b'\n');
        let rest = std::iter::from_fn(&mut next).take_while(|unit| *unit != end);
        let line: Vec<u16> =
            if first == end { Vec::new() } else { std::iter::once(first).chain(rest).collect() };
        Some(String::from_utf16_lossy(&line).into_bytes())
    }))
}

/// Sends each line on; ends with its input or with the one who listens.
fn listen(udp: Option<&str>, senders: &Arc<Mutex<Senders>>) -> Result<Receiver<Vec<u8>>, CliError> {
    let (send, from) = sync_channel(WAITING);
    match udp {
        Some(address) => {
            let failed = CliError::step(format!("cannot listen at {address}"));
            let socket = UdpSocket::bind(address).map_err(|error| failed(error.into()))?;
            let (senders, begun) = (senders.clone(), Instant::now());
            thread::spawn(move || {
                let mut packet = vec![0; PACKET];
                while let Ok((length, sender)) = socket.recv_from(&mut packet) {
                    let mut senders = senders.lock().unwrap_or_else(PoisonError::into_inner);
                    if !senders.takes(sender, begun.elapsed().as_secs_f64()) {
                        continue;
                    }
                    drop(senders);
                    let lines = packet[..length].split(|byte| *byte == b'\n');
                    for line in lines.filter(|line| !line.trim_ascii().is_empty()) {
                        if send.send(line.to_vec()).is_err() {
                            return;
                        }
                    }
                }
            });
        }
        None => {
            thread::spawn(move || {
                for line in lines_of(std::io::stdin().lock()) {
                    if !line.trim_ascii().is_empty() && send.send(line).is_err() {
                        return;
                    }
                }
            });
        }
    }
    Ok(from)
}

impl Args {
    fn inputs(&self, replace: bool) -> Result<Inputs, CliError> {
        let bytes = self.part_mb.map(|mb| Part::Bytes(u64::from(mb) << 20));
        let part = bytes.or(self.part_minutes.map(|minutes| Part::Seconds(60.0 * f64::from(minutes))));
        Ok(Inputs { output: self.output.clone(), options: self.columns.options()?, part, replace })
    }

    /// `run.mcap` with its plan is `run-with-plan.mcap`.
    fn joined(&self) -> PathBuf {
        let stem = self.output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.output.with_file_name(format!("{stem}-with-plan.mcap"))
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let inputs: Vec<PathBuf> = self.plan.iter().cloned().collect();
        spare_for_log(Some(&self.output), &inputs)?;
        // What is wrong with it should not show after an hour.
        self.plan.as_deref().map(join::check_plan).transpose()?;
        let request = self.inputs(self.output.exists())?;
        let senders = Arc::default();
        super::interrupt::ask_only();
        let until = self.seconds.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
        let lines = Lines { from: listen(self.udp.as_deref(), &senders)?, until, left: WAITING };
        let bar = progress(None, "{spinner} {elapsed}  {msg}");
        bar.enable_steady_tick(Duration::from_millis(200));
        let mut shown = Instant::now();
        let recorded = run(&request, lines, |now: &Progress| {
            if shown.elapsed() > Duration::from_millis(500) {
                shown = Instant::now();
                bar.set_message(words::progress(now));
            }
        });
        bar.finish_and_clear();
        let mut recorded = recorded?;
        recorded.remarks.extend(senders.lock().unwrap_or_else(PoisonError::into_inner).remarks());
        let joined = self.plan.as_deref().map(|plan| self.join(plan, &recorded.logs)).transpose()?;
        let target = Target::stdout(self.json);
        let result = if self.json {
            pretty(&recorded)
        } else {
            target.text(&words::document(&recorded, joined.as_deref()))
        };
        let outcome = console.finish(&target, &result, &recorded.remarks, &[])?;
        if !self.report {
            return Ok(outcome);
        }
        let logs = joined.map_or(recorded.logs, |log| vec![log]);
        let words = std::iter::once("report".into()).chain(logs.into_iter().map(PathBuf::into_os_string));
        let report = Report::try_parse_from(words).map_err(|error| CliError::Usage(error.to_string()))?;
        console.print("\n")?;
        report.args.run(console)
    }
}

impl Args {
    fn join(&self, plan: &Path, logs: &[PathBuf]) -> Result<PathBuf, CliError> {
        let output = self.joined();
        let inputs = join::Inputs {
            logs: logs.to_vec(),
            plan: plan.to_owned(),
            read: ReadOptions::default(),
            at_s: None,
            output: output.clone(),
        };
        join::run(&inputs)?;
        Ok(output)
    }
}
