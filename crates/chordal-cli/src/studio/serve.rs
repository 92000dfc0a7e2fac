//! Answers requests: an allowed request gets a file of the page, and every response has the same strict
//! headers.
use super::gate::{GateDecision, RequestGate};
use super::page::{PageFile, StudioPage};
use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::{
    ACCEPT_ENCODING, ALLOW, CACHE_CONTROL, CONTENT_ENCODING, CONTENT_SECURITY_POLICY, CONTENT_TYPE,
    HeaderMap, HeaderValue, LOCATION, REFERRER_POLICY, SET_COOKIE, VARY, X_CONTENT_TYPE_OPTIONS,
    X_FRAME_OPTIONS,
};
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::borrow::Cow;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

/// The content security policy: the page may only run its own scripts, workers and WebAssembly, and load its
/// own files.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; \
    connect-src 'self'; style-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'; \
    frame-ancestors 'self'";

/// The most connections at once. Chosen: a browser opens about six.
const MOST_CONNECTIONS: usize = 64;
/// The most bytes of a request's head. Chosen: browsers send far less.
const MOST_HEAD: usize = 16 << 10;
/// The time limit for receiving a request's head. Chosen: generous for a local connection.
const PATIENCE: Duration = Duration::from_secs(10);
/// The time limit of a connection. Chosen: long enough for any page, and stalled clients do not hold a permit
/// for ever.
const LIFE: Duration = Duration::from_secs(300);
/// The pause after a failed accept. Chosen: short for users, and the loop does not spin.
const PAUSE: Duration = Duration::from_millis(100);

/// Serves `page` to requests that `gate` allows. It does not end.
pub async fn serve(listener: TcpListener, gate: Arc<RequestGate>, page: Arc<StudioPage>) {
    // A permit comes before each accept: connections beyond the limit wait in the system's queue and cost
    // nothing here.
    let permits = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        // The semaphore is never closed, so a permit comes eventually.
        let Ok(permit) = Arc::clone(&permits).acquire_owned().await else { return };
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let (gate, page) = (Arc::clone(&gate), Arc::clone(&page));
        tokio::spawn(async move {
            let answer = service_fn(|request: Request<Incoming>| {
                let answer = answer(&gate, &page, &request);
                async { Ok::<_, Infallible>(answer) }
            });
            // A connection that breaks or takes too long is simply dropped.
            let connection = hyper::server::conn::http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(PATIENCE)
                .max_buf_size(MOST_HEAD)
                .serve_connection(TokioIo::new(stream), answer);
            let _ = tokio::time::timeout(LIFE, connection).await;
            drop(permit);
        });
    }
}

