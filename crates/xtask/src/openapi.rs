//! The description of the web API: made from its routes, with the schemas of the
//! model, which are those of the journal, in their places.

use rtf_model::{
    Attachment, Diagnostic, Event, ExitStatus, ExpectedFailure, LeakedProcess, Location,
    Measurement, Message, Parameter, Phase, Question, Respondent, Stream, SuitePrepared, Trigger,
    Verdict,
};
use schemars::SchemaGenerator;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value};

/// Where OpenAPI keeps schemas.
const PLACE: &str = "/components/schemas";

/// The description as text.
///
/// # Errors
/// It cannot be written as JSON.
///
/// # Panics
/// When a type of the API has the name of another type of the model.
pub fn description() -> serde_json::Result<String> {
    let mut description = rtf_web::description()?;
    if let Some(Value::Object(schemas)) = description.pointer_mut(PLACE) {
        let model = model();
        schemas.retain(|name, _| !rtf_web::model::NAMES.contains(&name.as_str()));
        let twice: Vec<_> = schemas.keys().filter(|name| model.contains_key(*name)).collect();
        assert!(twice.is_empty(), "types of the API are called as types of the model: {twice:?}");
        schemas.extend(model);
    }
    // What takes the rest of a path is not marked in a description.
    if let Some(Value::Object(paths)) = description.get_mut("paths") {
        *paths = std::mem::take(paths)
            .into_iter()
            .map(|(path, item)| (path.replace("{*", "{"), item))
            .collect();
    }
    serde_json::to_string_pretty(&description)
}

/// The schemas of all types of the model that the API speaks of, and of theirs.
fn model() -> Map<String, Value> {
    let settings = SchemaSettings::draft2020_12().with(|settings| {
        settings.definitions_path = PLACE.into();
    });
    let mut generator = SchemaGenerator::new(settings);
    generator.subschema_for::<Event>();
    generator.subschema_for::<Attachment>();
    generator.subschema_for::<Diagnostic>();
    generator.subschema_for::<ExitStatus>();
    generator.subschema_for::<ExpectedFailure>();
    generator.subschema_for::<LeakedProcess>();
    generator.subschema_for::<Location>();
    generator.subschema_for::<Measurement>();
    generator.subschema_for::<Message>();
    generator.subschema_for::<Parameter>();
    generator.subschema_for::<Phase>();
    generator.subschema_for::<Question>();
    generator.subschema_for::<Respondent>();
    generator.subschema_for::<Stream>();
    generator.subschema_for::<SuitePrepared>();
    generator.subschema_for::<Trigger>();
    generator.subschema_for::<Verdict>();
    generator.take_definitions(true)
}
