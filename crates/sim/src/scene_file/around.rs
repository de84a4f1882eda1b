//! `scene`, `[materials]` and `[[objects]]`: what stands around the scanner.

use std::sync::Arc;

use super::{File, SHIPPED, SceneError, line_of};
use crate::scene::Scene;
use crate::scenery::{Scenery, SceneryError, Sections, shipped};

type Files<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// What can be cast at. Objects of a scenery that move are refused: the simulation moves what `[effects.moving_objects]` names, and an object
/// that stood still for all that would look right.
pub(super) fn build(
    text: &str,
    file: File,
    seed: u64,
    files: Files<'_>,
) -> Result<Arc<Scene>, SceneError> {
    let own = Sections {
        materials: file.materials,
        objects: file.objects,
    };
    let said = |error: SceneryError| SceneError {
        line: error.at().line,
        what: error.what(),
    };
    let (line, scenery) = match file.scene {
        None if own.objects.is_empty() => return Ok(Arc::default()),
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
    if let Some(moving) = placed.moving.first() {
        return Err(SceneError {
            line: moving.at.line,
            what: "expected an object that stands, got one that moves; boxes that move go into [effects.moving_objects]"
                .to_owned(),
        });
    }
    let scene = Scene::of(placed).map_err(|error| SceneError {
        line,
        what: error.to_string(),
    })?;
    Ok(Arc::new(scene))
}
