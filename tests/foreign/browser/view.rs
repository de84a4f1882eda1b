//! The view: files of `velomotion view`, playing, picking, cutting, colours, links, pictures, full
//! screen.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::channel;
use std::thread::JoinHandle;

use velomotion::cli::Common;
use velomotion::commands::view::show;

use super::browser::{DESKTOP, Driver, PHONE, Page, both_kinds, screens};
use super::{browser_and_simulator, points, ready, simulator, start, until_in_sight, url};

/// Makes a scan with a daemon and returns the folder of its log and cloud.
fn scanned(driver: &Driver, folder: &Path) -> PathBuf {
    let daemon = simulator(folder);
    let url = url(&daemon);
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        // A busy machine may lose packets, or a reply of the drive.
        for scans in 1..=3 {
            start(&page, "hall", "56.25", "-45").await;
            page.until_true(&format!(
                "document.querySelectorAll('.scan').length === {scans}"
            ))
            .await;
            let state = page.until(".scan .badge[data-state]", "the end", |text| {
                ["complete", "partial", "no cloud"].contains(&text)
            });
            if state.await != "no cloud" {
                break;
            }
        }
    });
    daemon.stop(|| true).unwrap();
    let mut scans = std::fs::read_dir(folder.join("scans")).unwrap();
    scans
        .find_map(|scan| {
            let scan = scan.unwrap().path();
            scan.join("cloud.ply").exists().then_some(scan)
        })
        .unwrap()
}

/// `velomotion view` in a thread, and its address.
fn view(files: Vec<PathBuf>) -> (String, JoinHandle<Result<(), engine::Failure>>) {
    let (sender, served) = channel();
    let common = Common {
        config: None,
        json: false,
        quiet: true,
        verbose: 0,
    };
    let viewing = std::thread::spawn(move || {
        let interrupt = Arc::new(AtomicBool::new(false));
        show(&files, &common, &interrupt, |url| {
            sender.send(url.to_owned()).unwrap();
        })
    });
    (served.recv().unwrap(), viewing)
}

