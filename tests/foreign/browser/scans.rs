//! The list of scans: named, found, sorted, selected, deleted and restored, also a thousand of
//! them.

use std::path::Path;

use engine::config::Config;
use engine::failure::{Failure, Kind};
use serde_json::{Value, json};

use super::browser::{DESKTOP, Driver, PHONE, Page, both_kinds, screens};
use super::{
    ENTER, ESCAPE, TOO_MANY, browser_and_simulator, daemon, ready, simulator, start,
    until_in_sight, url,
};

/// Writes the folder of a finished scan; `more` replaces keys of its record.
fn store(folder: &Path, number: u64, more: &Value) {
    let id = format!("made-{number:04}");
    let place = folder.join("scans").join(&id);
    std::fs::create_dir_all(&place).unwrap();
    let mut record = json!({
        "id": id, "name": format!("scan-{number}"), "state": "whole", "why": null, "simulated": true,
        "started_s": 1.76e9 + 60.0 * number as f64, "asked": { "speed_deg_s": 56.25 }, "number": number,
        // Too many to be opened unasked.
        "points": 5_000_000 + number, "duration_s": 10.0 + (number * 7 % 1_000) as f64,
    });
    for (key, value) in more.as_object().unwrap() {
        record[key] = value.clone();
    }
    std::fs::write(place.join("scan.json"), record.to_string()).unwrap();
    std::fs::write(place.join("log.pcapng"), "log").unwrap();
}

async fn open(page: &Page, url: &str, sum: &str) {
    page.goto(url).await;
    page.until_has("#chip-link", "Connected").await;
    page.until_has("#scans-sum", sum).await;
}

