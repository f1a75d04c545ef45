//! Statistics compared with SciPy; exact and simulated error rates; the tables of
//! `docs/explanation/campaign-statistics.md`.

#![expect(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    reason = "a test ends there; counts are far below 2^53"
)]

mod binomial;
mod comparisons;
mod documented;
mod error_rates;
mod scipy;
