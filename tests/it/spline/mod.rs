//! Splines against SciPy and against their own laws.

mod conformance;
mod properties;
