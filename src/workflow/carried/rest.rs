//! How long joints rest before and after a plan: a start from rest needs a rest to be seen as one.

/// Rest before the plan in the log of a plan, s.
pub const PLAN_LEAD_S: f64 = 1.5;
/// Rest after a plan that is sent with a command, s: the command comes back to the plan within it.
pub const COMMAND_TAIL_S: f64 = 2.0;
/// Rest before the plan in the log of a run, s.
pub const RUN_LEAD_S: f64 = 2.0;
/// Rest after it, s: the joints are watched until they stand.
pub const RUN_TAIL_S: f64 = 3.0;
