//! Logs in object stores and on web servers, by address: `s3://`, `gs://`, `az://`, `https://`. Feature `cloud`.

#[cfg(feature = "cloud")]
mod reader;
#[cfg(feature = "cloud")]
mod request;
#[cfg(feature = "cloud")]
mod store;

use std::{path::Path, sync::Arc};

use thiserror::Error;

use super::file::ReadAt;

/// Why an address leads to no log.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum RemoteError {
    #[error(
        "this build reads no object stores, and {address} lies in one; build it with `--features cloud`, mount the \
         store, or copy the logs"
    )]
    NotBuilt { address: String },
    #[error(
        "{address:?} is no address of logs: {reason}; expected s3://BUCKET/PATH, gs://BUCKET/PATH, az://CONTAINER/PATH \
         or https://HOST/PATH, with * for any signs of a name and ** for any folders"
    )]
    Address { address: String, reason: String },
    #[error("cannot {action} {address}: {reason}")]
    Store { action: &'static str, address: String, reason: String },
}

/// A log in a store, not read yet.
#[derive(Debug, Clone)]
pub struct Object {
    /// Where it is.
    pub address: String,
    /// Its size.
    pub bytes: u64,
    /// Another one is another content.
    pub etag: String,
    opener: Arc<dyn Opener>,
}

/// Begins the reading of an object.
trait Opener: std::fmt::Debug + Send + Sync {
    fn open(&self) -> Box<dyn ReadAt>;
}

impl Object {
    /// Its bytes, fetched where they are wanted.
    pub fn open(&self) -> Box<dyn ReadAt> {
        self.opener.open()
    }
}

/// Whether a name is an address, as no path of a file is.
pub fn is_address(name: &Path) -> bool {
    let scheme = name.to_str().and_then(|text| text.split_once("://")).map(|(scheme, _)| scheme);
    scheme.is_some_and(|scheme| !scheme.is_empty() && scheme.bytes().all(|b| b.is_ascii_alphanumeric()))
}

/// All objects below an address, or that fit it where it has a `*`, in no order; one if it names one.
///
/// # Errors
///
/// [`RemoteError`] if the address is none, or the store does not answer.
pub fn objects(address: &str) -> Result<Vec<Object>, RemoteError> {
    #[cfg(feature = "cloud")]
    return store::objects(address);
    #[cfg(not(feature = "cloud"))]
    Err(RemoteError::NotBuilt { address: address.to_owned() })
}

/// The object of an address.
///
/// # Errors
///
/// As [`objects`].
pub fn object(address: &str) -> Result<Object, RemoteError> {
    #[cfg(feature = "cloud")]
    return store::object(address);
    #[cfg(not(feature = "cloud"))]
    Err(RemoteError::NotBuilt { address: address.to_owned() })
}
