//! JSON Schema of a scene, with which editors complete and check its TOML.

use super::{Form, Key, SCENE, Without};
use crate::tree::Range;
use serde_json::{Map, Value, json};

/// Schema `docs/amberfield.schema.json`, as text.
#[must_use]
pub fn schema() -> String {
    let mut root = table(SCENE);
    let head = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of amberfield",
    });
    for (key, value) in head.as_object().into_iter().flatten() {
        root.insert(key.clone(), value.clone());
    }
    let mut text = serde_json::to_string_pretty(&root).unwrap_or_default();
    text.push('\n');
    text
}

/// Schema of a table.
fn table(keys: &[Key]) -> Map<String, Value> {
    let properties: Map<String, Value> =
        keys.iter().map(|key| (key.name.to_owned(), Value::Object(entry(key)))).collect();
    let required: Vec<&str> =
        keys.iter().filter(|key| key.without == Without::Required).map(|key| key.name).collect();
    let mut schema = Map::new();
    schema.insert("type".to_owned(), json!("object"));
    schema.insert("additionalProperties".to_owned(), json!(false));
    schema.insert("properties".to_owned(), Value::Object(properties));
    if !required.is_empty() {
        schema.insert("required".to_owned(), json!(required));
    }
    schema
}

/// Schema of a key's value, with its description.
fn entry(key: &Key) -> Map<String, Value> {
    let mut schema = form(&key.form);
    let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
    schema.insert("description".to_owned(), json!(format!("{}{unit}", key.meaning)));
    if let Without::Value(value) = key.without {
        schema.insert("default".to_owned(), of_toml(value));
    }
    if !key.example.is_empty() {
        schema.insert("examples".to_owned(), json!([of_toml(key.example)]));
    }
    schema
}

fn of_toml(value: &str) -> Value {
    let table: toml::Table = format!("value = {value}").parse().unwrap_or_default();
    table.get("value").and_then(|value| serde_json::to_value(value).ok()).unwrap_or(Value::Null)
}

fn form(form: &Form) -> Map<String, Value> {
    let schema = match form {
        Form::Number(range) => number(*range),
        Form::Whole(least, most) => json!({ "type": "integer", "minimum": least, "maximum": most }),
        Form::Boolean => json!({ "type": "boolean" }),
        Form::Text => json!({ "type": "string", "minLength": 1 }),
        Form::Word(words) => json!({ "enum": words }),
        Form::Words(words) => json!({ "type": "array", "items": { "enum": words } }),
        Form::Vector(range) => {
            json!({ "type": "array", "items": number(*range), "minItems": 3, "maxItems": 3 })
        }
        Form::Numbers(range) => json!({ "type": "array", "items": number(*range) }),
        Form::Pairs(first, second) => json!({
            "type": "array", "minItems": 1,
            "items": {
                "type": "array", "minItems": 2, "maxItems": 2, "items": [number(*first), number(*second)],
            },
        }),
        Form::Wholes(least, most) => json!({
            "type": "array", "minItems": 3, "maxItems": 3,
            "items": { "type": "integer", "minimum": least, "maximum": most },
        }),
        Form::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Form::Anything => json!({}),
        Form::Table(keys) => Value::Object(table(keys)),
        Form::Tables(keys) => json!({ "type": "array", "items": table(keys) }),
        Form::Either(forms) => json!({ "anyOf": forms.iter().map(self::form).collect::<Vec<_>>() }),
    };
    match schema {
        Value::Object(schema) => schema,
        _ => Map::new(),
    }
}

fn number(range: Range) -> Value {
    let (low, included, high) = range.ends();
    let least = if included { "minimum" } else { "exclusiveMinimum" };
    json!({ "type": "number", least: low, "maximum": high })
}
