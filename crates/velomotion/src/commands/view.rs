//! `velomotion view`: clouds, logs and recordings in the browser.

mod served_cloud;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use cloud::formats::Format;
use daemon::http::view::{FileState, ViewServer, ViewedFile, ViewedFiles};
use engine::document::Document;
use engine::failure::{Failure, Kind};
use engine::reconstruct::source::Source;

use super::CommandOutput;
use super::analyze::input::{InputArgument, companion_path};
use crate::cli::{self, Common};
use crate::documents::ServedView;
use crate::logging;
use crate::signals;
use crate::terminal::{Progress, to_stderr};
use served_cloud::{cloud, log};

/// Between two polls of signals and pages.
const POLL: Duration = Duration::from_millis(100);

/// Runs the command.
///
/// # Errors
/// [`Failure`] if no file can be shown.
pub fn run(arguments: &cli::ViewArguments, common: &Common) -> Result<CommandOutput, Failure> {
    let interrupt = signals::interrupt_flag()?;
    let mut is_served = false;
    let shown = show(&arguments.files, common, &interrupt, |url| {
        is_served = true;
        greet(url, arguments, common);
        if !arguments.no_open {
            open_browser(url);
        }
    });
    match shown {
        // The address was the one object of --json.
        Err(failure) if is_served => Ok(CommandOutput {
            failure: Some(failure),
            ..CommandOutput::default()
        }),
        shown => shown.map(|()| CommandOutput::default()),
    }
}

/// Serves the files until `interrupt`, or until their last page is closed. `served` gets the
/// address.
///
/// # Errors
/// [`Failure`] of a file that cannot be shown; of several files those are printed at once.
pub fn show(
    paths: &[PathBuf],
    common: &Common,
    interrupt: &AtomicBool,
    served: impl FnOnce(&str),
) -> Result<(), Failure> {
    let mut inputs: Vec<ViewInput<'_>> = paths.iter().map(|path| ViewInput::open(path)).collect();
    // `velomotion view *` names the texts beside clouds, too.
    let beside: Vec<PathBuf> = inputs
        .iter()
        .filter_map(ViewInput::companion_path)
        .collect();
    inputs.retain(|input| !beside.iter().any(|text| text == input.path()));
    // With nothing to show there is no page.
    let is_failed = |input: &ViewInput<'_>| matches!(input, ViewInput::Failed(..));
    if let Some(ViewInput::Failed(_, failure)) = inputs.first()
        && inputs.iter().all(is_failed)
    {
        return Err(failure.clone());
    }
    let server = ViewServer::start(inputs.iter().map(ViewInput::listed).collect())?;
    served(&server.url());
    let files = Arc::clone(&server.files);
    let failures = std::thread::scope(|scope| {
        let making = scope.spawn(|| make_all(&inputs, &files, common, interrupt));
        // Without a cloud and without a page nothing is left to do.
        while !interrupt.load(Ordering::Acquire)
            && !files.is_left()
            && (files.is_open() || !making.is_finished() || files.has_cloud())
        {
            std::thread::sleep(POLL);
        }
        interrupt.store(true, Ordering::Release);
        // No device is open: a second signal need not wait until a large file is read.
        signals::end_process_on_signal();
        making.join()
    });
    server.stop();
    let failures = failures.map_err(|_| {
        Failure::new(Kind::Incomplete, "a thread of the command had panicked")
            .help("run it with -vv and report the messages")
    })?;
    let Some(first) = failures.first() else {
        return Ok(());
    };
    if inputs.len() == 1 {
        return Err(first.clone());
    }
    let what = format!("{} of {} files are not shown", failures.len(), inputs.len());
    Err(Failure::new(first.kind, what).help("the messages above say why"))
}

