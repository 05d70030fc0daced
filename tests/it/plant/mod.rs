//! The simulated arm from outside: laws of its runs, and the regimes of the paper's tasks.

mod detector;
mod log;
mod paper;
mod robust;
mod runs;
mod starts;
mod structures;
