//! Looking around: mouse, fingers and keys; windows of every width; values of points that a stored
//! cloud lacks; errors of fields.

use serde_json::{Value, json};

use super::browser::{DESKTOP, Page, SCREENS, Screen, both_kinds, screens};
use super::view::pick;
use super::{browser_and_simulator, points, ready, start, until_in_sight};

/// Opens the page, and makes a scan if there is none.
async fn with_a_scan(page: &Page, url: &str) {
    ready(page, url).await;
    if page.text(".scan").await.is_empty() {
        start(page, "hall", "56.25", "-45").await;
    }
    page.until_has(".scan .badge[data-state]", "complete").await;
    page.until("#view-title", "the scan", |text| text == "hall")
        .await;
    page.until_loaded().await;
    // Where the keys go.
    page.run("document.querySelector('#canvas').focus()").await;
}

/// Azimuth and elevation of the camera, radians; its distance and its target's place, metres.
async fn camera(page: &Page) -> [f64; 6] {
    let script = "document.querySelector('#link').click();
        return new URLSearchParams(location.hash.slice(1)).get('camera').split(',').map(Number)";
    let values = page.run(script).await;
    std::array::from_fn(|i| values[i].as_f64().unwrap())
}

/// The middle of the view in the window, and its height.
async fn middle(page: &Page) -> ([f64; 2], f64) {
    let script =
        "const { x, y, width, height } = document.querySelector('#canvas').getBoundingClientRect();
        return [x + width / 2, y + height / 2, height]";
    let values = page.run(script).await;
    let [x, y, height] = [0, 1, 2].map(|i| values[i].as_f64().unwrap());
    ([x, y], height)
}

/// Waits until the drawn axes x, y and z, `[right, down]` in pixels, are as they should be: the
/// page draws them after it has moved the camera.
async fn until_drawn(page: &Page, axes: &str) {
    page.until_true(&format!(
        "(([x, y, z]) => {axes})([...document.querySelectorAll('#overlay line.axis')].map(({{ x1, y1, x2, y2 }}) =>
            [x2.baseVal.value - x1.baseVal.value, y2.baseVal.value - y1.baseVal.value]))"
    ))
    .await;
}

