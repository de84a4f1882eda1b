//! What the page shows when something fails: refused requests, faults, no answer, no connection.

use engine::config::Config;
use tokio::task::spawn_blocking;
use velomotion_tests::bench::Bench;

use super::browser::{DESKTOP, Driver, NARROW, PHONE, Page, both_kinds, screens};
use super::{
    ESCAPE, TO_THE_TOP, TOO_MANY, browser_and_simulator, daemon, points, ready, reserving,
    simulator, start, until_in_sight, url,
};

/// Requests to the daemon get no answer until `window.answer` is called.
const SILENT: &str = "
    const answered = window.fetch;
    window.stops = 0;
    window.fetch = (url, init) => new Promise((_, fail) => {
      window.stops += String(url).endsWith('tilt/stop') ? 1 : 0;
      init.signal?.addEventListener('abort', () => fail(new Error('no answer')));
    });
    window.answer = () => { window.fetch = answered; };";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn an_unconfirmed_stop_is_repeated_under_an_alarm_of_full_width() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    for screen in both_kinds() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.run(SILENT).await;
            page.click("#stop").await;
            page.until_has("#not-stopped", "NOT STOPPED: cut the supply").await;
            page.until_true("window.stops >= 3").await;
            page.until_true("(({ x, y, width }) => x === 0 && y === 0 && width === innerWidth)(document.querySelector('#not-stopped').getBoundingClientRect())")
                .await;
            page.picture("not-stopped").await;
            page.audit("an unconfirmed stop").await;
            page.run("window.answer()").await;
            page.until_true("document.querySelector('#not-stopped').hidden").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn refusals_are_visible_at_their_control() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    for screen in screens() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.run(TOO_MANY).await;
            page.click("#home").await;
            page.until_has("#control-error", "Home: too many downloads at once")
                .await;
            until_in_sight(&page, "#control-error").await;
            page.click("#start").await;
            page.until_has("#control-error", "Start: too many downloads at once")
                .await;
            until_in_sight(&page, "#control-error").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

/// The request to capture is accepted, and an error is answered when the page shows the sweep.
const ERROR_IN_MOTION: &str = "
    const answered = window.fetch;
    window.fetch = async (url, init) => {
      const answer = await answered(url, init);
      if (!String(url).endsWith('captures')) return answer;
      await new Promise((seen) => {
        const look = setInterval(() => {
          if (!document.querySelector('#doing').textContent.startsWith('Sweeping')) return;
          clearInterval(look);
          seen();
        }, 20);
      });
      return new Response(JSON.stringify({ error: { message: 'the drive reports an error' } }), { status: 500 });
    };";

