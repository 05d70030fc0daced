//! The built binary, as an operator and a script meet it.

mod compare;
mod csv;
mod figures;
mod join;
#[cfg(unix)]
mod output;
mod plan;
mod report;
mod simulate;
mod tables;
mod terminal;
mod view;
mod whole_loop;
