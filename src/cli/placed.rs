//! An option that a verb does not know, and another does.

use clap::{
    Command, Error,
    error::{ContextKind, ContextValue, ErrorKind},
};

use super::gates::is_limit;

/// Says of an option that the verb does not know whose it is.
pub(super) fn placed(mut error: Error, program: &Command) -> Error {
    let Some(ContextValue::String(arg)) = error.get(ContextKind::InvalidArg) else { return error };
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    let long = arg.strip_prefix("--").map(|arg| arg.split('=').next().unwrap_or(arg));
    let knows = |verb: &&Command| {
        long.is_some_and(|long| {
            verb.get_arguments().any(|own| !own.is_hide_set() && own.get_long() == Some(long))
        })
    };
    let verbs: Vec<String> = program
        .get_subcommands()
        .filter(knows)
        .map(|verb| format!("`hydrotrace {}`", verb.get_name()))
        .collect();
    let tip = match verbs.as_slice() {
        _ if is_limit(arg) => format!("{arg} is a limit of `hydrotrace report`"),
        [] => return error,
        [verb] => format!("{arg} is an option of {verb}"),
        [verbs @ .., last] => format!("{arg} is an option of {} and {last}", verbs.join(", ")),
    };
    error.remove(ContextKind::SuggestedArg);
    error.remove(ContextKind::Usage);
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}
