//! Plans and the search for them.

mod choice;
mod optima;
mod search;
