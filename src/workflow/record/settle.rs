//! What the columns are, told by the first lines.

use super::{RecordError, Recording};
use crate::{
    log::{CsvError, TableStream, is_aside, is_header, other_header, read_csv_bytes},
    remark::Code,
};

/// What errors name in place of a file: that of the log is not there yet.
const WHAT_CAME: &str = "what came";

/// Lines after which it is given up to settle the columns.
const MOST_LINES: usize = 200;

/// So many objects are waited for while none has a key of the other side.
const ONE_SIDED: usize = 300;

/// So many rows are waited for a header that comes again and again.
const MOST_HEADLESS: u64 = 10_000;

impl Recording<'_> {
    /// Tells the columns by the lines so far, at the latest at the end; until then more of them may help.
    pub(super) fn settle(&mut self, last: bool) -> Result<(), RecordError> {
        if self.open.is_some() || self.lost || self.first_lines < 3 && !last {
            return Ok(());
        }
        let name = self.inputs.output.file_name().unwrap_or_default().to_string_lossy();
        if let Some(objects) = &mut self.objects {
            if objects.is_growing() && !last && self.first_lines < ONE_SIDED {
                return Ok(());
            }
            self.first = objects.table().into_bytes();
        } else if let Some(at) = other_header(&self.first) {
            return self.settle_each(at);
        }
        let one_sided = |stream: &TableStream| {
            stream.remarks().as_slice().iter().any(|remark| remark.code == Code::OneSide)
        };
        match TableStream::begin(WHAT_CAME, &self.first, &self.inputs.options) {
            // The other side's sensor may not send yet; rows that wait are lost if the power is.
            Ok(stream)
                if self.objects.is_some() && !last && self.first_lines < ONE_SIDED && one_sided(&stream) =>
            {
                Ok(())
            }
            Ok(stream) => {
                if let Some(objects) = &mut self.objects {
                    objects.settle();
                }
                let stream = stream.named(name.into_owned()).after(self.closed.last());
                self.progress.joints = stream.understood().joints.len();
                let log = stream.log(self.next_part()?)?;
                self.open = Some((stream, log));
                let first = std::mem::take(&mut self.first);
                self.write(&first, false)
            }
            Err(CsvError::NoJoints { .. } | CsvError::NoPair { .. })
                if self.objects.is_some() && !last && self.first_lines < ONE_SIDED =>
            {
                Ok(())
            }
            // Rows that are yet to come may settle it; an option that is missing will be missing then.
            Err(CsvError::NoTable { .. } | CsvError::NoTime { .. } | CsvError::TimeUnit { .. })
                if !last && self.first_lines < MOST_LINES =>
            {
                Ok(())
            }
            // What was recorded stays a run; rows of a header that says nothing are left out until the next one.
            Err(error) if !self.closed.is_empty() => {
                self.left_out.below += self.first_lines as u64;
                self.left_out.why.get_or_insert(error.to_string());
                (self.first_lines, self.lost) = (0, true);
                self.first.clear();
                Ok(())
            }
            Err(error @ (CsvError::NoUnit { .. } | CsvError::NotByRows { .. })) => Err(error.into()),
            Err(error)
                if self.objects.is_none() && !self.first.split(|byte| *byte == b'\n').any(is_header) =>
            {
                self.await_header(error, last)
            }
            Err(error) => match read_csv_bytes(WHAT_CAME, &self.first, &self.inputs.options) {
                Ok(_) => Err(RecordError::ImportReads(error)),
                Err(_) => Err(error.into()),
            },
        }
    }

    /// Whether a line before the columns are settled is none of their table: words among rows, or rows of a header that says
    /// nothing.
    pub(super) fn steps_over(&mut self, line: &[u8]) -> bool {
        if self.lost && !is_header(line) {
            self.left_out.below += 1;
            return true;
        }
        self.lost = false;
        if self.closed.is_empty() && is_header(line) && is_numbers(&self.first) {
            self.leave_out_headless();
        }
        let aside = is_aside(&self.first, line);
        self.left_out.asides += u64::from(aside);
        aside
    }

    /// Rows alone came: who sends may repeat the header. What is wrong without one is said where none comes.
    fn await_header(&mut self, error: CsvError, last: bool) -> Result<(), RecordError> {
        self.leave_out_headless();
        let error = self.left_out.no_header.take().unwrap_or(error);
        if last || self.left_out.headless >= MOST_HEADLESS {
            return Err(error.into());
        }
        self.left_out.no_header = Some(error);
        Ok(())
    }

    fn leave_out_headless(&mut self) {
        self.left_out.headless += std::mem::take(&mut self.first_lines) as u64;
        self.first.clear();
    }

    /// Another header came before the columns of the first one were settled: each has the rows below it.
    fn settle_each(&mut self, at: usize) -> Result<(), RecordError> {
        let later = self.first.split_off(at);
        let rows = self.first_lines.saturating_sub(later.split_inclusive(|byte| *byte == b'\n').count());
        match self.settle(true) {
            Err(RecordError::Csv(_)) => {
                self.left_out.untold += rows as u64;
                self.first.clear();
            }
            settled => settled?,
        }
        self.first_lines = 0;
        later
            .split(|byte| *byte == b'\n')
            .filter(|line| !line.is_empty())
            .try_for_each(|line| self.take(line))
    }
}

/// Whether all cells of all lines are numbers.
fn is_numbers(lines: &[u8]) -> bool {
    let text = String::from_utf8_lossy(lines);
    text.split([',', ';', '\t', ' ', '\n'])
        .map(str::trim)
        .all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok())
}
