//! `watch`

mod serve;

use std::{
    cell::RefCell,
    io::ErrorKind,
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use super::{
    CliError, Outcome, Run,
    console::{Console, Target, progress, spare_inputs},
    fleet::SourceArgs,
    gates::GateArgs,
    interrupt,
    number::seconds,
    read::ReadArgs,
    terminal::harmless,
};
use crate::{
    document::line,
    input_file,
    render::{report, watch as words},
    workflow::watch::{Event, Inputs, Words, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace watch /data/logs --into reports
  hydrotrace watch /data/logs --into reports --serve --max-transition-peak-deg 0.5
  hydrotrace watch /mnt/share --into reports --machine-from path:1 --every 10
  hydrotrace watch /data/logs --into reports --once     (what is there now, for a timer)

A log is reported when it is whole: when it is closed, or has not changed for --settle seconds. reports/index.html shows
all runs; reports is a dataset too, as of `fleet scan`. Ctrl-C ends with everything written.";

/// Transitions listed on the page of a run.
const MOST: usize = 60;

/// Report each log of a folder when it is whole: pages and an index
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    /// Look every SECONDS
    #[arg(long, value_name = "SECONDS", default_value = "2", value_parser = seconds)]
    every: f64,

    /// A log is whole when it has not changed for SECONDS; an MCAP log that was not closed, for 60 at least
    #[arg(long, value_name = "SECONDS", default_value = "3", value_parser = seconds)]
    settle: f64,

    /// End when all logs are reported that are whole now
    #[arg(long)]
    once: bool,

    /// Show the folder to browsers of this computer at http://127.0.0.1:PORT/; the index renews itself there
    #[arg(long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "8020")]
    serve: Option<u16>,

    /// Print a line of JSON for each log (schemas/watch.v1.schema.json in the repository)
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    gates: GateArgs,
}

impl Args {
    fn inputs(&self) -> Result<Inputs, CliError> {
        let [every, settle] = [self.every, self.settle].map(Duration::try_from_secs_f64);
        let longer = |_| CliError::Usage("no folder is watched that long; give fewer seconds".to_owned());
        let (fleet, gates) = (self.source.inputs(&self.read)?, self.gates.gates.clone());
        let (every, settle) = (every.map_err(longer)?, settle.map_err(longer)?);
        Ok(Inputs { fleet, gates, every, settle, once: self.once })
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        // Logs come and go while this goes on.
        input_file::forget();
        spare_inputs(Some(&self.source.into.join("index.html")), &[])?;
        let inputs = self.inputs()?;
        if let Some(port) = self.serve {
            let address = serve::start(&self.source.into, port)?;
            console.say(words::served(&address));
        }
        interrupt::ask_only();
        let bar = progress(None, "{spinner} {msg}");
        bar.enable_steady_tick(Duration::from_millis(200));
        let (broken, failed) = (AtomicBool::new(false), RefCell::new(None));
        let words_of_read = self.read.words();
        let page = |found: &_| report::page(&report::name(found), found, None, MOST, &words_of_read);
        let watched = run(
            &inputs,
            &Words { page: &page, index: &words::index },
            &|| interrupt::is_asked() || broken.load(Ordering::Relaxed),
            &mut |event| match event {
                Event::Reported(run) => {
                    let text = if self.json { line(run) } else { harmless(&words::line(run)) };
                    if let Err(error) = bar.suspend(|| console.announce(&text)) {
                        broken.store(true, Ordering::Relaxed);
                        failed.replace(Some(error));
                    }
                }
                Event::Waiting { reported, open } => bar.set_message(words::waiting(reported, open)),
                Event::Trouble(why) => bar.suspend(|| console.say(harmless(&words::trouble(why)))),
            },
        );
        bar.finish_and_clear();
        let watched = watched?;
        // A reader that has left ends the watch; what it saw is judged.
        if let Some(error) = failed.into_inner().filter(|error| error.kind() != ErrorKind::BrokenPipe) {
            return Err(CliError::Output(error));
        }
        let target = Target::stdout(self.json);
        let result = if self.json { String::new() } else { target.text(&words::watched(&watched)) };
        let outcome = console.finish(&target, &result, &watched.remarks, &[])?;
        Ok(match outcome {
            _ if watched.not_kept > 0 => Outcome::LimitBroken,
            Outcome::Clean if watched.doubtful > 0 => Outcome::Remarks,
            outcome => outcome,
        })
    }
}
