//! The API in OpenAPI 3.1, described by the functions that answer it.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use axum::http::header;
use axum::response::{IntoResponse, Response};
use cloud::formats::Format;
use engine::document::{self, Document, ErrorReport};
use engine::failure::{Failure, Kind};
use engine::service::events::Event;
use serde_json::Value;
use utoipa::openapi::header::HeaderBuilder;
use utoipa::openapi::path::PathItem;
use utoipa::openapi::response::{Response as Answer, ResponseBuilder};
use utoipa::openapi::schema::{Object, ObjectBuilder, Type};
use utoipa::openapi::security::{
    ApiKey, ApiKeyValue, HttpAuthScheme, HttpBuilder, SecurityRequirement, SecurityScheme,
};
use utoipa::openapi::{ContentBuilder, OpenApi, Ref, RefOr, Schema};
use utoipa::{IntoResponses, Modify, OpenApi as _, ToResponse};

use super::{captures, download, events, metrics, page, scans, statistics, tilt};

/// Refusals, each with the meaning of its status.
macro_rules! refusals {
    ($($name:ident: $meaning:literal, such as $kind:ident: $example:literal;)*) => {
        $(
            #[doc = $meaning]
            pub struct $name;

            impl<'r> ToResponse<'r> for $name {
                fn response() -> (&'r str, RefOr<Answer>) {
                    (stringify!($name), refusal($meaning, Kind::$kind, $example).into())
                }
            }
        )*
    };
}

refusals! {
    Usage: "Invalid request", such as Usage: "speed_deg_s: expected a number above 0, got -5";
    Denied: "Missing or wrong token, or a request of another site's page",
        such as Denied: "the token is missing or wrong";
    NotFound: "Not found", such as NotFound: "there is no scan \"hall-1\"";
    NotNow: "Not possible now: busy, a device is absent or in fault, or the disk is nearly full",
        such as Busy: "the axis is busy: it is homing";
    Limit: "Too large, too many, or too slow", such as Limit: "too many downloads at once";
}

fn refusal(meaning: &str, kind: Kind, example: &str) -> Answer {
    let body = RefOr::<Schema>::Ref(Ref::from_schema_name("ErrorReport"));
    let failure = Failure::new(kind, example).help("what to do next");
    let example = ErrorReport { error: failure }.to_json();
    let content = ContentBuilder::new()
        .schema(Some(body))
        .example(Some(example));
    let answer = ResponseBuilder::new()
        .description(meaning)
        .content("application/json", content.build());
    match kind {
        Kind::Busy | Kind::Limit => answer.header(
            "Retry-After",
            HeaderBuilder::new()
                .schema(Some(Object::with_type(Type::Integer)))
                .description(Some("Seconds until another try may succeed, where known"))
                .build(),
        ),
        _ => answer,
    }
    .build()
}

/// Responses of a request for a file that is stored.
pub struct StoredFile;

impl IntoResponses for StoredFile {
    fn responses() -> BTreeMap<String, RefOr<Answer>> {
        stored("application/octet-stream")
    }
}

/// Responses of a request for a picture that is stored.
pub struct StoredPicture;

impl IntoResponses for StoredPicture {
    fn responses() -> BTreeMap<String, RefOr<Answer>> {
        stored("image/png")
    }
}

fn stored(content: &str) -> BTreeMap<String, RefOr<Answer>> {
    let text = || HeaderBuilder::new().schema(Some(Object::with_type(Type::String)));
    let tag = || text().description(Some("Version of the file")).build();
    let part = text().description(Some("Which part of how many bytes (RFC 9110)"));
    let named = |name: &str| RefOr::Ref(Ref::from_response_name(name));
    let file = |meaning: &str| {
        ResponseBuilder::new()
            .description(meaning)
            .content(
                content,
                ContentBuilder::new().schema(None::<Schema>).build(),
            )
            .header("ETag", tag())
    };
    let unchanged = ResponseBuilder::new().description("Not modified");
    let all = [
        ("200", file("The file").build().into()),
        (
            "206",
            file("The requested part")
                .header("Content-Range", part.build())
                .build()
                .into(),
        ),
        ("304", unchanged.header("ETag", tag()).build().into()),
        ("404", named("NotFound")),
        ("416", named("Usage")),
        ("429", named("Limit")),
    ];
    all.map(|(status, answer)| (status.to_owned(), answer))
        .into()
}

/// Extensions of the formats of clouds.
pub fn formats() -> Schema {
    let names = Format::single_files().map(Format::extension);
    ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some(names))
        .build()
        .into()
}

#[derive(utoipa::OpenApi)]
#[openapi(
    info(
        title = "velomotion daemon",
        version = "1",
        description = "A lidar on a tilting platform: captures, scans, motions of the axis. Objects may get new keys. No content of a request causes a 5xx status except 507."
    ),
    paths(
        super::api::status,
        super::api::health,
        page::page,
        page::signed_in,
        page::login,
        page::logout,
        description,
        metrics::metrics,
        captures::plan,
        captures::begin,
        captures::stop,
        tilt::status,
        tilt::home,
        tilt::goto,
        tilt::stop,
        tilt::clear,
        scans::list,
        scans::one,
        scans::edit,
        scans::delete,
        scans::restore,
        statistics::measure,
        download::cloud,
        download::log,
        download::thumbnail,
        events::events,
    ),
    components(schemas(ErrorReport, Event), responses(Usage, Denied, NotFound, NotNow, Limit)),
    modifiers(&SharedParts)
)]
struct Description;

