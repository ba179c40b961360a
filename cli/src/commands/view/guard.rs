//! Who may ask: only the page that the command has opened.
//!
//! Any page in the browser can send requests to this machine, and any program can find the port. So the address has a random
//! token; `Host` must be this machine's name, lest a foreign name that points here be taken for the page's own
//! origin; and `Origin`, which browsers send with what pages ask of others, must be the page's.

use super::http::{Request, Response};
use std::fmt::Write;

/// The address of the page, and what is asked there.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    token: String,
    port: u16,
}

impl Guard {
    /// With a new token; nothing if the system has no random numbers.
    pub(super) fn new(port: u16) -> Option<Self> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).ok()?;
        let token = bytes.iter().fold(String::new(), |mut token, byte| {
            let _ = write!(token, "{byte:02x}");
            token
        });
        Some(Self { token, port })
    }

    /// Where the page is.
    pub(super) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// What is asked for below the page's address, without a query.
    pub(super) fn admit<'a>(&self, request: &'a Request) -> Result<&'a str, Response> {
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        if !matches!(&request.host[..], [host] if hosts.contains(host)) {
            return Err(Response::refusal(403, "this server is asked by its own name only"));
        }
        let is_own = |origin: &String| hosts.iter().any(|host| *origin == format!("http://{host}"));
        if !request.origin.iter().all(is_own) {
            return Err(Response::refusal(403, "this server answers its own page only"));
        }
        let path = request.path.split(['?', '#']).next().unwrap_or_default();
        let inside = path.strip_prefix('/').and_then(|path| path.split_once('/'));
        match inside {
            Some((token, inside)) if is_same(token, &self.token) => Ok(inside),
            _ => Err(Response::refusal(404, "there is nothing here: use the address that cones view has printed")),
        }
    }
}

/// Compares in a time that does not tell where two texts differ.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(guard: &Guard, path: &str, host: &str, origin: &[&str]) -> Result<String, u16> {
        let origin = origin.iter().map(|&origin| origin.to_owned()).collect();
        let request = Request { path: path.to_owned(), host: vec![host.to_owned()], origin, ..Request::default() };
        guard.admit(&request).map(str::to_owned).map_err(|refusal| refusal.status)
    }

    #[test]
    fn only_the_own_page_is_admitted() {
        let guard = Guard::new(80).unwrap();
        let path = |inside: &str| format!("/{}/{inside}", guard.token);
        let here = "127.0.0.1:80";
        assert_eq!(ask(&guard, &path("map?x"), here, &[]), Ok("map".to_owned()));
        assert_eq!(ask(&guard, &path(""), "localhost:80", &["http://localhost:80"]), Ok(String::new()));
        assert_eq!(ask(&guard, &path("map"), "evil.example:80", &[]), Err(403));
        assert_eq!(ask(&guard, &path("map"), "127.0.0.1", &[]), Err(403));
        for origin in ["http://evil.example", "null", "https://127.0.0.1:80", "http://127.0.0.1:81"] {
            assert_eq!(ask(&guard, &path("map"), here, &[origin]), Err(403));
        }
        for wrong in ["/", "", "//map", "/0123/map", &path("")[..20], "/../map", "*"] {
            assert_eq!(ask(&guard, wrong, here, &[]), Err(404), "{wrong}");
        }
        assert_ne!(guard.token, Guard::new(80).unwrap().token);
    }
}
