//! Logs in the making: by the crate `mcap`, and byte by byte for what that never writes.

use std::{collections::BTreeMap, io::Cursor, path::PathBuf};

use mcap::{WriteOptions, records::MessageHeader, write::Writer};
use tempfile::TempDir;

/// Topic, type, and how both are encoded.
#[derive(Debug, Clone)]
pub(crate) struct Channel {
    pub(crate) topic: String,
    pub(crate) type_name: String,
    pub(crate) schema_encoding: String,
    pub(crate) schema: Vec<u8>,
    pub(crate) encoding: String,
}

impl Channel {
    pub(crate) fn cdr(topic: &str, type_name: &str) -> Self {
        Self {
            topic: topic.into(),
            type_name: type_name.into(),
            schema_encoding: "ros2msg".into(),
            schema: super::schema::text(type_name).into_bytes(),
            encoding: "cdr".into(),
        }
    }

    pub(crate) fn with_schema(mut self, encoding: &str, schema: impl Into<Vec<u8>>) -> Self {
        self.schema_encoding = encoding.into();
        self.schema = schema.into();
        self
    }

    pub(crate) fn encoded(mut self, encoding: &str) -> Self {
        self.encoding = encoding.into();
        self
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Message {
    pub(crate) channel: usize,
    pub(crate) log_ns: u64,
    pub(crate) publish_ns: u64,
    pub(crate) data: Vec<u8>,
}

/// Channels and messages, before they become bytes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Log {
    pub(crate) channels: Vec<Channel>,
    pub(crate) messages: Vec<Message>,
}

impl Log {
    pub(crate) fn channel(&mut self, channel: Channel) -> usize {
        self.channels.push(channel);
        self.channels.len() - 1
    }

    pub(crate) fn send(&mut self, channel: usize, ns: i64, data: Vec<u8>) {
        self.messages.push(Message { channel, log_ns: ns as u64, publish_ns: ns as u64, data });
    }

    /// As the crate `mcap` writes it.
    pub(crate) fn bytes(&self, options: WriteOptions) -> Vec<u8> {
        let mut writer = Writer::with_options(Cursor::new(Vec::new()), options).unwrap();
        let ids: Vec<u16> = self
            .channels
            .iter()
            .map(|channel| {
                let schema = if channel.schema_encoding == "none" {
                    0
                } else {
                    writer.add_schema(&channel.type_name, &channel.schema_encoding, &channel.schema).unwrap()
                };
                writer.add_channel(schema, &channel.topic, &channel.encoding, &BTreeMap::new()).unwrap()
            })
            .collect();
        for (sequence, message) in self.messages.iter().enumerate() {
            let header = MessageHeader {
                channel_id: ids[message.channel],
                sequence: sequence as u32,
                log_time: message.log_ns,
                publish_time: message.publish_ns,
            };
            writer.write_to_known_channel(&header, &message.data).unwrap();
        }
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }

    /// Definitions, then chunks of `per_chunk` messages each, compressed as named (`""`, `lz4`,
    /// `zstd`, or `loose` for no chunks), no summary.
    pub(crate) fn by_hand(&self, compression: &str, per_chunk: usize) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(record(1, &[text(""), text("")].concat()));
        bytes.extend(self.definitions());
        for messages in self.messages.chunks(per_chunk) {
            let inside = message_records(messages);
            match compression {
                "loose" => bytes.extend(inside),
                _ => bytes.extend(chunk(compression, &inside)),
            }
        }
        bytes.extend(end());
        bytes
    }

    pub(crate) fn definitions(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (k, channel) in self.channels.iter().enumerate() {
            let id = k as u16 + 1;
            bytes.extend(schema_record(id, &channel.type_name, &channel.schema_encoding, &channel.schema));
            bytes.extend(channel_record(id, id, &channel.topic, &channel.encoding));
        }
        bytes
    }
}

pub(crate) fn message_records(messages: &[Message]) -> Vec<u8> {
    messages
        .iter()
        .flat_map(|m| message_record(m.channel as u16 + 1, m.log_ns, m.publish_ns, &m.data))
        .collect()
}

pub(crate) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

pub(crate) fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

pub(crate) fn text(text: &str) -> Vec<u8> {
    block(text.as_bytes())
}

fn block(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

pub(crate) fn schema_record(id: u16, name: &str, encoding: &str, data: &[u8]) -> Vec<u8> {
    record(3, &[&id.to_le_bytes()[..], &text(name), &text(encoding), &block(data)].concat())
}

pub(crate) fn channel_record(id: u16, schema: u16, topic: &str, encoding: &str) -> Vec<u8> {
    let ids = [id.to_le_bytes(), schema.to_le_bytes()].concat();
    record(4, &[&ids[..], &text(topic), &text(encoding), &block(&[])].concat())
}

pub(crate) fn message_record(channel: u16, log_ns: u64, publish_ns: u64, data: &[u8]) -> Vec<u8> {
    let head = [&channel.to_le_bytes()[..], &[0; 4], &log_ns.to_le_bytes(), &publish_ns.to_le_bytes()];
    record(5, &[&head.concat()[..], data].concat())
}

/// A chunk with a checksum.
pub(crate) fn chunk(compression: &str, records: &[u8]) -> Vec<u8> {
    chunk_with(compression, records.len() as u64, crc32fast::hash(records), &compressed(compression, records))
}

pub(crate) fn compressed(compression: &str, records: &[u8]) -> Vec<u8> {
    match compression {
        "zstd" => zstd::bulk::compress(records, 3).unwrap(),
        "lz4" => {
            let mut encoder = lz4_flex::frame::FrameEncoder::with_frame_info(
                // As the C library does unless told otherwise.
                lz4_flex::frame::FrameInfo::new().block_size(lz4_flex::frame::BlockSize::Max64KB),
                Vec::new(),
            );
            std::io::Write::write_all(&mut encoder, records).unwrap();
            encoder.finish().unwrap()
        }
        _ => records.to_vec(),
    }
}

pub(crate) fn chunk_with(compression: &str, promised: u64, crc: u32, packed: &[u8]) -> Vec<u8> {
    let size = (packed.len() as u64).to_le_bytes();
    let head = [&[0; 16][..], &promised.to_le_bytes(), &crc.to_le_bytes(), &text(compression), &size];
    record(6, &[&head.concat()[..], packed].concat())
}

/// `DataEnd`, `Footer` and magic.
pub(crate) fn end() -> Vec<u8> {
    [record(0x0F, &[0; 4]), record(2, &[0; 20]), MAGIC.to_vec()].concat()
}

/// Files in a folder that lasts as long as this.
pub(crate) struct Stored {
    pub(crate) folder: TempDir,
    pub(crate) paths: Vec<PathBuf>,
}

pub(crate) fn store(files: &[(&str, &[u8])]) -> Stored {
    let folder = tempfile::tempdir().unwrap();
    let paths = files.iter().map(|(name, bytes)| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    });
    let paths = paths.collect();
    Stored { folder, paths }
}
