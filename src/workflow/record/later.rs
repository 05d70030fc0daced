//! Keys of objects that come after the columns were settled: those of a joint begin a part of its own.

use super::{RecordError, Recording, told::FIRST_LINES};
use crate::log::{ColumnRead, JsonLines, TableStream};

/// So many lines are kept back until keys that are new are understood.
const MOST_LINES: usize = 100;
/// So many parts may begin so.
const MOST_PARTS: usize = 20;

/// Lines from the first with a new key on, which are not written yet.
#[derive(Debug)]
pub(super) struct Later {
    objects: JsonLines,
    lines: Vec<Vec<u8>>,
}

impl Recording<'_> {
    /// Whether a line waits, with those before it, until its keys are understood.
    pub(super) fn keeps_back(&self, line: &[u8]) -> bool {
        let is_new = |objects: &JsonLines| self.closed.len() < MOST_PARTS && objects.has_new_key(line);
        self.later.is_some() || self.open.is_some() && self.objects.as_ref().is_some_and(is_new)
    }

    pub(super) fn keep_back(&mut self, line: &[u8]) -> Result<(), RecordError> {
        let Some(objects) = &self.objects else { return Ok(()) };
        let later = self.later.get_or_insert_with(|| Later { objects: objects.anew(), lines: Vec::new() });
        if !later.objects.gather(line) {
            self.left_out.unread += 1;
            return Ok(());
        }
        later.lines.push(line.to_vec());
        let count = later.lines.len();
        if count.is_multiple_of(FIRST_LINES) { self.settle_later(count >= MOST_LINES) } else { Ok(()) }
    }

    /// Begins a part with the new keys if they are of a joint, and else, at the latest at the `last`, goes on without them.
    pub(super) fn settle_later(&mut self, last: bool) -> Result<(), RecordError> {
        let (Some(later), Some((stream, _))) = (&mut self.later, &self.open) else { return Ok(()) };
        let columns = |stream: &TableStream| stream.understood().columns.len();
        let has = |columns: &[ColumnRead], one: &ColumnRead| {
            columns.iter().any(|other| (&other.header, &other.becomes) == (&one.header, &one.becomes))
        };
        let table = later.objects.table();
        let new = TableStream::begin("what came", table.as_bytes(), &self.inputs.options).ok();
        let new = new.filter(|new| {
            let all = &new.understood().columns;
            stream.understood().columns.iter().all(|one| has(all, one))
        });
        let is_more = new.as_ref().map(|new| columns(new) > columns(stream));
        if is_more.is_none() && !last {
            return Ok(());
        }
        let Some(Later { objects, lines }) = self.later.take() else { return Ok(()) };
        let rest = self.objects.as_mut().map(JsonLines::rest).unwrap_or_default();
        self.write(&rest.into_bytes(), false)?;
        if is_more != Some(true) {
            return lines.iter().try_for_each(|line| {
                let row = self.objects.as_mut().and_then(|objects| objects.row(line));
                self.write(&row.unwrap_or_default().into_bytes(), false)
            });
        }
        if let Some((stream, log)) = self.open.take() {
            log.finish()?;
            self.closed.push(stream);
        }
        self.part_from = self.progress;
        self.left_out.later += 1;
        self.first_lines = lines.len();
        self.objects = Some(objects);
        self.settle(true)
    }
}
