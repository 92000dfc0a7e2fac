//! `chordal studio` as a browser, a foreign page and a foreign machine meet it: raw requests over a socket.
use crate::common;

use common::{Folder, chordal, run};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};

/// A running studio; it ends with the test.
struct Studio {
    child: Child,
    port: u16,
    token: String,
    /// Where the link leads.
    home: &'static str,
    _folder: Folder,
}

impl Studio {
    fn start(name: &str) -> Self {
        Self::start_with(name, &[], "/")
    }

    /// With files on the workbench, written into the folder of the page; none of them is a part of the page.
    fn start_with(name: &str, files: &[(&str, &[u8])], home: &'static str) -> Self {
        let folder = Folder::new(name);
        folder.file("workbench.html", "<!doctype html><p>bench");
        let opened: Vec<String> = files.iter().map(|(name, bytes)| folder.file(name, bytes)).collect();
        std::fs::create_dir(folder.path("assets")).unwrap();
        folder.file("index.html", "<!doctype html><p>page");
        folder.file("assets/app.js", "1;");
        folder.file("key.pem", "private");
        let mut child = chordal(&["studio", "--dir", &folder.text("")])
            .args(opened)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let url =
            line.trim().strip_prefix("Chordal studio: http://127.0.0.1:").unwrap_or_else(|| panic!("{line}"));
        let (port, token) = url.split_once("/?token=").unwrap();
        Self { child, port: port.parse().unwrap(), token: token.to_owned(), home, _folder: folder }
    }

    /// Sends bytes as they are and returns all that comes back.
    fn send(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        // A server that has heard enough may hang up before everything is sent or read.
        let _ = stream.write_all(request.as_bytes());
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn ask(&self, first: &str, headers: &[&str]) -> String {
        let host = format!("Host: localhost:{}", self.port);
        let lines = [&[first, &host, "Connection: close"], headers].concat();
        self.send(&(lines.join("\r\n") + "\r\n\r\n"))
    }

    /// The `Cookie` header that the token is good for.
    fn enter(&self) -> String {
        let answer = self.ask(&format!("GET /?token={} HTTP/1.1", self.token), &[]);
        assert_eq!(status(&answer), 303, "{answer}");
        let cookie = header(&answer, "set-cookie").unwrap_or_else(|| panic!("{answer}"));
        assert!(cookie.ends_with("; HttpOnly; SameSite=Strict; Path=/"), "{cookie}");
        assert_eq!(header(&answer, "location"), Some(self.home));
        format!("Cookie: {}", cookie.split(';').next().unwrap())
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0)
}

fn header<'a>(answer: &'a str, name: &str) -> Option<&'a str> {
    let head = answer.split("\r\n\r\n").next()?;
    let mut pairs = head.lines().filter_map(|line| line.split_once(": "));
    pairs.find(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, value)| value)
}

#[test]
fn the_link_works_once_and_leads_to_the_page() {
    let studio = Studio::start("studio-link");
    assert_eq!(studio.token.len(), 48);
    let cookie = studio.enter();
    let page = studio.ask("GET / HTTP/1.1", &[&cookie]);
    assert_eq!(status(&page), 200);
    assert!(page.ends_with("<!doctype html><p>page"), "{page}");
    let script = studio.ask("GET /assets/app.js HTTP/1.1", &[&cookie]);
    assert_eq!(
        (status(&script), header(&script, "content-type")),
        (200, Some("text/javascript; charset=utf-8"))
    );
    let again = studio.ask(&format!("GET /?token={} HTTP/1.1", studio.token), &[]);
    assert_eq!((status(&again), header(&again, "set-cookie")), (403, None));
}

