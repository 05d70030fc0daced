//! A store of objects on this machine: a web server that knows ranges, conditions and both kinds of lists.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    io::{BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    sync::{Arc, Mutex},
};

type Files = Arc<Mutex<BTreeMap<String, Vec<u8>>>>;

/// A server that lives as long as the test.
pub(crate) struct Store {
    /// `HOST:PORT`.
    pub(crate) host: String,
    /// By path, without a slash at the start.
    pub(crate) files: Files,
    /// Methods, paths and ranges so far.
    pub(crate) requests: Arc<Mutex<Vec<String>>>,
    /// How many of the next requests for bytes fail.
    pub(crate) faults: Arc<Mutex<usize>>,
}

struct Request {
    method: String,
    path: String,
    query: String,
    headers: BTreeMap<String, String>,
}

impl Store {
    pub(crate) fn new() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let store = Self {
            host: listener.local_addr().unwrap().to_string(),
            files: Arc::default(),
            requests: Arc::default(),
            faults: Arc::default(),
        };
        let (files, requests, faults) = (store.files.clone(), store.requests.clone(), store.faults.clone());
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (files, requests, faults) = (files.clone(), requests.clone(), faults.clone());
                std::thread::spawn(move || {
                    let Some(request) = read(&stream) else { return };
                    let range = request.headers.get("range").cloned().unwrap_or_default();
                    requests.lock().unwrap().push(format!("{} {} {range}", request.method, request.path));
                    let fails = request.method == "GET" && request.query.is_empty() && {
                        let mut left = faults.lock().unwrap();
                        *left = left.saturating_sub(1);
                        *left > 0
                    };
                    let answer = if fails {
                        head(500, "Internal Server Error", "Content-Length: 0\r\n")
                    } else {
                        answer(&request, &files.lock().unwrap())
                    };
                    let _ = (&stream).write_all(&answer);
                });
            }
        });
        store
    }

    pub(crate) fn put(&self, path: &str, bytes: Vec<u8>) {
        self.files.lock().unwrap().insert(path.to_owned(), bytes);
    }
}

fn read(stream: &TcpStream) -> Option<Request> {
    let mut reader = BufReader::new(stream);
    let mut line = String::new();
    reader.read_line(&mut line).ok()?;
    let mut words = line.split_whitespace();
    let (method, target) = (words.next()?.to_owned(), words.next()?.to_owned());
    let mut headers = BTreeMap::new();
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).ok()?;
        let Some((name, value)) = line.trim().split_once(": ") else { break };
        headers.insert(name.to_lowercase(), value.to_owned());
    }
    let length = headers.get("content-length").and_then(|text| text.parse().ok()).unwrap_or(0);
    reader.take(length).read_to_end(&mut Vec::new()).ok()?;
    let (path, query) = target.split_once('?').unwrap_or((&target, ""));
    let path = path.trim_start_matches('/').replace("%20", " ").replace("%3D", "=");
    Some(Request { method, path, query: query.to_owned(), headers })
}

fn head(code: u32, text: &str, headers: &str) -> Vec<u8> {
    format!("HTTP/1.1 {code} {text}\r\nConnection: close\r\n{headers}\r\n").into_bytes()
}

/// Equal for equal bytes, as good a tag as any here.
fn tag(bytes: &[u8]) -> String {
    let sum = bytes.iter().fold(17_u64, |sum, byte| sum.wrapping_mul(31).wrapping_add(u64::from(*byte)));
    format!("\"{sum:x}\"")
}

fn answer(request: &Request, files: &BTreeMap<String, Vec<u8>>) -> Vec<u8> {
    let Request { method, path, query, headers } = request;
    if method == "PROPFIND" || query.contains("list-type=2") {
        let text = if method == "PROPFIND" { listed_dav(path, files) } else { listed_s3(query, files) };
        let mut answer = head(
            if method == "PROPFIND" { 207 } else { 200 },
            "OK",
            &format!("Content-Length: {}\r\n", text.len()),
        );
        answer.extend(text.into_bytes());
        return answer;
    }
    let Some(bytes) = files.get(path) else { return head(404, "Not Found", "Content-Length: 0\r\n") };
    let own = tag(bytes);
    if headers.get("if-match").is_some_and(|wanted| *wanted != own) {
        return head(412, "Precondition Failed", "Content-Length: 0\r\n");
    }
    let range = headers.get("range").and_then(|text| text.strip_prefix("bytes=")?.split_once('-'));
    let range = range.map(|(from, to)| {
        let from: usize = from.parse().unwrap();
        from..to.parse::<usize>().map_or(bytes.len(), |to| (to + 1).min(bytes.len()))
    });
    let told = range
        .as_ref()
        .map(|range| format!("Content-Range: bytes {}-{}/{}\r\n", range.start, range.end - 1, bytes.len()));
    let part = &bytes[range.clone().unwrap_or(0..bytes.len())];
    let common = format!(
        "Content-Length: {}\r\nETag: {own}\r\nLast-Modified: Sun, 01 Mar 2026 08:00:00 GMT\r\n{}",
        part.len(),
        told.unwrap_or_default()
    );
    let mut answer = head(if range.is_some() { 206 } else { 200 }, "OK", &common);
    if method == "GET" {
        answer.extend_from_slice(part);
    }
    answer
}

fn listed_dav(path: &str, files: &BTreeMap<String, Vec<u8>>) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?><D:multistatus xmlns:D=\"DAV:\">");
    for (name, bytes) in files.iter().filter(|(name, _)| name.starts_with(path)) {
        let (length, tag) = (bytes.len(), tag(bytes));
        write!(
            text,
            "<D:response><D:href>/{}</D:href><D:propstat><D:prop><D:getlastmodified>Sun, 01 Mar 2026 08:00:00 GMT\
             </D:getlastmodified><D:getcontentlength>{length}</D:getcontentlength><D:resourcetype/>\
             <D:getetag>{tag}</D:getetag></D:prop><D:status>HTTP/1.1 200 OK</D:status></D:propstat></D:response>",
            name.replace(' ', "%20")
        )
        .unwrap();
    }
    text + "</D:multistatus>"
}

/// What lies in the bucket `bucket` below the prefix of the query.
fn listed_s3(query: &str, files: &BTreeMap<String, Vec<u8>>) -> String {
    let prefix = query.split('&').find_map(|part| part.strip_prefix("prefix=")).unwrap_or_default();
    let prefix = format!("bucket/{}", prefix.replace("%2F", "/"));
    let mut text = String::from("<?xml version=\"1.0\"?><ListBucketResult><IsTruncated>false</IsTruncated>");
    for (name, bytes) in files.iter().filter(|(name, _)| name.starts_with(&prefix)) {
        let (key, length, tag) = (&name["bucket/".len()..], bytes.len(), tag(bytes));
        write!(
            text,
            "<Contents><Key>{key}</Key><LastModified>2026-03-01T08:00:00.000Z</LastModified>\
             <ETag>{tag}</ETag><Size>{length}</Size></Contents>"
        )
        .unwrap();
    }
    text + "</ListBucketResult>"
}
