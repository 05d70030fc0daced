//! Decodes blocks on all threads and appends their content in the order of the file.

use std::{
    collections::BTreeMap,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{
    content::{Content, Extracted, Route, TopicCount},
    description,
};
use crate::{
    log::{
        decode::LayoutCache,
        file::{Block, Blocks, Loss, MessageRecord, Opcode, Source, records},
        source::Spec,
    },
    remark::Code,
    threads,
};

/// A block, the file that it is in, the channels of that, and its index.
pub(super) type Work<'a> = (Block, &'a Source, Arc<BTreeMap<u16, Route>>, usize);

/// Content of one block; emptied and reused. Cost is by the topics that the block touches: files
/// may have many channels and many blocks.
struct Piece {
    contents: Vec<Option<Content>>,
    topics: Vec<TopicCount>,
    is_touched: Vec<bool>,
    touched_contents: Vec<usize>,
    touched_topics: Vec<usize>,
    /// Topics of URDFs, and the first text of each.
    descriptions: Vec<(usize, String)>,
    unknown: u64,
    loss: Loss,
    /// Whether bytes follow the last whole record.
    has_tail: bool,
    messages: u64,
}

struct Progress<'a> {
    work: &'a [Work<'a>],
    next: usize,
    waiting: BTreeMap<usize, Piece>,
    spare: Vec<Piece>,
    unknown: u64,
    out: &'a mut Extracted,
}

/// Decodes blocks on all threads and appends them in the order of the file, so that the result
/// does not depend on the number of threads. Returns how many messages are of no known channel.
pub(super) fn read_blocks(work: &[Work<'_>], specs: &[Spec], joints: &[String], out: &mut Extracted) -> u64 {
    let topics = out.topics.len();
    let fresh = || Piece {
        contents: vec![None; specs.len()],
        topics: vec![TopicCount::default(); topics],
        is_touched: vec![false; specs.len()],
        touched_contents: Vec::new(),
        touched_topics: Vec::new(),
        descriptions: Vec::new(),
        unknown: 0,
        loss: Loss::Nothing,
        has_tail: false,
        messages: 0,
    };
    let threads = threads::count();
    let counter = AtomicUsize::new(0);
    let progress =
        Mutex::new(Progress { work, next: 0, waiting: BTreeMap::new(), spare: Vec::new(), unknown: 0, out });
    let moved = Condvar::new();
    threads::everywhere(|| {
        let mut blocks = Blocks::new();
        let _release = ReleaseOnPanic { progress: &progress, moved: &moved };
        loop {
            let index = counter.fetch_add(1, Ordering::Relaxed);
            let Some((block, source, routes, _)) = work.get(index) else { return };
            let mut piece = lock(&progress).spare.pop().unwrap_or_else(fresh);
            let new = |source: usize| Content::new(&specs[source], joints);
            read_block(blocks.open(*block, source), routes, &new, &mut piece);
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
    lock(&progress).unknown
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A thread that panics never hands over its block; those that wait for it must not wait forever.
struct ReleaseOnPanic<'a, 'b> {
    progress: &'a Mutex<Progress<'b>>,
    moved: &'a Condvar,
}

impl Drop for ReleaseOnPanic<'_, '_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            lock(self.progress).next = usize::MAX / 2;
            self.moved.notify_all();
        }
    }
}

impl Progress<'_> {
    fn append_ready(&mut self) {
        while let Some(mut piece) = self.waiting.remove(&self.next) {
            let file = self.work.get(self.next).map_or(0, |(_, _, _, file)| *file);
            self.next += 1;
            for source in piece.touched_contents.drain(..) {
                piece.is_touched[source] = false;
                if let Some(content) = &mut piece.contents[source] {
                    let all = &mut self.out.sources[source];
                    if all.parts.last().is_none_or(|(last, _)| *last != file) {
                        all.parts.push((file, all.content.rows()));
                    }
                    all.content.append(content);
                }
            }
            for topic in piece.touched_topics.drain(..) {
                self.out.topics[topic].add(&std::mem::take(&mut piece.topics[topic]));
            }
            for (topic, text) in piece.descriptions.drain(..) {
                let length = |topic: usize| self.out.topics[topic].topic.len();
                if self.out.description.as_ref().is_none_or(|(known, _)| length(topic) < length(*known)) {
                    self.out.description = Some((topic, text));
                }
            }
            self.unknown += piece.unknown;
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
                Loss::Doubtful(reason) | Loss::Dropped(reason) => {
                    remarks.add(Code::DamagedChunk, 1, format!("a chunk was dropped: {reason}"));
                }
            }
            remarks.add(
                Code::PartialChunk,
                u64::from(std::mem::take(&mut piece.has_tail)),
                "chunks that end in bytes that are no record; the messages before these were kept",
            );
            piece.messages = 0;
            self.spare.push(piece);
        }
    }
}

fn read_block(
    (bytes, loss): (&[u8], Loss),
    routes: &BTreeMap<u16, Route>,
    new: &impl Fn(usize) -> Content,
    piece: &mut Piece,
) {
    piece.loss = loss;
    let mut end = 0;
    let mut last: Option<(u16, &Route)> = None;
    let mut caches: BTreeMap<u16, LayoutCache> = BTreeMap::new();
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
        if topic.messages == 0 {
            piece.touched_topics.push(route.topic);
        }
        topic.count(message.log_time_ns);
        topic.unread += u64::from(route.unreadable);
        if let Some((source, decoder)) = &route.read {
            if !piece.is_touched[*source] {
                piece.is_touched[*source] = true;
                piece.touched_contents.push(*source);
            }
            let content = piece.contents[*source].get_or_insert_with(|| new(*source));
            if let Err(error) = content.read(decoder, &mut caches, &message) {
                topic.undecodable += 1;
                topic.first_error.get_or_insert(error);
            }
        } else if route.describes
            && piece.descriptions.iter().all(|(known, _)| *known != route.topic)
            && let Some(text) = description::text(message.data)
        {
            piece.descriptions.push((route.topic, text));
        }
    }
    if piece.loss == Loss::Nothing {
        piece.has_tail = end < bytes.len();
    }
}