/// Parts shared by all requests: their refusals, and the identification of a client.
struct SharedParts;

/// Responses of every request.
const EVERY: [(&str, &str); 6] = [
    ("403", "Denied"),
    ("408", "Limit"),
    ("413", "Limit"),
    ("414", "Limit"),
    ("429", "Limit"),
    ("431", "Limit"),
];
/// Responses of every request that needs a token.
const GUARDED: [(&str, &str); 2] = [("400", "Usage"), ("401", "Denied")];

impl Modify for SharedParts {
    fn modify(&self, api: &mut OpenApi) {
        for (path, item) in &mut api.paths.paths {
            let guarded = GUARDED.iter().filter(|_| !page::is_open(path));
            let responses: Vec<_> = EVERY.iter().chain(guarded).collect();
            let PathItem {
                get,
                post,
                patch,
                delete,
                ..
            } = item;
            for operation in [get, post, patch, delete].into_iter().flatten() {
                for (status, name) in &responses {
                    let answer = RefOr::Ref(Ref::from_response_name(*name));
                    let known = &mut operation.responses.responses;
                    known.entry((*status).to_owned()).or_insert(answer);
                }
            }
        }
        let components = api.components.get_or_insert_default();
        let bearer = HttpBuilder::new().scheme(HttpAuthScheme::Bearer).build();
        components.add_security_scheme("token", SecurityScheme::Http(bearer));
        let cookie = ApiKey::Cookie(ApiKeyValue::new("velomotion"));
        components.add_security_scheme("cookie", SecurityScheme::ApiKey(cookie));
        let none = SecurityRequirement::default();
        let named = |name: &str| SecurityRequirement::new::<_, [&str; 0], &str>(name, []);
        api.security = Some(vec![none, named("token"), named("cookie")]);
    }
}

/// Objects that clients send: the daemon refuses unknown keys. Those of its answers may get new
/// ones.
const REQUESTS: [&str; 4] = ["CaptureRequest", "GotoRequest", "Login", "ScanEdit"];

static JSON: LazyLock<String> = LazyLock::new(|| {
    let mut api = serde_json::to_value(Description::openapi()).unwrap_or_default();
    let schemas = api.pointer_mut("/components/schemas");
    if let Some(schemas) = schemas.and_then(Value::as_object_mut) {
        let answers = schemas
            .iter_mut()
            .filter(|(name, _)| !REQUESTS.contains(&name.as_str()));
        answers.for_each(|(_, schema)| document::open(schema));
    }
    api.to_string()
});

/// This description.
#[utoipa::path(get, path = "/api/v1/openapi.json", tag = "daemon", responses(
    (status = 200, description = "OpenAPI 3.1", body = Object),
))]
pub async fn description() -> Response {
    ([(header::CONTENT_TYPE, "application/json")], JSON.as_str()).into_response()
}

#[cfg(test)]
mod tests {
    use axum::routing::MethodRouter;

    use super::super::api::{daemon_routes, device_routes};
    use super::*;
    use std::collections::BTreeSet;

    /// Methods of a route, from the debug form of its router.
    fn methods<S>(router: &MethodRouter<S>) -> BTreeSet<String> {
        let shown = format!("{router:?}");
        ["get", "post", "put", "delete", "patch"]
            .into_iter()
            .filter(|method| !shown.contains(&format!(" {method}: None")))
            .map(str::to_owned)
            .collect()
    }

    #[test]
    fn the_description_lists_exactly_the_routes() {
        let described: Value = serde_json::from_str(&JSON).unwrap();
        let paths = described["paths"].as_object().unwrap();
        let devices = device_routes();
        let devices = devices
            .iter()
            .map(|(path, router)| (*path, methods(router)));
        let daemon = daemon_routes();
        let daemon = daemon.iter().map(|(path, router)| (*path, methods(router)));
        let ours: std::collections::BTreeMap<&str, _> = devices.chain(daemon).collect();
        let theirs: BTreeSet<&str> = paths.keys().map(String::as_str).collect();
        let mut all: BTreeSet<&str> = ours.keys().copied().collect();
        all.extend(["/", "/login", "/logout"]);
        assert_eq!(all, theirs);
        for (path, methods) in ours {
            let described = paths[path].as_object().unwrap().keys();
            let described: BTreeSet<String> = described
                .filter(|key| *key != "parameters")
                .cloned()
                .collect();
            assert_eq!(methods, described, "{path}");
        }
    }