/// Records whether the error is ever hidden again, and counts changes of the state's text.
const WATCH_ERROR: &str = "
    window.changes = 0;
    window.hidden_again = document.querySelector('#control-error').hidden;
    new MutationObserver(() => { window.hidden_again ||= document.querySelector('#control-error').hidden; })
      .observe(document.querySelector('#control-error'), { attributes: true });
    new MutationObserver(() => { window.changes += 1; })
      .observe(document.querySelector('#doing'), { childList: true, characterData: true, subtree: true });";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn an_error_during_a_motion_stays_visible() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(PHONE, async |page| {
        ready(&page, &url).await;
        page.run(ERROR_IN_MOTION).await;
        start(&page, "slow", "1", "-45").await;
        page.until_has("#control-error", "Start: the drive reports an error")
            .await;
        page.run(WATCH_ERROR).await;
        // More than a second of the remaining time, with a status.
        page.until_true("window.changes > 30").await;
        assert_eq!(page.run("return window.hidden_again").await, false);
        until_in_sight(&page, "#control-error").await;
        page.click("#stop").await;
        page.until_has(".scan .badge[data-state]", "partial").await;
    });
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_refused_download_is_reported_at_its_scan() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let first = simulator(folder.path());
    let first_url = url(&first);
    driver.test(DESKTOP, async |page| {
        ready(&page, &first_url).await;
        start(&page, "short", "5", "-5").await;
        page.until_has(".scan .badge[data-state]", "complete").await;
    });
    first.stop(|| true).unwrap();
    // No disk has as much: clouds in other formats than PLY cannot be made.
    let reserve_bytes = 1 << 60;
    let full = reserving(
        reserve_bytes,
        Config::default(),
        Some("sim"),
        folder.path(),
        ([127, 0, 0, 1], 0),
    );
    let url = url(&full);
    for screen in screens() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.until_has(".scan", "short").await;
            page.download("las").await;
            let no_room = page.until_has(".scan .wrong", "Download as las: ").await;
            assert!(no_room.contains("disk"), "{no_room}");
            until_in_sight(&page, ".scan .wrong").await;
            page.picture("no-room").await;
            page.audit("a refused download").await;
            for format in ["ply", "log"] {
                page.run(TOO_MANY).await;
                page.download(format).await;
                page.until_has(
                    ".scan .wrong",
                    &format!("Download as {format}: too many downloads at once"),
                )
                .await;
                until_in_sight(&page, ".scan .wrong").await;
                page.run("window.answer()").await;
            }
            assert_eq!(page.run("return location.href").await, url);
            // The next download clears it.
            page.download("ply").await;
            page.until_gone(".scan .wrong").await;
            // A reload keeps the messages.
            page.goto(&url).await;
            page.until_has("#messages", "Download as log: too many downloads at once")
                .await;
        });
    }
    full.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_fault_is_shown_with_advice_and_cleared() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let bench = Bench::start();
    // The drive's own following error, not the client's motion guard, stops the held axis.
    let mut config = bench.config();
    config.axis.guard.behind_deg = 30.0;
    let daemon = daemon(config, None, folder.path(), 0);
    let url = url(&daemon);
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        assert_eq!(page.text("#simulated").await, "");
        start(&page, "held", "10", "-45").await;
        page.until("#view-points", "a growing cloud", |text| {
            points(text) > 60_000
        })
        .await;
        bench.hold(true);
        let fault = page
            .until_has(".problem[data-device=drive]", "What to do")
            .await;
        assert!(
            fault.contains("Following Error") && fault.contains("moves freely"),
            "{fault}"
        );
        // It stays beside the buttons when the fault is over.
        page.until_has("#control-error", "Following Error").await;
        page.until_has(".scan .badge[data-state]", "partial").await;
        page.until("#view-title", "held", |text| text == "held")
            .await;
        page.until_loaded().await;
        page.run(TO_THE_TOP).await;
        page.picture("fault").await;
        page.audit("a fault").await;
        assert_eq!(page.text("#chip-drive").await, "Drive fault");
        let start_is_off = page
            .run("return document.querySelector('#start').disabled")
            .await;
        assert_eq!(start_is_off, true);
        clear_is_refused(&page).await;
    });
    for screen in [DESKTOP.light(), PHONE, NARROW, NARROW.light()] {
        driver.test(screen, async |page| {
            page.goto(&url).await;
            page.until_has(".problem[data-device=drive]", "What to do")
                .await;
            page.audit("a fault").await;
        });
    }
    driver.test(PHONE.light(), async |page| {
        page.goto(&url).await;
        page.until_has(".problem[data-device=drive]", "What to do")
            .await;
        page.until_has("#view-points", " points").await;
        page.until_loaded().await;
        page.run(TO_THE_TOP).await;
        page.picture("fault").await;
        page.audit("a fault").await;
        clear_is_refused(&page).await;
        bench.hold(false);
        page.click("#clear").await;
        page.until_gone(".problem").await;
        page.until_has("#chip-drive", "Drive ready").await;
        // Unplugs the cable.
        drop(bench);
        let gone = page
            .until_has(".problem[data-device=drive]", "What to do")
            .await;
        assert!(gone.contains("Drive absent"), "{gone}");
        page.until_has("#chip-lidar", "Lidar absent").await;
    });
    daemon.stop(|| true).unwrap();
}

/// A refused request to clear the fault is reported beside its button.
async fn clear_is_refused(page: &Page) {
    page.run(TOO_MANY).await;
    page.click("#clear").await;
    page.until_has("#clear-error", "Clear: too many downloads at once")
        .await;
    until_in_sight(page, "#clear-error").await;
    page.run("window.answer()").await;
}

/// A request to move that waits in the network until `window.arrive` is called.
const LATE: &str = "
    const sent = window.fetch;
    window.fetch = (url, init) => !String(url).endsWith('tilt/goto') ? sent(url, init) : new Promise((done, fail) => {
      window.arrive = () => { window.fetch = sent; sent(url, init).then(done, fail); };
    });";

