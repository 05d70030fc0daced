//! The program `rerun`: a window, or a server with a page for browsers.

use std::{
    io,
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    process::{Child, Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use super::ViewError;

const PROGRAM: &str = "rerun";
/// Where viewers listen for data, and where they serve their page.
const PORTS: [u16; 2] = [9876, 9090];
/// Time that the program has until it listens; its first start is slow, from disk.
const START: Duration = Duration::from_secs(60);
const PERIOD: Duration = Duration::from_millis(50);

/// A viewer for browsers, as long as it runs.
pub(super) struct Page {
    child: Child,
    /// Where it takes data.
    pub(super) url: String,
    /// Where a browser opens it.
    pub(super) address: String,
}

impl Page {
    /// Waits until it is ended, by Ctrl-C for one.
    pub(super) fn wait(&mut self) -> Result<(), ViewError> {
        self.child.wait().map(|_| ()).map_err(ViewError::Program)
    }

    pub(super) fn end(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Address of the window of a viewer: an open one, or else a new one that outlives this program.
pub(super) fn window() -> Result<String, ViewError> {
    let port = PORTS[0];
    if !listens(port) {
        let mut command = program(port);
        // Ctrl-C is for us.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        await_port(&mut run(command.args(["--memory-limit", "75%", "--expect-data-soon"]))?, port)?;
    }
    Ok(url(port))
}

pub(super) fn page() -> Result<Page, ViewError> {
    let port = |wanted: u16| free(wanted).map_err(ViewError::Program);
    let (data, page) = (port(PORTS[0])?, port(PORTS[1])?);
    let mut command = program(data);
    let mut child = run(command.arg("--serve-web").args(["--web-viewer-port", &page.to_string()]))?;
    if let Err(error) = await_port(&mut child, data).and_then(|()| await_port(&mut child, page)) {
        let _ = child.kill();
        return Err(error);
    }
    let url = url(data);
    let escaped = url.replace('+', "%2B").replace(':', "%3A").replace('/', "%2F");
    let address = format!("http://127.0.0.1:{page}/?url={escaped}");
    Ok(Page { child, url, address })
}

fn program(port: u16) -> Command {
    let mut command = Command::new(PROGRAM);
    // By itself it would listen to the whole network. Its words are for when it fails.
    command.args(["--bind", "127.0.0.1", "--port", &port.to_string()]).env("RUST_LOG", "error");
    command.stdin(Stdio::null()).stdout(Stdio::null());
    command
}

fn run(command: &mut Command) -> Result<Child, ViewError> {
    command.spawn().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => ViewError::NoProgram,
        _ => ViewError::Program(error),
    })
}

fn url(port: u16) -> String {
    format!("rerun+http://127.0.0.1:{port}/proxy")
}

fn listens(port: u16) -> bool {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    TcpStream::connect_timeout(&address, Duration::from_secs(1)).is_ok()
}

fn await_port(child: &mut Child, port: u16) -> Result<(), ViewError> {
    let start = Instant::now();
    while !listens(port) {
        if let Some(status) = child.try_wait().map_err(ViewError::Program)? {
            return Err(ViewError::Silent(format!("ended at once ({status})")));
        }
        if start.elapsed() > START {
            return Err(ViewError::Silent(format!("does not listen after {} s", START.as_secs())));
        }
        sleep(PERIOD);
    }
    Ok(())
}

/// The port wanted, or one that is free.
fn free(wanted: u16) -> io::Result<u16> {
    let bound = TcpListener::bind((Ipv4Addr::LOCALHOST, wanted));
    Ok(bound.or_else(|_| TcpListener::bind((Ipv4Addr::LOCALHOST, 0)))?.local_addr()?.port())
}
