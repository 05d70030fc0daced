//! The same recording whatever the number of threads.

use super::{file::*, *};

/// Many chunks, some damaged, of messages whose joints change, some undecodable.
fn unruly() -> Vec<u8> {
    let mut log = Log::default();
    let planned = log.channel(Channel::cdr("/planned/joint_states", "sensor_msgs/msg/JointState"));
    let measured = log.channel(Channel::cdr("/joint_states", "sensor_msgs/msg/JointState"));
    for k in 0..2000_i64 {
        let name = |j: i64| format!("j{}", (k / 7 + j * 3) % 11);
        let names: Vec<String> = (0..2 + k % 3).map(name).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let values: Vec<f64> = (0..names.len()).map(|j| (k + j as i64) as f64 * 1e-3).collect();
        for channel in [planned, measured] {
            let mut data = states(k, &names, &values);
            if k % 13 == 0 || (k / 16) % 9 == 0 {
                data = states(k, &[&format!("phantom{k}"), "j3"], &[0.0; 2]);
                data.truncate(data.len() - 9);
            }
            log.send(channel, stamp(k), data);
        }
    }
    let mut bytes = [&MAGIC[..], &log.definitions()].concat();
    for (n, messages) in log.messages.chunks(16).enumerate() {
        let compression = ["zstd", "lz4", ""][n % 3];
        let mut packed = chunk(compression, &message_records(messages));
        if n % 17 == 3 {
            let middle = packed.len() / 2;
            packed[middle] ^= 0x40;
        }
        bytes.extend(packed);
    }
    bytes.truncate(bytes.len() - 100);
    bytes
}

#[test]
fn the_number_of_threads_does_not_show() {
    let stored = store(&[("run.mcap", &unruly())]);
    let read = || hydrotrace::log::read_recording(&stored.paths, &ReadOptions::default()).unwrap();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(read);
    assert!(joints(&one.measured).iter().all(|name| name.starts_with('j')), "{:?}", joints(&one.measured));
    for code in [Code::DamagedChunk, Code::NotClosed, Code::UndecodableMessage, Code::JointsChange] {
        assert!(count(&one.remarks, code) > 0, "{code:?}");
    }
    for threads in [1, 2, 5, 5, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(read) == one, "{threads} threads");
    }
    assert!(read() == one);
}

#[test]
fn several_recordings_are_read_at_once_within_one_pool() {
    use rayon::prelude::*;
    let stored = store(&[("run.mcap", &unruly())]);
    let read = || hydrotrace::log::read_recording(&stored.paths, &ReadOptions::default()).unwrap();
    let one = read();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    pool.install(|| assert!((0..24).into_par_iter().all(|_| read() == one)));
}
