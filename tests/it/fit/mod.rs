//! Fits to simulated machines, whose truth is known, and the commands made from them.

mod inversion;
mod matched;
mod recovery;
mod structure;
