//! Origins, hosts and tokens.

use std::net::SocketAddr;

use super::rig::{self, Answer, Rig, printed, request, run};

const TOKEN: &str = "0123456789abcdef-secret";

fn capture(address: SocketAddr, headers: &str) -> Answer {
    let headers = format!("content-type: application/json\r\n{headers}");
    request(address, "POST", "/api/v1/captures", &headers, "{}")
}

fn status(address: SocketAddr, headers: &str) -> Answer {
    request(address, "GET", "/api/v1/status", headers, "")
}

#[test]
fn requests_from_other_sites_are_refused() {
    let rig = Rig::new();
    let own = format!("origin: http://{}\r\n", rig.address);
    // Refused for its body, not for its origin.
    capture(rig.address, &own).refused(400, "own page");
    capture(rig.address, "").refused(400, "a program");
    for origin in [
        "http://evil.example",
        "null",
        "http://127.0.0.1",
        "http://127.0.0.1:1",
        // Same host and port, but this daemon has no TLS: the page belongs to another server.
        &format!("https://{}", rig.address),
        &format!("ws://{}", rig.address),
        &format!("http://{}/", rig.address),
    ] {
        let foreign = format!("origin: {origin}\r\n");
        let answer = capture(rig.address, &foreign);
        assert_eq!(answer.refused(403, origin)["kind"], "denied");
        let socket = format!(
            "{foreign}upgrade: websocket\r\nconnection: upgrade\r\nsec-websocket-version: 13\r\nsec-websocket-key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        );
        request(rig.address, "GET", "/api/v1/events", &socket, "").refused(403, origin);
    }
    // A foreign name that a foreign DNS server resolves to this address.
    status(rig.address, "host: evil.example\r\n").refused(403, "rebound");
    let both = "host: evil.example:80\r\norigin: http://evil.example:80\r\n";
    capture(rig.address, both).refused(403, "rebound");
    assert_eq!(status(rig.address, "host: localhost:1\r\n").status, 200);
}

#[test]
fn configured_tls_proxies_are_allowed() {
    let more = format!("token = '{TOKEN}'\norigins = ['https://scanner.example']");
    let rig = Rig::with(&more, |_| {});
    let from = |origin: &str| {
        let headers = format!(
            "host: scanner.example\r\nauthorization: Bearer {TOKEN}\r\norigin: {origin}\r\n"
        );
        capture(rig.address, &headers)
    };
    // Refused for its body, not for its origin.
    from("https://scanner.example").refused(400, "the proxy's page");
    from("https://scanner.example:443").refused(400, "the same");
    for other in [
        "https://scanner.example:8443",
        "https://evil.example",
        "https://scanner.example.evil.example",
    ] {
        let refused = from(other);
        let printed = refused.refused(403, other);
        assert!(
            printed["help"].as_str().unwrap().contains("origins"),
            "{printed}"
        );
    }
    // A host name does not replace the token.
    let bare = "host: scanner.example\r\norigin: https://scanner.example\r\n";
    capture(rig.address, bare).refused(401, "no token");
}

#[test]
fn every_request_needs_the_token() {
    let rig = Rig::with(&format!("token = '{TOKEN}'"), |_| {});
    let with = |given: &str| status(rig.address, &format!("authorization: {given}\r\n"));
    assert_eq!(with(&format!("Bearer {TOKEN}")).status, 200);
    assert_eq!(with(&format!("bearer  {TOKEN}")).status, 200);
    for wrong in [
        "Bearer".to_owned(),
        "Bearer ".to_owned(),
        "Bearer wrong".to_owned(),
        format!("Bearer {TOKEN}x"),
        format!("Bearer {}", &TOKEN[1..]),
        format!("Basic {TOKEN}"),
        TOKEN.to_owned(),
    ] {
        assert_eq!(with(&wrong).refused(401, &wrong)["kind"], "denied");
    }
    for path in [
        "/",
        "/metrics",
        "/api/v1/openapi.json",
        "/api/v1/scans",
        "/nothing",
    ] {
        rig.get(path).refused(401, path);
    }
    // With a token any host name is accepted.
    let proxied = format!("host: scanner.example\r\nauthorization: Bearer {TOKEN}\r\n");
    assert_eq!(status(rig.address, &proxied).status, 200);
}

#[test]
fn a_browser_signs_in_once() {
    let rig = Rig::with(&format!("token = '{TOKEN}'"), |_| {});
    let page = request(rig.address, "GET", "/", "accept: text/html\r\n", "");
    assert_eq!(page.status, 401);
    assert!(page.text().contains("<form"), "{}", page.text());
    let form = "content-type: application/x-www-form-urlencoded\r\n";
    let login = |body: &str| request(rig.address, "POST", "/login", form, body);
    assert_eq!(login("token=wrong").status, 401);
    assert_eq!(login("").status, 400);
    assert_eq!(login(&format!("token={TOKEN}&more=1")).status, 400);
    let answer = login(&format!("token={TOKEN}"));
    assert_eq!(answer.status, 303, "{}", answer.head);
    let cookie = answer
        .head
        .lines()
        .find_map(|line| line.strip_prefix("set-cookie: "))
        .unwrap();
    assert!(
        cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"),
        "{cookie}"
    );
    assert!(!cookie.contains(TOKEN));
    let cookie = cookie.split(';').next().unwrap();
    let with = |cookie: &str| status(rig.address, &format!("cookie: a=b; {cookie}\r\n")).status;
    assert_eq!(with(cookie), 200);
    assert_eq!(with("velomotion=00000000000000000000000000000000"), 401);
    let json = "content-type: application/json\r\n";
    let body = format!("{{\"token\": \"{TOKEN}\"}}");
    assert_eq!(
        request(rig.address, "POST", "/login", json, &body).status,
        204
    );
}

#[test]
fn requests_without_a_token_are_refused() {
    let folder = super::rig::place();
    for address in ["0.0.0.0:0", "[::]:0"] {
        let output = run(folder.path(), &format!("daemon --listen {address}"));
        assert_eq!(output.status.code(), Some(2));
        let printed = printed(&output);
        assert!(
            printed.contains("without a token") && printed.contains("help:"),
            "{printed}"
        );
    }
    assert!(!folder.path().join("velomotion").exists());
}

#[test]
fn a_browser_signs_out_and_its_cookie_is_for_tls_behind_tls() {
    let more = format!("token = '{TOKEN}'\norigins = ['https://scanner.example']");
    let rig = Rig::with(&more, |_| {});
    let cookie = |origin: &str| {
        let headers = format!("content-type: application/json\r\n{origin}");
        let body = format!("{{\"token\": \"{TOKEN}\"}}");
        let answer = request(rig.address, "POST", "/login", &headers, &body);
        let mut lines = answer.head.lines();
        lines
            .find_map(|line| line.strip_prefix("set-cookie: "))
            .unwrap()
            .to_owned()
    };
    assert!(!cookie("").contains("Secure"));
    let secure = cookie("host: scanner.example\r\norigin: https://scanner.example\r\n");
    assert!(secure.ends_with("; Secure"), "{secure}");
    let own = format!("cookie: {}\r\n", secure.split(';').next().unwrap());
    let signed_in = || request(rig.address, "GET", "/login", &own, "").json()["signed_in"].clone();
    assert_eq!(signed_in(), true);
    assert_eq!(status(rig.address, &own).status, 200);
    assert_eq!(
        request(rig.address, "POST", "/logout", &own, "").status,
        204
    );
    status(rig.address, &own).refused(401, "signed out");
    assert_eq!(signed_in(), false);
}

#[test]
fn a_host_with_many_wrong_tokens_has_to_wait() {
    let rig = Rig::with(&format!("token = '{TOKEN}'"), |_| {});
    let with = |given: &str| status(rig.address, &format!("authorization: Bearer {given}\r\n"));
    for _ in 0..10 {
        with("0123456789abcdef-guessed").refused(401, "wrong");
    }
    with(TOKEN).refused(429, "right, too late");
}

/// The administrator finds the host in the log, but no token.
#[test]
fn wrong_tokens_are_logged_without_the_token() {
    let folder = rig::place();
    let path = folder.path().join("stderr");
    let config = folder.path().join("velomotion.toml");
    let text = std::fs::read_to_string(&config).unwrap();
    std::fs::write(&config, format!("{text}token = '{TOKEN}'\n")).unwrap();
    let mut command = rig::velomotion(folder.path(), "daemon --listen 127.0.0.1:0 --json");
    command.stderr(std::fs::File::create(&path).unwrap());
    let daemon = rig::Process::of(command);
    let guess = "0123456789abcdef-guessed";
    let header = format!("authorization: Bearer {guess}\r\n");
    for _ in 0..2 {
        status(daemon.address, &header).refused(401, "wrong");
    }
    rig::wait("two lines", || {
        let logged = std::fs::read_to_string(&path).unwrap();
        assert!(
            !logged.contains(guess) && !logged.contains(TOKEN),
            "{logged}"
        );
        let is_logged = |tries: u32| {
            logged.contains(&format!(
                "wrong token from this machine, {tries} in the last minute"
            ))
        };
        (is_logged(1) && is_logged(2)).then_some(())
    });
}
