//! The page by the keyboard alone, from the first Tab on.

use super::browser::{Page, screens};
use super::view::{CATCH_DOWNLOAD, DELETE};
use super::{ENTER, ESCAPE, browser_and_simulator, ready};

/// WebDriver's codes of keys.
const TAB: char = '\u{e004}';
const SPACE: char = ' ';
const DOWN: char = '\u{e015}';
const RIGHT: char = '\u{e014}';
const HOME: char = '\u{e011}';
/// All of a field's text is replaced.
const SELECT_ALL: &str = "\u{e009}a";

/// Presses Tab until an element has the focus, which is then in sight, uncovered and outlined.
async fn tab_to(page: &Page, css: &str) {
    let script = format!(
        "const {{ activeElement: focused }} = document;
        if (!focused.matches({css:?})) return 'elsewhere';
        const {{ left, top, right, bottom }} = focused.getBoundingClientRect();
        const hit = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
        const shown = focused.closest('label') ?? focused;
        if (hit === null || !shown.contains(hit)) return `under ${{hit?.id || hit?.className || 'nothing'}}`;
        return getComputedStyle(focused).outlineStyle === 'none' ? 'not outlined' : 'focused'"
    );
    for _ in 0..400 {
        page.press(TAB).await;
        let found = page.run(&script).await;
        if found == "elsewhere" {
            continue;
        }
        assert_eq!(found, "focused", "{css}");
        return;
    }
    let place = page.picture("failed").await;
    panic!("Tab never reaches {css}; {}", place.display());
}

/// Reaches an element by Tab, and presses a key there.
async fn press_at(page: &Page, css: &str, key: char) {
    tab_to(page, css).await;
    page.press(key).await;
}

/// Reaches a field by Tab, and replaces its text.
async fn type_at(page: &Page, css: &str, text: &str) {
    tab_to(page, css).await;
    page.keys(SELECT_ALL).await;
    page.keys(text).await;
}

