//! The pages of a folder for browsers of this computer: read only, on the loopback address alone.

use std::{
    io::Read,
    net::{Ipv4Addr, SocketAddr},
    path::{Path, PathBuf},
    thread,
};

use tiny_http::{Header, Method, Request, Response, Server};

use super::super::CliError;
use crate::input_file;

/// How often a browser asks for the index again, s.
const REFRESH_S: &str = "5";

/// Begins to answer on a thread of its own, which ends with the process; returns the address.
pub(super) fn start(root: &Path, port: u16) -> Result<String, CliError> {
    let failed =
        CliError::step(format!("cannot listen at 127.0.0.1:{port}; --serve=PORT takes another port"));
    let server = Server::http(SocketAddr::from((Ipv4Addr::LOCALHOST, port))).map_err(failed)?;
    let port = server.server_addr().to_ip().map_or(port, |address| address.port());
    let root = root.to_owned();
    thread::spawn(move || {
        for request in server.incoming_requests() {
            // A browser that has gone hears nothing.
            let _ = answer(&root, port, request);
        }
    });
    Ok(format!("http://127.0.0.1:{port}/"))
}

fn answer(root: &Path, port: u16, request: Request) -> std::io::Result<()> {
    let host = request.headers().iter().find(|header| header.field.equiv("Host"));
    let status = match request.method() {
        Method::Get | Method::Head => 200,
        _ => 405,
    };
    // A page of elsewhere whose name leads here by a trick has another host.
    let status = if host.is_some_and(|host| is_ours(host.value.as_str(), port)) { status } else { 403 };
    let path = request.url().split(['?', '#']).next().unwrap_or_default();
    let found = page(path).filter(|_| status == 200).map(|page| (read(&root.join(&page)), page));
    let (status, bytes, is_index) = match found {
        Some((Ok(bytes), page)) => (200, bytes, page == Path::new("index.html")),
        _ => (if status == 200 { 404 } else { status }, b"There is no such page.\n".to_vec(), false),
    };
    let mut response = Response::from_data(bytes).with_status_code(status).with_chunked_threshold(usize::MAX);
    let kind = if status == 200 { "text/html; charset=utf-8" } else { "text/plain" };
    let refresh = Some(("Refresh", REFRESH_S)).filter(|_| is_index);
    let fields =
        [("Content-Type", kind), ("Cache-Control", "no-cache"), ("X-Content-Type-Options", "nosniff")];
    for (name, value) in fields.into_iter().chain(refresh) {
        response.add_header(header(name, value)?);
    }
    request.respond(response)
}

fn header(name: &str, value: &str) -> std::io::Result<Header> {
    Header::from_bytes(name, value).map_err(|()| std::io::ErrorKind::InvalidInput.into())
}

fn is_ours(host: &str, port: u16) -> bool {
    ["127.0.0.1", "localhost"].iter().any(|name| host == format!("{name}:{port}") || host == *name)
}

/// The file of a path; only the index and plain names of pages lead to one.
fn page(path: &str) -> Option<PathBuf> {
    let name = path.strip_prefix("/pages/").and_then(|name| name.strip_suffix(".html"));
    let plain = |name: &&str| {
        !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte))
    };
    match path {
        "/" | "/index.html" => Some("index.html".into()),
        _ => name.filter(plain).map(|name| format!("pages/{name}.html").into()),
    }
}

fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input_file::open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_but_pages_has_a_path() {
        for path in ["/", "/index.html"] {
            assert_eq!(page(path).unwrap(), Path::new("index.html"));
        }
        assert_eq!(page("/pages/M07-run-0a1b2c3d.html").unwrap(), Path::new("pages/M07-run-0a1b2c3d.html"));
        for path in [
            "", "index.html", "/../index.html", "/pages/../index.html", "/pages/..%2Findex.html",
            "/pages/.html", "/pages/a.json", "/runs/schema=1/part.parquet", "/pages//etc/passwd.html",
            "http://elsewhere/", "/pages/.lock",
        ] {
            assert_eq!(page(path), None, "{path}");
        }
    }

    #[test]
    fn another_name_of_this_computer_is_refused() {
        assert!(is_ours("127.0.0.1:8020", 8020) && is_ours("localhost:8020", 8020));
        assert!(
            !is_ours("elsewhere.example:8020", 8020) && !is_ours("127.0.0.1:80", 8020) && !is_ours("", 8020)
        );
    }
}
