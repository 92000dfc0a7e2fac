//! `chordal studio`: serves the studio to a browser on this machine.
mod gate;
mod page;
mod secret;
mod serve;

use crate::console::print;
use crate::fault::{Exit, Fault, plainly};
use crate::input::InputSource;
use crate::signal;
use clap::Args;
use gate::RequestGate;
use page::StudioPage;
use secret::Secret;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;

/// `chordal studio`
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  chordal studio
  chordal studio part.star
  chordal studio scene.gltf scene.bin --open
  chordal studio --port 8000 --open
  chordal studio --host 0.0.0.0 --allow-host lab.example --token $(openssl rand -hex 24)")]
pub struct StudioArgs {
    /// Files to open in the workbench: a shape, and the files that it uses
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,

    /// Port to listen on; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,

    /// Address to listen on, instead of 127.0.0.1; an address that other machines can reach requires --token
    #[arg(long, value_name = "ADDRESS")]
    pub host: Option<IpAddr>,

    /// Token in the link, instead of a random one: 32 letters and digits or more
    #[arg(long, value_name = "TOKEN")]
    pub token: Option<String>,

    /// A host name that browsers may use, besides localhost, 127.0.0.1 and [::1]
    #[arg(long, value_name = "NAME")]
    pub allow_host: Vec<String>,

    /// Folder of the page, instead of the built-in one
    #[arg(long, value_name = "DIR")]
    pub dir: Option<PathBuf>,

    /// Open the link in the default browser
    #[arg(long)]
    pub open: bool,
}

/// The shortest token that a user may choose. Derived: the hexadecimal digits of 128 bits.
const SHORTEST_TOKEN: usize = 32;

/// Serves until a signal stops it.
pub fn run(args: &StudioArgs) -> Result<(), Fault> {
    let address = address(args)?;
    let token = token(args)?;
    let page = StudioPage::find(args.dir.as_deref())?.opened(read_all(&args.files)?)?;
    let session = Secret::random().map_err(no_random)?;
    // One thread is enough: the page is a handful of files in memory.
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(|error| {
        Fault::output("no-server", format!("the server cannot start: {}", plainly(&error)))
    })?;
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::bind(address).await;
        let listener = listener.map_err(|error| cannot_listen(address, &error))?;
        let address = listener.local_addr().map_err(|error| cannot_listen(address, &error))?;
        let names = allowed_names(address.ip(), &args.allow_host);
        let name = names.first().map_or("localhost", String::as_str);
        let url = format!("http://{name}:{}/?token={}", address.port(), token.text());
        let gate = RequestGate::new(address.port(), &names, token, session);
        // There is no job to cancel: the handler just ends the process.
        signal::install(Arc::default());
        print(&format!(
            "Chordal studio: {url}\nThe link works once, in one browser. Ctrl-C stops the server.\n"
        ))?;
        if args.open {
            open(&url)?;
        }
        serve::serve(listener, Arc::new(gate), Arc::new(page)).await;
        Ok(())
    })
}

/// The most bytes of all files. Chosen: a browser has memory for several times as much.
const MOST_BYTES: u64 = 600 << 20;

/// The files with their names, without folders.
fn read_all(paths: &[PathBuf]) -> Result<Vec<(String, Vec<u8>)>, Fault> {
    let mut left = MOST_BYTES;
    let read = |path: &PathBuf| {
        let bytes = InputSource::File(path.clone()).read(left)?;
        left -= bytes.len() as u64;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok((name, bytes))
    };
    paths.iter().map(read).collect()
}

/// Loopback, unless a host and a token are given.
fn address(args: &StudioArgs) -> Result<SocketAddr, Fault> {
    let host = args.host.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST));
    if !host.is_loopback() && args.token.is_none() {
        return Err(Fault::usage(format!(
            "--host {host} opens the studio to other machines, which requires your own --token as well"
        )));
    }
    Ok(SocketAddr::new(host, args.port))
}

/// The host names that browsers may use besides the usual ones: the given names, and the address itself,
/// which unlike a name nobody else can redirect.
fn allowed_names(address: IpAddr, given: &[String]) -> Vec<String> {
    let address_name = match address {
        // It stands for all addresses of the machine, and is none that a browser goes to.
        address if address.is_unspecified() => None,
        IpAddr::V4(address) => Some(address.to_string()),
        IpAddr::V6(address) => Some(format!("[{address}]")),
    };
    given.iter().cloned().chain(address_name).collect()
}

/// The user's token, or a new one.
fn token(args: &StudioArgs) -> Result<Secret, Fault> {
    let Some(token) = &args.token else { return Secret::random().map_err(no_random) };
    let plain = token.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_');
    if token.len() < SHORTEST_TOKEN || !plain {
        return Err(Fault::usage(format!(
            "--token needs at least {SHORTEST_TOKEN} random letters and digits, for example from 'openssl rand -hex 24'"
        )));
    }
    Ok(Secret::from_text(token))
}

fn no_random(error: getrandom::Error) -> Fault {
    Fault::new(Exit::Output, "no-random", format!("the system has no random numbers for a token: {error}"))
}

fn cannot_listen(address: SocketAddr, error: &std::io::Error) -> Fault {
    Fault::output("no-server", format!("cannot listen at {address}: {}", plainly(error)))
}

/// Opens the link in the system's browser.
fn open(url: &str) -> Result<(), Fault> {
    let (program, before): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else {
        ("xdg-open", &[])
    };
    let started = std::process::Command::new(program).args(before).arg(url).spawn();
    started.map(drop).map_err(|error| {
        Fault::output(
            "no-browser",
            format!("{program} cannot be started ({}): open the link yourself", plainly(&error)),
        )
    })
}
