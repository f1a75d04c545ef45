//! Stand-ins for the types of `rtf-model` in the API's description. Their schemas
//! are those of the journal, which `cargo xtask schemas` puts in their place: the
//! model does not depend on this API.

use std::borrow::Cow;

use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{Object, Schema};
use utoipa::{PartialSchema, ToSchema};

macro_rules! model {
    ($($name:ident),* $(,)?) => {
        /// The names of the model's types that the API speaks of.
        pub const NAMES: &[&str] = &[$(stringify!($name)),*];
        $(
            #[doc = concat!("`rtf_model::", stringify!($name), "`")]
            #[derive(Debug)]
            pub struct $name;

            impl PartialSchema for $name {
                fn schema() -> RefOr<Schema> {
                    RefOr::T(Schema::Object(Object::default()))
                }
            }

            impl ToSchema for $name {
                fn name() -> Cow<'static, str> {
                    Cow::Borrowed(stringify!($name))
                }
            }
        )*
    };
}

model! {
    Attachment, Diagnostic, Event, ExitStatus, ExpectedFailure, FaultKind, LeakedProcess, Location,
    Measurement, Message, Parameter, Phase, Question, Respondent, Revision, Stream, SuitePrepared,
    Trigger, Verdict,
}