/// A file, classified by its name.
enum ViewInput<'a> {
    Cloud(&'a Path, Format),
    Log(Arc<Source>),
    Failed(&'a Path, Failure),
}

impl<'a> ViewInput<'a> {
    /// The failure of a file that is none is for the list.
    fn open(path: &'a Path) -> Self {
        Self::opened(path).unwrap_or_else(|failure| Self::Failed(path, failure))
    }

    fn opened(path: &'a Path) -> Result<Self, Failure> {
        let name = path.to_string_lossy();
        if name != "-" && !path.exists() {
            let what = format!("{name}: there is no such file");
            return Err(Failure::new(Kind::BadInput, what).help("check the name"));
        }
        Ok(match InputArgument::new(&name)? {
            InputArgument::Cloud(_, format) => Self::Cloud(path, format),
            // A file may have the name of a pattern.
            InputArgument::Log(_) | InputArgument::Pattern(_) => {
                Self::Log(Arc::new(Source::open(path, None)?))
            }
        })
    }

    fn path(&self) -> &Path {
        match self {
            Self::Cloud(path, _) | Self::Failed(path, _) => path,
            Self::Log(source) => source.path(),
        }
    }

    fn companion_path(&self) -> Option<PathBuf> {
        match self {
            Self::Cloud(path, format) => companion_path(path, *format),
            Self::Log(_) | Self::Failed(..) => None,
        }
    }

    fn listed(&self) -> ViewedFile {
        let path = self.path();
        let name = path.file_name().unwrap_or(path.as_os_str());
        let source = match self {
            Self::Log(source) => Some(Arc::clone(source)),
            Self::Cloud(..) | Self::Failed(..) => None,
        };
        ViewedFile::new(name.to_string_lossy().into_owned(), source)
    }
}

/// Prints the address.
fn greet(url: &str, arguments: &cli::ViewArguments, common: &Common) {
    if common.json {
        let report = ServedView {
            url: url.to_owned(),
            files: arguments.files.clone(),
        };
        let mut out = std::io::stdout().lock();
        // A closed pipe is not a failure.
        let _ = writeln!(out, "{}", report.to_json()).and_then(|()| out.flush());
        return;
    }
    // The address is the result: --quiet keeps it.
    to_stderr(&format!(
        "{url} (only from this machine; ends with its tab or Ctrl-C)"
    ));
}

/// Opens the user's browser, if there is a screen for one.
fn open_browser(url: &str) {
    let (program, arguments): (_, &[&str]) = if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else if cfg!(target_os = "macos") {
        ("open", &[])
    } else {
        ("xdg-open", &[])
    };
    let is_set = |name: &&str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if program == "xdg-open" && !["DISPLAY", "WAYLAND_DISPLAY"].iter().any(is_set) {
        return;
    }
    let opener = Command::new(program)
        .args(arguments)
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    match opener {
        Ok(mut opener) => drop(std::thread::spawn(move || opener.wait())),
        Err(error) => tracing::info!("no browser opened: {program}: {error}"),
    }
}

/// Makes every cloud and returns the failures.
fn make_all(
    inputs: &[ViewInput<'_>],
    files: &ViewedFiles,
    common: &Common,
    interrupt: &AtomicBool,
) -> Vec<Failure> {
    let progress = Progress::new(common);
    let mut failures = Vec::new();
    for (index, input) in inputs.iter().enumerate() {
        let made = match input {
            ViewInput::Cloud(path, format) => cloud(path, *format),
            ViewInput::Failed(_, failure) => Err(failure.clone()),
            ViewInput::Log(source) => {
                progress.say(&format!("making the cloud of {}", input.path().display()));
                let share = |share| files.update(index, |file| file.share = Some(share));
                log(source, &share, interrupt)
            }
        };
        match made {
            Ok(made) => {
                if made.simulated {
                    let name = input.path().display();
                    progress.say(&format!("SIMULATED: {name} is not of a real scan"));
                }
                if let Some(missing) = &made.missing {
                    let name = input.path().display();
                    tracing::warn!("{name}: {}", missing.message);
                }
                files.update(index, |file| {
                    file.state = FileState::Ready;
                    file.points = Some(made.points);
                    if let Some(missing) = &made.missing {
                        file.error = Some(missing.message.clone());
                        file.help.clone_from(&missing.help);
                    }
                    file.simulated = made.simulated;
                    file.scanner = made.scanner;
                    file.report = made.report;
                    file.cloud = Some(Arc::new(made.file));
                });
            }
            Err(failure) if failure.kind == Kind::Interrupted => break,
            Err(failure) => {
                files.update(index, |file| {
                    file.state = FileState::Failed;
                    file.error = Some(failure.message.clone());
                    file.help.clone_from(&failure.help);
                });
                // That of one file is the command's own.
                if inputs.len() > 1 {
                    logging::failed(&failure);
                }
                failures.push(failure);
            }
        }
    }
    failures
}