/// The names of all scans of the daemon, the newest first.
async fn names(page: &Page) -> Vec<Value> {
    let list = page.api("scans").await;
    let scans = list["scans"].as_array().unwrap().iter();
    scans.map(|scan| scan["name"].clone()).collect()
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_thousand_scans_are_loaded_in_parts_and_stay_quick() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    for number in 1..=1_000 {
        let more = match number {
            400 => json!({ "notes": "the needle is here" }),
            _ => json!({}),
        };
        store(folder.path(), number, &more);
    }
    let daemon = daemon(Config::default(), Some("sim"), folder.path(), 0);
    let url = url(&daemon);
    for screen in screens() {
        driver.test(screen, async |page| {
            open(&page, &url, "1,000 scans").await;
            // The last part is empty.
            page.until_true("performance.getEntriesByType('resource').filter(({ name }) => name.includes('/scans?limit=100&before=')).length === 10")
                .await;
            only_rows_in_sight(&page).await;
            page.picture("thousand").await;
            page.audit("a thousand scans").await;

            // The last one is at the end of the list, and none covers another.
            page.run("
                const strip = document.querySelector('#strip');
                strip.scrollTo(strip.scrollWidth, 0);
                document.querySelector('#scans').scrollIntoView({ block: 'end' });
                document.querySelector('#scan-rows-scroller').scrollTo(0, 1e6);")
                .await;
            page.until_true("document.querySelector('.scan[aria-posinset=\"1000\"] h3')?.textContent === 'scan-1'")
                .await;
            if !page.is_phone() {
                page.until_true("document.querySelector('.scan-row[aria-rowindex=\"1001\"] .name')?.textContent === 'scan-1'")
                    .await;
            }
            until_in_sight(&page, ".scan[aria-posinset=\"1000\"] h3").await;
            only_rows_in_sight(&page).await;

            page.fill("#search", "needle").await;
            page.until_has("#scans-sum", "1 of 1,000 scans").await;
            assert_eq!(page.text(".scan h3").await, "scan-400");
            page.fill("#search", "SCAN-77").await;
            page.until_has("#scans-sum", "11 of 1,000 scans").await;
            page.choose("#order", "name up").await;
            page.until_has(".scan h3", "scan-77").await;
            page.fill("#search", "none of them").await;
            page.until_has("#no-scans", "No scan has these words").await;
            // 10 + 7 n modulo 1000 is largest for n = 857.
            page.fill("#search", "scan").await;
            page.choose("#order", "duration down").await;
            page.until_has(".scan h3", "scan-857").await;

            // A letter of a search, with layout: a delay of a tenth of a second is noticed.
            let typical_ms = page
                .run("
                    const list = document.querySelector('#scans');
                    const search = document.querySelector('#search');
                    const times = [];
                    for (const words of ['s', 'sc', '', '1', '12', '']) {
                        const begin = performance.now();
                        search.value = words;
                        search.dispatchEvent(new Event('input'));
                        list.getBoundingClientRect();
                        times.push(performance.now() - begin);
                    }
                    return times.sort((a, b) => a - b)[3]")
                .await;
            assert!(typical_ms.as_f64().unwrap() < 100.0, "{typical_ms} ms");
        });
    }
    daemon.stop(|| true).unwrap();
}

/// The document has few of all rows, and those do not overlap.
async fn only_rows_in_sight(page: &Page) {
    for rows in [".scan", "#scan-rows .scan-row"] {
        let count = page
            .run(&format!(
                "return document.querySelectorAll('{rows}').length"
            ))
            .await;
        assert!(count.as_u64().unwrap() < 40, "{count} {rows}");
    }
    page.until_true(
        "[...document.querySelectorAll('.scan')].map((card) => card.getBoundingClientRect())
            .every((box, i, all) => i === 0 || all[i - 1].right < box.left || all[i - 1].bottom < box.top)",
    )
    .await;
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_scan_gets_a_name_and_notes_where_it_is_shown() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    for number in 1..=3 {
        store(folder.path(), number, &json!({}));
    }
    let daemon = simulator(folder.path());
    let url = url(&daemon);
    for (screen, round) in both_kinds().into_iter().zip(1..) {
        driver.test(screen, async |page| {
            open(&page, &url, "3 scans").await;
            let name = format!("Hall {round}, north end");
            page.click(".scan [data-role=edit]").await;
            page.fill(".scan .edit [data-role=name]", &name).await;
            page.fill(
                ".scan .edit [data-role=notes]",
                &format!("Door open\nround {round}"),
            )
            .await;
            page.audit("a scan is edited").await;
            page.picture("edit").await;
            // A refusal keeps what was typed.
            page.run(TOO_MANY).await;
            page.click(".scan .edit [type=submit]").await;
            page.until_has(".scan .edit .wrong", "Save: too many").await;
            page.run("window.answer()").await;
            page.click(".scan .edit [data-role=name]").await;
            page.keys(ENTER).await;
            page.until(".scan h3", &name, |text| text == name).await;
            page.until_has(".scan .notes", &format!("round {round}"))
                .await;
            page.until_true("document.activeElement?.dataset.role === 'edit'")
                .await;
            let listed = page.api("scans").await;
            assert_eq!(listed["scans"][0]["name"], name);
            assert_eq!(
                listed["scans"][0]["notes"],
                format!("Door open\nround {round}")
            );
            page.fill("#search", &format!("hall round {round}")).await;
            page.until_has("#scans-sum", "1 of 3 scans").await;
            page.fill("#search", "round").await;
            // Escape changes nothing.
            page.click(".scan [data-role=edit]").await;
            page.fill(".scan .edit [data-role=name]", "another").await;
            page.keys(ESCAPE).await;
            page.until(".scan h3", &name, |text| text == name).await;
            if page.is_phone() {
                return;
            }
            // In the table, and by the keyboard alone.
            page.click("#scan-rows .scan-row:nth-child(1) [data-role=edit]")
                .await;
            page.fill("#scan-rows .edit [data-role=name]", "from the table")
                .await;
            page.picture("edit-row").await;
            page.audit("a row is edited").await;
            page.keys(ENTER).await;
            page.until_has("#scan-rows .name", "from the table").await;
            assert_eq!(page.text(".scan h3").await, "from the table");
            assert_eq!(names(&page).await[0], "from the table");
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn deleted_scans_are_back_after_undo_and_gone_without_it() {
    let driver = Driver::start();
    for screen in screens() {
        let folder = tempfile::tempdir().unwrap();
        for number in 1..=4 {
            store(folder.path(), number, &json!({}));
        }
        let daemon = simulator(folder.path());
        let url = url(&daemon);
        driver.test(screen, async |page| {
            open(&page, &url, "4 scans").await;
            let all = names(&page).await;
            // Refused: reported at the scan, which stays.
            page.run(TOO_MANY).await;
            page.click(".scan [data-role=delete]").await;
            page.until_has(".scan .wrong", "Delete: too many downloads at once")
                .await;
            until_in_sight(&page, ".scan .wrong").await;
            page.run("window.answer()").await;
            // One, and back by the keyboard: the button has the focus.
            page.click(".scan [data-role=delete]").await;
            page.until_has("#undo", "scan-4 deleted").await;
            page.until_has("#scans-sum", "3 scans").await;
            assert_eq!(names(&page).await, all[1..]);
            until_in_sight(&page, "#undo-now").await;
            page.audit("a deleted scan").await;
            page.picture("undo").await;
            page.until_true("document.activeElement.id === 'undo-now'")
                .await;
            page.keys(ENTER).await;
            page.until_has("#scans-sum", "4 scans").await;
            page.until_gone("#undo").await;
            assert_eq!(names(&page).await, all);

            // Several: all but the second.
            page.click("#choose-all").await;
            page.until_has("#chosen", "4 selected").await;
            page.run("document.querySelector('#scans').scrollIntoView()")
                .await;
            page.until_true("document.querySelector('.scan:nth-child(2)')")
                .await;
            page.click(".scan:nth-child(2) [data-role=choose]").await;
            page.until_has("#delete-chosen", "Delete 3").await;
            page.audit("selected scans").await;
            page.click("#delete-chosen").await;
            page.until_has("#undo", "3 scans deleted").await;
            assert_eq!(names(&page).await, all[1..2]);
            page.click("#undo-now").await;
            page.until_has("#scans-sum", "4 scans").await;
            assert_eq!(names(&page).await, all);
            if !page.is_phone() {
                shift_selects_a_range(&page).await;
            }

            // Without undo it is gone after 10 s, with its files.
            page.click(".scan [data-role=delete]").await;
            page.until_has("#undo", "scan-4 deleted").await;
            page.until_gone("#undo").await;
            let kept = folder.path().join("scans/.made-0004.deleted");
            while kept.exists() {
                tokio::time::sleep(std::time::Duration::from_millis(50)).await;
            }
            assert_eq!(names(&page).await, all[1..]);
        });
        daemon.stop(|| true).unwrap();
    }
}

/// In the table, whose head also sorts.
async fn shift_selects_a_range(page: &Page) {
    page.click("#scan-table [data-sort=name]").await;
    page.until_has("#scan-rows .name", "scan-1").await;
    page.until_true(
        "document.querySelector('[data-sort=name]').parentElement.ariaSort === 'ascending'",
    )
    .await;
    page.click("#scan-rows .scan-row:nth-child(1) [data-role=choose]")
        .await;
    page.until_has("#chosen", "1 selected").await;
    page.run("document.querySelector('#scan-rows .scan-row:nth-child(3) [data-role=choose]').dispatchEvent(new MouseEvent('click', { shiftKey: true, bubbles: true }))")
        .await;
    page.until_has("#chosen", "3 selected").await;
    page.picture("table").await;
    page.click("#choose-all").await;
    page.click("#choose-all").await;
    page.until_has("#chosen", "Select all").await;
    page.click("#scan-table [data-sort=time]").await;
    page.until_has("#scan-rows .name", "scan-4").await;
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_reason_of_a_partial_scan_is_readable_whole() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let why = Failure::new(
        Kind::Incomplete,
        "12 of 37,000 lidar packets were lost in the network between the lidar and this machine, and 3 were dropped by the kernel",
    )
    .help("see whether the cable is damaged\nuse a network card of its own for the lidar\nthen scan again");
    store(
        folder.path(),
        1,
        &json!({ "state": "partial", "why": why, "notes": "Rain.\nThe tripod stood on grass and may have sunk a little." }),
    );
    let daemon = simulator(folder.path());
    let url = url(&daemon);
    for screen in screens() {
        driver.test(screen, async |page| {
            open(&page, &url, "1 scan").await;
            let summary = page.api("scans/made-0001").await["summary"].clone();
            let summary = summary.as_str().unwrap();
            assert!(summary.ends_with("Then scan again."), "{summary}");
            let whole = |css: &str| {
                format!("(({{ scrollHeight, clientHeight, scrollWidth, clientWidth }}) => scrollHeight <= clientHeight + 1 && scrollWidth <= clientWidth + 1)(document.querySelector({css:?}))")
            };
            if page.is_phone() {
                assert_eq!(page.text(".scan .why").await, summary);
                page.until_true(&whole(".scan")).await;
            }
            page.click(".scan .why").await;
            page.until_has("#about-title", "scan-1").await;
            assert_eq!(page.text("#about-why").await, summary);
            assert!(page.text("#about-notes").await.starts_with("Rain.\nThe tripod"));
            page.until_true(&whole("#about")).await;
            page.audit("a reason").await;
            page.picture("reason").await;
            page.keys(ESCAPE).await;
            page.until_gone("#about").await;
            page.until_true("document.activeElement.dataset.role === 'why'").await;
            page.click(".scan .notes").await;
            page.click("#about button").await;
            page.until_gone("#about").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_view_of_a_deleted_scan_is_back_with_it() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(DESKTOP, async |page| {
        super::ready(&page, &url).await;
        start(&page, "short", "5", "-5").await;
        page.until_has(".scan .badge[data-state]", "complete").await;
        page.until("#view-title", "short", |text| text == "short")
            .await;
        page.until_loaded().await;
        page.click(".scan [data-role=delete]").await;
        page.until_has("#view-empty", "No scan in view").await;
        page.click("#undo-now").await;
        page.until("#view-title", "short", |text| text == "short")
            .await;
        page.until_loaded().await;
        page.until_true("document.querySelector('.scan').ariaCurrent === 'true'")
            .await;
    });
    daemon.stop(|| true).unwrap();
}

/// One button makes both scans of a calibration, one at each click. A scan that is stopped is to
/// be made again.
#[test]
#[ignore = "needs chromium and chromedriver"]
fn a_button_makes_the_two_scans_for_a_calibration() {
    let driver = Driver::start();
    let folder = tempfile::tempdir().unwrap();
    let daemon = simulator(folder.path());
    let url = url(&daemon);
    let begin = async |page: &Page| {
        page.run("document.querySelector('#recipe').closest('details').open = true")
            .await;
        page.until_true("!document.querySelector('#recipe').disabled")
            .await;
        page.click("#recipe").await;
        page.until_true("document.querySelector('#stop').dataset.moving === 'true'")
            .await;
    };
    driver.test(PHONE, async |page| {
        ready(&page, &url).await;
        begin(&page).await;
        page.click("#stop").await;
        page.until_has("#recipe-error", "is not complete: scan again")
            .await;
        assert_eq!(page.text("#recipe").await, "Scan for a calibration");
        begin(&page).await;
        page.until_has("#recipe", "Second scan, at 10\u{b0}/s")
            .await;
        // It waits for the user.
        assert_eq!(names(&page).await.len(), 2);
        begin(&page).await;
        let done = page.until_has("#messages", "velomotion calibrate").await;
        assert_eq!(page.text("#recipe").await, "Scan for a calibration");
        let scans = page.api("scans").await;
        let scans = scans["scans"].as_array().unwrap();
        assert_eq!(scans.len(), 3, "{scans:?}");
        for (scan, speed_deg_s) in scans.iter().zip([10.0, 56.25]) {
            assert_eq!(scan["state"], "whole", "{scan}");
            assert_eq!(scan["asked"]["speed_deg_s"], speed_deg_s, "{scan}");
            assert_eq!(scan["asked"]["both_ways"], true, "{scan}");
            assert!(done.contains(scan["id"].as_str().unwrap()), "{done}");
        }
        page.audit("after two scans").await;
    });
    daemon.stop(|| true).unwrap();
}
