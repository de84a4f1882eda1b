//! The scan in view: losses and residuals, and on request density, gaps, ranges and errors.

use super::browser::{DESKTOP, NARROW, PHONE};
use super::{TOO_MANY, browser_and_simulator, ready, start, until_in_sight};

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
    for screen in [DESKTOP, DESKTOP.light(), PHONE, NARROW.light()] {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            page.until_has("#quality-facts", "Clock residual").await;
            page.run(TOO_MANY).await;
            page.click("#measure").await;
            page.until_has("#quality-error", "Measure: too many").await;
            until_in_sight(&page, "#quality-error").await;
            page.run("window.answer()").await;
            page.click("#measure").await;
            let facts = page.until_has("#measured-facts", "Points per bin").await;
            for part in ["of 5,120", "Largest gap", "Stated sd"] {
                assert!(facts.contains(part), "{part} in {facts}");
            }
            assert_eq!(page.text("#quality-error").await, "");
            let words = page
                .until_has("#ranges-words", "half of the points within")
                .await;
            assert!(words.contains(" m"), "{words}");
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
