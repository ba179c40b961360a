//! `cones view` as a browser, and others, meet it; what the page makes of it is tested in `web/test`.

use crate::folder::{Folder, PROGRAM};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A running viewer of a small hare; it ends with the test.
struct Viewer {
    child: Child,
    port: u16,
    token: String,
    _folder: Folder,
}

impl Drop for Viewer {
    fn drop(&mut self) {
        // It has ended already in the tests of its end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Viewer {
    fn new() -> Self {
        Self::of(Folder::with_shapes(), &["hare.obj", "-n", "6"])
    }

    fn of(folder: Folder, arguments: &[&str]) -> Self {
        let mut command = Command::new(PROGRAM);
        command.arg("view").args(arguments).arg("--no-open").current_dir(folder.root());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the program starts");
        let mut address = String::new();
        let stdout = child.stdout.take().expect("it was asked for");
        BufReader::new(stdout).read_line(&mut address).expect("it prints where it is");
        let rest = address.trim().strip_prefix("http://127.0.0.1:").expect("it is on this machine");
        let (port, token) = rest.trim_end_matches('/').split_once('/').expect("the address has a token");
        Self { port: port.parse().expect("a port"), token: token.to_owned(), child, _folder: folder }
    }

    fn send(&self, request: &[u8]) -> Option<Answer> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).ok()?;
        stream.set_read_timeout(Some(Duration::from_secs(120))).ok()?;
        // A refusal may come before all was sent.
        let _ = stream.write_all(request);
        let _ = stream.shutdown(Shutdown::Write);
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n")? + 4;
        let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
        let status = head.split(' ').nth(1)?.parse().ok()?;
        Some(Answer { status, head, body: bytes.split_off(end) })
    }

    fn ask(&self, method: &str, path: &str, headers: &str, body: &str) -> Answer {
        let length = if body.is_empty() { String::new() } else { format!("Content-Length: {}\r\n", body.len()) };
        let text = format!("{method} {path} HTTP/1.1\r\n{headers}{length}\r\n{body}");
        self.send(text.as_bytes()).expect("there is an answer")
    }

    fn own(&self) -> String {
        format!("Host: 127.0.0.1:{}\r\n", self.port)
    }

    fn get(&self, inside: &str) -> Answer {
        self.ask("GET", &format!("/{}/{inside}", self.token), &self.own(), "")
    }

    fn post(&self, inside: &str, body: &str) -> Answer {
        self.ask("POST", &format!("/{}/{inside}", self.token), &self.own(), body)
    }

    fn serves_the_page(&self) -> bool {
        let answer = self.get("");
        answer.status == 200 && answer.body.starts_with(b"<!doctype html>")
    }
}

