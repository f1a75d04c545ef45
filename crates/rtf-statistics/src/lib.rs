//! Statistics of passed and failed results, and reproducible random numbers. Pure functions: no
//! I/O, no clock, no global state.
//!
//! - [`wilson`] and [`exact`]: a rate with its interval, for a number of trials that was fixed in
//!   advance. The exact one is for decisions.
//! - [`sprt`] and [`confidence_sequence`]: decisions that may be made after each trial.
//! - [`paired`] and [`independent`]: two versions, on the same trials or on different ones;
//!   [`difference`] has the size of the effect.
//! - [`mod@holm`]: several claims at once.
//! - [`sample_size`]: how many trials a comparison needs.
//! - [`mod@strata`]: rates by bins of a parameter.
//! - [`random`]: random numbers that are the same on every machine, and the quantile of the
//!   normal distribution.
//!
//! Random numbers and sequential decisions use the logarithm of the crate `libm`, not that of the
//! system, so that they are the same on every machine.

pub mod confidence_sequence;
pub mod difference;
pub mod exact;
pub mod holm;
pub mod independent;
pub mod paired;
pub mod random;
pub mod sample_size;
pub mod sprt;
pub mod strata;
pub mod wilson;

pub use confidence_sequence::ConfidenceSequence;
pub use difference::{Counts, Difference, PairCounts};
pub use exact::exact_rate;
pub use holm::holm;
pub use random::RandomStream;
pub use sprt::{Accepted, Sprt};
pub use strata::{Stratum, strata};
pub use wilson::{CONFIDENCE, Rate, rate};

/// Whether a number is between 0 and 1, both excluded.
fn is_probability(number: f64) -> bool {
    number > 0.0 && number < 1.0
}
