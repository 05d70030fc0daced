//! The built binary, as an operator and a script meet it.

mod answer;
mod carried;
mod columns;
mod commissioning;
mod compare;
mod compare_runs;
mod controllers;
mod csv;
mod cut;
mod cylinders;
mod dates;
mod figures;
mod fleet;
mod fleet_dates;
mod forms;
#[cfg(unix)]
mod historians;
mod hostile;
mod join;
mod join_share;
mod join_units;
mod layout;
#[cfg(unix)]
mod next_run;
mod odd_runs;
mod other_machines;
mod output;
#[cfg(unix)]
mod parts;
#[cfg(unix)]
mod pasted;
#[cfg(unix)]
mod pipes;
mod plan;
mod range_end;
mod record;
#[cfg(unix)]
mod record_senders;
mod record_taken;
mod recorders;
#[cfg(feature = "cloud")]
mod remote;
mod replan;
mod report;
mod season;
mod set_values;
mod simulate;
mod sliding;
#[cfg(unix)]
mod spared;
mod spellings;
mod starved;
mod tables;
mod telescope;
mod terminal;
mod tool;
mod trajectory;
mod unnamed;
mod view;
#[cfg(unix)]
mod watch;
mod whole_loop;
