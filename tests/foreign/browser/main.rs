//! The daemon's page in Debian's Chromium with the real daemon and simulated devices: scans,
//! faults, a lost connection.
//!
//! The tests need `chromedriver` and `chromium`. `VELOMOTION_SCREENSHOTS=FOLDER` keeps the
//! pictures, as for docs/src/page; `VELOMOTION_ALL_SCREENS=1` takes all six screens everywhere.

mod browser;
mod keyboard;
mod look;
mod quality;
mod refusals;
mod scans;
mod view;

use std::collections::BTreeSet;
use std::net::SocketAddr;
use std::path::Path;

use daemon::{Daemon, Options};
use engine::config::Config;
use engine::config::daemon::DaemonConfig;
use serde_json::Value;

use browser::{DESKTOP, Driver, NARROW, PHONE, Page, both_kinds, screens};

/// A daemon with its own folder; port 0 takes a free one.
fn daemon(config: Config, device: Option<&str>, folder: &Path, port: u16) -> Daemon {
    // Most tests do not depend on free disk space.
    reserving(0, config, device, folder, ([127, 0, 0, 1], port))
}

/// A daemon that keeps this much of the disk free.
fn reserving(
    reserve_bytes: u64,
    config: Config,
    device: Option<&str>,
    folder: &Path,
    listen: ([u8; 4], u16),
) -> Daemon {
    let settings = DaemonConfig {
        scans: Some(folder.join("scans")),
        reserve_bytes,
        ..config.daemon.clone()
    };
    Daemon::start(Options {
        config: Config {
            daemon: settings,
            ..config
        },
        device: device.map(str::to_owned),
        listen: Some(SocketAddr::from(listen)),
        runtime: Some(folder.to_owned()),
        ..Options::default()
    })
    .unwrap()
}

fn simulator(folder: &Path) -> Daemon {
    daemon(Config::default(), Some("sim"), folder, 0)
}

/// A browser, and a daemon with simulated devices in a folder of its own.
fn browser_and_simulator() -> (Driver, tempfile::TempDir, Daemon, String) {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let daemon = simulator(folder.path());
    let url = url(&daemon);
    (driver, folder, daemon, url)
}

fn url(daemon: &Daemon) -> String {
    format!("http://{}/", daemon.address())
}

/// Opens the page and waits for both devices.
async fn ready(page: &Page, url: &str) {
    page.goto(url).await;
    page.until_has("#chip-link", "Connected").await;
    page.until_has("#chip-drive", "Drive ready").await;
    page.until_has("#chip-lidar", "Lidar ready").await;
}

/// Starts a scan of this name through the form. A sweep of a second has positions even where the
/// browser, which draws in software, holds the daemon up for a few tenths.
async fn start(page: &Page, name: &str, speed: &str, to: &str) {
    page.fill("#speed", speed).await;
    page.fill("#to", to).await;
    page.run("document.querySelector('#sweep details').open = true")
        .await;
    page.fill("#name", name).await;
    page.run("document.querySelector('#sweep details').open = false")
        .await;
    // The last motion may not have ended.
    page.until_true("!document.querySelector('#start').disabled")
        .await;
    page.click("#start").await;
}

/// The scan of this name from the API.
async fn scan(page: &Page, name: &str) -> Value {
    let scans = page.api("scans").await;
    let scans = scans.as_array().or(scans["scans"].as_array()).unwrap();
    let id = scans.iter().find(|scan| scan["name"] == name).unwrap()["id"].clone();
    page.api(&format!("scans/{}", id.as_str().unwrap())).await
}

/// The number before " points", as the page writes it.
fn points(text: &str) -> u64 {
    let digits: String = text.chars().filter(char::is_ascii_digit).collect();
    digits.parse().unwrap_or(0)
}

/// Records every shown number of points of the live cloud.
const WATCH: &str = "
    window.live = [];
    new MutationObserver(() => {
      if (document.querySelector('#view-title').textContent.startsWith('Live')) window.live.push(document.querySelector('#view-points').textContent);
    }).observe(document.querySelector('#view-points'), { childList: true, characterData: true, subtree: true });";

/// Waits until an element is in the window, and nothing covers it.
async fn until_in_sight(page: &Page, css: &str) {
    page.until_true(&format!(
        "((shown) => {{
          const {{ left, top, right, bottom }} = shown.getBoundingClientRect();
          const within = left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight && top < bottom;
          return within && document.elementFromPoint((left + right) / 2, (top + bottom) / 2) === shown;
        }})(document.querySelector({css:?}))"
    ))
    .await;
}

