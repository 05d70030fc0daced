//! Plans and the search for them.

mod optima;
mod search;
