//! What fits find against what is there.
