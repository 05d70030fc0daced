//! Stores by address, and what they hold. Credentials come from the environment, as the stores' own tools read them.

use std::{sync::Arc, time::Duration};

use futures_util::TryStreamExt;
use object_store::{
    ClientOptions, ObjectMeta, ObjectStore, ObjectStoreExt, ObjectStoreScheme, RetryConfig,
    aws::AmazonS3Builder, azure::MicrosoftAzureBuilder, gcp::GoogleCloudStorageBuilder, http::HttpBuilder,
    path::Path,
};
use url::{Position, Url};

use super::{
    Object, RemoteError,
    reader::Held,
    request::{reason, wait},
};

/// How long a request is repeated that a store does not answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// A store, the address of its root, and a place in it.
#[derive(Debug)]
struct Place {
    store: Arc<dyn ObjectStore>,
    /// Without a slash at the end.
    root: String,
    path: Path,
}

pub(super) fn object(address: &str) -> Result<Object, RemoteError> {
    let place = Place::of(address)?;
    let found = wait(place.store.head(&place.path)).map_err(failed("find", address))?;
    Ok(place.object(found.map_err(failed("find", address))?))
}

pub(super) fn objects(address: &str) -> Result<Vec<Object>, RemoteError> {
    // The folders before the first sign that stands for others.
    let plain = match address.split_once('*') {
        Some((before, _)) => before.rsplit_once('/').map_or(before, |(folder, _)| folder),
        None => address,
    };
    let place = Place::of(plain)?;
    let prefix = Some(&place.path).filter(|path| !path.as_ref().is_empty());
    let listed = wait(place.store.list(prefix).try_collect::<Vec<ObjectMeta>>());
    match listed.map_err(failed("list", plain))? {
        Ok(found) if !found.is_empty() => Ok(found.into_iter().map(|one| place.object(one)).collect()),
        // A web server that knows no lists may have the file.
        Ok(_) | Err(object_store::Error::NotFound { .. } | object_store::Error::Generic { .. })
            if plain == address =>
        {
            Ok(vec![object(address)?])
        }
        Ok(_) => Ok(Vec::new()),
        Err(error) => Err(failed("list", plain)(error)),
    }
}

impl Place {
    fn of(address: &str) -> Result<Self, RemoteError> {
        let bad = |reason: String| RemoteError::Address { address: address.to_owned(), reason };
        let url = Url::parse(address).map_err(|error| bad(error.to_string()))?;
        if let Some(query) = url.query() {
            return Err(bad(format!("it has a query, ?{query}, which stores are not asked with")));
        }
        let (scheme, path) = ObjectStoreScheme::parse(&url).map_err(|error| bad(error.to_string()))?;
        let store = open(&scheme, &url).map_err(failed("open", address))?;
        let store = store.ok_or_else(|| bad(format!("{}:// is no store", url.scheme())))?;
        // Some addresses name the bucket in their path.
        let parts = |text: &str| text.split('/').filter(|part| !part.is_empty()).count();
        let bucket = parts(url.path()).saturating_sub(parts(path.as_ref()));
        let mut root = url[..Position::BeforePath].to_owned();
        for part in url.path().split('/').filter(|part| !part.is_empty()).take(bucket) {
            root = format!("{root}/{part}");
        }
        Ok(Self { store, root, path })
    }

    fn object(&self, meta: ObjectMeta) -> Object {
        let path = meta.location.as_ref();
        let path = path.replace('%', "%25").replace('?', "%3F").replace('#', "%23");
        let changed = meta.last_modified.timestamp_micros();
        let etag = meta.e_tag.clone().unwrap_or_else(|| format!("{:x}-{changed:x}", meta.size));
        // A weak tag is never equal.
        let tag = meta.e_tag.filter(|tag| !tag.starts_with("W/"));
        let held = Held { store: self.store.clone(), path: meta.location, bytes: meta.size, tag };
        Object { address: format!("{}/{path}", self.root), bytes: meta.size, etag, opener: Arc::new(held) }
    }
}

/// The store of an address; `None` for what is no store of objects.
fn open(scheme: &ObjectStoreScheme, url: &Url) -> Result<Option<Arc<dyn ObjectStore>>, object_store::Error> {
    let retry = RetryConfig { retry_timeout: PATIENCE, ..RetryConfig::default() };
    Ok(Some(match scheme {
        ObjectStoreScheme::AmazonS3 => {
            Arc::new(AmazonS3Builder::from_env().with_url(url.as_str()).with_retry(retry).build()?)
        }
        ObjectStoreScheme::GoogleCloudStorage => {
            Arc::new(GoogleCloudStorageBuilder::from_env().with_url(url.as_str()).with_retry(retry).build()?)
        }
        ObjectStoreScheme::MicrosoftAzure => {
            Arc::new(MicrosoftAzureBuilder::from_env().with_url(url.as_str()).with_retry(retry).build()?)
        }
        ObjectStoreScheme::Http => {
            // An address that begins with http:// was meant so.
            let client = ClientOptions::new().with_allow_http(true);
            let builder = HttpBuilder::new().with_url(&url[..Position::BeforePath]);
            Arc::new(builder.with_client_options(client).with_retry(retry).build()?)
        }
        _ => return Ok(None),
    }))
}

fn failed<E: std::error::Error + 'static>(
    action: &'static str,
    address: &str,
) -> impl FnOnce(E) -> RemoteError {
    let address = address.to_owned();
    move |error| RemoteError::Store { action, address, reason: reason(&error) }
}
