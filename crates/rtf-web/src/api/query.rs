//! What a request asks for: its path and its query, or a problem in JSON.

use axum::extract::{FromRequestParts, Path, Query};
use axum::http::request::Parts;
use rtf_model::Verdict;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use utoipa::IntoParams;

use crate::problem::Problem;

/// Parts of the path.
#[derive(Debug)]
pub struct At<T>(pub T);

/// The query.
#[derive(Debug)]
pub struct QueryParams<T>(pub T);

impl<T: DeserializeOwned + Send, S: Send + Sync> FromRequestParts<S> for At<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let path = Path::<T>::from_request_parts(parts, state).await;
        path.map(|Path(path)| Self(path)).map_err(|error| Problem::not_found(error.body_text()))
    }
}

impl<T: DeserializeOwned + Send, S: Send + Sync> FromRequestParts<S> for QueryParams<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let query = Query::<T>::from_request_parts(parts, state).await;
        query.map(|Query(query)| Self(query)).map_err(|e| Problem::bad_request(e.body_text()))
    }
}

/// A number of an event or a byte: one that every JSON reader takes exactly.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "u64")]
pub struct Number(pub u64);

/// The largest [`Number`].
const LARGEST_NUMBER: u64 = (1 << 53) - 1;

impl TryFrom<u64> for Number {
    type Error = String;

    fn try_from(number: u64) -> Result<Self, String> {
        match number {
            0..=LARGEST_NUMBER => Ok(Self(number)),
            _ => Err(format!("{number} is larger than {LARGEST_NUMBER}")),
        }
    }
}

/// The values of a list of words that are separated by commas.
///
/// # Errors
/// One of the words is not known.
pub fn values<T: Copy>(name: &str, list: &str, known: &[(&str, T)]) -> Result<Vec<T>, Problem> {
    let value = |word: &str| {
        let found = known.iter().find(|(known, _)| *known == word);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let known: Vec<_> = known.iter().map(|(known, _)| format!("`{known}`")).collect();
            let known = known.join(", ");
            Problem::bad_request(format!("`{name}` has `{word}`, expected some of {known}"))
        })
    };
    list.split(',').map(value).collect()
}

/// The verdicts that were asked for.
///
/// # Errors
/// As for [`values`].
pub fn verdicts(list: Option<&str>) -> Result<Option<Vec<Verdict>>, Problem> {
    let known = Verdict::ALL.map(|verdict| (verdict.as_str(), verdict));
    list.map(|list| values("verdict", list, &known)).transpose()
}

/// A page of a list.
#[derive(Clone, Copy, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct PageQuery {
    /// The `next` of the page before.
    #[param(value_type = Option<u64>, maximum = 9_007_199_254_740_991_i64)]
    pub after: Option<Number>,
    /// How many entries at most.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    pub limit: Option<usize>,
}

/// A page of a list of an attempt of a test.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CasePageQuery {
    /// Only those of this case and of the cases that it contains.
    #[param(maximum = 4_294_967_295_i64)]
    pub case: Option<u32>,
    /// The `next` of the page before.
    #[param(value_type = Option<u64>, maximum = 9_007_199_254_740_991_i64)]
    pub after: Option<Number>,
    /// How many entries at most.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    pub limit: Option<usize>,
}

impl CasePageQuery {
    /// The page.
    pub fn page(&self) -> PageQuery {
        PageQuery { after: self.after, limit: self.limit }
    }
}

/// Default number of entries per page.
const PAGE: usize = 100;
/// How many it may have.
const LARGEST_PAGE: usize = 1000;

impl PageQuery {
    /// How many entries are wanted.
    ///
    /// # Errors
    /// More than a page may have, or none.
    pub fn limit(&self) -> Result<usize, Problem> {
        limit(self.limit, PAGE)
    }
}

/// A limit that was asked for.
///
/// # Errors
/// More than a page may have, or none.
pub fn limit(asked: Option<usize>, usual: usize) -> Result<usize, Problem> {
    match asked.unwrap_or(usual) {
        limit @ 1..=LARGEST_PAGE => Ok(limit),
        limit => Err(Problem::bad_request(format!(
            "`limit` is {limit}, expected a number from 1 to {LARGEST_PAGE}"
        ))),
    }
}
