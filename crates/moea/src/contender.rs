//! Algorithms by name.

use super::{Algorithm, Focus};

/// An algorithm with the names it goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contender {
    /// As typed and written to files.
    pub name: &'static str,
    /// As in the literature.
    pub title: &'static str,
    /// What it is.
    pub algorithm: Algorithm,
}

const fn focused(focus: Focus, adaptive_rates: bool) -> Algorithm {
    Algorithm::Nsga3Fo { focus, adaptive_rates }
}

/// Every algorithm that has a name.
pub const CONTENDERS: [Contender; 9] = [
    Contender { name: "nsga3-fo", title: "NSGA-III-FO", algorithm: Algorithm::NSGA3_FO },
    Contender {
        name: "nsga3-fo-literal",
        title: "NSGA-III-FO, literal focus",
        algorithm: focused(Focus::Literal, false),
    },
    Contender {
        name: "nsga3-fo-signed",
        title: "NSGA-III-FO, signed focus",
        algorithm: focused(Focus::Signed, false),
    },
    Contender {
        name: "nsga3-fo-adaptive",
        title: "NSGA-III-FO, adaptive rates",
        algorithm: focused(Focus::Local, true),
    },
    Contender { name: "nsga3", title: "NSGA-III", algorithm: Algorithm::Nsga3 },
    Contender { name: "nsga2", title: "NSGA-II", algorithm: Algorithm::Nsga2 },
    Contender { name: "moead", title: "MOEA/D", algorithm: Algorithm::Moead { normalized: false } },
    Contender {
        name: "moead-normalized",
        title: "MOEA/D, normalised",
        algorithm: Algorithm::Moead { normalized: true },
    },
    Contender { name: "msops2", title: "MSOPS-II", algorithm: Algorithm::Msops2 },
];

impl Contender {
    /// The contender of a name, in any case.
    pub fn named(name: &str) -> Option<Self> {
        CONTENDERS.into_iter().find(|contender| contender.name.eq_ignore_ascii_case(name))
    }
}