/// Picks a point somewhere in the view and returns the numbers of the last column: x, y, z, range.
pub async fn pick(page: &Page, count: usize) -> [f64; 4] {
    page.run("document.querySelector('#canvas').scrollIntoView({ block: 'center', behavior: 'instant' })")
        .await;
    let canvas = "document.querySelector('#canvas').getBoundingClientRect()";
    let size = page
        .run(&format!(
            "const {{ x, y, width, height }} = {canvas}; return [x, y, width, height]"
        ))
        .await;
    let [x, y, width, height] =
        [0, 1, 2, 3].map(|i| size.get(i).and_then(serde_json::Value::as_f64).unwrap());
    let heads = format!("return document.querySelectorAll('#picked thead th').length === {count}");
    // Not where the panels are. The second point is elsewhere than the first.
    for step in 0..60_u32 {
        let (right, down) = (0.03 * f64::from(step % 10), 0.05 * f64::from(step / 10));
        let (right, down) = match count {
            1 => (0.35 + right, 0.42 + down),
            _ => (0.62 - right, 0.67 - down),
        };
        let [tap_x, tap_y] = [x + right * width, y + down * height].map(f64::round);
        page.tap(tap_x, tap_y).await;
        if page.run(&heads).await != true {
            continue;
        }
        // The mark is where the finger was: the point is the one that is drawn there. On a narrow
        // screen the values take a part of the view's height, by which its scale changes.
        let (right, down) = (tap_x - x - width / 2.0, tap_y - y - height / 2.0);
        page.until_true(&format!(
            "(({{ clientWidth: width, clientHeight: height }}, {{ cx, cy }}) => {{
                const scale = height / {height};
                return Math.hypot(cx.baseVal.value - width / 2 - scale * {right}, cy.baseVal.value - height / 2 - scale * {down}) <= {};
            }})(document.querySelector('#canvas'), document.querySelectorAll('#overlay .pick')[{}])",
            if page.is_phone() { 24 } else { 9 },
            count - 1
        ))
        .await;
        let cells = page
            .run("return [...document.querySelectorAll('#picked tbody tr')].slice(0, 4).map((row) => Number.parseFloat(row.lastElementChild.textContent.replace('\u{2212}', '-')))")
            .await;
        return [0, 1, 2, 3].map(|i| cells.get(i).and_then(serde_json::Value::as_f64).unwrap());
    }
    panic!(
        "no point found; {}",
        page.picture("no-point").await.display()
    );
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn files_are_shown_played_and_end_with_their_tab() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let scan = scanned(&driver, folder.path());
    let other = folder.path().join("map.csv");
    std::fs::write(
        &other,
        "x,y,z,intensity\n500000,4600000,1,10\n500001,4600002,1.5,20\n500002,4600001,2,30\n",
    )
    .unwrap();
    let files = vec![scan.join("log.pcapng"), scan.join("cloud.ply"), other];
    for screen in screens() {
        let (url, viewing) = view(files.clone());
        driver.test(screen, async |page| {
            page.goto(&url).await;
            page.until("#view-title", "the log", |text| text == "log.pcapng")
                .await;
            page.until_loaded().await;
            assert!(points(&page.text("#view-points").await) > 100_000);
            assert_eq!(page.text("#view-simulated").await, "SIMULATED");
            assert_eq!(page.text("#stop").await, "", "there is no axis");
            page.until_has("#scans", "map.csv").await;
            page.picture("view").await;
            page.audit("files").await;
            // What the scan is worth, without a daemon.
            page.until_has("#quality-facts", "Packet delay").await;
            page.click("#measure").await;
            page.until_has("#measured-facts", "Largest gap").await;
            page.until_has("#sphere-words", "Fewest: ").await;
            assert_eq!(
                page.text("#budget").await,
                "",
                "the log has no error budget"
            );
            page.audit("a measured file").await;
            page.picture("view-measured").await;
            // By keys: to the start, and on from there. The time changes before the picture does.
            let whole = page.pixels_of("#canvas").await;
            page.run("document.querySelector('#time').focus()").await;
            page.press(HOME).await;
            page.until_has("#time-now", "0.00 of ").await;
            page.until_changed("#canvas", &whole).await;
            let empty = page.pixels_of("#canvas").await;
            page.run("document.querySelector('#play').focus()").await;
            page.press(' ').await;
            page.until("#time-now", "played", |text| !text.starts_with("0.00 of "))
                .await;
            page.until_has("#play", "Play").await;
            // While it plays a slow graphics card draws fewer points, and all of them after that.
            page.until_changed("#canvas", &empty).await;
            // Coordinates of a map stay what they are.
            page.click(".scan[data-id='2'] button").await;
            page.until("#view-points", "three points", |text| points(text) == 3)
                .await;
            page.until_loaded().await;
            assert_eq!(page.text("#player").await, "", "these points have no times");
            assert_eq!(page.text("#quality").await, "", "this is no scan");
            // Its own column is a colour.
            page.choose("#field", "intensity").await;
            page.until_has("#legend-high", "30").await;
            for wrong in ["/", "/0123456789abcdef0123456789abcdef/"] {
                let status = format!("return fetch('{wrong}').then((answer) => answer.status)");
                assert_eq!(page.run(&status).await, 404, "without the token");
            }
        });
        // Its last tab is closed.
        viewing.join().unwrap().unwrap();
    }
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_log_plays_by_itself_unless_the_user_wants_no_animations() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let log = scanned(&driver, folder.path()).join("log.pcapng");
    for (screen, button) in [(DESKTOP.moving(), "Pause"), (DESKTOP, "Play")] {
        let (url, viewing) = view(vec![log.clone()]);
        driver.test(screen, async |page| {
            page.goto(&url).await;
            page.until_loaded().await;
            page.until_has("#play", button).await;
            page.until_has("#time-now", " of ").await;
            // It ends with all points.
            page.until_has("#play", "Play").await;
        });
        viewing.join().unwrap().unwrap();
    }
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_cloud_is_downloaded_with_uncertainty_echo_and_laser() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        start(&page, "short", "5", "-5").await;
        page.until_has(".scan .badge[data-state]", "complete").await;
        page.run(CATCH_DOWNLOAD).await;
        page.download("csv+").await;
        page.until_true("window.saved?.endsWith('.csv')").await;
        let head = page
            .run("return window.blob.text().then((text) => text.slice(0, 2000))")
            .await;
        let head = head.as_str().unwrap();
        assert!(
            ["sd_m", "echo", "laser"]
                .iter()
                .all(|name| head.contains(name)),
            "{head}"
        );

        // It breaks off after its first bytes, and goes on from there.
        page.run(CUT_DOWNLOAD).await;
        page.run("window.saved = null").await;
        page.download("csv").await;
        page.until_true("window.saved?.endsWith('.csv')").await;
        assert_eq!(page.run("return window.answers").await, serde_json::json!([200, 206]));
        let same = "const done = arguments[0];
            (async () => done(await window.blob.text() === await (await fetch(window.made)).text()))()";
        assert_eq!(page.answer(same).await, true, "the whole file");

        // One that takes long shows its bytes, and is cancelled.
        page.run(HOLD_DOWNLOAD).await;
        page.run("window.saved = null").await;
        page.download("laz").await;
        page.until_has("#downloads", "12 B").await;
        page.audit("a download that is being made").await;
        page.click("#downloads button").await;
        page.until_gone("#downloads li").await;
        page.until_has("#announce", "cancelled").await;
        assert_eq!(page.run("return window.saved").await, serde_json::Value::Null);
        assert_eq!(page.text(".scan .wrong").await, "", "the user's wish is no error");
    });
    daemon.stop(|| true).unwrap();
}