fn answer<B>(gate: &RequestGate, page: &StudioPage, request: &Request<B>) -> Response<Full<Bytes>> {
    let mut response = match gate.judge(request) {
        GateDecision::Enter => file(page, request),
        GateDecision::Welcome { cookie } => welcome(&cookie, page.home()),
        GateDecision::ForeignHost => text(StatusCode::MISDIRECTED_REQUEST, "This server has another name.\n"),
        GateDecision::ForeignOrigin => {
            text(StatusCode::FORBIDDEN, "Requests from pages of other sites are refused.\n")
        }
        GateDecision::Stranger => text(
            StatusCode::FORBIDDEN,
            "Open the link that 'chordal studio' printed; it works once. Start it again for a new one.\n",
        ),
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (CONTENT_SECURITY_POLICY, POLICY),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "SAMEORIGIN"),
        (REFERRER_POLICY, "no-referrer"),
        (CACHE_CONTROL, "no-store"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    // No page of another site shares a process with these, which is what browsers ask of a page whose workers are
    // to share memory: the workbench computes on several threads.
    for (name, value) in [
        ("cross-origin-resource-policy", "same-origin"),
        ("cross-origin-opener-policy", "same-origin"),
        ("cross-origin-embedder-policy", "require-corp"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

fn file<B>(page: &StudioPage, request: &Request<B>) -> Response<Full<Bytes>> {
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        let mut response = text(StatusCode::METHOD_NOT_ALLOWED, "This server only answers GET and HEAD.\n");
        response.headers_mut().insert(ALLOW, HeaderValue::from_static("GET, HEAD"));
        return response;
    }
    let Some(file) = page.get(request.uri().path()) else {
        return text(StatusCode::NOT_FOUND, "There is no such file.\n");
    };
    sent(file, file.is_packed && takes_brotli(request.headers()))
}

/// A file as it is stored, or decompressed.
fn sent(file: &PageFile, as_stored: bool) -> Response<Full<Bytes>> {
    let content = match &file.bytes {
        Cow::Borrowed(bytes) if as_stored => Some(Bytes::from_static(bytes)),
        _ => file.unpacked().map(Bytes::from),
    };
    let Some(content) = content else {
        return text(StatusCode::INTERNAL_SERVER_ERROR, "This file is damaged.\n");
    };
    let mut response = with_type(StatusCode::OK, file.kind, content);
    if as_stored {
        response.headers_mut().insert(CONTENT_ENCODING, HeaderValue::from_static("br"));
    }
    if file.is_packed {
        response.headers_mut().insert(VARY, HeaderValue::from_static("accept-encoding"));
    }
    response
}

/// Whether a client decompresses Brotli: it names it, and not with the weight 0.
fn takes_brotli(headers: &HeaderMap) -> bool {
    let lines = headers.get_all(ACCEPT_ENCODING).iter().filter_map(|line| line.to_str().ok());
    lines.flat_map(|line| line.split(',')).any(|coding| {
        let (name, weight) = coding.split_once(';').unwrap_or((coding, "q=1"));
        let weight = weight.trim().strip_prefix("q=").and_then(|weight| weight.parse::<f64>().ok());
        name.trim().eq_ignore_ascii_case("br") && weight.is_some_and(|weight| weight > 0.0)
    })
}

/// Redirects to the page without the token, which thus leaves the address bar and the history.
fn welcome(cookie: &str, home: &str) -> Response<Full<Bytes>> {
    let mut response = text(StatusCode::SEE_OTHER, "The page is at another address.\n");
    match (HeaderValue::from_str(cookie), HeaderValue::from_str(home)) {
        (Ok(cookie), Ok(home)) => {
            response.headers_mut().insert(SET_COOKIE, cookie);
            response.headers_mut().insert(LOCATION, home);
            response
        }
        _ => text(StatusCode::INTERNAL_SERVER_ERROR, "The redirect cannot be written.\n"),
    }
}

fn text(status: StatusCode, line: &'static str) -> Response<Full<Bytes>> {
    with_type(status, "text/plain; charset=utf-8", Bytes::from_static(line.as_bytes()))
}

fn with_type(status: StatusCode, kind: &'static str, bytes: Bytes) -> Response<Full<Bytes>> {
    let mut response = Response::new(Full::new(bytes));
    *response.status_mut() = status;
    response.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_sent_as_it_is_stored_to_who_decompresses_it() {
        // `<p>`, as Node compresses it.
        let file =
            PageFile { bytes: (&b"\x0b\x01\x80<p>\x03"[..]).into(), is_packed: true, kind: "text/html" };
        for (accepted, as_stored) in [
            (Some("gzip, deflate, br, zstd"), true),
            (Some("br;q=0.5"), true),
            (Some("gzip, BR"), true),
            (Some("gzip, br;q=0"), false),
            (Some("gzip, brotli"), false),
            (None, false),
        ] {
            let headers = accepted.map(|accepted| (ACCEPT_ENCODING, HeaderValue::from_static(accepted)));
            assert_eq!(takes_brotli(&headers.into_iter().collect()), as_stored, "{accepted:?}");
            let response = sent(&file, as_stored);
            assert_eq!(response.headers().contains_key(CONTENT_ENCODING), as_stored);
            assert_eq!(response.headers()[VARY], "accept-encoding");
        }
        assert_eq!(sent(&PageFile { is_packed: false, ..file }, false).headers().get(VARY), None);
    }
}
