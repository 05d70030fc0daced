//! Algorithms by name.

use super::{Algorithm, Focus};

/// An algorithm with the names it goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedAlgorithm {
    /// As typed and written to files.
    pub name: &'static str,
    /// As in the literature.
    pub title: &'static str,
    /// The algorithm.
    pub algorithm: Algorithm,
}

const fn focused(focus: Focus, adaptive_rates: bool) -> Algorithm {
    Algorithm::Nsga3Fo { focus, adaptive_rates }
}

/// Every algorithm that has a name.
pub const ALGORITHMS: [NamedAlgorithm; 13] = [
    NamedAlgorithm { name: "nsga3-fo", title: "NSGA-III-FO", algorithm: Algorithm::NSGA3_FO },
    NamedAlgorithm {
        name: "nsga3-fo-local",
        title: "NSGA-III-FO, local focus",
        algorithm: focused(Focus::Local, false),
    },
    NamedAlgorithm {
        name: "nsga3-fo-literal",
        title: "NSGA-III-FO, literal focus",
        algorithm: focused(Focus::Literal, false),
    },
    NamedAlgorithm {
        name: "nsga3-fo-signed",
        title: "NSGA-III-FO, signed focus",
        algorithm: focused(Focus::Signed, false),
    },
    NamedAlgorithm {
        name: "nsga3-fo-adaptive",
        title: "NSGA-III-FO, adaptive rates",
        algorithm: focused(Focus::Local, true),
    },
    NamedAlgorithm { name: "nsga3", title: "NSGA-III", algorithm: Algorithm::Nsga3 },
    NamedAlgorithm { name: "unsga3", title: "U-NSGA-III", algorithm: Algorithm::UNsga3 },
    NamedAlgorithm { name: "nsga2", title: "NSGA-II", algorithm: Algorithm::Nsga2 },
    NamedAlgorithm { name: "moead", title: "MOEA/D", algorithm: Algorithm::Moead { normalized: false } },
    NamedAlgorithm {
        name: "moead-normalized",
        title: "MOEA/D, normalised",
        algorithm: Algorithm::Moead { normalized: true },
    },
    NamedAlgorithm { name: "msops2", title: "MSOPS-II", algorithm: Algorithm::Msops2 },
    NamedAlgorithm { name: "age-moea-2", title: "AGE-MOEA-II", algorithm: Algorithm::AgeMoea2 },
    NamedAlgorithm { name: "sms-emoa", title: "SMS-EMOA", algorithm: Algorithm::SmsEmoa },
];

impl NamedAlgorithm {
    /// The algorithm of a name or title, in any case and with any marks between its letters and digits: `nsga3-fo`, `NSGA-III`.
    pub fn find(name: &str) -> Option<Self> {
        let bare = |text: &str| -> String {
            text.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
        };
        let wanted = bare(name);
        ALGORITHMS.into_iter().find(|named| [named.name, named.title].iter().any(|own| bare(own) == wanted))
    }
}