    #[test]
    fn the_description_lists_every_format() {
        let described: Value = serde_json::from_str(&JSON).unwrap();
        let parameters = &described["paths"]["/api/v1/scans/{id}/cloud"]["get"]["parameters"];
        let format = parameters
            .as_array()
            .unwrap()
            .iter()
            .find(|p| p["name"] == "format");
        let listed = format.unwrap()["schema"]["enum"].as_array().unwrap();
        let ours: Vec<&str> = Format::single_files().map(Format::extension).collect();
        assert_eq!(
            listed
                .iter()
                .map(|name| name.as_str().unwrap())
                .collect::<Vec<_>>(),
            ours
        );
    }

    /// Clients that validate answers accept those of later versions.
    #[test]
    fn only_requests_are_closed_to_new_keys() {
        let described: Value = serde_json::from_str(&JSON).unwrap();
        let schemas = described["components"]["schemas"].as_object().unwrap();
        for (name, schema) in schemas {
            let is_closed = schema
                .to_string()
                .contains("\"additionalProperties\":false");
            assert_eq!(is_closed, REQUESTS.contains(&name.as_str()), "{name}");
        }
    }

    /// Keys of an object of a schema; those of each variant where it has some.
    fn keys(schemas: &Value, schema: &Value) -> Vec<BTreeSet<String>> {
        if let Some(reference) = schema["$ref"].as_str() {
            return keys(schemas, &schemas[reference.rsplit('/').next().unwrap()]);
        }
        if let Some(variants) = schema["oneOf"].as_array() {
            return variants.iter().flat_map(|v| keys(schemas, v)).collect();
        }
        let parts = schema["allOf"].as_array().into_iter().flatten();
        let mut all: BTreeSet<String> = parts
            .flat_map(|part| keys(schemas, part).into_iter().flatten())
            .collect();
        let own = schema["properties"].as_object().into_iter();
        all.extend(own.flat_map(|own| own.keys().cloned()));
        vec![all]
    }

    /// An example has exactly the keys of its schema, or, of a request, some of them.
    #[test]
    fn examples_have_the_keys_of_their_schemas() {
        let described: Value = serde_json::from_str(&JSON).unwrap();
        let all = &described["components"]["schemas"];
        let schemas = all.as_object().unwrap();
        let mut checked = 0;
        for (name, schema) in schemas {
            let Some(example) = schema["example"].as_object() else {
                continue;
            };
            let given: BTreeSet<String> = example.keys().cloned().collect();
            let is_request = REQUESTS.contains(&name.as_str());
            let known = keys(all, schema);
            let fits = |known: &BTreeSet<String>| match is_request {
                true => given.is_subset(known),
                false => given == *known,
            };
            assert!(known.iter().any(fits), "{name}: {given:?} of {known:?}");
            checked += 1;
        }
        assert!(checked >= 15, "{checked}");
        let operations = described["paths"].as_object().unwrap().values();
        let operations = operations.flat_map(|path| path.as_object().unwrap().values());
        let operations: Vec<&Value> = operations.collect();
        let answers = operations
            .iter()
            .filter_map(|operation| operation["responses"].as_object());
        for answer in answers.flat_map(|answers| answers.values()) {
            let schema = answer.pointer("/content/application~1json/schema/$ref");
            if let Some(name) = schema.and_then(|schema| schema.as_str()?.rsplit('/').next()) {
                assert!(schemas[name]["example"].is_object(), "{name}");
            }
        }
        let bodies = operations.iter().filter_map(|operation| {
            let body = operation.pointer("/requestBody/content/application~1json/schema/$ref")?;
            body.as_str()?.rsplit('/').next()
        });
        let bodies: BTreeSet<&str> = bodies.collect();
        assert_eq!(bodies, REQUESTS.into());
        for name in bodies {
            assert!(schemas[name]["example"].is_object(), "{name}");
        }
    }

    /// Too many clients or wrong tokens refuse any request, with a time to wait.
    #[test]
    fn every_request_may_be_one_too_many() {
        let described: Value = serde_json::from_str(&JSON).unwrap();
        let paths = described["paths"].as_object().unwrap().values();
        let operations = paths.flat_map(|path| path.as_object().unwrap());
        for (method, operation) in operations.filter(|(method, _)| *method != "parameters") {
            assert!(
                operation["responses"]["429"].is_object(),
                "{method} {operation}"
            );
        }
        for name in ["Limit", "NotNow"] {
            let answer = &described["components"]["responses"][name];
            assert!(answer["headers"]["Retry-After"].is_object(), "{answer}");
        }
    }

    #[test]
    fn every_reference_in_the_description_resolves() {
        let described: Value = serde_json::from_str(&JSON).unwrap();
        let mut references = Vec::new();
        collect(&described, &mut references);
        assert!(references.len() > 20);
        for reference in references {
            let pointer = reference.trim_start_matches('#');
            assert!(described.pointer(pointer).is_some(), "{reference}");
        }
    }

    fn collect(value: &Value, into: &mut Vec<String>) {
        match value {
            Value::Object(object) => {
                for (key, value) in object {
                    match value.as_str() {
                        Some(text) if key == "$ref" => into.push(text.to_owned()),
                        _ => collect(value, into),
                    }
                }
            }
            Value::Array(array) => array.iter().for_each(|v| collect(v, into)),
            _ => {}
        }
    }
}
