//! The elements and attributes of a campaign file. `spec/campaign.xsd` contains the same schema; a
//! test validates files with both.

use rtf_plan::suite::schema::{ElementSchema, leaf};

pub(super) const CAMPAIGN: ElementSchema = ElementSchema {
    name: "campaign",
    attributes: &["name", "suite", "episodes", "seed", "repeats", "budget"],
    elements: &["description", "parameter", "constraint", "claim", "stop", "versions"],
    text: false,
};

/// `<parameter>` without a known distribution.
pub(super) const PARAMETER: ElementSchema = leaf(
    "parameter",
    &["name", "distribution", "values", "file", "low", "high", "mean", "deviation", "nominal"],
);
/// `<parameter>` with `grid` or `choice`.
pub(super) const WORDS: ElementSchema =
    leaf("parameter", &["name", "distribution", "values", "nominal"]);
/// `<parameter distribution="file">`.
pub(super) const FILE: ElementSchema =
    leaf("parameter distribution=\"file\"", &["distribution", "file"]);
/// `<parameter distribution="uniform">`.
pub(super) const UNIFORM: ElementSchema =
    leaf("parameter distribution=\"uniform\"", &["name", "distribution", "low", "high", "nominal"]);
/// `<parameter distribution="normal">`.
pub(super) const NORMAL: ElementSchema = leaf(
    "parameter distribution=\"normal\"",
    &["name", "distribution", "mean", "deviation", "nominal"],
);
/// `<parameter>` with a design: `latin-hypercube` or `sobol`.
pub(super) const DESIGN: ElementSchema = leaf(
    "parameter",
    &["name", "distribution", "values", "low", "high", "mean", "deviation", "nominal"],
);

pub(super) const CONSTRAINT: ElementSchema = leaf("constraint", &["require"]);
pub(super) const CLAIM: ElementSchema = leaf("claim", &["require", "confidence"]);
pub(super) const STOP: ElementSchema = leaf("stop", &["rule"]);
pub(super) const VERSIONS: ElementSchema = leaf("versions", &["parameter", "values", "blinded"]);
/// `<stop rule="sprt">`.
pub(super) const SPRT: ElementSchema =
    leaf("stop rule=\"sprt\"", &["rule", "low", "high", "alpha", "beta"]);