/// The answer with a cloud ends after its first bytes; the states of all answers are kept.
const CUT_DOWNLOAD: &str = "
    const answered = window.fetch;
    window.answers = [];
    window.fetch = async (url, init) => {
      const answer = await answered(url, init);
      if (!String(url).includes('/cloud?') || init === undefined) return answer;
      window.made = String(url);
      window.answers.push(answer.status);
      if (window.answers.length > 1) return answer;
      const reader = answer.body.getReader();
      const { value } = await reader.read();
      await reader.cancel();
      let sent = false;
      const body = new ReadableStream({ pull: (stream) => {
        if (sent) stream.error(new TypeError('the network is gone'));
        else stream.enqueue(value);
        sent = true;
      } });
      return new Response(body, { status: 200, headers: answer.headers });
    };";

/// A cloud has a few bytes and never ends.
const HOLD_DOWNLOAD: &str = "
    window.fetch = async (url, { signal }) => new Response(new ReadableStream({ start: (stream) => {
      stream.enqueue(new Uint8Array(12));
      signal.addEventListener('abort', () => stream.error(signal.reason));
    } }));";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_file_that_is_no_cloud_is_reported() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let [path, good, beside] =
        ["broken.ply", "good.xyz", "good.xyz.txt"].map(|name| folder.path().join(name));
    std::fs::write(&good, "1 2 3\n4 5 6\n").unwrap();
    std::fs::write(&beside, "columns: x_m y_m z_m\n").unwrap();
    std::fs::write(
        &path,
        "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n",
    )
    .unwrap();
    let (url, viewing) = view(vec![path, good, beside]);
    driver.test(PHONE, async |page| {
        page.goto(&url).await;
        page.until_has("#scans", "a property x of the vertices")
            .await;
        page.audit("a failure").await;
    });
    let failure = viewing.join().unwrap().unwrap_err();
    assert_eq!(failure.kind, engine::Kind::BadInput, "{failure}");
    assert_eq!(failure.message, "1 of 2 files are not shown");
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn points_are_measured_cut_coloured_and_linked() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let scan = scanned(&driver, folder.path());
    for screen in screens() {
        let (url, viewing) = view(vec![scan.join("log.pcapng")]);
        driver.test(screen, async |page| {
            page.goto(&url).await;
            page.until_loaded().await;
            until_in_sight(&page, "#fit").await;
            let [x1, y1, z1, range] = pick(&page, 1).await;
            assert!((length([x1, y1, z1]) - range).abs() < 2e-3, "{x1} {y1} {z1} {range}");
            // Folded where they would cover the view.
            if screen.width < 900 {
                page.click("#picked summary").await;
            }
            for value in ["sd", "Time", "Tilt", "Ring", "Laser", "Intensity", "Return"] {
                page.until_has("#picked", value).await;
            }
            let [x2, y2, z2, _] = pick(&page, 2).await;
            let measured = page.until_has("#picked .distance", "\u{b1}").await;
            let shown: f64 = measured.split(' ').next().unwrap().parse().unwrap();
            let expected = length([x2 - x1, y2 - y1, z2 - z1]);
            assert!((shown - expected).abs() < 2e-3, "{measured}, expected {expected}");
            page.picture("measured").await;
            page.audit("a distance").await;
            if screen.width < 900 {
                page.click("#picked summary").await;
                page.click("#large").await;
                until_in_sight(&page, "#picked .distance b").await;
                page.until_true("document.querySelector('#canvas').clientHeight > 150")
                    .await;
                page.picture("measured-large").await;
                page.click("#large").await;
            } else {
                page.click("#tools > summary").await;
                until_in_sight(&page, "#picked .distance b").await;
                page.picture("measured-beside-tools").await;
                page.click("#tools > summary").await;
            }
            // From the front the two are as far apart, by the scale bar, as in x and z.
            page.click("#tools summary").await;
            page.click("#front").await;
            page.click("#parallel").await;
            page.until_true(&format!("Math.abs(({SCALED})() - {0}) < 0.02 * {0} + 0.05", (x2 - x1).hypot(z2 - z1)))
                .await;
            page.run("document.querySelector('#canvas').focus()").await;
            page.keys(DELETE).await;
            page.until_gone("#picked").await;
            page.click(".clip summary").await;
            page.fill("#z-low", "1").await;
            page.until_has("#clipped", "parts hidden").await;
            page.audit("tools").await;
            page.picture("tools").await;
            page.click("#tools > summary").await;
            page.until_has("#view-clipped", "Parts are hidden").await;
            let [_, _, z, _] = pick(&page, 1).await;
            assert!(z >= 1.0, "the box begins at 1 m, and a point at {z} m was picked");

            page.click("#tools > summary").await;
            page.click("#unclip").await;
            page.until_gone("#clipped").await;
            page.choose("#field", "range").await;
            page.fill("#limit-high", "6").await;
            let shaded = page.pixels_of("#canvas").await;
            page.click("#shading").await;
            page.until_pixels("#canvas", "points without shading", |now| {
                now.iter().zip(&shaded).filter(|(a, b)| a != b).count() * 100 > now.len()
            })
            .await;
            page.until_has("#legend-above", "above 6.0 m").await;
            page.click("#tools > summary").await;
            page.until_pixels("#canvas", "a point coloured as above the limit", |pixels| {
                let near = |pixel: &[u8; 3]| pixel.iter().zip([214, 94, 0]).all(|(a, b)| a.abs_diff(b) <= 3);
                pixels.iter().any(near)
            }).await;

            page.click("#tools > summary").await;
            page.fill("#z-low", "1").await;
            let before = page.pixels_of("#canvas").await;
            page.choose("#section", "y").await;
            page.until_pixels("#canvas", "a section", |now| {
                now.iter().zip(&before).filter(|(a, b)| a != b).count() * 100 > now.len()
            })
            .await;
            page.run("const size = document.querySelector('#size'); size.value = '3'; size.dispatchEvent(new Event('input'))")
                .await;
            page.click("#link").await;
            page.until("#tool-done", "an answer", |text| !text.is_empty()).await;
            let link = page.run("return location.href").await;
            let link = link.as_str().unwrap().to_owned();
            // The link is the page's address now.
            page.run("window.before = true; location.reload()").await;
            page.until_true("!window.before && document.querySelector('#view-points').textContent !== ''").await;
            page.until_loaded().await;
            page.until_true("document.querySelector('#z-low').value === '1' && document.querySelector('#limit-high').value === '6'").await;
            page.until_true("document.querySelector('#parallel').checked && document.querySelector('#section').value === 'y'").await;
            page.until_true("!document.querySelector('#shading').checked && document.querySelector('#size').value === '3'").await;
            page.until_has("#picked", "Pick another point").await;
            page.until_true("[...document.querySelectorAll('#overlay .pick')].filter((mark) => mark.style.display === '').length === 1").await;
            page.click("#tools > summary").await;
            page.click("#link").await;
            assert_eq!(page.run("return location.href").await, link, "the view is the linked one");

            page.run(CATCH_DOWNLOAD).await;
            page.click("#picture").await;
            page.until_true("window.saved === 'log.pcapng.png'").await;
            let png = page.run("return window.blob.arrayBuffer().then((bytes) => [...new Uint8Array(bytes, 1, 3)])").await;
            assert_eq!(png, serde_json::json!(b"PNG"));
        });
        viewing.join().unwrap().unwrap();
    }
}

