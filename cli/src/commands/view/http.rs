//! HTTP for one page on this machine: small requests, one to a connection, each within limits of size and time.
//!
//! `httparse` reads the head; whatever it or the limits refuse is answered and forgotten. Nothing that a request claims is allocated.
//! A server library was not taken: `tiny_http` 0.12 allocates what a `Content-Length` says when it drops a request, reads heads without
//! limit, and stops for good where no file is left to be opened; `hyper` brings an asynchronous runtime.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::time::{Duration, Instant};

/// The longest head of a request.
const MOST_HEAD: usize = 16 * 1024;
/// The longest body: cones by hand, some tens of bytes each.
pub(super) const MOST_BODY: usize = 1024 * 1024;
const MOST_HEADERS: usize = 64;
/// So many requests are answered at once; more are told to come back. A browser opens six connections a page.
const MOST_AT_ONCE: usize = 64;
/// A request must have come within this.
const PATIENCE: Duration = Duration::from_secs(10);
/// What a refused request still sends is taken so long, so that it reads the answer.
const FAREWELL: Duration = Duration::from_millis(200);
/// Where no connection can be had, as when too many files are open, it is tried again after this.
const BREATH: Duration = Duration::from_millis(50);

const FAULT: &str = "this has brought out a fault of the program: please report it, with the surface if you may";

/// A request, as far as it matters here.
#[derive(Clone, Debug, Default)]
pub(super) struct Request {
    pub(super) method: String,
    pub(super) path: String,
    pub(super) host: Vec<String>,
    pub(super) origin: Vec<String>,
    pub(super) body: Vec<u8>,
}

/// An answer.
#[derive(Clone, Debug)]
pub(super) struct Response {
    pub(super) status: u16,
    pub(super) kind: &'static str,
    pub(super) body: Vec<u8>,
    /// What the page is going to ask for: it is sent for while its script is still being read.
    pub(super) ahead: Option<&'static str>,
}

impl Response {
    pub(super) fn new(kind: &'static str, body: Vec<u8>) -> Self {
        Self { status: 200, kind, body, ahead: None }
    }

    /// A refusal, or a sentence why something cannot be had.
    pub(super) fn refusal(status: u16, text: &str) -> Self {
        Self { status, ..Self::new("text/plain; charset=utf-8", text.as_bytes().to_vec()) }
    }

    fn write(&self, mut out: impl Write) -> io::Result<()> {
        let reason = match self.status {
            200 => "OK",
            400 => "Bad Request",
            403 => "Forbidden",
            404 => "Not Found",
            405 => "Method Not Allowed",
            408 => "Request Timeout",
            409 => "Conflict",
            411 => "Length Required",
            413 => "Content Too Large",
            422 => "Unprocessable Content",
            431 => "Request Header Fields Too Large",
            500 => "Internal Server Error",
            _ => "Service Unavailable",
        };
        let ahead = self.ahead.map(|path| format!("Link: <{path}>; rel=preload; as=fetch; crossorigin\r\n"));
        // The page has its script and style inside and talks to its server alone.
        write!(
            out,
            "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
             X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
             Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
             connect-src 'self'; img-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n{}\r\n",
            self.status,
            self.kind,
            self.body.len(),
            ahead.unwrap_or_default()
        )?;
        out.write_all(&self.body)?;
        out.flush()
    }
}

/// Answers what comes in, a thread a connection, for as long as the program runs.
pub(super) fn serve(listener: &TcpListener, answer: impl Fn(Request) -> Response + Sync) {
    let open = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        loop {
            let Ok((stream, _)) = listener.accept() else {
                std::thread::sleep(BREATH);
                continue;
            };
            if open.fetch_add(1, SeqCst) >= MOST_AT_ONCE {
                let _ = Response::refusal(503, "busy: try again").write(&stream);
                open.fetch_sub(1, SeqCst);
                continue;
            }
            let (open_here, answer) = (&open, &answer);
            let work = move || {
                // A browser that is gone needs no answer.
                let _ = converse(stream, answer);
                open_here.fetch_sub(1, SeqCst);
            };
            if std::thread::Builder::new().spawn_scoped(scope, work).is_err() {
                open.fetch_sub(1, SeqCst);
            }
        }
    });
}

fn converse(mut stream: TcpStream, answer: impl Fn(Request) -> Response) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let deadline = Instant::now() + PATIENCE;
    match read(&mut Timed { stream: &stream, deadline }) {
        Ok(request) => {
            // A fault in one answer is no reason to give no others.
            let answered = catch_unwind(AssertUnwindSafe(|| answer(request)));
            answered.unwrap_or_else(|_| Response::refusal(500, FAULT)).write(&stream)
        }
        Err(Refused::Gone) => Ok(()),
        Err(Refused::With(status, text)) => {
            Response::refusal(status, text).write(&stream)?;
            stream.shutdown(Shutdown::Write)?;
            let mut rest = Timed { stream: &stream, deadline: Instant::now() + FAREWELL };
            let _ = io::copy(&mut Read::by_ref(&mut rest).take(MOST_BODY as u64), &mut io::sink());
            stream.flush()
        }
    }
}

/// A stream that ends at a moment, however slowly bytes trickle.
struct Timed<'a> {
    stream: &'a TcpStream,
    deadline: Instant,
}

