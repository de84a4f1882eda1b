//! The scan in view: losses and residuals, and on request density, gaps, ranges and errors.

use std::collections::BTreeSet;

use super::browser::{DESKTOP, screens};
use super::view::pick;
use super::{TO_THE_TOP, TOO_MANY, browser_and_simulator, ready, start, until_in_sight};

/// What the points are coloured by.
const FIELD: &str = "return document.querySelector('#field').value";

#[test]
#[ignore = "needs chromium and chromedriver"]
fn the_scan_in_view_is_measured_on_request() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        assert_eq!(page.text("#quality").await, "", "no scan is in view");
        start(&page, "hall", "20", "-45").await;
        page.until_has(".scan .badge[data-state]", "complete").await;
    });
    for screen in screens() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.until_has("#quality-facts", "Packet delay").await;
            page.run(TOO_MANY).await;
            page.click("#measure").await;
            page.until_has("#quality-error", "Measure hall: too many").await;
            until_in_sight(&page, "#quality-error").await;
            page.run("window.answer()").await;
            page.click("#measure").await;
            let facts = page.until_has("#measured-facts", "Points per bin").await;
            for part in ["of 5,120", "Largest gap", "Stated sd"] {
                assert!(facts.contains(part), "{part} in {facts}");
            }
            assert_eq!(page.text("#quality-error").await, "");
            page.until_has("#sphere-words", "Fewest: ").await;
            page.until_pixels("#sphere", "bins of many densities", |pixels| {
                pixels.iter().collect::<BTreeSet<_>>().len() > 50
            })
            .await;
            // It turns with the view.
            let sphere = page.pixels_of("#sphere").await;
            page.run("document.querySelector('#top').click()").await;
            page.until_changed("#sphere", &sphere).await;
            let words = page
                .until_has("#ranges-words", "half of the points within")
                .await;
            assert!(words.contains(" m"), "{words}");
            for (plot, usual, unit) in [
                ("delays", "usually ", " \u{b5}s"),
                ("deviations", "usually ", "\u{b0}"),
            ] {
                let words = page.text(&format!("#{plot}-words")).await;
                assert!(words.starts_with(usual), "{words}");
                assert!(words.contains(&format!("{unit}, at most ")), "{words}");
                // Two bars per part of the recording, the greatest 38 high.
                let bars = format!("return Math.max(...[...document.querySelectorAll('#{plot} path')].map((path) => path.getBBox().height))");
                let height: f64 = page.run(&bars).await.as_f64().unwrap();
                assert!((height - 38.0).abs() < 0.1, "{plot}: {height}");
            }
            page.until_has("#budget-facts", "Mount\nnot included").await;
            let near = page.text("#budget-facts").await;
            page.choose("#budget-at", "50").await;
            page.until("#budget-facts", "other errors", |text| text != near)
                .await;
            page.run("document.querySelector('#measured').scrollIntoView()")
                .await;
            page.audit("a measured scan").await;
            page.picture("quality").await;
        });
    }
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn two_scans_are_compared_and_shown_together() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    driver.test(DESKTOP, async |page| {
        ready(&page, &url).await;
        for (scans, name) in [(1, "before"), (2, "after")] {
            start(&page, name, "56.25", "-45").await;
            page.until_true(&format!(
                "[...document.querySelectorAll('.scan .badge[data-state]')].filter(({{ textContent }}) => textContent === 'complete').length === {scans}"
            ))
            .await;
        }
    });
    for screen in screens() {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.until_has("#view-title", "after").await;
            page.until_loaded().await;
            page.run("document.querySelector('#scans').scrollIntoView()")
                .await;
            page.click("#scans .scan:nth-child(1) [data-role=choose]")
                .await;
            assert_eq!(page.text("#compare").await, "", "one scan is selected");
            page.click("#scans .scan:nth-child(2) [data-role=choose]")
                .await;
            page.click("#compare").await;
            page.until_has("#view-title", "after compared with before")
                .await;
            // Both scans are of one scene, seen at other azimuths of the lidar.
            let note = page.until_has("#view-note", "of before").await;
            let median = note.strip_prefix("50 % within ").unwrap();
            let median_mm: f64 = median.split(' ').next().unwrap().parse().unwrap();
            assert!((0.5..100.0).contains(&median_mm), "{note}");
            assert_eq!(page.run(FIELD).await, "distance");
            page.until_has("#announce", "50 % within").await;
            page.audit("a comparison").await;
            page.run(TO_THE_TOP).await;
            page.picture("compared").await;

            let one = page.pixels_of("#canvas").await;
            page.click("#tools > summary").await;
            page.click("#both-clouds").await;
            page.click("#tools > summary").await;
            page.until_pixels("#canvas", "the other cloud", |now| {
                let changed = now.iter().zip(&one).filter(|(a, b)| a != b).count();
                changed * 100 > now.len()
            })
            .await;

            // A link holds both scans, a picked point of one of them, and how they are drawn.
            pick(&page, 1).await;
            page.run("document.querySelector('#link').click()").await;
            let link = page.run("return location.href").await;
            page.run("window.before = true; location.reload()").await;
            page.until_true(
                "!window.before && document.querySelector('#view-points').textContent !== ''",
            )
            .await;
            page.until_has("#view-title", "after compared with before")
                .await;
            page.until_has("#view-note", "of before").await;
            page.until_true(
                "document.querySelector('#picked tbody')?.textContent.includes('Distance')",
            )
            .await;
            assert_eq!(page.run(FIELD).await, "distance");
            page.run("document.querySelector('#link').click()").await;
            assert_eq!(page.run("return location.href").await, link);
            // One that is pasted into the same tab, of a scan that was deleted.
            page.run("location.hash = '#scan=gone'").await;
            page.until_has("#scans-error", "The scan of the link is not on this daemon")
                .await;
            page.run("document.querySelector('#scans .scan [data-role=open]').click()")
                .await;
            page.until("#view-title", "one scan", |text| text == "after")
                .await;
            page.run(&format!("location.href = {link}")).await;
            page.until_has("#view-title", "after compared with before")
                .await;
            page.until_gone("#scans-error").await;
            page.until_has("#view-note", "of before").await;

            page.run("document.querySelector('#swap').click()").await;
            page.until_has("#view-title", "before compared with after")
                .await;
            page.until_has("#view-note", "of after").await;
            assert_eq!(page.run(FIELD).await, "distance");

            page.click("#scans .scan:nth-child(1) [data-role=open]")
                .await;
            page.until("#view-title", "one scan", |text| text == "after")
                .await;
            page.until_loaded().await;
            assert_eq!(page.run(FIELD).await, "height");
            page.until_gone("#both-clouds-row").await;
        });
    }
    daemon.stop(|| true).unwrap();
}