#[test]
#[ignore = "needs chromium and chromedriver"]
fn everything_is_done_by_the_keyboard_alone() {
    let (driver, _folder, daemon, url) = browser_and_simulator();
    let enter = ENTER.chars().next().unwrap();
    for (screen, number) in screens().into_iter().zip(1..) {
        driver.test(screen, async |page| {
            ready(&page, &url).await;
            // The first stop leads to the buttons that matter.
            page.press(TAB).await;
            page.press(enter).await;
            page.until_true("document.activeElement.id === 'stop'")
                .await;
            press_at(&page, "#home", enter).await;
            page.until_has("#doing", "Homing").await;
            page.until_has("#doing", "Ready").await;
            page.until_has("#drive-facts", "Angle known\nyes").await;

            press_at(&page, "#by-hand summary", SPACE).await;
            type_at(&page, "#goto", "-45").await;
            type_at(&page, "#goto-speed", "1").await;
            page.press(enter).await;
            page.until_has("#doing", "Moving").await;
            page.keys(ESCAPE).await;
            page.until_has("#doing", "Ready").await;
            let tilt = page.api("tilt").await;
            assert_eq!(tilt["velocity_rpm"], 0);
            press_at(&page, "#jog [data-jog='-1']", enter).await;
            page.until_has("#doing", "Moving").await;
            page.until_has("#doing", "Ready").await;
            let jogged = page.api("tilt").await["angle_deg"].as_f64().unwrap();
            let expected = tilt["angle_deg"].as_f64().unwrap() - 1.0;
            assert!(
                (jogged - expected).abs() < 0.1,
                "{jogged}, expected {expected}"
            );
            press_at(&page, "#by-hand summary", SPACE).await;

            let name = format!("round-{number}");
            type_at(&page, "#speed", "30").await;
            press_at(&page, "#sweep > details > summary", enter).await;
            type_at(&page, "#name", &name).await;
            press_at(&page, "#sweep > details > summary", enter).await;
            press_at(&page, "#start", enter).await;
            page.until("#view-title", "the scan", |text| text == name)
                .await;
            page.until_loaded().await;

            press_at(&page, "#measure", enter).await;
            page.until_has("#measured-facts", "Largest gap").await;

            press_at(&page, "#tools > summary", enter).await;
            press_at(&page, "#top", enter).await;
            press_at(&page, "#parallel", SPACE).await;
            press_at(&page, "#map", DOWN).await;
            type_at(&page, "#limit-low", "0.5").await;
            press_at(&page, "#size", RIGHT).await;
            press_at(&page, ".clip > summary", enter).await;
            press_at(&page, "#section", DOWN).await;
            press_at(&page, "#section-offset", RIGHT).await;
            page.until_has("#clipped", "parts hidden").await;
            press_at(&page, "#link", enter).await;
            let link = page.run("return location.hash").await;
            let link = link.as_str().unwrap();
            for part in [
                "parallel=1",
                "map=cividis",
                "limits=0.5,",
                "size=2",
                "section=z,0.05,",
            ] {
                assert!(link.contains(part), "{part} in {link}");
            }
            page.run(CATCH_DOWNLOAD).await;
            press_at(&page, "#picture", enter).await;
            page.until_true("window.saved?.endsWith('.png')").await;
            press_at(&page, "#unclip", enter).await;
            press_at(&page, "#tools > summary", enter).await;
            press_at(&page, "#field", DOWN).await;
            page.until_true("document.querySelector('#field').value === 'range'")
                .await;
            press_at(&page, "#time", HOME).await;
            page.until_has("#time-now", "0.00 of ").await;
            press_at(&page, "#play", SPACE).await;
            page.until("#time-now", "played", |text| !text.starts_with("0.00 of "))
                .await;

            press_at(&page, ".scan [data-role=edit]", enter).await;
            page.keys(SELECT_ALL).await;
            let renamed = format!("renamed-{number}");
            page.keys(&renamed).await;
            page.press(enter).await;
            page.until(".scan h3", "the new name", |text| text == renamed)
                .await;
            type_at(&page, "#search", "no such name").await;
            page.until_true("document.querySelector('.scan') === null")
                .await;
            page.keys(SELECT_ALL).await;
            page.keys(&renamed).await;
            page.until(".scan h3", "the one found", |text| text == renamed)
                .await;
            page.keys(SELECT_ALL).await;
            page.keys(DELETE).await;
            press_at(&page, ".scan [data-role=download]", enter).await;
            page.until_true("document.activeElement.value === 'ply'")
                .await;
            page.press(enter).await;
            page.until_true("window.saved?.startsWith('renamed-')")
                .await;
            press_at(&page, ".scan [data-role=delete]", enter).await;
            page.until_true("document.activeElement.id === 'undo-now'")
                .await;
            page.press(enter).await;
            page.until(".scan h3", "restored", |text| text == renamed)
                .await;
            if number > 1 {
                for place in [1, 2] {
                    press_at(
                        &page,
                        &format!(".scan:nth-child({place}) [data-role=choose]"),
                        SPACE,
                    )
                    .await;
                }
                press_at(&page, "#compare", enter).await;
                page.until_has("#view-title", &format!("{renamed} compared with"))
                    .await;
                page.until_has("#view-note", " within ").await;
                press_at(&page, "#tools > summary", enter).await;
                press_at(&page, "#swap", enter).await;
                page.until("#view-title", "swapped", |text| {
                    text.ends_with(&format!(" compared with {renamed}"))
                })
                .await;
                page.until_has("#view-note", " within ").await;
                press_at(&page, "#tools > summary", enter).await;
            }
            press_at(&page, "#large", enter).await;
            page.until_true("document.fullscreenElement !== null").await;
            tab_to(&page, "#stop").await;
            press_at(&page, "#large", enter).await;
            page.until_true("document.fullscreenElement === null").await;
        });
    }
    daemon.stop(|| true).unwrap();
}