impl Read for Timed<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let left = self.deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(into)
    }
}

/// Why there is no request.
#[derive(Debug, PartialEq)]
enum Refused {
    /// Nobody is there to be answered.
    Gone,
    With(u16, &'static str),
}

impl From<io::Error> for Refused {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => Self::With(408, "the request did not come in time"),
            _ => Self::Gone,
        }
    }
}

fn read(from: &mut impl Read) -> Result<Request, Refused> {
    let mut bytes = Vec::new();
    let mut piece = [0; 4096];
    loop {
        let read = from.read(&mut piece)?;
        if read == 0 {
            return Err(Refused::Gone);
        }
        bytes.extend_from_slice(&piece[..read]);
        if let Some((mut request, length, begin)) = head(&bytes)? {
            request.body = body(&bytes[begin..], length, from)?;
            return Ok(request);
        }
        if bytes.len() > MOST_HEAD {
            return Err(Refused::With(431, "the request's head is too long"));
        }
    }
}

/// The request without its body, that one's length, and where it begins; nothing while there is more of the head to come.
fn head(bytes: &[u8]) -> Result<Option<(Request, usize, usize)>, Refused> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    let begin = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(begin)) => begin,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(Refused::With(431, "the request has too many headers")),
        Err(_) => return Err(Refused::With(400, "this is no HTTP request")),
    };
    let values = |name: &str| -> Vec<String> {
        let named = parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
        named.map(|header| String::from_utf8_lossy(header.value).into_owned()).collect()
    };
    if !values("transfer-encoding").is_empty() {
        return Err(Refused::With(411, "a body is sent with its length"));
    }
    let length = match &values("content-length")[..] {
        [] => 0,
        [length] => length.parse().map_err(|_| Refused::With(400, "the body's length is no number"))?,
        _ => return Err(Refused::With(400, "the body has several lengths")),
    };
    if length > MOST_BODY {
        return Err(Refused::With(413, "the body is too long"));
    }
    let word = |word: Option<&str>| word.unwrap_or_default().to_owned();
    let (method, path) = (word(parsed.method), word(parsed.path));
    Ok(Some((
        Request { method, path, host: values("host"), origin: values("origin"), body: Vec::new() },
        length,
        begin,
    )))
}

fn body(begun: &[u8], length: usize, from: &mut impl Read) -> Result<Vec<u8>, Refused> {
    let mut body = begun[..begun.len().min(length)].to_vec();
    let missing = length - body.len();
    if from.take(missing as u64).read_to_end(&mut body)? < missing {
        return Err(Refused::Gone);
    }
    Ok(body)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn refused(text: &[u8]) -> Refused {
        read(&mut { text }).unwrap_err()
    }

    #[test]
    fn a_request_is_read_in_whatever_pieces_it_comes() {
        let text = b"POST /a?b HTTP/1.1\r\nHost: h\r\nContent-Length: 5\r\n\r\nabcdefg";
        for first in 1..text.len() {
            let request = read(&mut text[..first].chain(&text[first..])).unwrap();
            assert_eq!((&*request.method, &*request.path, &*request.body), ("POST", "/a?b", &b"abcde"[..]));
            assert_eq!(request.host, ["h"]);
        }
    }

    #[test]
    fn what_is_too_long_or_unclear_is_refused() {
        let with = |header: &str| refused(format!("POST / HTTP/1.1\r\n{header}\r\n\r\n").as_bytes());
        assert!(matches!(with("Content-Length: 99999999999999"), Refused::With(413, _)));
        assert!(matches!(with("Content-Length: 99999999999999999999999999"), Refused::With(400, _)));
        assert!(matches!(with("Content-Length: -1"), Refused::With(400, _)));
        assert!(matches!(with("Content-Length: 1\r\nContent-Length: 2"), Refused::With(400, _)));
        assert!(matches!(with("Transfer-Encoding: chunked"), Refused::With(411, _)));
        assert!(matches!(with(&"A: b\r\n".repeat(100)), Refused::With(431, _)));
        assert!(matches!(refused(&[b'a'; 40_000]), Refused::With(431, _)));
        assert!(matches!(refused(b"\x16\x03\x01\x02\x00\x01\x00"), Refused::With(400, _)));
        assert_eq!(with("Content-Length: 7"), Refused::Gone);
        assert_eq!(refused(b""), Refused::Gone);
    }

    #[test]
    fn after_a_fault_in_one_answer_others_are_given() {
        let [mut client, server] = {
            let listener = TcpListener::bind("127.0.0.1:0").unwrap();
            let client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
            [client, listener.accept().unwrap().0]
        };
        client.write_all(b"GET / HTTP/1.1\r\n\r\n").unwrap();
        converse(server, |_| panic!("a fault")).unwrap();
        let mut answer = String::new();
        client.read_to_string(&mut answer).unwrap();
        assert!(answer.starts_with("HTTP/1.1 500 ") && answer.ends_with(FAULT), "{answer}");
    }

    proptest! {
        #[test]
        fn junk_is_no_reason_to_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), begin in "(GET|POST|) ?/? ?(HTTP/1.1\r\n)?") {
            let _ = read(&mut begin.as_bytes().chain(&bytes[..]));
        }
    }
}
