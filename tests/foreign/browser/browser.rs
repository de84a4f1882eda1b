//! Debian's Chromium through its WebDriver: one `chromedriver`, and one window per test.

use std::future::Future;
use std::io::{BufRead, BufReader, Cursor, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use fantoccini::actions::{
    Actions, InputSource, KeyAction, KeyActions, MOUSE_BUTTON_LEFT, MouseActions, PointerAction,
    TouchActions, WheelAction, WheelActions,
};
use fantoccini::wd::WebDriverCompatibleCommand;
use fantoccini::{Client, ClientBuilder, Locator};
use http::Method;
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use url::Url;

/// Every awaited condition comes sooner, or never.
const TIME_LIMIT: Duration = Duration::from_secs(90);
const LOOK_AGAIN: Duration = Duration::from_millis(40);

/// A screen: its size and colour scheme.
#[derive(Clone, Copy, Debug)]
pub struct Screen {
    /// Name in file names of pictures.
    pub name: &'static str,
    pub width: u32,
    height: u32,
    ratio: u32,
    dark: bool,
    /// Whether the user wants no animations.
    still: bool,
}

/// A laptop's screen.
pub const DESKTOP: Screen = Screen {
    name: "desktop",
    width: 1440,
    height: 900,
    ratio: 1,
    dark: true,
    still: true,
};
/// A phone next to the tripod.
pub const PHONE: Screen = Screen {
    name: "phone",
    width: 390,
    height: 844,
    ratio: 1,
    dark: true,
    still: true,
};
/// The narrowest supported screen.
pub const NARROW: Screen = Screen {
    name: "narrow",
    width: 360,
    height: 640,
    ratio: 1,
    dark: true,
    still: true,
};

/// Every screen with both colour schemes.
pub const SCREENS: [Screen; 6] = [
    DESKTOP,
    DESKTOP.light(),
    PHONE,
    PHONE.light(),
    NARROW,
    NARROW.light(),
];

/// One screen: a laptop for half of the tests, a phone for the others. Every test takes every
/// screen with both colour schemes if `VELOMOTION_ALL_SCREENS` is set, which takes six times as
/// long.
pub fn screens() -> Vec<Screen> {
    // A test's thread has its name.
    let length = std::thread::current().name().map_or(0, str::len);
    let screens = [DESKTOP, PHONE.light(), DESKTOP.light(), NARROW];
    of_ci(&[screens[length % screens.len()]])
}

/// A laptop and a phone, for a test whose steps differ between them, or that concerns a stop.
pub fn both_kinds() -> Vec<Screen> {
    of_ci(&[DESKTOP, PHONE.light()])
}

fn of_ci(screens: &[Screen]) -> Vec<Screen> {
    match std::env::var_os("VELOMOTION_ALL_SCREENS") {
        Some(_) => SCREENS.to_vec(),
        None => screens.to_vec(),
    }
}

impl Screen {
    /// A window of this size.
    pub const fn of(width: u32, height: u32) -> Self {
        Self {
            name: "window",
            width,
            height,
            ratio: 1,
            dark: true,
            still: true,
        }
    }

    /// The same screen of a user who wants animations.
    pub const fn moving(self) -> Self {
        Self {
            still: false,
            ..self
        }
    }

    pub const fn is_dark(&self) -> bool {
        self.dark
    }

    /// The same screen with the light colour scheme.
    pub const fn light(self) -> Self {
        Self {
            dark: false,
            ..self
        }
    }
}

/// The command of `chromedriver` that takes the network from a browser.
#[derive(Debug)]
struct Offline(bool);

impl WebDriverCompatibleCommand for Offline {
    fn endpoint(&self, driver: &Url, session: Option<&str>) -> Result<Url, url::ParseError> {
        let session = session.unwrap();
        driver.join(&format!("session/{session}/chromium/network_conditions"))
    }

    fn method_and_body(&self, _: &Url) -> (Method, Option<String>) {
        let conditions = json!({ "offline": self.0, "latency": 0, "throughput": 0 });
        let body = json!({ "network_conditions": conditions });
        (Method::POST, Some(body.to_string()))
    }
}

/// A `chromedriver` that ends when dropped.
pub struct Driver {
    process: Child,
    url: String,
}

impl Driver {
    pub fn start() -> Self {
        // `--port=0` chooses a port that is free in IPv6 and ends when IPv4 has it in use, as by a
        // connection of another test.
        std::iter::repeat_with(Self::started)
            .flatten()
            .next()
            .unwrap()
    }

    /// `None`: the chosen port is in use.
    fn started() -> Option<Self> {
        // The browser draws by software with all processors: the simulated devices go first.
        let mut process = Command::new("nice")
            .args(["-n", "10", "chromedriver", "--port=0"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromedriver, of the Debian package chromium-driver");
        let mut printed = BufReader::new(process.stdout.take().unwrap())
            .lines()
            .map(Result::unwrap);
        let result = printed
            .find(|line| line.contains("started successfully") || line.contains("Exiting"))
            .expect("chromedriver reports its port");
        let Some((_, port)) = result.split_once("started successfully on port ") else {
            assert!(result.contains("port not available"), "{result}");
            process.wait().unwrap();
            return None;
        };
        let url = format!("http://127.0.0.1:{}", port.trim_end_matches('.'));
        // A process that writes into an unread pipe blocks.
        std::thread::spawn(move || printed.for_each(drop));
        Some(Self { process, url })
    }

    /// Runs a test in its own window and closes the window even if the test panics.
    pub fn test<F: Future<Output = ()>>(&self, screen: Screen, act: impl FnOnce(Page) -> F) {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap();
        runtime.block_on(async {
            let page = self.open(screen).await;
            let client = page.client.clone();
            // A panic drops the future; the browser's process ends with its driver.
            act(page).await;
            client.close().await.unwrap();
        });
    }

    async fn open(&self, screen: Screen) -> Page {
        let arguments = [
            "--headless=new".to_owned(),
            "--no-sandbox".to_owned(),
            "--disable-dev-shm-usage".to_owned(),
            "--hide-scrollbars".to_owned(),
            "--use-angle=swiftshader".to_owned(),
            "--enable-unsafe-swiftshader".to_owned(),
            "--disable-background-networking".to_owned(),
            format!("--window-size={},{}", screen.width, screen.height),
            format!(
                "--blink-settings=preferredColorScheme={}",
                if screen.dark { 0 } else { 1 }
            ),
        ];
        let still = screen
            .still
            .then(|| "--force-prefers-reduced-motion".to_owned());
        let arguments: Vec<String> = arguments.into_iter().chain(still).collect();
        let phone = screen.width < 600;
        let mut options = json!({ "args": arguments });
        options["mobileEmulation"] = json!({ "deviceMetrics": {
                "width": screen.width, "height": screen.height, "pixelRatio": screen.ratio, "touch": phone, "mobile": phone,
        }});
        let capabilities = json!({
            "browserName": "chrome",
            "goog:chromeOptions": options,
            "goog:loggingPrefs": { "browser": "ALL" },
        });
        let mut builder = ClientBuilder::new(HttpConnector::new());
        builder.capabilities(capabilities.as_object().unwrap().clone());
        let client = builder.connect(&self.url).await.unwrap();
        Page { client, screen }
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        // The driver ends its browsers if it is asked to, and leaves them if it is killed.
        if let Ok(mut stream) = TcpStream::connect(self.url.trim_start_matches("http://")) {
            let _ = stream.set_read_timeout(Some(Duration::from_secs(10)));
            let _ = stream.write_all(b"GET /shutdown HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
            let _ = stream.read(&mut [0]);
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A window.
pub struct Page {
    client: Client,
    screen: Screen,
}

impl Page {
    /// Opens the URL.
    pub async fn goto(&self, url: &str) {
        self.client.goto(url).await.unwrap();
    }

    /// Result of a function body that runs in the page.
    pub async fn run(&self, script: &str) -> Value {
        self.client.execute(script, vec![]).await.unwrap()
    }

    /// What a function body passes to its last argument, a function.
    pub async fn answer(&self, script: &str) -> Value {
        self.client.execute_async(script, vec![]).await.unwrap()
    }

    /// An answer of the daemon's API to a request by the page.
    pub async fn api(&self, path: &str) -> Value {
        let script = "const done = arguments[1];
            fetch('/api/v1/' + arguments[0]).then((answer) => answer.json()).then(done, (error) => done(String(error)));";
        self.client
            .execute_async(script, vec![json!(path)])
            .await
            .unwrap()
    }

    /// Text of the first matching element, or an empty string.
    pub async fn text(&self, css: &str) -> String {
        let script = "const at = document.querySelector(arguments[0]); return at && at.checkVisibility() ? at.innerText : '';";
        let text = self.client.execute(script, vec![json!(css)]).await.unwrap();
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Waits until the text fits, and returns it.
    pub async fn until(&self, css: &str, what: &str, fits: impl Fn(&str) -> bool) -> String {
        let begin = Instant::now();
        loop {
            let text = self.text(css).await;
            if fits(&text) {
                return text;
            }
            if begin.elapsed() > TIME_LIMIT {
                let place = self.picture("failed").await;
                eprintln!(
                    "messages: {}",
                    self.run("return document.querySelector('#messages')?.innerText")
                        .await
                );
                panic!("{css} is {text:?}, not {what}; {}", place.display());
            }
            tokio::time::sleep(LOOK_AGAIN).await;
        }
    }

    /// Waits until the text contains `part`.
    pub async fn until_has(&self, css: &str, part: &str) -> String {
        self.until(css, part, |text| text.contains(part)).await
    }

    /// Waits until no such element is visible, or it is empty.
    pub async fn until_gone(&self, css: &str) {
        self.until(css, "gone", str::is_empty).await;
    }

    /// Waits until an expression is true in the page.
    pub async fn until_true(&self, expression: &str) {
        let begin = Instant::now();
        while self.run(&format!("return Boolean({expression})")).await != true {
            assert!(begin.elapsed() < TIME_LIMIT, "never true: {expression}");
            tokio::time::sleep(LOOK_AGAIN).await;
        }
    }

    /// Waits until the shown cloud is complete.
    pub async fn until_loaded(&self) {
        self.until_true("document.querySelector('#view-progress').hidden && document.querySelector('#view-note').textContent === ''")
            .await;
    }

    /// The pixels in the picture of an element, which is scrolled into sight: a part of it would be
    /// compared with another part.
    pub async fn pixels_of(&self, css: &str) -> Vec<[u8; 3]> {
        let scroll = "document.querySelector(arguments[0]).scrollIntoView({ block: 'center', behavior: 'instant' })";
        self.client.execute(scroll, vec![json!(css)]).await.unwrap();
        let element = self.client.find(Locator::Css(css)).await.unwrap();
        let picture = element.screenshot().await.unwrap();
        let mut reader = png::Decoder::new(Cursor::new(picture)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let pixels = bytes.chunks(info.color_type.samples());
        pixels
            .filter_map(|pixel| pixel.first_chunk().copied())
            .collect()
    }

    /// Waits until the pixels of an element are as they should be: a page shows a new text before a
    /// new picture.
    pub async fn until_pixels(&self, css: &str, what: &str, good: impl Fn(&[[u8; 3]]) -> bool) {
        let begin = Instant::now();
        while !good(&self.pixels_of(css).await) {
            if begin.elapsed() > TIME_LIMIT {
                let place = self.picture("failed").await;
                panic!("{css} never has {what}; {}", place.display());
            }
        }
    }

    /// Waits until a thirtieth of the pixels of an element differ from an earlier picture of it: on
    /// a phone a cloud covers a fourteenth.
    pub async fn until_changed(&self, css: &str, before: &[[u8; 3]]) {
        self.until_pixels(css, "another picture", |now| {
            let changed = now.iter().zip(before).filter(|(a, b)| a != b).count();
            changed * 30 > now.len()
        })
        .await;
    }

    /// Clicks an element, or touches it with a finger on a phone, once it rests where that reaches
    /// it: a picture that loads moves the elements below it.
    pub async fn click(&self, css: &str) {
        // The driver scrolls only to the edge, where the buttons may be.
        let script = "const [css, done] = arguments;
            let last = null;
            const look = () => {
                const element = document.querySelector(css);
                if (element === null) return void requestAnimationFrame(look);
                element.scrollIntoView({ block: 'center' });
                const { x, y, width, height } = element.getBoundingClientRect();
                const place = [x + width / 2, y + height / 2];
                const rests = last !== null && place.every((value, index) => value === last[index]);
                last = place;
                if (rests && element.contains(document.elementFromPoint(...place))) done();
                else requestAnimationFrame(look);
            };
            look();";
        self.client
            .execute_async(script, vec![json!(css)])
            .await
            .unwrap_or_else(|error| panic!("{css}: {error}"));
        self.touch(css).await;
    }

    /// Touches a place of the window, in pixels, with a finger on a phone and else the mouse.
    pub async fn tap(&self, x: f64, y: f64) {
        let to = PointerAction::MoveTo {
            duration: None,
            x,
            y,
        };
        let button = MOUSE_BUTTON_LEFT;
        let (down, up) = (PointerAction::Down { button }, PointerAction::Up { button });
        let tapped = match self.is_phone() {
            true => {
                let finger = TouchActions::new("finger".to_owned());
                let finger = finger.then(to).then(down).then(up);
                self.client.perform_actions(finger).await
            }
            false => {
                let mouse = MouseActions::new("mouse".to_owned());
                let mouse = mouse.then(to).then(down).then(up);
                self.client.perform_actions(mouse).await
            }
        };
        tapped.unwrap();
    }

    /// Drags from one place of the window to another with the mouse or a finger, with a key down.
    pub async fn drag(&self, [from, to]: [[f64; 2]; 2], key: Option<char>) {
        let button = MOUSE_BUTTON_LEFT;
        let place = |[x, y]: [f64; 2]| PointerAction::MoveTo {
            duration: None,
            x,
            y,
        };
        let half = [0, 1].map(|axis| f64::midpoint(from[axis], to[axis]));
        let (down, up) = (PointerAction::Down { button }, PointerAction::Up { button });
        let way = [place(from), down, place(half), place(to), up];
        if let Some(value) = key {
            self.hold(KeyAction::Down { value }).await;
        }
        let dragged = match self.is_phone() {
            true => {
                let finger = TouchActions::new("finger".to_owned());
                let finger = way.into_iter().fold(finger, InputSource::then);
                self.client.perform_actions(finger).await
            }
            false => {
                let mouse = MouseActions::new("mouse".to_owned());
                let mouse = way.into_iter().fold(mouse, InputSource::then);
                self.client.perform_actions(mouse).await
            }
        };
        dragged.unwrap();
        if let Some(value) = key {
            self.hold(KeyAction::Up { value }).await;
        }
    }

    async fn hold(&self, action: KeyAction) {
        let keyboard = KeyActions::new("keyboard".to_owned()).then(action);
        self.client.perform_actions(keyboard).await.unwrap();
    }

    /// Touches the middle of an element with a finger on a phone, and clicks it elsewhere.
    pub async fn touch(&self, css: &str) {
        let script = format!(
            "const {{ x, y, width, height }} = document.querySelector({css:?}).getBoundingClientRect();
            return [x + width / 2, y + height / 2]"
        );
        let middle = self.run(&script).await;
        let [x, y] = [0, 1].map(|i| middle[i].as_f64().unwrap().round());
        self.tap(x, y).await;
    }

    /// Takes the network from the browser, or gives it back.
    pub async fn set_offline(&self, offline: bool) {
        self.client.issue_cmd(Offline(offline)).await.unwrap();
    }

    /// Two fingers left and right of a place move apart, from one distance to another.
    pub async fn pinch(&self, [x, y]: [f64; 2], [from, to]: [f64; 2]) {
        let finger = |name: &str, side: f64| {
            let place = |apart: f64| PointerAction::MoveTo {
                duration: None,
                x: x + side * apart / 2.0,
                y,
            };
            let button = MOUSE_BUTTON_LEFT;
            TouchActions::new(name.to_owned())
                .then(place(from))
                .then(PointerAction::Down { button })
                .then(place(f64::midpoint(from, to)))
                .then(place(to))
                .then(PointerAction::Up { button })
        };
        let both = Actions::from(finger("left", -1.0)).and(finger("right", 1.0));
        self.client.perform_actions(both).await.unwrap();
    }

    /// Turns the wheel over a place, in pixels.
    pub async fn wheel(&self, [x, y]: [f64; 2], down: i64) {
        #[expect(clippy::cast_possible_truncation, reason = "a place in a window")]
        let (x, y) = (x as i64, y as i64);
        let mut wheel = WheelActions::new("wheel".to_owned());
        wheel.push(WheelAction::Scroll {
            duration: None,
            x,
            y,
            delta_x: 0,
            delta_y: down,
        });
        self.client.perform_actions(wheel).await.unwrap();
    }

    /// Whether the window is a phone's.
    pub const fn is_phone(&self) -> bool {
        self.screen.width < 600
    }

    /// Types into a field and replaces its text.
    pub async fn fill(&self, css: &str, text: &str) {
        let begin = Instant::now();
        // A page that is being replaced removes its fields.
        let element = loop {
            let element = self.client.find(Locator::Css(css)).await.unwrap();
            match element.clear().await {
                Ok(()) => break element,
                Err(error) => assert!(begin.elapsed() < TIME_LIMIT, "{css}: {error}"),
            }
        };
        element.send_keys(text).await.unwrap();
    }

    /// Presses keys with the current focus.
    pub async fn keys(&self, keys: &str) {
        let element = self.client.active_element().await.unwrap();
        element.send_keys(keys).await.unwrap();
    }

    /// Presses a key as a keyboard does, also where the driver would set a value instead.
    pub async fn press(&self, key: char) {
        let keyboard = KeyActions::new("keyboard".to_owned());
        let value = key;
        let pressed = keyboard
            .then(KeyAction::Down { value })
            .then(KeyAction::Up { value });
        self.client.perform_actions(pressed).await.unwrap();
    }

    /// Sets a list to a value.
    pub async fn choose(&self, css: &str, value: &str) {
        let element = self.client.find(Locator::Css(css)).await.unwrap();
        element.select_by_value(value).await.unwrap();
        // WebDriver fires the input event before it changes the value; a user's comes after it.
        let input = "document.querySelector(arguments[0]).dispatchEvent(new Event('input', { bubbles: true }))";
        self.client.execute(input, vec![json!(css)]).await.unwrap();
    }

    /// Downloads the first scan in a format.
    pub async fn download(&self, format: &str) {
        self.click(".scan [data-role=download]").await;
        self.click(&format!("#download [value='{format}']")).await;
    }

    /// Deletes the cookies, as if they had expired.
    pub async fn forget_cookies(&self) {
        self.client.delete_all_cookies().await.unwrap();
    }

    /// Fails if axe or `audit.js` reports a problem.
    pub async fn audit(&self, what: &str) {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../crates/daemon/web/node_modules/axe-core/axe.min.js"
        );
        let axe = std::fs::read_to_string(path)
            .unwrap_or_else(|error| panic!("{path}: {error}; run crates/daemon/web/build"));
        if self.run("return 'axe' in window").await == false {
            self.run(&axe).await;
        }
        let script = "const [done] = arguments;
            const said = ({ id, nodes }) => nodes.map((node) => `${id}: ${node.target} ${node.failureSummary}`);
            axe.run({ resultTypes: ['violations'] }).then(
                ({ violations }) => done(violations.flatMap(said)),
                (error) => done([String(error)]),
            );";
        let found = self.client.execute_async(script, Vec::new()).await.unwrap();
        assert_eq!(found, json!([]), "axe, {what} on {:?}", self.screen);
        let complaints = self.run(include_str!("audit.js")).await;
        assert_eq!(complaints, json!([]), "{what} on {:?}", self.screen);
    }

    /// Software rendering may exceed the driver's own time limit.
    async fn screenshot(&self) -> Vec<u8> {
        let begin = Instant::now();
        loop {
            match self.client.screenshot().await {
                Ok(picture) => return picture,
                Err(error) => assert!(begin.elapsed() < TIME_LIMIT, "{error}"),
            }
        }
    }

    /// Saves a picture of the window in the folder `VELOMOTION_SCREENSHOTS` or a temporary one.
    pub async fn picture(&self, name: &str) -> PathBuf {
        let folder = std::env::var_os("VELOMOTION_SCREENSHOTS").map_or_else(
            || std::env::temp_dir().join("velomotion-screenshots"),
            PathBuf::from,
        );
        std::fs::create_dir_all(&folder).unwrap();
        let theme = if self.screen.dark { "dark" } else { "light" };
        let path = folder.join(format!("{}-{theme}-{name}.png", self.screen.name));
        std::fs::write(&path, self.screenshot().await).unwrap();
        path
    }
}