fn assert_near(found: f64, expected: f64, what: &str) {
    assert!(
        (found - expected).abs() < 0.02,
        "{what}: {found}, expected {expected}"
    );
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_camera_follows_mouse_fingers_wheel_and_keys() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    let half_turn = std::f64::consts::PI;
    for screen in both_kinds() {
        driver.test(screen, async |page| {
            with_a_scan(&page, &url).await;
            let (centre, height) = middle(&page).await;
            let [x, y] = centre;
            // While the cloud is loaded its extent is not yet known.
            page.press('0').await;
            let start = camera(&page).await;

            // A tenth of the view's height turns by a tenth of a half turn.
            let aside = [x + 0.1 * height, y - 0.1 * height];
            page.drag([centre, aside], None).await;
            let turned = camera(&page).await;
            assert_near(turned[0], start[0] - 0.1 * half_turn, "azimuth");
            assert_near(turned[1], start[1] - 0.1 * half_turn, "elevation");
            assert_eq!(turned[2..], start[2..], "a turn only turns");
            assert_eq!(page.text("#picked").await, "", "a drag picks nothing");

            let zoomed = if page.is_phone() {
                page.pinch(centre, [100.0, 200.0]).await;
                let zoomed = camera(&page).await;
                assert_near(zoomed[2] / turned[2], 0.5, "fingers twice as far apart");
                zoomed
            } else {
                page.wheel(centre, 100).await;
                let zoomed = camera(&page).await;
                assert_near(zoomed[2] / turned[2], 1.12, "a step of the wheel");
                page.drag([centre, aside], Some(SHIFT)).await;
                let moved = camera(&page).await;
                assert_eq!(moved[..3], zoomed[..3], "a move only moves");
                assert_ne!(moved[3..], zoomed[3..], "the target moves");
                zoomed
            };
            assert_eq!(zoomed[..2], turned[..2], "a zoom does not turn");

            page.run("document.querySelector('#canvas').focus()").await;
            let before = camera(&page).await;
            page.press(LEFT).await;
            page.press(UP).await;
            page.press('+').await;
            let after = camera(&page).await;
            assert_near(after[0], before[0] - 0.1, "arrow to the left");
            assert_near(after[1], before[1] + 0.1, "arrow up");
            assert_near(after[2] / before[2], 1.0 / 1.15, "plus");
            page.press('-').await;
            assert_near(camera(&page).await[2] / before[2], 1.0, "minus");
            page.press('0').await;
            assert_eq!(camera(&page).await, start, "0 fits the view");

            page.run("document.querySelector('#tools').open = true")
                .await;
            let looks = async |preset: &str| {
                page.click(preset).await;
                camera(&page).await
            };
            let top = looks("#top").await;
            assert!(top[1] > 1.5, "from above: {top:?}");
            until_drawn(&page, "Math.hypot(...x) > 25 && Math.hypot(...y) > 25 && Math.hypot(...z) < 1").await;
            let [front, side] = [looks("#front").await, looks("#side").await];
            until_drawn(&page, "Math.abs(z[0]) < 1 && z[1] < -25").await;
            assert_near(
                (front[0] - side[0]).abs(),
                half_turn / 2.0,
                "front and side",
            );
            let [.., distance_m, x, y, z] = looks("#scanner").await;
            assert!(
                distance_m < start[2] / 2.0 && [x, y, z] == [0.0; 3],
                "from the scanner"
            );
            page.run("document.querySelector('#tools').open = false")
                .await;
            page.click("#fit").await;

            // Toward the scanner, whose floor is in the middle of the view.
            page.run("document.querySelector('#canvas').focus()").await;
            let mut picked = false;
            for _ in 0..40 {
                page.keys(ENTER).await;
                picked = !page.text("#picked").await.is_empty();
                if picked {
                    break;
                }
                page.press(LEFT).await;
                page.press('+').await;
            }
            assert!(picked, "Enter picks in the middle of the view");
            page.keys(DELETE).await;
            page.until_gone("#picked").await;

            // Along its time with the mouse or a finger.
            page.run("document.querySelector('#time').scrollIntoView({ block: 'center', behavior: 'instant' })")
                .await;
            let slider = "const { x, y, width, height } = document.querySelector('#time').getBoundingClientRect();
                return [x, y + height / 2, width]";
            let slider = page.run(slider).await;
            let [x, y, width] = [0, 1, 2].map(|i| slider[i].as_f64().unwrap());
            page.drag([[x + 0.9 * width, y], [x + 0.5 * width, y]], None)
                .await;
            let now = page.until_has("#time-now", " of ").await;
            let (now_s, end_s) = now.trim_end_matches(" s").split_once(" of ").unwrap();
            let share = now_s.parse::<f64>().unwrap() / end_s.parse::<f64>().unwrap();
            assert!((share - 0.5).abs() < 0.1, "{now}");
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn picked_points_get_the_columns_that_the_stored_cloud_lacks() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    for screen in screens() {
        driver.test(screen, async |page| {
            with_a_scan(&page, &url).await;
            let first = pick(&page, 1).await;
            if screen.width < 900 {
                page.click("#picked summary").await;
            }
            let values = page.until_has("#picked", "Ring").await;
            let before = page.run(IDENTITY).await;
            assert!(
                !values.contains("Laser") && !values.contains("sd"),
                "{values}"
            );
            page.click("#complete").await;
            page.until_has("#picked", "Laser").await;
            page.until_loaded().await;
            for value in ["sd", "Return", "Time", "Ring"] {
                page.until_has("#picked tbody", value).await;
            }
            page.until_gone("#complete").await;
            let again = page.run(NUMBERS).await;
            let again: [f64; 4] = std::array::from_fn(|i| again[i].as_f64().unwrap());
            assert_eq!(again, first, "the same place");
            assert_eq!(page.run(IDENTITY).await, before, "the same point");
            pick(&page, 2).await;
            page.until_has("#picked .distance", "\u{b1}").await;
            page.picture("complete").await;
            page.audit("picked points with all columns").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn nothing_overlaps_in_windows_of_any_width() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    // Every part is audited at 360, 390 and 1440 pixels by itself.
    let sizes = [
        (600, 900),
        (768, 1024),
        (899, 700),
        (900, 700),
        (1024, 768),
        (1199, 800),
        (1200, 800),
        (1920, 1080),
        (2560, 1440),
    ];
    for (width, height) in sizes {
        driver.test(Screen::of(width, height), async |page| {
            with_a_scan(&page, &url).await;
            let inner = page.run("return innerWidth").await;
            assert_eq!(inner, json!(width));
            pick(&page, 1).await;
            pick(&page, 2).await;
            page.audit("two points").await;
            page.run(
                "for (const folded of document.querySelectorAll('details')) folded.open = true",
            )
            .await;
            page.audit("everything unfolded").await;
            page.picture(&format!("{width}")).await;
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn wrong_fields_say_beside_them_what_is_expected() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    for screen in screens() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.until_has("#plan", "per sweep").await;
            for (field, value, expected) in [
                ("#speed", "0", "Speed: expected a number from 0.05 to 98\u{b0}/s"),
                ("#speed", "", "Speed: expected a number from 0.05 to 98\u{b0}/s"),
                ("#from", "-200", "From: expected a number from \u{2212}45 to 0\u{b0}"),
                ("#sweeps", "1.5", "Sweeps: expected a whole number from 1 to 10000"),
            ] {
                let before = page.run(&format!("return document.querySelector('{field}').value")).await;
                page.fill(field, value).await;
                page.run(&format!("for (const kind of ['input', 'change']) document.querySelector('{field}').dispatchEvent(new Event(kind, {{ bubbles: true }}))"))
                    .await;
                let wrong = format!("{field}-wrong");
                page.until(&wrong, expected, |text| text == expected).await;
                page.until_has("#plan", "No plan until").await;
                page.click("#start").await;
                until_in_sight(&page, &wrong).await;
                assert_eq!(page.run("return document.activeElement.id").await, Value::from(&field[1..]));
                page.audit(expected).await;
                page.fill(field, before.as_str().unwrap()).await;
                page.run(&format!("for (const kind of ['input', 'change']) document.querySelector('{field}').dispatchEvent(new Event(kind, {{ bubbles: true }}))"))
                    .await;
                page.until_gone(&wrong).await;
                page.until_has("#plan", "per sweep").await;
            }
            // In a folded section.
            page.run("document.querySelector('#name').value = 'a b'; document.querySelector('#tolerance').value = '2mm'")
                .await;
            page.click("#start").await;
            page.until_has("#name-wrong", "Name: expected letters, digits, - and _").await;
            until_in_sight(&page, "#name-wrong").await;
            let expected = "Tolerance: expected an error at a distance, such as 2mm@20m";
            assert_eq!(page.text("#tolerance-wrong").await, expected);
            page.picture("wrong-field").await;
            assert_eq!(page.text("#doing").await, "Ready");
            // Limits that leave nothing between them.
            page.click("#tools > summary").await;
            page.click(".clip > summary").await;
            page.fill("#x-high", "-1.5").await;
            page.fill("#x-low", "2").await;
            page.run("document.querySelector('#x-low').blur()").await;
            let expected = "x to: expected a number above 2";
            page.until("#x-high-wrong", expected, |text| text == expected)
                .await;
            page.audit(expected).await;
            page.click("#unclip").await;
            page.until_gone("#x-high-wrong").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn every_part_passes_the_audit_on_every_screen() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        // A partial scan with a reason and notes, then a complete one.
        start(&page, "stopped", "1", "-45").await;
        page.until_has("#doing", "Sweeping").await;
        page.until("#view-points", "points", |text| points(text) > 20_000)
            .await;
        page.click("#stop").await;
        page.until_has(".scan .badge[data-state]", "partial").await;
        page.until_has("#doing", "Ready").await;
        page.click(".scan [data-role=edit]").await;
        page.fill("textarea", "Door open").await;
        page.click(".edit .start").await;
        page.until_has(".scan .notes", "Door open").await;
        start(&page, "hall", "56.25", "-45").await;
        page.until_has("#view-title", "hall").await;
        page.until_has(".scan .badge[data-state]", "complete").await;
    });
    for screen in SCREENS {
        driver.test(screen, async |page| {
            with_a_scan(&page, &url).await;
            pick(&page, 1).await;
            page.click("#complete").await;
            page.until_gone("#complete").await;
            page.until_loaded().await;
            pick(&page, 2).await;
            page.click("#measure").await;
            page.until_has("#measured-facts", "Largest gap").await;
            page.run("for (const folded of document.querySelectorAll('details')) folded.open = true")
                .await;
            page.choose("#section", "z").await;
            page.audit("points, tools and statistics").await;
            page.run("for (const folded of document.querySelectorAll('#tools, #tools details')) folded.open = false")
                .await;
            page.run("document.querySelector('#unclip').click()").await;
            page.click(".scan [data-role=download]").await;
            page.until_has("#download-title", "hall").await;
            page.audit("downloads").await;
            page.click("#download .row button").await;
            page.click(".scan:nth-child(2) .notes").await;
            page.until_has("#about-notes", "Door open").await;
            page.audit("notes").await;
            page.click("#about button").await;
            page.click(".scan [data-role=edit]").await;
            page.audit("editing a scan").await;
            page.click(".edit button:not(.start)").await;
            page.run("for (const box of document.querySelectorAll('#scans [data-role=choose]')) box.click()")
                .await;
            page.click("#compare").await;
            page.until_has("#view-title", "hall compared with stopped")
                .await;
            page.until_has("#view-note", "of stopped").await;
            page.run("document.querySelector('#tools').open = true").await;
            page.audit("a comparison with its tools").await;
            page.run("document.querySelector('#tools').open = false").await;
            page.click("#large").await;
            page.until_true("document.fullscreenElement !== null").await;
            page.audit("full screen").await;
            page.click("#large").await;
            page.until_true("document.fullscreenElement === null").await;
            // Only rows in sight are drawn.
            page.run("document.querySelector('#scans').scrollIntoView()")
                .await;
            page.click(".scan:nth-child(2) [data-role=delete]").await;
            page.until_has("#undo-what", "stopped").await;
            page.audit("undo").await;
            page.click("#undo-now").await;
            page.until_has("#scans", "Door open").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

/// x, y, z and range of the last picked point, as they are shown.
const NUMBERS: &str = "
    const value = (name) => [...document.querySelectorAll('#picked tbody tr')].find((row) => row.firstChild.textContent === name).lastElementChild.textContent;
    return ['x', 'y', 'z', 'Range'].map((name) => Number.parseFloat(value(name).replace('\u{2212}', '-')))";

/// What tells a picked point from its neighbours.
const IDENTITY: &str = "
    return [...document.querySelectorAll('#picked tbody tr')].filter(({ firstChild }) => ['Time', 'Tilt', 'Ring', 'Intensity'].includes(firstChild.textContent)).map(({ textContent }) => textContent)";

/// WebDriver's codes of keys.
const SHIFT: char = '\u{e008}';
const LEFT: char = '\u{e012}';
const UP: char = '\u{e013}';
const ENTER: &str = "\u{e007}";
const DELETE: &str = "\u{e017}";