/// The stop takes a connection of its own: it may overtake the motion that it is to stop.
#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_move_that_arrives_after_its_stop_moves_nothing() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        page.click("#home").await;
        page.until_has("#drive-facts", "Angle known\nyes").await;
        page.until_has("#doing", "Ready").await;
        page.run(LATE).await;
        page.click("#by-hand summary").await;
        page.fill("#goto", "-20").await;
        page.click("#go").await;
        page.until_true("window.arrive !== undefined").await;
        let before = page.api("tilt").await["angle_deg"].as_f64().unwrap();
        // Nothing moves yet, and Escape stops what may.
        page.keys(ESCAPE).await;
        page.until_has("#doing", "Stopped").await;
        page.run("window.arrive()").await;
        page.until_has("#axis-error", "stopped before this motion began")
            .await;
        let tilt = page.api("tilt").await;
        assert_eq!(tilt["velocity_rpm"], 0, "{tilt}");
        let after = tilt["angle_deg"].as_f64().unwrap();
        assert!((after - before).abs() < 0.05, "{before}, {tilt}");
        // What is asked for after the stop moves.
        page.click("#go").await;
        page.until_has("#angle", "20.0").await;
        page.until_has("#doing", "Ready").await;
    });
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_lost_network_is_told_from_a_daemon_that_ended() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    for screen in screens() {
        // The page takes every address but localhost's usual ones for another machine.
        let another = ([127, 0, 0, 2], 0);
        let first = reserving(0, Config::default(), Some("sim"), folder.path(), another);
        let url = url(&first);
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.set_offline(true).await;
            spawn_blocking(move || first.stop(|| true).unwrap())
                .await
                .unwrap();
            page.until_has("#lost", "This device has no network.").await;
            page.audit("no network").await;
            page.set_offline(false).await;
            page.until_has("#lost", "the daemon has probably ended")
                .await;
            // What was known of the axis is old: Escape stops as the button does.
            page.keys(ESCAPE).await;
            page.until_has("#not-stopped", "NOT STOPPED").await;
        });
    }
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_lost_connection_is_reported_and_restored() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    for screen in screens() {
        let first = simulator(folder.path());
        let (url, port) = (url(&first), first.address().port());
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            start(&page, "hall", "56.25", "-45").await;
            page.until_has(".scan .badge[data-state]", "complete").await;
            page.until_has("#view-title", "hall").await;
            // The stop waits for the daemon's threads.
            spawn_blocking(move || first.stop(|| true).unwrap())
                .await
                .unwrap();
            page.until_has("#lost", "Connection to the daemon lost")
                .await;
            assert_eq!(page.text("#chip-link").await, "Offline");
            page.until_has("#lost", "The daemon on this machine does not answer")
                .await;
            page.picture("lost").await;
            page.audit("no connection").await;
            // The scan in view is deleted meanwhile, which no event reports.
            std::fs::remove_dir_all(folder.path().join("scans")).unwrap();
            // The daemon is back. On dark screens it now asks for a token.
            let place = folder.path().to_owned();
            let with_token = screen.is_dark();
            let mut config = Config::default();
            if with_token {
                config.daemon = toml::from_str("token = 'a-token-of-this-test'").unwrap();
            }
            let second = spawn_blocking(move || daemon(config, Some("sim"), &place, port));
            let second = second.await.unwrap();
            if with_token {
                page.until_has("#signin", "requires its token").await;
                page.audit("signing in again").await;
                page.fill("#token", "not-the-token-of-this-test").await;
                page.click("#signin .start").await;
                page.until_has("#signin-wrong", "wrong").await;
                page.fill("#token", "a-token-of-this-test").await;
                page.click("#signin .start").await;
                page.until_gone("#signin").await;
            }
            page.until_has("#chip-link", "Connected").await;
            page.until_gone("#lost").await;
            page.until_has("#chip-drive", "Drive ready").await;
            page.until_has("#view-title", "Point cloud").await;
            page.until_has("#messages", "was deleted while the page was not")
                .await;
            spawn_blocking(move || second.stop(|| true).unwrap())
                .await
                .unwrap();
        });
    }
}
