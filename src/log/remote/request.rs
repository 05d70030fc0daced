//! A request to a store, waited for, and why one failed.

use std::{future::Future, io, sync::OnceLock};

use tokio::runtime::{Builder, Runtime};

/// Runs a request to its end on this thread; what it asks of the network goes on beside.
pub(super) fn wait<T>(request: impl Future<Output = T>) -> io::Result<T> {
    static RUNTIME: OnceLock<Result<Runtime, String>> = OnceLock::new();
    let begin = || {
        let begun = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        begun.map_err(|error| error.to_string())
    };
    match RUNTIME.get_or_init(begin) {
        Ok(runtime) => Ok(runtime.block_on(request)),
        Err(reason) => Err(io::Error::other(reason.clone())),
    }
}

/// Why a store said no, without the addresses, times and repetitions of its library.
pub(super) fn reason(error: &(dyn std::error::Error + 'static)) -> String {
    match error.downcast_ref() {
        Some(object_store::Error::NotFound { .. }) => return "there is no such object".to_owned(),
        Some(object_store::Error::Precondition { .. }) => {
            return "the object was changed after it was listed".to_owned();
        }
        Some(object_store::Error::PermissionDenied { .. } | object_store::Error::Unauthenticated { .. }) => {
            return "the store denies access: credentials come from the environment, such as AWS_ACCESS_KEY_ID, \
                    GOOGLE_SERVICE_ACCOUNT or AZURE_STORAGE_ACCOUNT_KEY"
                .to_owned();
        }
        _ => {}
    }
    let mut root = error;
    while let Some(source) = root.source() {
        root = source;
    }
    root.to_string().trim_end_matches([':', ' ']).to_owned()
}