#[test]
fn strangers_foreign_hosts_and_foreign_pages_get_nothing() {
    let studio = Studio::start("studio-foreign");
    for (first, headers) in [
        ("GET / HTTP/1.1", &[][..]),
        ("GET /assets/app.js HTTP/1.1", &[]),
        ("GET /?token=000000000000000000000000000000000000000000000000 HTTP/1.1", &[]),
        ("GET / HTTP/1.1", &["Cookie: chordal=1"]),
    ] {
        assert_eq!(status(&studio.ask(first, headers)), 403, "{first} {headers:?}");
    }
    let cookie = studio.enter();
    for host in ["evil.test", "localhost", "localhost:1", "127.0.0.1.evil.test"] {
        let answer =
            studio.send(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\nConnection: close\r\n\r\n"));
        assert_eq!(status(&answer), 421, "{host}: {answer}");
        assert!(!answer.contains("page"), "{answer}");
    }
    for origin in ["Origin: http://evil.test", "Origin: null", "X: none"] {
        let answer = studio.ask("POST / HTTP/1.1", &[&cookie, origin, "Content-Length: 0"]);
        assert_eq!(status(&answer), 403, "{origin}: {answer}");
        let socket = ["Upgrade: websocket", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: x"];
        let answer = studio.ask("GET / HTTP/1.1", &[&[cookie.as_str(), origin][..], &socket].concat());
        assert_eq!(status(&answer), 403, "{origin}: {answer}");
    }
    let own = format!("Origin: http://localhost:{}", studio.port);
    assert_eq!(status(&studio.ask("POST / HTTP/1.1", &[&cookie, &own, "Content-Length: 0"])), 405);
}

#[test]
fn every_answer_is_strict_and_none_speaks_of_other_origins() {
    let studio = Studio::start("studio-strict");
    let cookie = studio.enter();
    let foreign = "Origin: http://evil.test";
    for answer in [
        studio.ask("GET / HTTP/1.1", &[&cookie, foreign]),
        studio.ask("GET /nothing HTTP/1.1", &[&cookie]),
        studio.ask("GET / HTTP/1.1", &[]),
        studio.ask("OPTIONS / HTTP/1.1", &[&cookie, foreign, "Access-Control-Request-Method: GET"]),
    ] {
        let policy = header(&answer, "content-security-policy").unwrap_or_else(|| panic!("{answer}"));
        assert!(policy.starts_with("default-src 'none'; script-src 'self' 'wasm-unsafe-eval';"), "{policy}");
        assert!(!policy.contains("unsafe-inline") && !policy.contains("'unsafe-eval'"), "{policy}");
        assert_eq!(header(&answer, "x-content-type-options"), Some("nosniff"));
        assert_eq!(header(&answer, "cross-origin-resource-policy"), Some("same-origin"));
        assert_eq!(header(&answer, "cross-origin-opener-policy"), Some("same-origin"));
        assert_eq!(header(&answer, "cross-origin-embedder-policy"), Some("require-corp"));
        assert_eq!(header(&answer, "referrer-policy"), Some("no-referrer"));
        assert_eq!(header(&answer, "cache-control"), Some("no-store"));
        assert!(!answer.to_ascii_lowercase().contains("access-control-"), "{answer}");
    }
}

#[test]
fn no_request_becomes_a_path() {
    let studio = Studio::start("studio-path");
    let cookie = studio.enter();
    for path in [
        "/key.pem",
        "/assets",
        "/assets/",
        "/assets/../key.pem",
        "/../../../../etc/passwd",
        "/..%2f..%2fetc/passwd",
        "//etc/passwd",
        "/index.html%00",
        "/.",
    ] {
        let answer = studio.ask(&format!("GET {path} HTTP/1.1"), &[&cookie]);
        assert!([400, 404].contains(&status(&answer)), "{path}: {answer}");
        assert!(!answer.contains("root:") && !answer.contains("private"), "{path}: {answer}");
    }
}

#[test]
fn heads_that_are_endless_or_ambiguous_are_refused() {
    let studio = Studio::start("studio-heads");
    let cookie = studio.enter();
    let long = format!("X: {}", "x".repeat(100_000));
    assert!([0, 400, 431].contains(&status(&studio.ask("GET / HTTP/1.1", &[&cookie, &long]))));
    let own = format!("Origin: http://localhost:{}", studio.port);
    let head = [
        "POST / HTTP/1.1",
        &format!("Host: localhost:{}", studio.port),
        &cookie,
        &own,
        "Content-Length: 6",
        "Transfer-Encoding: chunked",
    ]
    .join("\r\n");
    let inner = format!("GET / HTTP/1.1\r\nHost: localhost:{}\r\n{cookie}\r\n\r\n", studio.port);
    let smuggled = studio.send(&format!("{head}\r\n\r\n0\r\n\r\n{inner}"));
    assert!([400, 405].contains(&status(&smuggled)), "{smuggled}");
    assert_eq!(smuggled.matches("HTTP/1.1 ").count(), 1, "one answer: {smuggled}");
    // The server is as good as new.
    assert_eq!(status(&studio.ask("GET / HTTP/1.1", &[&cookie])), 200);
}

#[test]
fn opens_to_other_machines_only_with_a_token_that_cannot_be_guessed() {
    run(&["studio", "--host", "0.0.0.0"]).fails_with(2, &["--token"]);
    run(&["studio", "--host", "0.0.0.0", "--token", "secret"]).fails_with(2, &["32", "--token"]);
    let spaced = "0123456789 0123456789 0123456789 0123456789";
    run(&["studio", "--host", "0.0.0.0", "--token", spaced]).fails_with(2, &["--token"]);
}

#[test]
fn a_missing_page_is_one_sentence() {
    let folder = Folder::new("studio-none");
    run(&["studio", "--dir", &folder.text("")]).fails_with(3, &["index.html", "make studio"]);
    run(&["studio", "--dir", &folder.text("nowhere")]).fails_with(3, &["no such file"]);
}

#[test]
fn files_are_opened_on_the_workbench_by_number() {
    let files: [(&str, &[u8]); 2] = [("a b&c.star", b"sphere(1)"), ("x.dat", &[0, 255, 10])];
    let home = "/workbench.html?open=a%20b%26c.star&open=x.dat";
    let studio = Studio::start_with("studio-opened", &files, home);
    let cookie = studio.enter();
    let got = |path: &str| studio.ask(&format!("GET {path} HTTP/1.1"), &[&cookie]);
    assert!(got("/opened/0").ends_with("\r\n\r\nsphere(1)"));
    assert_eq!(header(&got("/opened/1"), "content-type"), Some("application/octet-stream"));
    for path in ["/opened/2", "/opened/a%20b%26c.star", "/x.dat", "/opened/../x.dat"] {
        assert_eq!(status(&got(path)), 404, "{path}");
    }
    // Without the cookie there is nothing.
    assert_eq!(status(&studio.ask("GET /opened/0 HTTP/1.1", &[])), 403);
    let missing = run(&["studio", "no-such-file.star"]);
    assert_eq!(missing.code, 3);
    assert!(missing.stderr.contains("no-such-file.star: no such file"), "{}", missing.stderr);
}
