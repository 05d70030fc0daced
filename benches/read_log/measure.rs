//! CPU time and memory of this process, as Linux counts them.

use std::{
    fmt,
    path::Path,
    process::Command,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use cpu_time::ProcessTime;

/// The least time of several runs, wall and CPU apart.
#[derive(Clone, Copy)]
pub(crate) struct Best {
    pub(crate) wall_s: f64,
    /// User and system time of all threads.
    pub(crate) cpu_s: f64,
}

impl Default for Best {
    fn default() -> Self {
        Self { wall_s: f64::INFINITY, cpu_s: f64::INFINITY }
    }
}

impl Best {
    pub(crate) fn take(&mut self, run: impl FnOnce()) {
        let (start, before_s) = (Instant::now(), cpu_s());
        run();
        self.wall_s = self.wall_s.min(start.elapsed().as_secs_f64());
        self.cpu_s = self.cpu_s.min(cpu_s() - before_s);
    }
}

impl fmt::Display for Best {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} ms of CPU ({:.1} ms wall)", self.cpu_s * 1e3, self.wall_s * 1e3)
    }
}

fn cpu_s() -> f64 {
    ProcessTime::now().as_duration().as_secs_f64()
}

fn anonymous_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("RssAnon:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() * 1024.0 / 1e6
}

/// The most anonymous memory seen during a run beyond that before it, sampled each millisecond.
pub(crate) fn peak_anonymous_mb(run: impl FnOnce()) -> f64 {
    let before_mb = anonymous_mb();
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let sampler = scope.spawn(|| {
            let mut peak_mb = before_mb;
            while !done.load(Ordering::Relaxed) {
                peak_mb = peak_mb.max(anonymous_mb());
                std::thread::sleep(Duration::from_millis(1));
            }
            peak_mb
        });
        run();
        done.store(true, Ordering::Relaxed);
        sampler.join().unwrap() - before_mb
    })
}

/// Runs this benchmark again with one flag, in a process whose memory is untouched; the number
/// it prints.
pub(crate) fn child(flag: &str, path: &Path) -> f64 {
    let output = Command::new(std::env::current_exe().unwrap()).arg(flag).arg(path).output().unwrap();
    String::from_utf8(output.stdout).unwrap().trim().parse().unwrap()
}
