//! `scene`, `[materials]` and `[[objects]]`: what surrounds the scanner.

use std::sync::Arc;

use super::demands::MoverName;
use super::{SHIPPED, SceneFileError, Sections};
use crate::effect_models::Mover;
use crate::scene::Scene;
use crate::scenery::{Scenery, SceneryError, ScenerySections, line_of_value, shipped};

type Files<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// The static scene and the moving objects.
#[derive(Debug, Default)]
pub(super) struct SceneObjects {
    pub scene: Arc<Scene>,
    pub movers: Vec<Mover>,
    /// Their names and lines.
    pub names: Vec<MoverName>,
}

pub(super) fn build(
    text: &str,
    file: Sections,
    seed: u64,
    files: Files<'_>,
) -> Result<SceneObjects, SceneFileError> {
    let error = |line: usize, what: String| SceneFileError { line, what };
    let own = ScenerySections {
        materials: file.materials,
        objects: file.objects,
    };
    let (line, scenery) = match file.scene {
        None if own.objects.is_empty() => return Ok(SceneObjects::default()),
        None => (1, Scenery::new(text, own)),
        Some(name) => {
            let line = line_of_value(text, "scene");
            if !own.objects.is_empty() {
                let what = "expected either a scene or objects of the file itself, got both";
                return Err(error(line, what.to_owned()));
            }
            let Some(text) = shipped(&name) else {
                let known = SHIPPED.map(|(name, _)| name).join(", ");
                let what = format!("expected a known scene ({known}), got {name:?}");
                return Err(error(line, what));
            };
            (line, Scenery::parse(text))
        }
    };
    let invalid = |invalid: SceneryError| {
        let reason = invalid.source.map(|source| format!(": {source}"));
        let what = invalid.what + &reason.unwrap_or_default();
        error(invalid.at.line, what)
    };
    let scenery = scenery.map_err(invalid)?;
    let placed = scenery.place(seed, files).map_err(invalid)?;
    let (fixed, moving) = (placed.divided()).map_err(|invalid| error(line, invalid.to_string()))?;
    let scene = Scene::of(fixed).map_err(|invalid| error(line, invalid.to_string()))?;
    let mut objects = SceneObjects {
        scene: Arc::new(scene),
        ..SceneObjects::default()
    };
    for (moving, body) in moving {
        let scene = Scene::of(body);
        let scene = scene.map_err(|invalid| error(moving.at.line, invalid.to_string()))?;
        let table = scenery.objects.iter().find(|(at, _)| *at == moving.at);
        let name = table.map_or_else(String::new, |(_, table)| table.name.clone());
        objects.names.push((name, moving.at.line));
        objects.movers.push(Mover {
            scene: Arc::new(scene),
            travel: moving.travel,
        });
    }
    Ok(objects)
}
