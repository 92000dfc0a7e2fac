//! `RequestGate`: access control of the server. Every rule against foreign pages and machines is here.
use super::secret::Secret;
use hyper::header::{COOKIE, HOST, HeaderMap, HeaderName, ORIGIN, UPGRADE};
use hyper::{Method, Request};
use std::sync::atomic::{AtomicBool, Ordering};

/// The host names under which a browser on this machine reaches the server.
const OWN_NAMES: [&str; 3] = ["localhost", "127.0.0.1", "[::1]"];

/// The decision about a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GateDecision {
    /// The request is allowed.
    Enter,
    /// The token is valid: the browser gets this cookie and is redirected to a URL without the token.
    Welcome {
        /// The value of `Set-Cookie`.
        cookie: String,
    },
    /// The `Host` is unknown: another site's name points to this address (DNS rebinding).
    ForeignHost,
    /// A page of another site requests something other than a plain read.
    ForeignOrigin,
    /// Neither a valid cookie nor a valid, unused token.
    Stranger,
}

/// Checks host, origin and secret, in this order.
pub struct RequestGate {
    port: u16,
    names: Vec<String>,
    token: Secret,
    session: Secret,
    is_token_spent: AtomicBool,
}

impl RequestGate {
    /// A gate for the server at `port`, which is also reachable under each of `names`.
    pub fn new(port: u16, names: &[String], token: Secret, session: Secret) -> Self {
        let usual_names = OWN_NAMES.iter().map(|name| (*name).to_owned());
        let names = usual_names.chain(names.iter().map(|name| name.to_ascii_lowercase())).collect();
        Self { port, names, token, session, is_token_spent: AtomicBool::new(false) }
    }

    /// Decides about a request.
    pub fn judge<B>(&self, request: &Request<B>) -> GateDecision {
        let headers = request.headers();
        if !single_header(headers, &HOST).is_some_and(|host| self.is_own_host(host)) {
            return GateDecision::ForeignHost;
        }
        // A WebSocket begins as a GET, and browsers open one to any site without asking it.
        let reads = matches!(*request.method(), Method::GET | Method::HEAD) && !headers.contains_key(UPGRADE);
        if !reads && !single_header(headers, &ORIGIN).is_some_and(|origin| self.is_own_origin(origin)) {
            return GateDecision::ForeignOrigin;
        }
        if self.has_cookie(headers) {
            return GateDecision::Enter;
        }
        // Only the link that was printed has a token: elsewhere one would be a guess.
        let given = if request.uri().path() == "/" { token_in(request.uri().query()) } else { None };
        // The swap comes last, so that a wrong token does not use up the right one.
        if given.is_some_and(|token| self.token.matches(token))
            && !self.is_token_spent.swap(true, Ordering::SeqCst)
        {
            return GateDecision::Welcome { cookie: self.cookie() };
        }
        GateDecision::Stranger
    }

    /// The `Set-Cookie` value. Browsers share the cookies of a host between its ports, so the name contains
    /// the port.
    fn cookie(&self) -> String {
        // Without `Secure`, since the server speaks plain HTTP and a browser would not send it back.
        format!("{}={}; HttpOnly; SameSite=Strict; Path=/", self.cookie_name(), self.session.text())
    }

    fn cookie_name(&self) -> String {
        format!("chordal-{}", self.port)
    }

    fn has_cookie(&self, headers: &HeaderMap) -> bool {
        let name = self.cookie_name();
        let lines = headers.get_all(COOKIE).iter().filter_map(|line| line.to_str().ok());
        lines
            .flat_map(|line| line.split(';'))
            .filter_map(|pair| pair.trim().split_once('='))
            .any(|(key, value)| key == name && self.session.matches(value))
    }

    /// Whether a host is `name:port`, or just `name` at the default port of HTTP.
    fn is_own_host(&self, host: &str) -> bool {
        let host = host.to_ascii_lowercase();
        let named = self.names.iter().filter_map(|name| host.strip_prefix(name.as_str()));
        let port = format!(":{}", self.port);
        named.into_iter().any(|rest| rest == port || (rest.is_empty() && self.port == 80))
    }

    fn is_own_origin(&self, origin: &str) -> bool {
        origin.strip_prefix("http://").is_some_and(|host| self.is_own_host(host))
    }
}

/// A header that occurs exactly once, as text.
fn single_header<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    // Of two such headers it would depend on the reader which one counts.
    let mut values = headers.get_all(name).iter();
    match (values.next(), values.next()) {
        (Some(value), None) => value.to_str().ok(),
        _ => None,
    }
}

