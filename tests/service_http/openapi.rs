//! The description of the interface holds all that is answered, and nothing else.

use serde_json::Value;

use super::client::Client;
use super::stand_in::{outside, settings};

/// A path with something in the place of its parameters.
fn filled(path: &str) -> String {
    path.replace("{name}", "move-000001").replace("{id}", "1")
}

#[test]
fn every_route_is_in_the_description_and_every_description_is_a_route() {
    let outside = outside(settings(), None);
    let mut client = Client::new(outside.address);
    let document = client.get("/openapi.json").json();
    assert_eq!(document["openapi"], "3.1.0");
    let paths = document["paths"].as_object().expect("paths");
    for (path, methods) in paths {
        let methods = methods.as_object().expect("methods");
        for method in ["get", "post", "delete", "put", "patch"] {
            // Each time anew: a refused WebSocket closes its connection.
            let mut client = Client::new(outside.address);
            let answer = client.send(&method.to_uppercase(), &filled(path), &[], b"");
            let unknown = answer.text().contains("there is nothing at");
            assert!(!unknown, "{path}");
            let known = methods.contains_key(method);
            assert_eq!(
                answer.status != 405,
                known,
                "{method} {path}: {}",
                answer.status
            );
        }
        let Some(unversioned) = path.strip_prefix("/api/v1") else {
            continue;
        };
        // The old name answers alike, and says that it is old.
        let old = filled(&format!("/api{unversioned}"));
        let mut client = Client::new(outside.address);
        let answer = client.get(&old);
        assert!(!answer.text().contains("there is nothing at"), "{old}");
        // What the library itself refuses, a WebSocket that is none, is answered anew.
        if ![400, 405].contains(&answer.status) {
            let head = answer.head.to_lowercase();
            assert!(head.contains("deprecation: @"), "{old}: {head}");
        }
    }
    // The table of the program's own documentation is this one: nothing is routed beside it.
    let router = include_str!("../../src/service/http/mod.rs");
    let beside = router.matches(".route(").count();
    assert_eq!(beside, 2, "only the two of a stop beyond the places");
    references(&document, &document);
}

/// Each reference leads to something.
fn references(value: &Value, document: &Value) {
    match value {
        Value::Object(object) => {
            if let Some(Value::String(reference)) = object.get("$ref") {
                let found = document.pointer(reference.trim_start_matches('#'));
                assert!(found.is_some(), "{reference}");
            }
            object
                .values()
                .for_each(|inner| references(inner, document));
        }
        Value::Array(array) => array.iter().for_each(|inner| references(inner, document)),
        _ => {}
    }
}

#[test]
fn several_joints_are_named_with_their_targets() {
    let outside = outside(settings(), None);
    let mut client = Client::new(outside.address);
    let one = r#"{"joint": "joint_1", "target_deg": 30}"#;
    let together = client.post("/api/v1/move", &format!(r#"{{"joints": [{one}]}}"#));
    assert_eq!(
        together.json()["accepted"],
        "together",
        "{}",
        together.text()
    );
    for (body, words) in [
        (
            r#"{"joint": "joint_1", "target_deg": 1, "joints": []}"#,
            "give either joint",
        ),
        (r#"{"joints": [], "target_deg": 1}"#, "give either joint"),
        (
            r#"{"joints": [{"joint": "elbow", "target_deg": 1}]}"#,
            "no joint",
        ),
        (r#"{"joints": [{"joint": "joint_1"}]}"#, "exactly one of"),
        (
            r#"{"joints": [{"joint": "joint_1", "target_deg": 101}]}"#,
            "from -100 to 100",
        ),
    ] {
        let answer = client.post("/api/v1/move", body);
        assert_eq!(answer.status, 422, "{body}");
        assert!(answer.error().contains(words), "{body}: {}", answer.error());
    }
}
