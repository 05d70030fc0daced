//! CPU time and memory of this process, as Linux counts them.

use std::{
    fmt,
    path::Path,
    process::Command,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use cpu_time::ProcessTime;

/// What one run took.
#[derive(Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "the unit is part of a name")]
pub(crate) struct Time {
    pub(crate) wall_s: f64,
    /// User and system time of all threads.
    pub(crate) cpu_s: f64,
    /// System time, counted in ticks of 10 ms.
    pub(crate) kernel_s: f64,
}

impl Time {
    pub(crate) fn of(run: impl FnOnce()) -> Self {
        let (start, cpu_s, kernel_s) = (Instant::now(), cpu_s(), kernel_s());
        run();
        Self {
            wall_s: start.elapsed().as_secs_f64(),
            cpu_s: self::cpu_s() - cpu_s,
            kernel_s: self::kernel_s() - kernel_s,
        }
    }

    /// CPU time outside the kernel.
    fn user_s(&self) -> f64 {
        self.cpu_s - self.kernel_s
    }

    /// The run that took the least CPU time, whole: its kernel time goes with its CPU time.
    pub(crate) fn least_cpu(runs: &[Self]) -> Self {
        runs.iter().copied().min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s)).unwrap()
    }

    /// The least wall time of several runs, s.
    pub(crate) fn least_wall_s(runs: &[Self]) -> f64 {
        runs.iter().map(|run| run.wall_s).fold(f64::INFINITY, f64::min)
    }

    /// The median CPU time outside the kernel, s: single runs are counted in coarse ticks.
    pub(crate) fn median_user_s(runs: &[Self]) -> f64 {
        hydrotrace::math::median(runs.iter().map(Self::user_s).collect())
    }
}

/// As the child prints it and [`timed`] reads it.
impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.wall_s, self.cpu_s, self.kernel_s)
    }
}

fn cpu_s() -> f64 {
    ProcessTime::now().as_duration().as_secs_f64()
}

fn kernel_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let (_, after_name) = stat.rsplit_once(')').unwrap();
    after_name.split_whitespace().nth(12).unwrap().parse::<f64>().unwrap() / 100.0
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

/// Runs this benchmark again with one task, in a process of its own: allocators keep memory from
/// one run for the next, so only the first is what a user sees. The numbers it prints.
pub(crate) fn child(task: &str, threads: usize, path: &Path) -> Vec<f64> {
    let mut command = Command::new(std::env::current_exe().unwrap());
    let output =
        command.args(["--task", task, "--threads", &threads.to_string()]).arg(path).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// The time of a task in a process of its own.
pub(crate) fn timed(task: &str, threads: usize, path: &Path) -> Time {
    match child(task, threads, path)[..] {
        [wall_s, cpu_s, kernel_s] => Time { wall_s, cpu_s, kernel_s },
        _ => panic!("{task} of {} failed", path.display()),
    }
}