#[test]
fn the_page_the_surface_cones_maps_and_files_are_served() {
    let viewer = Viewer::new();
    assert!(viewer.serves_the_page());
    let page = viewer.get("").head.to_lowercase();
    for header in
        ["content-security-policy: default-src 'none'", "cache-control: no-store", "referrer-policy: no-referrer"]
    {
        assert!(page.contains(header), "{page}");
    }
    let surface = viewer.get("surface");
    assert_eq!(surface.status, 200);
    assert!(String::from_utf8_lossy(&surface.body).contains("\"name\":\"hare.obj\""));
    let json = |answer: &Answer| serde_json::from_slice::<serde_json::Value>(&answer.body).expect("it is JSON");
    let foreseen = json(&viewer.post("foreseen", r#"{"method":"refined"}"#));
    let levels = foreseen["levels"].as_array().expect("there are levels");
    assert!(levels.len() > 20, "{}", levels.len());
    for level in levels {
        let sum: f64 = level["cones"].as_array().unwrap().iter().map(|cone| cone[1].as_f64().unwrap()).sum();
        assert!((sum - 4.0 * std::f64::consts::PI).abs() < 1e-6, "Gauss–Bonnet: {sum}");
    }
    let cones = json(&viewer.post("cones", &format!(r#"{{"given":{}}}"#, levels[3]["cones"])));
    assert_eq!(cones["found"]["cones"].as_array().map(Vec::len), levels[3]["cones"].as_array().map(Vec::len));
    assert!(!cones["seams"].as_array().unwrap().is_empty());
    let map = viewer.post("map", r#"{"tab":"a","serial":1,"n":6}"#);
    assert_eq!(map.status, 200);
    assert!(String::from_utf8_lossy(&map.body).contains("seam_lengths"));
    let measured = viewer.post("measured", r#"{"tab":"a","serial":1,"n":6}"#);
    assert_eq!(measured.status, 200);
    assert!(String::from_utf8_lossy(&measured.body).contains("quasi_conformal"));
    let saved = |kind: &str| viewer.post(&format!("save/{kind}"), r#"{"tab":"a","serial":2,"n":6}"#).body;
    assert!(String::from_utf8(saved("obj")).expect("it is text").contains("\nvt "));
    assert!(saved("glb").starts_with(b"glTF"));
    assert_eq!(String::from_utf8(saved("cones")).unwrap().lines().filter(|line| !line.starts_with('#')).count(), 6);
}

#[test]
fn a_file_of_many_lines_is_saved_on_one_thread() {
    let folder = Folder::with_shapes();
    folder.run(&["shape", "hare", "--vertices", "40000", "-o", "large.obj"]).success();
    let viewer = Viewer::of(folder, &["large.obj", "-n", "6", "--method", "persistence", "--threads", "1"]);
    let saved = viewer.post("save/obj", r#"{"tab":"a","serial":1,"n":6,"method":"persistence"}"#);
    assert!(String::from_utf8(saved.body).expect("it is text").contains("\nvt "));
}

#[test]
fn a_refined_surface_is_saved_with_the_colours_between_those_of_the_file() {
    let folder = Folder::with_shapes();
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n\
                  property uchar green\nproperty uchar blue\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
    let points = "0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n0 0 1 9 9 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    folder.write("coloured.ply", &format!("{header}{points}"));
    let viewer = Viewer::of(folder, &["coloured.ply", "-n", "4", "--refine"]);
    let saved = viewer.post("save/glb", r#"{"tab":"a","serial":1,"n":4}"#);
    assert!(saved.body.starts_with(b"glTF") && String::from_utf8_lossy(&saved.body).contains("COLOR_0"));
}

#[test]
fn a_newer_question_of_the_same_tab_stops_an_older_one() {
    let viewer = Viewer::new();
    assert_eq!(viewer.post("map", r#"{"tab":"a","serial":2,"n":6}"#).status, 200);
    assert_eq!(viewer.post("map", r#"{"tab":"a","serial":1,"n":7}"#).status, 409);
    assert_eq!(viewer.post("map", r#"{"tab":"b","serial":1,"n":7}"#).status, 200);
    assert_eq!(viewer.post("stop", r#"{"tab":"b","serial":2}"#).status, 200);
    assert_eq!(viewer.post("map", r#"{"tab":"b","serial":1,"n":9}"#).status, 409);
    assert_eq!(viewer.post("map", r#"{"tab":"b","serial":2,"n":7}"#).status, 200);
    assert_eq!(viewer.post("leave", r#"{"tab":"b"}"#).status, 200);
    assert_eq!(viewer.post("map", r#"{"tab":"b","serial":9,"n":8}"#).status, 409);
}

#[test]
fn strangers_are_refused() {
    let viewer = Viewer::new();
    let (own, token) = (viewer.own(), viewer.token.clone());
    let status = |method: &str, path: &str, headers: &str| viewer.ask(method, path, headers, "").status;
    let inside = |path: &str| format!("/{token}/{path}");
    for path in ["/", "/surface", "/0123456789abcdef0123456789abcdef/", "/../etc/passwd", "*", "/%2e%2e/"] {
        assert_eq!(status("GET", path, &own), 404, "{path}");
    }
    for path in ["../secret", "surface/", "..%2f", "etc/passwd", "save/", "save/ply", "\\", "surface%00"] {
        assert_eq!(status("GET", &inside(path), &own), 404, "{path}");
    }
    for host in ["Host: evil.example\r\n", "Host: 127.0.0.1\r\n", "", "Host: [::1]:80\r\n", &format!("{own}{own}")] {
        assert_eq!(status("GET", &inside(""), host), 403, "{host}");
    }
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1", "file://"] {
        assert_eq!(status("POST", &inside("map"), &format!("{own}Origin: {origin}\r\n")), 403, "{origin}");
    }
    assert_eq!(status("GET", &inside("surface"), &format!("{own}Origin: http://127.0.0.1:{}\r\n", viewer.port)), 200);
    for (method, path) in [("POST", "surface"), ("GET", "map"), ("PUT", ""), ("DELETE", "map"), ("OPTIONS", "map")] {
        assert_eq!(status(method, &inside(path), &own), 405, "{method} {path}");
    }
}

#[test]
fn unclear_and_oversized_questions_are_refused_with_a_reason() {
    let viewer = Viewer::new();
    for wrong in
        ["{", "\"n\"", r#"{"n":-1}"#, r#"{"n":1000}"#, r#"{"m":1}"#, r#"{"method":"magic"}"#, &"[".repeat(100_000)]
    {
        assert_eq!(viewer.post("map", wrong).status, 400, "{}", &wrong[..wrong.len().min(40)]);
    }
    for impossible in [
        r#"{"given":[[99999999,null]]}"#,
        r#"{"given":[[1,null],[1,null]]}"#,
        r#"{"given":[[1,1.0]]}"#,
        r#"{"given":[]}"#,
    ] {
        let answer = viewer.post("map", impossible);
        assert_eq!(answer.status, 422, "{impossible}");
        assert!(answer.body.len() > 10, "it says why");
    }
    assert_eq!(viewer.post("map", &"x".repeat(2_000_000)).status, 413);
    let head = format!("POST /{}/map HTTP/1.1\r\n{}", viewer.token, viewer.own());
    let claimed = viewer.send(format!("{head}Content-Length: 18446744073709551615\r\n\r\n{{}}").as_bytes());
    assert_eq!(claimed.map(|answer| answer.status), Some(413));
    let chunked = viewer.send(format!("{head}Transfer-Encoding: chunked\r\n\r\nffffffff\r\n").as_bytes());
    assert_eq!(chunked.map(|answer| answer.status), Some(411));
    assert!(viewer.serves_the_page());
}

#[test]
fn ten_thousand_requests_of_junk_change_nothing() {
    let viewer = Viewer::new();
    let mut state = 1_u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    for k in 0..10_000 {
        let mut junk: Vec<u8> = match k % 4 {
            0 => Vec::new(),
            1 => b"GET / HTTP/1.1\r\n".to_vec(),
            2 => format!(
                "POST /{}/map HTTP/1.1\r\n{}Content-Length: {}\r\n\r\n",
                viewer.token,
                viewer.own(),
                next() % 60
            )
            .into(),
            _ => format!("GET /{}/\r\n", viewer.token).into(),
        };
        junk.extend((0..next() % 80).map(|_| next() as u8));
        let Ok(mut stream) = TcpStream::connect(("127.0.0.1", viewer.port)) else { panic!("nobody listens after {k}") };
        let _ = stream.write_all(&junk);
        if k % 3 == 0 {
            // Some hear the answer, the others are gone at once.
            let _ = stream.shutdown(Shutdown::Write);
            let _ = stream.read(&mut [0; 64]);
        }
    }
    assert!(viewer.serves_the_page());
    assert_eq!(viewer.post("map", r#"{"tab":"a","serial":1,"n":6}"#).status, 200);
}

#[test]
fn those_who_say_nothing_hold_nobody_up() {
    let viewer = Viewer::new();
    let silent: Vec<TcpStream> =
        (0..40).map(|_| TcpStream::connect(("127.0.0.1", viewer.port)).expect("there is room")).collect();
    let began = Instant::now();
    assert!(viewer.serves_the_page());
    assert!(began.elapsed() < Duration::from_secs(5));
    drop(silent);
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_it() {
    let mut viewer = Viewer::new();
    let id = viewer.child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().expect("there is a kill").success());
    assert_eq!(viewer.child.wait().expect("it ends").code(), Some(130));
}

#[test]
fn what_cannot_be_shown_is_told_before_anything_is_served() {
    let folder = Folder::new();
    folder.write("none.obj", "v 0 0 0\n");
    for input in ["none.obj", "missing.obj"] {
        assert!(folder.complaint(&["view", input, "--no-open"]).contains(input));
    }
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let port = taken.local_addr().expect("it has an address").port().to_string();
    assert!(folder.complaint(&["view", "none.obj", "--no-open", "--port", &port]).contains(&port));
}

#[test]
fn a_report_for_the_browser_has_everything_inside() {
    let folder = Folder::with_shapes();
    folder.run(&["unwrap", "hare.obj", "-n", "7", "-o", "out.obj", "--report", "report.html"]).success();
    let page = folder.read("report.html");
    let (_, data) =
        page.split_once("<script id=\"data\" type=\"application/octet-stream\">").expect("it has a place for data");
    let (data, _) = data.split_once("</script>").expect("that ends");
    assert!(data.len() > 10_000 && data.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+/=".contains(&byte)));
    assert!(page.len() < 2_000_000, "{}", page.len());
    let complaint = folder.complaint(&["unwrap", "hare.obj", "-o", "out.obj", "--report", "report.pdf"]);
    assert!(complaint.contains(".json or .html"), "{complaint}");
}

#[test]
fn a_field_is_shown_by_the_page_that_a_report_is() {
    let folder = Folder::new();
    folder.write("bumps.txt", "0 3 1 4\n1 5 9 2\n6 5 3 5\n");
    folder.run(&["persistence", "bumps.txt", "--report", "bumps.html"]).success();
    let report = folder.read("bumps.html");
    let viewer = Viewer::of(folder, &["bumps.txt"]);
    let page = viewer.get("");
    assert_eq!((page.status, String::from_utf8_lossy(&page.body) == report), (200, true));
    assert_eq!(viewer.get("surface").status, 404);
    assert_eq!(viewer.post("", "{}").status, 405);
    assert_eq!(viewer.ask("GET", "/", &viewer.own(), "").status, 404);
}

#[test]
fn a_field_on_a_mesh_is_shown_too_and_has_no_cones() {
    let viewer = Viewer::of(Folder::with_shapes(), &["hare.obj", "--field", "height"]);
    assert!(viewer.serves_the_page());
    let folder = Folder::with_shapes();
    let complaint = folder.complaint(&["view", "hare.obj", "--field", "height", "-n", "3", "--no-open"]);
    assert!(complaint.contains("-n") && complaint.contains("surface"), "{complaint}");
    let complaint = folder.complaint(&["view", "hare.obj", "--layer", "1", "--no-open"]);
    assert!(complaint.contains("--layer") && complaint.contains("field"), "{complaint}");
}

#[test]
fn how_to_open_the_page_and_to_stop_is_said_beside_the_address() {
    let folder = Folder::with_shapes();
    let says = |quiet: &[&str]| {
        let mut command = Command::new(PROGRAM);
        command.args(quiet).args(["view", "hare.obj", "-n", "6", "--no-open"]).current_dir(folder.root());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        let mut address = String::new();
        let mut stdout = BufReader::new(child.stdout.take().expect("it was asked for"));
        stdout.read_line(&mut address).expect("it prints where it is");
        assert!(address.starts_with("http://"), "the address comes first, alone: {address}");
        // What it says comes right behind the address, before it answers anything.
        let port = address.trim_start_matches("http://").split('/').next().expect("it has a port").to_owned();
        let mut stream = TcpStream::connect(&port).expect("it listens");
        stream.write_all(b"GET / HTTP/1.1\r\n\r\n").expect("it hears");
        let _ = stream.read_to_end(&mut Vec::new());
        child.kill().expect("it is running");
        let done = child.wait_with_output().expect("it ends");
        String::from_utf8(done.stderr).expect("it is text")
    };
    let said = says(&[]);
    assert!(said.contains("Open the address above in a browser") && said.contains("Ctrl-C"), "{said}");
    assert_eq!(says(&["-q"]), "");
}
