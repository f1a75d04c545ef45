//! The fuzz targets.

mod abi_texts;
mod campaign;
mod config;
mod filter;
mod frameworks;
mod history;
mod journal;
mod labels;
mod limits;
mod monitor;
mod protocol;
mod suite;
mod web;

use crate::Target;

/// All targets.
pub const TARGETS: &[Target] = &[
    Target { name: "abi", check: abi_texts::check, more: &[] },
    Target {
        name: "campaign",
        check: campaign::check,
        more: &["crates/rtf-campaign/tests/campaign/golden", "examples/10-campaign/campaign.xml"],
    },
    Target { name: "config", check: config::check, more: &[] },
    Target { name: "constraint", check: campaign::check_constraint, more: &[] },
    Target { name: "duration", check: suite::check_duration, more: &[] },
    Target { name: "event", check: journal::check_event, more: &[] },
    Target { name: "filter", check: filter::check, more: &[] },
    Target { name: "framework-boost", check: frameworks::boost, more: &[] },
    Target { name: "framework-cargo", check: frameworks::cargo, more: &[] },
    Target { name: "framework-catch2", check: frameworks::catch2, more: &[] },
    Target { name: "framework-ctest", check: frameworks::ctest, more: &[] },
    Target { name: "framework-doctest", check: frameworks::doctest, more: &[] },
    Target { name: "framework-go", check: frameworks::go, more: &[] },
    Target { name: "framework-gtest", check: frameworks::gtest, more: &[] },
    Target { name: "framework-junit", check: frameworks::junit, more: &[] },
    Target { name: "framework-rostest", check: frameworks::rostest, more: &[] },
    Target { name: "framework-tap", check: frameworks::tap, more: &[] },
    Target { name: "history", check: history::check, more: &[] },
    Target { name: "host-line", check: protocol::check_request, more: &[] },
    Target { name: "journal", check: journal::check, more: &["crates/rtf-report/tests/streams"] },
    Target { name: "journal-torn", check: journal::check_torn, more: &[] },
    Target { name: "limits", check: limits::check, more: &["examples/11-signals/arm.limits.yaml"] },
    Target { name: "monitor", check: monitor::check, more: &[] },
    Target { name: "picture", check: limits::check_picture, more: &[] },
    Target { name: "runner-line", check: protocol::check_host_message, more: &[] },
    Target { name: "suite", check: suite::check, more: &["crates/rtf-plan/tests/data"] },
    Target { name: "trajectory", check: limits::check_trajectory, more: &[] },
    Target { name: "web", check: web::check, more: &[] },
];
