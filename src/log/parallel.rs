//! Decodes blocks on all threads and appends what they yield in the order of the file.

use std::{
    collections::BTreeMap,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{
    file::{Block, Blocks, Loss, MessageRecord, Opcode, records},
    read::{Content, Extracted, Route, TopicCount},
    source::Spec,
};
use crate::remark::Code;

/// A block and the channels of its file.
pub(super) type Work<'a> = (Block<'a>, Arc<BTreeMap<u16, Route>>);

/// What one block yields; emptied and reused.
struct Piece {
    contents: Vec<Content>,
    topics: Vec<TopicCount>,
    unknown: u64,
    loss: Loss,
    messages: u64,
}

struct Progress<'a> {
    next: usize,
    waiting: BTreeMap<usize, Piece>,
    spare: Vec<Piece>,
    out: &'a mut Extracted,
}

/// Decodes blocks on all threads and appends them in the order of the file, so that the result
/// does not depend on the number of threads.
pub(super) fn read_blocks(work: &[Work<'_>], specs: &[Spec], joints: &[String], out: &mut Extracted) {
    let topics = out.topics.len();
    let fresh = || Piece {
        contents: specs.iter().map(|spec| Content::new(spec, joints)).collect(),
        topics: vec![TopicCount::default(); topics],
        unknown: 0,
        loss: Loss::Nothing,
        messages: 0,
    };
    let threads = rayon::current_num_threads();
    let counter = AtomicUsize::new(0);
    let progress = Mutex::new(Progress { next: 0, waiting: BTreeMap::new(), spare: Vec::new(), out });
    let moved = Condvar::new();
    rayon::broadcast(|_| {
        let mut blocks = Blocks::new();
        loop {
            let index = counter.fetch_add(1, Ordering::Relaxed);
            let Some((block, routes)) = work.get(index) else { return };
            let mut piece = lock(&progress).spare.pop().unwrap_or_else(fresh);
            read_block(&mut blocks, *block, routes, &mut piece);
            let mut state = lock(&progress);
            // A thread may run ahead of the slowest by a few blocks only: memory stays bounded.
            while index > state.next + 4 * threads {
                state = moved.wait(state).unwrap_or_else(PoisonError::into_inner);
            }
            state.waiting.insert(index, piece);
            state.append_ready();
            drop(state);
            moved.notify_all();
        }
    });
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Progress<'_> {
    fn append_ready(&mut self) {
        while let Some(mut piece) = self.waiting.remove(&self.next) {
            self.next += 1;
            for (source, content) in self.out.sources.iter_mut().zip(&mut piece.contents) {
                source.content.append(content);
            }
            for (total, part) in self.out.topics.iter_mut().zip(&mut piece.topics) {
                total.add(&std::mem::take(part));
            }
            let remarks = &mut self.out.remarks;
            remarks.add(
                Code::UnknownChannel,
                std::mem::take(&mut piece.unknown),
                "messages of channels that the file does not define",
            );
            match std::mem::replace(&mut piece.loss, Loss::Nothing) {
                Loss::Nothing => {}
                Loss::Cut => remarks.add(
                    Code::PartialChunk,
                    1,
                    format!(
                        "the file ends within a chunk; {} whole messages before the cut were kept",
                        piece.messages
                    ),
                ),
                Loss::Dropped(reason) => {
                    remarks.add(Code::DamagedChunk, 1, format!("a chunk was dropped: {reason}"));
                }
            }
            piece.messages = 0;
            self.spare.push(piece);
        }
    }
}

impl TopicCount {
    fn add(&mut self, part: &Self) {
        if part.messages == 0 {
            return;
        }
        let first = self.messages == 0;
        self.first_log_ns = if first { part.first_log_ns } else { self.first_log_ns.min(part.first_log_ns) };
        self.last_log_ns = self.last_log_ns.max(part.last_log_ns);
        self.messages += part.messages;
        self.undecodable += part.undecodable;
        if self.first_error.is_none() {
            self.first_error.clone_from(&part.first_error);
        }
    }

    fn count(&mut self, log_ns: u64) {
        self.first_log_ns = if self.messages == 0 { log_ns } else { self.first_log_ns.min(log_ns) };
        self.last_log_ns = self.last_log_ns.max(log_ns);
        self.messages += 1;
    }
}

fn read_block(blocks: &mut Blocks, block: Block<'_>, routes: &BTreeMap<u16, Route>, piece: &mut Piece) {
    let (bytes, loss) = blocks.open(block);
    piece.loss = loss;
    let mut end = 0;
    let mut last: Option<(u16, &Route)> = None;
    for record in records(bytes) {
        end = record.end;
        if record.opcode != Opcode::MESSAGE {
            continue;
        }
        let Some(message) = MessageRecord::parse(record.body) else { continue };
        piece.messages += 1;
        let route = match last {
            Some((id, route)) if id == message.channel_id => Some(route),
            _ => routes.get(&message.channel_id),
        };
        let Some(route) = route else {
            piece.unknown += 1;
            continue;
        };
        last = Some((message.channel_id, route));
        let topic = &mut piece.topics[route.topic];
        topic.count(message.log_time_ns);
        if let Some((source, decoder)) = &route.read
            && let Err(error) = piece.contents[*source].read(decoder, &message)
        {
            topic.undecodable += 1;
            topic.first_error.get_or_insert(error);
        }
    }
    if end < bytes.len() && piece.loss == Loss::Nothing {
        piece.loss = Loss::Dropped(format!("its last {} bytes are no record", bytes.len() - end));
    }
}
