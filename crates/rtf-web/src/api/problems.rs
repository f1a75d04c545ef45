//! The problems that every route may answer, for the API's description.

use std::collections::BTreeMap;

use utoipa::IntoResponses;
use utoipa::openapi::{ContentBuilder, Ref, RefOr, Response, ResponseBuilder};

/// 400, 401, 403, 404, 421 and 503.
#[derive(Debug)]
pub struct Problems;

/// What every change may answer, too: 405, 409, 413 and 415.
#[derive(Debug)]
pub struct ChangeProblems;

impl IntoResponses for Problems {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        described(&[
            ("400", "a bad query"),
            ("401", "the token is missing or wrong"),
            ("403", "a foreign `Origin`"),
            ("404", "there is no such thing"),
            ("421", "a foreign `Host`"),
            ("503", "a journal that cannot be read"),
        ])
    }
}

impl IntoResponses for ChangeProblems {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let more = described(&[
            ("409", "it cannot be done now"),
            ("413", "the body is too long"),
            ("415", "the body is not JSON"),
        ]);
        Problems::responses().into_iter().chain(more).collect()
    }
}

fn described(codes: &[(&str, &str)]) -> BTreeMap<String, RefOr<Response>> {
    let response = |text: &str| {
        let schema = Ref::from_schema_name("Problem");
        let content = ContentBuilder::new().schema(Some(schema)).build();
        ResponseBuilder::new().description(text).content("application/problem+json", content)
    };
    codes.iter().map(|(code, text)| ((*code).to_owned(), response(text).build().into())).collect()
}
