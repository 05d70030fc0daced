//! Plans and the search for them.

mod choice;
mod optima;
mod other_arms;
mod search;