/// Refuses every request as the daemon does when too many run, until `window.answer` is called.
const TOO_MANY: &str = "
    const answered = window.fetch;
    const refusal = JSON.stringify({ error: { message: 'too many downloads at once', help: 'try again when others have ended' } });
    window.fetch = async () => new Response(refusal, { status: 429, headers: { 'content-type': 'application/json' } });
    window.answer = () => { window.fetch = answered; };";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_scan_is_started_displayed_and_counted() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        page.until_has("#simulated", "SIMULATED").await;
        page.until_has("#view-empty", "No scan in view").await;
        page.fill("#to", "-30").await;
        let plan = page.until_has("#plan", "vertical resolution").await;
        // 5.625 deg at 600 rpm; slightly different once the lidar's own speed is known.
        assert!(
            plan.contains("5.6") && plan.contains("motor at 1125 rpm"),
            "{plan}"
        );

        page.run(WATCH).await;
        start(&page, "hall", "56.25", "-30").await;
        page.until_has("#view-title", "Live: hall").await;
        page.until_has(".scan .badge[data-state]", "complete").await;
        // The final cloud replaces the live one.
        page.until("#view-title", "hall", |text| text == "hall")
            .await;
        page.until_loaded().await;
        let printed = points(&page.text("#view-points").await);

        let made = scan(&page, "hall").await;
        assert_eq!(made["state"], "whole", "{made}");
        assert_eq!(Some(printed), made["report"]["points"].as_u64());
        assert!((100_000..200_000).contains(&printed), "{printed}");
        let live = page.run("return window.live").await;
        let most = live
            .as_array()
            .unwrap()
            .iter()
            .map(|text| points(text.as_str().unwrap()))
            .max();
        assert!(
            most.unwrap_or(0) > printed / 2,
            "{most:?} of {printed} live"
        );
        let residual = page.until_has("#last-facts", "Packet delay").await;
        assert!(
            residual.contains("Angle method") && residual.contains("\u{b5}s"),
            "{residual}"
        );
        page.until_true("document.querySelector('.scan img.thumb')?.naturalWidth === 324")
            .await;
        page.run(TO_THE_TOP).await;
        page.picture("idle").await;
        page.until_pixels("#canvas", "200 colours, of a cloud", |pixels| {
            pixels.iter().collect::<BTreeSet<_>>().len() > 200
        })
        .await;
        page.audit("a scan in view").await;
    });
    for screen in [DESKTOP.light(), PHONE, PHONE.light(), NARROW] {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.until_has("#view-points", " points").await;
            page.until_loaded().await;
            page.picture("idle").await;
            page.audit("a scan in view").await;
            for field in ["intensity", "ring", "time", "sd"] {
                page.choose("#field", field).await;
                page.until_loaded().await;
                let ends = page.text(".legend-ends").await;
                assert!(ends.chars().any(|c| c.is_ascii_digit()), "{field}: {ends}");
            }
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_sweep_is_displayed_and_stopped_by_key_and_by_touch() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    // Phones first: the list of downloads is of their scans.
    for screen in both_kinds().into_iter().rev() {
        let name = if screen.width < 600 {
            "by-finger"
        } else {
            "by-key"
        };
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            // Slow enough to outlast the checks.
            start(&page, name, "1", "-45").await;
            page.until_has("#doing", "Sweeping").await;
            page.until("#view-points", "a growing cloud", |text| {
                points(text) > 20_000
            })
            .await;
            // With software rendering a picture takes seconds, in which the cloud grows by 300,000
            // points.
            if std::env::var_os("VELOMOTION_SCREENSHOTS").is_some() {
                page.run(TO_THE_TOP).await;
                page.picture("live").await;
            }
            match name {
                "by-key" => {
                    // Another scan, then the running one again.
                    page.click(".scan:nth-child(2) [data-role=open]").await;
                    page.until("#view-title", "another", |text| !text.contains("Live"))
                        .await;
                    page.click(".scan [data-role=open]").await;
                    page.until_has("#view-title", "Live: by-key").await;
                    page.until("#view-points", "points again", |text| points(text) > 0)
                        .await;
                    // An open list of downloads does not take the key.
                    page.click("[data-role=download]").await;
                    page.until_has("#download-title", "Download").await;
                    page.keys(ESCAPE).await;
                }
                _ => page.touch("#stop").await,
            }
            page.until_has("#doing", "Stopped").await;
            if name == "by-key" {
                page.audit("the list of downloads").await;
                page.picture("downloads").await;
                page.click("#download .row button").await;
                page.until_gone("#download").await;
            }
            page.until_has(".scan .badge[data-state]", "partial").await;
            page.until_has("#view-partial", "PARTIAL").await;
            page.until_has("#doing", "Ready").await;
            let stopped = scan(&page, name).await;
            assert_eq!(stopped["why"]["kind"], "interrupted", "{stopped}");
            let swept = stopped["report"]["sweeps"][0]["to_deg"].as_f64().unwrap();
            assert!((-44.0..-0.02).contains(&swept), "{stopped}");
            let printed = page.text(".scan .why").await;
            let ended = format!(
                "Stopped by the user. Sweep 1 ended at {swept:.2} deg. What was captured is kept."
            );
            assert_eq!(printed, ended);
            let tilt = page.api("tilt").await;
            assert_eq!(tilt["velocity_rpm"], 0, "{tilt}");
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_axis_is_moved_by_hand_within_its_limits_and_stopped() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    for screen in screens() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            // The limits are drawn.
            page.until_true("document.querySelectorAll('#gauge-marks text').length === 2")
                .await;
            let axis = &page.api("status").await["axis"];
            let [min_deg, max_deg] = ["min_deg", "max_deg"].map(|key| axis[key].as_f64().unwrap());
            let drawn = page
                .run("return document.querySelector('#gauge-arc').getTotalLength()")
                .await;
            let expected = 58.0 * (max_deg - min_deg).to_radians();
            assert!(
                (drawn.as_f64().unwrap() - expected).abs() < 0.5,
                "{drawn}, expected {expected}"
            );
            page.click("#home").await;
            page.until_has("#doing", "Homing").await;
            page.until_has("#doing", "Ready").await;
            page.until_has("#drive-facts", "Angle known\nyes").await;
            page.click("#by-hand summary").await;
            page.fill("#goto-speed", "40").await;
            page.fill("#goto", "-20").await;
            page.keys(ENTER).await;
            page.until_has("#angle", "20.0").await;
            page.until_has("#doing", "Ready").await;
            page.audit("the axis by hand").await;
            page.click("#jog [data-jog='1']").await;
            page.until_has("#angle", "19.0").await;
            page.until_has("#doing", "Ready").await;
            // Beyond the limit: the field says so, and nothing is sent.
            page.fill("#goto", "10").await;
            page.click("#go").await;
            page.until_has("#goto-wrong", "Angle: expected a number from \u{2212}")
                .await;
            until_in_sight(&page, "#goto-wrong").await;
            page.audit("an angle beyond the limit").await;
            assert_eq!(page.text("#doing").await, "Ready");
            page.fill("#goto-speed", "1").await;
            page.fill("#goto", "-45").await;
            page.click("#go").await;
            page.until_has("#doing", "Moving").await;
            page.touch("#stop").await;
            page.until_has("#doing", "Ready").await;
            let tilt = page.api("tilt").await;
            assert_eq!(tilt["velocity_rpm"], 0, "{tilt}");
            let angle = tilt["angle_deg"].as_f64().unwrap();
            assert!((-40.0..-18.5).contains(&angle), "{tilt}");
            assert_eq!(page.text("#axis-error").await, "", "a stop is no error");
        });
    }
    daemon.stop(|| true).unwrap();
}