/// The distance of both picked points in the window, metres by the scale bar.
const SCALED: &str = "() => {
    const [a, b] = [...document.querySelectorAll('#overlay .pick')].map(({ cx, cy }) => [cx.baseVal.value, cy.baseVal.value]);
    const [, left, right] = /^M([0-9.]+) .*H([0-9.]+)/.exec(document.querySelector('#overlay .scale').getAttribute('d'));
    const [value, unit] = document.querySelector('#overlay .scale-words').textContent.split(' ');
    const metres = Number(value) * { m: 1, cm: 0.01, mm: 0.001 }[unit];
    return metres / (right - left) * Math.hypot(a[0] - b[0], a[1] - b[1]);
}";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_stop_stays_in_full_screen_and_leaving_that_stops_the_axis() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    for screen in both_kinds() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            start(&page, "slow", "1", "-45").await;
            page.until_has("#view-title", "Live: slow").await;
            page.until("#view-points", "a growing cloud", |text| {
                points(text) > 20_000
            })
            .await;
            page.click("#large").await;
            page.until_true("document.fullscreenElement !== null").await;
            until_in_sight(&page, "#stop").await;
            page.audit("full screen").await;
            // As the browser does at the Escape key, which the page then does not see.
            page.run("document.exitFullscreen()").await;
            page.until_has(".scan .badge[data-state]", "partial").await;
            page.until_true("!document.body.classList.contains('large')")
                .await;
            // Leaving by the button stops nothing.
            start(&page, "other", "1", "-45").await;
            page.until_has("#doing", "Sweeping").await;
            page.click("#large").await;
            page.until_true("document.fullscreenElement !== null").await;
            page.click("#large").await;
            page.until_true("document.fullscreenElement === null").await;
            let seen = points(&page.text("#view-points").await);
            page.until("#view-points", "a growing cloud", |text| {
                points(text) > seen
            })
            .await;
            page.until_has("#doing", "Sweeping").await;
            page.click("#stop").await;
            page.until_has("#doing", "Ready").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

/// Keeps the next download instead of saving it.
pub const CATCH_DOWNLOAD: &str = "
    HTMLAnchorElement.prototype.click = function () { window.saved = this.download; };
    URL.createObjectURL = (blob) => { window.blob = blob; return 'blob:kept'; };";

/// WebDriver's codes of keys.
const HOME: char = '\u{e011}';
pub const DELETE: &str = "\u{e017}";