fn token_in(query: Option<&str>) -> Option<&str> {
    query?.split('&').find_map(|pair| pair.strip_prefix("token="))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN: &str = "0123456789abcdef0123456789abcdef";
    const COOKIE_LINE: &str = "chordal-8000=session";

    fn gate() -> RequestGate {
        RequestGate::new(
            8000,
            &["studio.test".to_owned()],
            Secret::from_text(TOKEN),
            Secret::from_text("session"),
        )
    }

    fn ask(gate: &RequestGate, method: &str, uri: &str, headers: &[(&str, &str)]) -> GateDecision {
        let request = Request::builder().method(method).uri(uri);
        let request = headers.iter().fold(request, |request, (name, value)| request.header(*name, *value));
        gate.judge(&request.body(()).unwrap())
    }

    #[test]
    fn lets_nobody_in_without_token_or_cookie() {
        let gate = gate();
        let host = ("host", "127.0.0.1:8000");
        assert_eq!(ask(&gate, "GET", "/", &[host]), GateDecision::Stranger);
        assert_eq!(ask(&gate, "GET", "/?token=", &[host]), GateDecision::Stranger);
        assert_eq!(ask(&gate, "GET", "/?token=wrong", &[host]), GateDecision::Stranger);
        assert_eq!(
            ask(&gate, "GET", &format!("/assets/a.js?token={TOKEN}"), &[host]),
            GateDecision::Stranger
        );
        for cookie in ["chordal-8000=", "chordal-8000=wrong", "chordal-8001=session", "session", "x=session"]
        {
            assert_eq!(
                ask(&gate, "GET", "/", &[host, ("cookie", cookie)]),
                GateDecision::Stranger,
                "{cookie}"
            );
        }
    }

    #[test]
    fn exchanges_the_token_once_for_a_cookie_that_scripts_and_other_sites_cannot_use() {
        let gate = gate();
        let host = ("host", "localhost:8000");
        let GateDecision::Welcome { cookie } = ask(&gate, "GET", &format!("/?token={TOKEN}"), &[host]) else {
            panic!("the token is good")
        };
        assert_eq!(cookie, "chordal-8000=session; HttpOnly; SameSite=Strict; Path=/");
        assert_eq!(ask(&gate, "GET", &format!("/?token={TOKEN}"), &[host]), GateDecision::Stranger);
        assert_eq!(ask(&gate, "GET", "/", &[host, ("cookie", COOKIE_LINE)]), GateDecision::Enter);
        let among_others = ("cookie", "a=b; chordal-8000=session; c=d");
        assert_eq!(ask(&gate, "GET", "/", &[host, among_others]), GateDecision::Enter);
    }

    #[test]
    fn a_wrong_guess_does_not_spend_the_token() {
        let gate = gate();
        let host = ("host", "localhost:8000");
        assert_eq!(ask(&gate, "GET", "/?token=guess", &[host]), GateDecision::Stranger);
        assert!(matches!(
            ask(&gate, "GET", &format!("/?token={TOKEN}"), &[host]),
            GateDecision::Welcome { .. }
        ));
    }

    #[test]
    fn answers_to_its_own_names_only() {
        let cookie = ("cookie", COOKIE_LINE);
        for host in ["localhost:8000", "127.0.0.1:8000", "[::1]:8000", "LOCALHOST:8000", "studio.test:8000"] {
            assert_eq!(ask(&gate(), "GET", "/", &[("host", host), cookie]), GateDecision::Enter, "{host}");
        }
        for host in [
            "evil.test:8000",
            "localhost.evil.test:8000",
            "localhost",
            "localhost:8001",
            "localhost:80000",
            "127.0.0.1.nip.test:8000",
            "user@localhost:8000",
            "",
        ] {
            assert_eq!(
                ask(&gate(), "GET", "/", &[("host", host), cookie]),
                GateDecision::ForeignHost,
                "{host}"
            );
        }
        assert_eq!(ask(&gate(), "GET", "/", &[cookie]), GateDecision::ForeignHost);
        let twice = [("host", "localhost:8000"), ("host", "evil.test"), cookie];
        assert_eq!(ask(&gate(), "GET", "/", &twice), GateDecision::ForeignHost);
    }

    #[test]
    fn a_foreign_host_learns_nothing_even_with_the_token() {
        let foreign = [("host", "evil.test:8000")];
        assert_eq!(ask(&gate(), "GET", &format!("/?token={TOKEN}"), &foreign), GateDecision::ForeignHost);
    }

    #[test]
    fn what_is_not_a_plain_read_needs_our_own_origin() {
        let (host, cookie) = (("host", "localhost:8000"), ("cookie", COOKIE_LINE));
        let own = ("origin", "http://localhost:8000");
        for method in ["POST", "PUT", "DELETE", "OPTIONS", "PATCH"] {
            assert_eq!(ask(&gate(), method, "/", &[host, cookie]), GateDecision::ForeignOrigin, "{method}");
            for origin in ["null", "http://evil.test", "https://localhost:8000", "http://localhost:8001", ""]
            {
                let headers = [host, cookie, ("origin", origin)];
                assert_eq!(
                    ask(&gate(), method, "/", &headers),
                    GateDecision::ForeignOrigin,
                    "{method} {origin}"
                );
            }
            assert_eq!(ask(&gate(), method, "/", &[host, cookie, own]), GateDecision::Enter, "{method}");
        }
        let socket = ("upgrade", "websocket");
        assert_eq!(ask(&gate(), "GET", "/", &[host, cookie, socket]), GateDecision::ForeignOrigin);
        let foreign = [host, cookie, socket, ("origin", "http://evil.test")];
        assert_eq!(ask(&gate(), "GET", "/", &foreign), GateDecision::ForeignOrigin);
        assert_eq!(ask(&gate(), "GET", "/", &[host, cookie, socket, own]), GateDecision::Enter);
    }
}