/// WebDriver's code of the key.
const ENTER: &str = "\u{e007}";

const TO_THE_TOP: &str = "scrollTo(0, 0); document.querySelector('.panels').scrollTo(0, 0); document.activeElement.blur();";

/// WebDriver's code of the key.
const ESCAPE: &str = "\u{e00c}";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_page_asks_for_a_token_once() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let config = Config {
        daemon: toml::from_str("token = 'a-token-of-this-test'").unwrap(),
        ..Config::default()
    };
    let daemon = daemon(config, Some("sim"), folder.path(), 0);
    let url = url(&daemon);
    for screen in screens() {
        driver.test(screen, async |page| {
            page.goto(&url).await;
            page.until_has("h1", "velomotion").await;
            assert_eq!(page.text("#stop").await, "");
            page.audit("signing in").await;
            page.picture("sign-in").await;
            page.fill("[name=token]", "not-the-token-of-this-test")
                .await;
            page.click("button").await;
            page.until_has("[role=alert]", "The token was wrong").await;
            page.fill("[name=token]", "a-token-of-this-test").await;
            page.click("button").await;
            page.until_has("#chip-link", "Connected").await;
            // Without its cookie the page asks for the token.
            page.run("return fetch('/api/v1/status').then((answer) => answer.status)")
                .await;
            page.forget_cookies().await;
            page.goto(&url).await;
            page.until_has("button", "Sign in").await;
            page.fill("[name=token]", "a-token-of-this-test").await;
            page.click("button").await;
            page.until_has("#sign-out", "Sign out").await;
            // A sign-out without an answer is reported beside its button.
            page.run(TOO_MANY).await;
            page.click("#sign-out").await;
            page.until_has("#sign-out-error", "Sign out: too many")
                .await;
            until_in_sight(&page, "#sign-out-error").await;
            page.run("window.answer()").await;
            page.click("#sign-out").await;
            page.until_has("button", "Sign in").await;
        });
    }
    daemon.stop(|| true).unwrap();
}
