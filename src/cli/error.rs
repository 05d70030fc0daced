//! Why a command did not finish, by exit code.

use std::{
    error::Error,
    fmt,
    io::{self, Write},
};

use super::terminal::{FAILED, harmless};

#[derive(Debug)]
pub(super) enum CliError {
    /// Arguments that contradict what is there: exit code 2.
    Usage(String),
    /// Standard output takes no more. Success if its reader went away, as `head` does.
    Output(io::Error),
    /// Everything else: exit code 1.
    Failed(Box<dyn Error + Send + Sync>),
}

#[derive(Debug, thiserror::Error)]
#[error("{step}")]
struct Step {
    step: String,
    source: Box<dyn Error + Send + Sync>,
}

impl<E: Error + Send + Sync + 'static> From<E> for CliError {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

impl CliError {
    /// Failed, and this is all that there is to say.
    pub(super) fn failed(why: impl Into<String>) -> Self {
        Self::Failed(why.into().into())
    }

    /// What failed, with the reason below it.
    pub(super) fn step(step: impl Into<String>) -> impl FnOnce(Box<dyn Error + Send + Sync>) -> Self {
        let step = step.into();
        move |source| Self::Failed(Box::new(Step { step, source }))
    }

    /// Says why, with all reasons below, and gives the exit code.
    pub(super) fn explained(&self, err: &mut dyn Write) -> u8 {
        let (text, mut cause): (String, Option<&dyn Error>) = match self {
            Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => return 0,
            Self::Output(error) => ("cannot write the output".to_owned(), Some(error)),
            Self::Usage(text) => (text.clone(), None),
            Self::Failed(error) => (error.to_string(), error.source()),
        };
        // Where standard error is closed there is nobody left to tell.
        let _ = writeln!(err, "{FAILED}error:{FAILED:#} {}", harmless(&text));
        while let Some(inner) = cause {
            let _ = writeln!(err, "  because: {}", harmless(&inner.to_string()));
            cause = inner.source();
        }
        if matches!(self, Self::Usage(_)) { 2 } else { 1 }
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(text) => f.write_str(text),
            Self::Output(error) => error.fmt(f),
            Self::Failed(error) => error.fmt(f),
        }
    }
}
