//! `scene`, `[materials]` and `[[objects]]`: what stands around the scanner.

use std::sync::Arc;

use super::{File, SHIPPED, SceneError, line_of};
use crate::effects::Mover;
use crate::scene::Scene;
use crate::scenery::{Scenery, SceneryError, Sections, shipped};

type Files<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// What stands around the scanner, and what of it moves.
#[derive(Debug, Default)]
pub(super) struct Around {
    pub scene: Arc<Scene>,
    pub movers: Vec<Mover>,
    /// The line that asks for the first of them.
    pub line: Option<usize>,
}

/// What can be cast at.
pub(super) fn build(
    text: &str,
    file: File,
    seed: u64,
    files: Files<'_>,
) -> Result<Around, SceneError> {
    let own = Sections {
        materials: file.materials,
        objects: file.objects,
    };
    let said = |error: SceneryError| SceneError {
        line: error.at().line,
        what: error.what(),
    };
    let (line, scenery) = match file.scene {
        None if own.objects.is_empty() => return Ok(Around::default()),
        None => (1, Scenery::new(text, own)),
        Some(name) => {
            let line = line_of(text, name.span().start);
            let wrong = |what: String| SceneError { line, what };
            if !own.objects.is_empty() {
                let what = "expected either a scene or objects of the file itself, got both";
                return Err(wrong(what.to_owned()));
            }
            let Some(text) = shipped(name.get_ref()) else {
                let known = SHIPPED.map(|(name, _)| name).join(", ");
                let name = name.get_ref();
                return Err(wrong(format!(
                    "expected a scene that is known ({known}), got {name:?}"
                )));
            };
            (line, Scenery::parse(text))
        }
    };
    let placed = scenery
        .and_then(|scenery| scenery.place(seed, files))
        .map_err(said)?;
    let wrong = |line: usize, what: String| SceneError { line, what };
    let (stands, moves) = (placed.divided()).map_err(|error| wrong(line, error.to_string()))?;
    let scene = Scene::of(stands).map_err(|error| wrong(line, error.to_string()))?;
    let mut around = Around {
        scene: Arc::new(scene),
        line: moves.first().map(|(moving, _)| moving.at.line),
        ..Around::default()
    };
    for (moving, body) in moves {
        let scene = Scene::of(body).map_err(|error| wrong(moving.at.line, error.to_string()))?;
        around.movers.push(Mover {
            scene: Arc::new(scene),
            travel: moving.travel,
        });
    }
    Ok(around)
}
